"""Our own recordings, what is true of them, and what our receiver makes of them."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from outcome import Place

SKY_STATIC = "sky-static"
BOTH_BANDS = Path(__file__).with_name("b1i-b1c.toml")
"""B1I and B1C at zero IF between them, 20 Msps."""


@dataclass(frozen=True)
class Recording:
    """A synthetic one."""

    meta: Path
    place: Place
    """Latitude and longitude in degrees, height in m, of a receiver that stands still."""
    satellites: tuple[str, ...]
    """In view, RINEX names."""

    @property
    def data(self) -> Path:
        """The samples, ci8."""
        return self.meta.with_suffix(".sigmf-data")

    def drop_samples(self) -> None:
        """Free the disk."""
        self.data.unlink(missing_ok=True)


def sdr_spoof(*arguments: str | Path) -> None:
    """Run one of our commands; its progress goes to stderr."""
    code = "import sys; from sdr_spoof.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", code, *map(str, arguments)]
    subprocess.run(command, check=True, stdout=sys.stderr)


def synthesise(scenario: str | Path, folder: Path) -> Recording:
    """The recording of a scenario, unless it is there already."""
    name = Path(scenario).stem
    meta = folder / f"{name}.sigmf-meta"
    if not meta.with_suffix(".sigmf-data").exists():
        sdr_spoof("synth", scenario, "-o", folder / name, "--force")
    sky = json.loads((folder / f"{name}.truth.json").read_text())["sky"]
    state = sky["receiver"]
    place = (state["latitude_deg"][0], state["longitude_deg"][0], state["height_m"][0])
    names = tuple(f"{s['system']}{s['prn']:02d}" for s in sky["satellites"])
    return Recording(meta, place, names)


def fixes(recording: Recording, folder: Path) -> Path:
    """Our positions and RINEX files of a recording; the folder they are in."""
    if not (folder / "fixes.csv").exists():
        sdr_spoof("fix", recording.meta, "-o", folder, "--force", "--format", "rinex", "csv")
    return folder


def places(folder: Path) -> list[Place]:
    """Latitudes, longitudes and heights of our fixes."""
    with (folder / "fixes.csv").open() as file:
        return [
            (float(r["latitude_deg"]), float(r["longitude_deg"]), float(r["height_m"]))
            for r in csv.DictReader(file)
            if r["latitude_deg"]
        ]
