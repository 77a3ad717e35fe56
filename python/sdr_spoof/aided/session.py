"""From files to what aiding finds, and to files again."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding import measurements
from sdr_spoof.aiding.imu.readers import read_imu
from sdr_spoof.errors import AidingError
from sdr_spoof.nav.broadcast import Contents
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.store import Store
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.progress import silent
from sdr_spoof.sources.observed import open_observations

from .files import write_csv, write_hdf5
from .run import Aided, aid

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.aiding.imu.readers import ImuReading
    from sdr_spoof.aiding.records import Measurements
    from sdr_spoof.config import Config
    from sdr_spoof.progress import Stages
    from sdr_spoof.sources.observed import Observed


SAME_ARM_M = 0.05
"""Lever arms that differ by less are one."""


@dataclass(frozen=True)
class Session:
    """What aiding found, and what it was made from."""

    aided: Aided
    config: Config
    """Effective."""
    names: tuple[str, str]
    """Of the observations and of the IMU's log."""
    truth_m: NDArray[np.float64] | None = None
    """True antenna at the epochs (E, 3)."""
    notes: tuple[str, ...] = ()
    """What the files said, a sentence each."""

    @property
    def error_m(self) -> dict[str, float] | None:
        """Largest distance from the truth, aided, by GNSS alone, and smoothed if it was asked for;
        None where the truth is unknown."""
        track = self.aided.track
        if self.truth_m is None or track is None:
            return None
        places = {"aided": track.position_m, "gnss_alone": track.alone_m}
        if track.smoothed is not None:
            places["smoothed"] = track.smoothed.position_m
        return {
            name: float(np.nanmax(np.linalg.norm(place - self.truth_m, axis=1)))
            for name, place in places.items()
        }

    def write(self, out: Path, *, force: bool = False) -> None:
        """Write report, HDF5 and CSV into a folder.

        Raises:
            OutputError: one exists and ``force`` is not set, or cannot be written.
        """
        from sdr_spoof.report.aided import write_aided_report  # noqa: PLC0415

        plain = self.config.model_dump(mode="json")
        write_hdf5(out / "aided.h5", self.aided, plain, force=force)
        if self.aided.track is not None:
            write_csv(out / "aided.csv", self.aided.track, force=force)
        write_aided_report(
            out / "aided.html",
            self.aided,
            names=self.names,
            config=plain,
            truth_m=self.truth_m,
            force=force,
        )


def open_session(
    observations: Path,
    imu: Path,
    config: Config,
    *,
    truth: Path | None = None,
    stages: Stages = silent,
) -> Session:
    """Read both files and run everything.

    Raises:
        ObservationError, RecordingError, NavigationError, AidingError, InertialError: a file is
            wrong, or files do not go together; the message says what to do.
    """
    with stages("Reading"):
        observed = open_observations(observations)
        reading = read_imu(imu, config.imu)
    names = observations.name, imu.name
    return session_of(observed, reading, config, names=names, truth=truth, stages=stages)


def session_of(
    observed: Observed,
    imu: ImuReading,
    config: Config,
    *,
    names: tuple[str, str],
    truth: Path | None = None,
    stages: Stages = silent,
) -> Session:
    """As :func:`open_session`, of what has been read; ``names`` are those of the two files."""
    config, mounted = with_lever_arm(config, imu)
    with stages("Measurements"):
        contents, more = orbits_of(observed, config)
        measured = measurements.of(
            observed.observations, contents, config.pvt, lever_arm_m=config.imu.lever_arm_m
        )
    notes = (*observed.notes, *imu.notes, *mounted, *more)
    found = aid(measured, imu.log, config, stages, notes)
    known = None if truth is None else true_places(truth, measured)
    return Session(found, config, names, known, notes)


def with_lever_arm(config: Config, imu: ImuReading) -> tuple[Config, tuple[str, ...]]:
    """The configuration with the lever arm that the IMU's file tells, if it is not given; notes."""
    told, given = imu.lever_arm_m, config.imu.lever_arm_m
    if "lever_arm_m" in config.imu.model_fields_set:
        if told is None or max(abs(a - b) for a, b in zip(told, given, strict=True)) < SAME_ARM_M:
            return config, ()
        note = f"the lever arm given, {_arm(given)} m, is used; the IMU's file says {_arm(told)} m"
        return config, (note,)
    if told is None:
        note = "no lever arm is known (--lever-arm): the antenna is taken to be at the IMU"
        return config, (note,)
    own = config.imu.model_copy(update={"lever_arm_m": told})
    note = f"lever arm of {_arm(told)} m (forward, right, down), as the IMU's file says"
    return config.model_copy(update={"imu": own}), (note,)


def _arm(lever_arm_m: tuple[float, float, float]) -> str:
    return ",".join(f"{v:g}" for v in lever_arm_m)


def orbits_of(observed: Observed, config: Config) -> tuple[Store, tuple[str, ...]]:
    """What was received, and the files.

    Raises:
        AidingError: there are no orbits at all.
    """
    files = [read_navigation(path) for path in config.navigation.files]
    parts = [observed.navigation or Contents(), *files]
    if not any(part.ephemerides for part in parts):
        raise AidingError(
            "there are no orbits of the satellites; give a RINEX navigation file of the same day "
            "with --nav"
        )
    return Store(*parts), tuple(note for file in files for note in file.notes)


def true_places(path: Path, measured: Measurements) -> NDArray[np.float64]:
    """True antenna at the epochs, from the truth beside a synthesised recording (E, 3).

    Raises:
        AidingError: it is no such file, or it is of another time.
    """
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        time_s = np.asarray(told["time_s"], np.float64)
        sky = told["sky"]
        places = np.asarray(sky["receiver"]["position_m"], np.float64)
        start = GnssTime(int(sky["start"]["gpst_s"]), float(sky["start"]["gpst_fraction_s"]))
        clock_s = np.asarray(sky["receiver"]["clock_s"], np.float64)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise AidingError(
            f"{path}: is no truth of a scenario with a [sky] ({error}); leave --truth out"
        ) from error
    assert measured.reference is not None
    at_s = measured.time_s + (measured.reference - start)
    middle = places.mean(axis=0)
    known = [np.interp(at_s, time_s - clock_s, x) for x in (places - middle).T]
    inside = (at_s > time_s[0] - 1.0) & (at_s < time_s[-1] + 1.0)
    return np.where(inside[:, None], np.stack(known, axis=-1) + middle, np.nan)
