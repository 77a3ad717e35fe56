"""We receive what SignalSim makes: B1I, B1C and C/A."""

from __future__ import annotations

import json
import os
import subprocess
from collections import defaultdict
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
RATE_MSPS, CENTRE_MHZ = 20.0, 1568.259
SIGNALS = ("B1I", "B1CD", "L1CA")


def run(folder: Path) -> list[Outcome]:
    """Its sky, as our own would be: every satellite's messages, and its place."""
    program = _program()
    work = (folder / "signalsim").resolve()
    work.mkdir(parents=True, exist_ok=True)
    samples = work / "signalsim.bin"
    try:
        _generate(program, work, samples)
        _receive(samples, work)
    finally:
        samples.unlink(missing_ok=True)
    return [_frames(work), _position(work)]


def _program() -> Path:
    root = os.environ.get(VARIABLE)
    program = Path(root or "").resolve() / _GENERATOR
    if root is None or not program.is_file():
        raise PeerMissingError(
            f"set {VARIABLE} to a folder of SignalSim in which {_GENERATOR} has been built"
        )
    return program


def _generate(program: Path, work: Path, samples: Path) -> None:
    settings = work / "signalsim.json"
    settings.write_text(json.dumps(_scenario(samples), indent=1))
    done = subprocess.run([program, "-c", settings], cwd=work, capture_output=True, check=True)
    (work / "run.log").write_bytes(done.stdout)


def _scenario(samples: Path) -> dict[str, object]:
    latitude, longitude, height = PLACE
    signals = [("GPS", "L1CA"), ("BDS", "B1C"), ("BDS", "B1I")]
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
            "centerFreq": CENTRE_MHZ,
            "name": str(samples),
            "config": {"elevationMask": 35},
            "systemSelect": [{"system": s, "signal": n, "enable": True} for s, n in signals],
        },
        "power": {
            "noiseFloor": -172,
            "initPower": {"unit": "dBHz", "value": 48},
            "elevationAdjust": False,
        },
    }


def _receive(samples: Path, work: Path) -> None:
    form = ["--sample-format", "ci8", "--sample-rate-hz", f"{RATE_MSPS * 1e6:.0f}"]
    form += ["--lo-hz", f"{CENTRE_MHZ * 1e6:.0f}"]
    sdr_spoof("fix", samples, *form, "-o", work, "--force", "--format", "csv", "hdf5", "rinex")


def _frames(work: Path) -> Outcome:
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
    passed = all(any(ok for _, ok in found[s]) for s in SIGNALS)
    return Outcome("SignalSim", "its messages", passed, figures)


def _position(work: Path) -> Outcome:
    errors = Errors.of(places(work), PLACE)
    passed = errors.count >= LEAST_FIXES and errors.rms <= MOST_M
    return Outcome("SignalSim", "its sky", passed, str(errors))
