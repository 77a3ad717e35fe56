"""Increments and measured motion that overlap, and the attitude that fits both."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.errors import InertialError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix

from . import increments
from .alignment_checks import STANDARD_GRAVITY
from .records import ImuLog

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime

LEAST_S = 5.0
"""Shortest time that is fitted."""
_LEAST_EPOCHS = 5
_COURSE_M_S = 3.0


@dataclass(frozen=True)
class MeasuredMotion:
    """What GNSS says of the INS's point at K times."""

    reference: GnssTime | None
    time_s: NDArray[np.float64]
    """Ascending, (K,)."""
    position_m: NDArray[np.float64]
    """Earth-fixed, (K, 3)."""
    velocity_m_s: NDArray[np.float64]
    """Earth-fixed, at these instants (not means since the last), (K, 3)."""


@dataclass(frozen=True)
class Fit:
    """The attitude that fits best for one way to read the IMU."""

    attitude_rad: NDArray[np.float64]
    """Yaw, pitch, roll at the last epoch, (3,)."""
    scatter_m_s: float
    """Root mean square of what is left of velocities."""
    scale: float
    """Measured over sensed."""
    information: NDArray[np.float64]
    """Inverse covariance of the attitude for velocities of 1 m/s noise, (3, 3)."""


@dataclass(frozen=True)
class Task:
    """Increments and epochs that overlap, for the core."""

    log: ImuLog
    interval_s: NDArray[np.float64]
    epochs: NDArray[np.float64]
    length_s: float
    velocity_sigma_m_s: float

    def fits(self, readings: NDArray[np.float64]) -> list[Fit]:
        """One for each reading (C, 8, 3)."""
        rows = _core.inertial_fit(
            np.ascontiguousarray(self.log.rotation_rad),
            np.ascontiguousarray(self.log.velocity_m_s),
            self.interval_s,
            self.epochs,
            np.ascontiguousarray(readings),
        )
        return [Fit(r[:3], float(r[3]), float(r[4]), r[5:].reshape(3, 3)) for r in rows]

    def forces(self) -> tuple[float, float]:
        """Typical specific force, sensed and as velocities and gravity say, m/s^2."""
        sensed = np.linalg.norm(self.log.velocity_m_s, axis=1) / self.interval_s
        rate = np.diff(self.epochs[:, 4:], axis=0) / np.diff(self.epochs[:, :1], axis=0)
        up = self.epochs[1:, 1:4] / np.linalg.norm(self.epochs[1:, 1:4], axis=1)[:, None]
        wanted = np.linalg.norm(rate + STANDARD_GRAVITY * up, axis=1)
        return float(np.median(sensed)), float(np.median(wanted))

    def course(self) -> float | None:
        """At the last epoch; None where it is too slow."""
        latitude, longitude, _ = ecef_to_geodetic(self.epochs[-1, 1:4])
        east, north, _ = enu_matrix(latitude, longitude) @ self.epochs[-1, 4:]
        return float(np.arctan2(east, north)) if np.hypot(east, north) > _COURSE_M_S else None


def reading(
    gyro: NDArray[np.float64] | float = 1.0,
    accelerometer: NDArray[np.float64] | float = 1.0,
    gyro_bias: NDArray[np.float64] | float = 0.0,
    accelerometer_bias: NDArray[np.float64] | float = 0.0,
) -> NDArray[np.float64]:
    """How the IMU is read, (8, 3): matrices (or factors), then biases that are taken off."""
    rows = np.zeros((8, 3))
    rows[:3] = gyro * np.eye(3) if np.ndim(gyro) == 0 else gyro
    rows[3:6] = accelerometer * np.eye(3) if np.ndim(accelerometer) == 0 else accelerometer
    rows[6], rows[7] = gyro_bias, accelerometer_bias
    return rows


def task(log: ImuLog, motion: MeasuredMotion, sigma: float) -> Task:
    """What an IMU and GNSS (with a sigma of its velocities in m/s) have in common.

    Raises:
        InertialError: too little in common, gaps, or values that are no numbers.
    """
    increments.check(log)
    if None not in (log.reference, motion.reference) and log.reference != motion.reference:
        raise InertialError(
            "times of IMU and GNSS count from different instants: bring both to one"
        )
    values = np.hstack([motion.time_s[:, None], motion.position_m, motion.velocity_m_s])
    if not np.isfinite(values).all():
        raise InertialError("measured motion has values that are no numbers: leave such epochs out")
    begin_s = float(log.time_s[0]) - log.interval_s
    inside = (motion.time_s >= begin_s) & (motion.time_s <= log.time_s[-1])
    length_s = float(np.ptp(motion.time_s[inside])) if inside.any() else 0.0
    if inside.sum() < _LEAST_EPOCHS or length_s < LEAST_S:
        raise InertialError(
            f"IMU ({begin_s:.1f} to {log.time_s[-1]:.1f} s) and GNSS ({motion.time_s[0]:.1f} to "
            f"{motion.time_s[-1]:.1f} s) have {length_s:.1f} s and {inside.sum()} epochs in "
            f"common; {LEAST_S:.0f} s and {_LEAST_EPOCHS} are needed: do their clocks agree?"
        )
    epochs = values[inside]
    keep = slice(
        int(np.searchsorted(log.time_s, epochs[0, 0], side="right")),
        int(np.searchsorted(log.time_s, epochs[-1, 0])) + 1,
    )
    cut = replace(
        log,
        time_s=log.time_s[keep],
        rotation_rad=log.rotation_rad[keep],
        velocity_m_s=log.velocity_m_s[keep],
    )
    _check_whole(cut)
    interval_s = increments.intervals_s(cut)
    epochs[:, 0] -= cut.time_s[0] - interval_s[0]
    return Task(cut, interval_s, epochs, length_s, sigma)


def _check_whole(log: ImuLog) -> None:
    missing = increments.gaps(log)
    if missing:
        raise InertialError(
            f"the IMU misses {missing[0].length_s:.3f} s at {missing[0].start_s:.3f} s: bridge it "
            "(increments.bridged) or align before or after it"
        )
