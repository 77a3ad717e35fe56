"""We receive what SignalSim makes: B1I, B1C and C/A."""

from __future__ import annotations

import json
import os
import subprocess
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from outcome import Errors, Outcome, PeerMissingError, Place
from recordings import places, sdr_spoof

import sdr_spoof as package
from sdr_spoof import pvt
from sdr_spoof.nav.geodesy import ecef_to_geodetic
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.sinks.hdf5 import read_result

VARIABLE = "SIGNALSIM"
MOST_M = 15.0
MOST_CORRECTED_M = 5.0
LEAST_FIXES = 5
DURATION_S = 45
SAMPLES = "signalsim.bin"
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

    Its ranges have GPS's ionosphere in them, whatever the satellite; its messages tell none. So
    places are judged twice: with what was received, and with what it applies.
    """
    program = _program()
    works = [(folder / "signalsim" / part.name).resolve() for part in PARTS]
    try:
        with ThreadPoolExecutor() as together:
            list(together.map(_generate, [program] * len(PARTS), PARTS, works))
        outcomes = []
        for part, work in zip(PARTS, works, strict=True):
            _receive(part, work)
            outcomes += [_frames(part, work), _position(part, work), _corrected(part, work)]
        return outcomes
    finally:
        for work in works:
            (work / SAMPLES).unlink(missing_ok=True)


def _program() -> Path:
    root = os.environ.get(VARIABLE)
    program = Path(root or "").resolve() / _GENERATOR
    if root is None or not program.is_file():
        raise PeerMissingError(
            f"build {_GENERATOR} of SignalSim (globsky/SignalSim on GitHub) with -std=gnu++11 and "
            f"set {VARIABLE} to its folder"
        )
    return program


def _generate(program: Path, part: Part, work: Path) -> None:
    work.mkdir(parents=True, exist_ok=True)
    scenario = _scenario(part, work / SAMPLES)
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


def _receive(part: Part, work: Path) -> None:
    form: list[str | Path] = [
        "--sample-format",
        "ci8",
        "--sample-rate-hz",
        f"{RATE_MSPS * 1e6:.0f}",
    ]
    form += ["--lo-hz", f"{part.centre_mhz * 1e6:.0f}", "--tracking-data-component", "true"]
    sdr_spoof(
        "fix", work / SAMPLES, *form, "-o", work, "--force", "--format", "csv", "hdf5", "rinex"
    )


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
    return _judged(f"its sky, {part.name}", places(work), MOST_M)


def _corrected(part: Part, work: Path) -> Outcome:
    """As if its messages told the ionosphere that it applies: the last one in the file."""
    result = read_result(work / "fixes.h5")
    assert result.navigation is not None and result.observations is not None
    applied = read_navigation(ORBITS).ionosphere[-1:]
    fixes = pvt.solve(result.observations, replace(result.navigation, ionosphere=applied))
    found = ecef_to_geodetic(fixes.position_m[fixes.fixed])
    known = [(float(p[0]), float(p[1]), float(p[2])) for p in found]
    return _judged(f"its sky, {part.name}, its ionosphere told", known, MOST_CORRECTED_M)


def _judged(test: str, found: list[Place], most_m: float) -> Outcome:
    errors = Errors.of(found, PLACE)
    passed = errors.count >= LEAST_FIXES and errors.rms <= most_m
    return Outcome("SignalSim", test, passed, str(errors))
