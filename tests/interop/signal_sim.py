"""We receive what SignalSim makes: B1I, B1C and C/A."""

from __future__ import annotations

import json
import os
import subprocess
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

from outcome import Errors, Outcome, PeerMissingError
from recordings import places, sdr_spoof

import sdr_spoof as package
from sdr_spoof.sinks.hdf5 import read_result

VARIABLE = "SIGNALSIM"
MOST_M = 10.0
LEAST_FIXES = 5
DURATION_S = 45
_GENERATOR = Path("IFdataGen/IFdataGen")
PLACE = (31.2, 121.5, 30.0)
ORBITS = Path(package.__file__).parent / "scenario" / "data" / "brdc-2023-03-12.rnx"
RATE_MSPS = 5.0
"""No multiple of the chip rate: there, delays of unfiltered chips are known to a sample only."""


@dataclass(frozen=True)
class Part:
    """A recording; one of both bands together would be five times as long in the making."""

    name: str
    centre_mhz: float
    sent: tuple[tuple[str, str], ...]
    """Systems and signals as SignalSim names them."""
    messages: tuple[str, ...]
    """Signals whose messages must be decoded."""


PARTS = (
    Part("b1i", 1561.098, (("BDS", "B1I"),), ("B1I",)),
    Part("b1c-l1ca", 1575.42, (("BDS", "B1C"), ("GPS", "L1CA")), ("B1CD", "L1CA")),
)


def run(folder: Path) -> list[Outcome]:
    """Its sky, as our own would be: every satellite's messages, and its place.

    Its B-CNAV1: the check symbols of subframe 3 are made with the matrix of subframe 2, and those
    of subframe 2 are wrong too where it was built with ``-std=c++11``, as its Makefile has it: the
    matrix is a text with ``??=`` in it, which that standard reads as ``#``. Build it with
    ``-std=gnu++11``.
    """
    program = _program()
    outcomes = []
    for part in PARTS:
        work = (folder / "signalsim" / part.name).resolve()
        work.mkdir(parents=True, exist_ok=True)
        samples = work / "signalsim.bin"
        try:
            _generate(program, work, _scenario(part, samples))
            _receive(part, samples, work)
        finally:
            samples.unlink(missing_ok=True)
        outcomes += [_frames(part, work), _position(part, work)]
    return outcomes


def _program() -> Path:
    root = os.environ.get(VARIABLE)
    program = Path(root or "").resolve() / _GENERATOR
    if root is None or not program.is_file():
        raise PeerMissingError(
            f"set {VARIABLE} to a folder of SignalSim in which {_GENERATOR} has been built"
        )
    return program


def _generate(program: Path, work: Path, scenario: dict[str, object]) -> None:
    settings = work / "signalsim.json"
    settings.write_text(json.dumps(scenario, indent=1))
    command = [program, "-c", settings, "-st"]  # its threads wait for each other each millisecond
    done = subprocess.run(command, cwd=work, capture_output=True, check=True)
    (work / "run.log").write_bytes(done.stdout)


def _scenario(part: Part, samples: Path) -> dict[str, object]:
    latitude, longitude, height = PLACE
    return {
        "version": 1.0,
        "description": "for sdr-spoof",
        "time": {"type": "UTC", "year": 2023, "month": 3, "day": 12}
        | {"hour": 12, "minute": 0, "second": 0},
        "trajectory": {
            "name": "static",
            "initPosition": {"type": "LLA", "format": "d"}
            | {"longitude": longitude, "latitude": latitude, "altitude": height},
            "initVelocity": {"type": "SCU", "speed": 0, "course": 0},
            "trajectoryList": [{"type": "Const", "time": DURATION_S}],
        },
        "ephemeris": {"type": "RINEX", "name": str(ORBITS)},
        "output": {
            "type": "IFdata",
            "format": "IQ8",
            "sampleFreq": RATE_MSPS,
            "centerFreq": part.centre_mhz,
            "name": str(samples),
            "config": {"elevationMask": 35},
            "systemSelect": [{"system": s, "signal": n, "enable": True} for s, n in part.sent],
        },
        "power": {
            "noiseFloor": -172,
            "initPower": {"unit": "dBHz", "value": 48},
            "elevationAdjust": False,
        },
    }


def _receive(part: Part, samples: Path, work: Path) -> None:
    form = ["--sample-format", "ci8", "--sample-rate-hz", f"{RATE_MSPS * 1e6:.0f}"]
    form += ["--lo-hz", f"{part.centre_mhz * 1e6:.0f}", "--tracking-data-component", "true"]
    sdr_spoof("fix", samples, *form, "-o", work, "--force", "--format", "csv", "hdf5", "rinex")


def _frames(part: Part, work: Path) -> Outcome:
    result = read_result(work / "fixes.h5")
    assert result.navigation is not None
    found: dict[str, list[tuple[int, bool]]] = defaultdict(list)
    for frame in result.navigation.frames:
        found[frame.signal].append((frame.prn, frame.ok))
    figures = ", ".join(
        f"{signal}: {sum(ok for _, ok in frames)} of {len(frames)} frames, of "
        f"{len({prn for prn, ok in frames if ok})} satellites"
        for signal, frames in sorted(found.items())
    )
    passed = all(any(ok for _, ok in found[s]) for s in part.messages)
    return Outcome("SignalSim", f"its messages, {part.name}", passed, figures or "no frame")


def _position(part: Part, work: Path) -> Outcome:
    errors = Errors.of(places(work), PLACE)
    passed = errors.count >= LEAST_FIXES and errors.rms <= MOST_M
    return Outcome("SignalSim", f"its sky, {part.name}", passed, str(errors))
