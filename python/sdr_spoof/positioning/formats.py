"""What positions can be written as: a registry of formats, a file or two each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof.nav.rinex_nav_write import format_navigation
from sdr_spoof.sinks.atomic import write_bytes
from sdr_spoof.sinks.csv_tables import write_fixes_csv, write_observations_csv
from sdr_spoof.sinks.geojson import write_geojson
from sdr_spoof.sinks.hdf5 import Result, write_result
from sdr_spoof.sinks.kml import write_kml
from sdr_spoof.sinks.nmea import write_nmea
from sdr_spoof.sinks.rinex_obs import write_rinex_obs

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from .located import Located


@dataclass(frozen=True)
class Output:
    """One file of a format."""

    name: str
    """In the output folder."""
    write: Callable[[Path, Located, Result, bool], None]
    """Takes the path, what was found, the whole result, and whether to replace a file."""


def _rinex_obs(path: Path, found: Located, result: Result, force: bool) -> None:
    write_rinex_obs(path, found.observations, position_m=found.middle_m, force=force)


def _rinex_nav(path: Path, found: Located, result: Result, force: bool) -> None:
    text = format_navigation(found.navigation, "3.05")
    write_bytes(path, text.encode("ascii"), force=force)


def _rinex_nav4(path: Path, found: Located, result: Result, force: bool) -> None:
    text = format_navigation(found.navigation, "4.00")
    write_bytes(path, text.encode("ascii"), force=force)


def _nmea(path: Path, found: Located, result: Result, force: bool) -> None:
    write_nmea(path, found.route, force=force)


def _geojson(path: Path, found: Located, result: Result, force: bool) -> None:
    write_geojson(path, found.route, force=force)


def _kml(path: Path, found: Located, result: Result, force: bool) -> None:
    write_kml(path, found.route, force=force)


def _fixes(path: Path, found: Located, result: Result, force: bool) -> None:
    write_fixes_csv(path, found.route, force=force)


def _observations(path: Path, found: Located, result: Result, force: bool) -> None:
    write_observations_csv(path, found.observations, force=force)


def _hdf5(path: Path, found: Located, result: Result, force: bool) -> None:
    write_result(path, result, force=force)


FORMATS: dict[str, tuple[Output, ...]] = {
    "rinex": (
        Output("observations.rnx", _rinex_obs),
        Output("navigation.rnx", _rinex_nav),
        Output("navigation4.rnx", _rinex_nav4),
    ),
    "nmea": (Output("track.nmea", _nmea),),
    "geojson": (Output("track.geojson", _geojson),),
    "kml": (Output("track.kml", _kml),),
    "csv": (Output("fixes.csv", _fixes), Output("observations.csv", _observations)),
    "hdf5": (Output("fixes.h5", _hdf5),),
}
"""By the name that ``--format`` takes. RINEX 3.05 navigation files, which any receiver's software
reads, have no place for what RINEX 4 has of B-CNAV1 and BDGIM: both are written."""


def write_formats(
    folder: Path, found: Located, result: Result, formats: Sequence[str], *, force: bool = False
) -> list[Path]:
    """Write the files of some formats into a folder that exists; returns their paths.

    Raises:
        OutputError: a file exists and ``force`` is not set, or cannot be written.
    """
    outputs = [output for name in formats for output in FORMATS[name]]
    for output in outputs:
        output.write(folder / output.name, found, result, force)
    return [folder / output.name for output in outputs]
