"""GNSS-SDR receives our B1I."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import debian
from outcome import Errors, Outcome, Place
from recordings import SKY_STATIC, Recording, synthesise

MOST_M = 10.0
LEAST_FIXES = 5
CONFIGURATION = Path(__file__).with_name("gnss-sdr.conf")
_FIX = re.compile(r"<trkpt lon=\"([-\d.]+)\" lat=\"([-\d.]+)\"><ele>([-\d.]+)</ele>")


def run(folder: Path) -> list[Outcome]:
    """60 s of B1I of BDS, zero IF, 10 Msps: it must acquire, track, decode and fix."""
    program = debian.require("gnss-sdr", "gnss-sdr")
    recording = synthesise(SKY_STATIC, folder)
    report = _receive(program, recording, folder / "gnss-sdr")
    found = _places(folder / "gnss-sdr")
    errors = Errors.of(found, recording.place)
    tracked = len(set(re.findall(r"Tracking of Beidou B1I signal started.*PRN (\d+)", report)))
    passed = errors.count >= LEAST_FIXES and errors.rms <= MOST_M
    figures = f"{tracked} satellites tracked; {errors}"
    return [Outcome(f"GNSS-SDR {debian.version('gnss-sdr')}", "our B1I", passed, figures)]


def _receive(program: str, recording: Recording, folder: Path) -> str:
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.gpx"):
        old.unlink()
    settings = folder / "gnss-sdr.conf"
    text = CONFIGURATION.read_text()
    settings.write_text(text.replace("RECORDING", str(recording.data.resolve())))
    command = [program, f"--config_file={settings.name}", "--log_dir=."]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    (folder / "run.log").write_text(done.stdout + done.stderr)
    return done.stdout


def _places(folder: Path) -> list[Place]:
    text = "".join(p.read_text() for p in folder.glob("*.gpx"))
    return [(float(lat), float(lon), float(height)) for lon, lat, height in _FIX.findall(text)]
