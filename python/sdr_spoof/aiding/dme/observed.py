"""Differences between an INS and what GNSS and DME measure, epoch by epoch.

Predicted are ranges from the antenna as the INS has it; a gap in its states leaves no prediction.
Satellites of one system are taken, of that with the most, since each system has a clock of its own.
A DME range counts for the epochs within ``dme_clock_s`` of it: its difference is taken at its own
time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from sdr_spoof.errors import AidingError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix
from sdr_spoof.scenario.sky import earth
from sdr_spoof.scenario.sky.trajectory import rotations

from .geometry import Geometry
from .stations import sigma_m, slant_ranges_m

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.nav.time import GnssTime

    from .config import SequentialConfig
    from .records import DmeLog
    from .statistics import Statistic

    Floats = NDArray[np.float64]

GAP = 1.5
"""Usual steps of the INS from which on two states are not joined."""
LEAST_SIGMA_M = 0.1
HELD, HELD_SQUARE = 3.0, 0.995007
"""Steps count with at most so many rough standard deviations, so that glitches do not; the mean
square of normal numbers that are held so. The median alone, 1.4 times as uncertain, alarms more
often than is promised."""


@dataclass(frozen=True)
class Differences:
    """E epochs of n satellites and d stations; NaN where there is none."""

    time_s: NDArray[np.float64]
    """(E,)"""
    satellites: tuple[str, ...]
    differences_m: NDArray[np.float64]
    """Predicted less measured, satellites and then stations, (E, n + d)."""
    to: NDArray[np.float64]
    """Unit vectors to satellites and stations, east, north, up, (E, n + d, 3)."""
    sigma_m: NDArray[np.float64]
    """(E, n + d)"""
    axes: NDArray[np.float64]
    """East, north, up, one a row, Earth-fixed, (3, 3)."""
    error_m: NDArray[np.float64]
    """What the INS is expected to be off: east, north, up, (E, 3)."""
    error_m2: NDArray[np.float64]
    """Covariance of that, (E, 3, 3)."""

    def known(self, epoch: int) -> NDArray[np.int64]:
        """Columns with a difference at an epoch."""
        return np.flatnonzero(np.isfinite(self.differences_m[epoch]))

    def geometry(self, epoch: int, columns: NDArray[np.int64] | None = None) -> Geometry:
        """Of some of the columns, or of all that are known."""
        rows = self.known(epoch) if columns is None else columns
        sats, dmes = (rows[k] for k in (rows < self.count, rows >= self.count))
        to, sigma = self.to[epoch], self.sigma_m[epoch]
        return Geometry.of(to[sats], sigma[sats], to[dmes], sigma[dmes])

    def channels(self, statistic: Statistic, epoch: int, columns: NDArray[np.int64]) -> Floats:
        """A statistic of some columns, less what the INS is expected to add, of unit variance."""
        geometry = self.geometry(epoch, columns)
        weights = statistic.weights(geometry)
        seen = weights @ geometry.design[:, :3]
        spread = 1.0 + np.einsum("ci,ij,cj->c", seen, self.error_m2[epoch], seen)
        left = weights @ self.differences_m[epoch, columns] - seen @ self.error_m[epoch]
        return np.asarray(left / np.sqrt(spread))

    @property
    def learnt(self) -> bool:
        """Whether anything is known of the drift of the INS."""
        return bool(self.error_m2.any())

    @property
    def count(self) -> int:
        """Satellites."""
        return len(self.satellites)


def differences(
    measurements: Measurements,
    ins: InertialStates,
    dme: DmeLog | None,
    config: SequentialConfig,
) -> Differences:
    """Of all epochs.

    Raises:
        AidingError: records do not go together in time, or there are too few satellites.
    """
    shift_s = _shift(measurements, ins.reference)
    antenna = _Antenna(ins, measurements.lever_arm_m)
    columns = _system(measurements)
    places = antenna(measurements.time_s + shift_s)
    if not np.isfinite(places).any():
        raise AidingError(
            "the INS solution and the observations have no time in common; give files of one drive"
        )
    between = measurements.satellite_m[:, columns] - places[:, None]
    distance = np.linalg.norm(between, axis=-1)
    y, to = [distance - measurements.range_m[:, columns]], [between / distance[..., None]]
    sigma = [np.ones_like(distance)]
    if dme is not None and dme.time_s.size:
        found = _dme(measurements, antenna, shift_s, dme, places, config)
        for part, of_dme in zip((y, to, sigma), found, strict=True):
            part.append(of_dme)
    axes, epochs = _axes(places), measurements.time_s.size
    made = Differences(
        measurements.time_s,
        tuple(measurements.satellites[k] for k in columns),
        np.concatenate(y, axis=1),
        np.concatenate(to, axis=1) @ axes.T,
        np.concatenate(sigma, axis=1),
        axes,
        np.zeros((epochs, 3)),
        np.zeros((epochs, 3, 3)),
    )
    return _scaled(made, config)


def _system(measurements: Measurements) -> NDArray[np.int64]:
    systems = np.array(measurements.systems)
    there = np.isfinite(measurements.range_m).any(axis=0)
    names, counts = np.unique(systems[there], return_counts=True)
    if not names.size or counts.max() < 2:
        raise AidingError("there are not two satellites of one system to compare; more are needed")
    return np.flatnonzero(there & (systems == names[counts.argmax()]))


def _shift(measurements: Measurements, reference: GnssTime | None) -> float:
    """What to add to the epochs' times for those of another record."""
    if reference is None or measurements.reference is None:
        return 0.0
    return float(measurements.reference - reference)


class _Antenna:
    """Place of the antenna at any time, as the INS has it; NaN beyond its states and in gaps."""

    def __init__(self, ins: InertialStates, lever_arm_m: tuple[float, float, float]) -> None:
        place = ins.position_m
        if any(lever_arm_m) and np.isfinite(ins.attitude_rad).all():
            forward = rotations(ins.attitude_rad) @ np.array(lever_arm_m)
            enu = forward[:, [1, 0, 2]] * (1.0, 1.0, -1.0)
            place = place + np.einsum("nk,nkx->nx", enu, earth.enu_axes(ins.position_m))
        self._time, self._middle = ins.time_s, place.mean(axis=0)
        steps = np.diff(ins.time_s)
        self._gap = steps > GAP * np.median(steps) if steps.size else np.zeros(0, bool)
        rates = ins.velocity_m_s
        if not np.isfinite(rates).all() or any(lever_arm_m):
            rates = np.gradient(place, ins.time_s, axis=0) if ins.time_s.size > 1 else 0.0 * place
        self._curve: CubicHermiteSpline | None = None
        if ins.time_s.size > 1:
            self._curve = CubicHermiteSpline(ins.time_s, place - self._middle, rates)

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        if self._curve is None:
            return np.full((time_s.size, 3), np.nan)
        found = np.asarray(self._middle + self._curve(time_s))
        step = np.searchsorted(self._time, time_s, side="right") - 1
        outside = (time_s < self._time[0]) | (time_s > self._time[-1])
        # An epoch at a state is known even if a gap follows.
        within = np.clip(step, 0, self._gap.size - 1)
        in_gap = self._gap[within] & (np.abs(time_s - self._time[within]) > 1e-6)
        found[outside | in_gap] = np.nan
        return found


def _dme(
    measurements: Measurements,
    antenna: _Antenna,
    shift_s: float,
    dme: DmeLog,
    places: NDArray[np.float64],
    config: SequentialConfig,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Differences, Earth-fixed unit vectors and noise at the epochs, (E, d) and (E, d, 3)."""
    epochs, count = measurements.time_s.size, len(dme.stations)
    at_s = measurements.time_s + _shift(measurements, dme.reference)
    there = np.stack([s.position_m for s in dme.stations])
    between = there - places[:, None]
    distance = np.linalg.norm(between, axis=-1)
    y = np.full((epochs, count), np.nan)
    to_ins_s = shift_s - _shift(measurements, dme.reference)
    own = slant_ranges_m(dme.stations, antenna(dme.time_s + to_ins_s))
    for k in range(count):
        rows = np.flatnonzero(dme.station == k)
        if rows.size:
            near = _nearest(dme.time_s[rows], at_s)
            close = np.abs(dme.time_s[rows][near] - at_s) <= config.dme_clock_s
            y[:, k] = np.where(close, (own[rows, k] - dme.range_m[rows])[near], np.nan)
    return y, between / distance[..., None], sigma_m(distance)


def _nearest(times: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.int64]:
    after = np.clip(np.searchsorted(times, wanted), 0, times.size - 1)
    before = np.maximum(after - 1, 0)
    return np.where(np.abs(times[before] - wanted) <= np.abs(times[after] - wanted), before, after)


def _axes(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """East, north, up at the first place that is known."""
    first = int(np.argmax(np.isfinite(places).all(axis=1)))
    latitude, longitude, _ = ecef_to_geodetic(places[first])
    return enu_matrix(latitude, longitude)


def _scaled(made: Differences, config: SequentialConfig) -> Differences:
    """With the noise of the pseudoranges, given or measured."""
    n = made.count
    sigma = config.sigma_m or _measured_sigma(made, config)
    scaled = made.sigma_m.copy()
    scaled[:, :n] *= sigma
    return replace(made, sigma_m=scaled)


def _measured_sigma(made: Differences, config: SequentialConfig) -> float:
    """From what changes between epochs, the clock taken off: free of bias and of slow drifts."""
    first = made.time_s <= made.time_s[0] + config.baseline_s
    y = made.differences_m[first, : made.count]
    y = y[np.isfinite(y).sum(axis=1) > 1]
    centred = y - np.nanmean(y, axis=1, keepdims=True) if y.size else y
    steps = np.diff(centred, axis=0) / np.sqrt(2.0 * (1.0 - 1.0 / made.count))
    steps = steps[np.isfinite(steps)]
    if steps.size < 20:
        raise AidingError(
            f"the first {config.baseline_s:g} s hold too few pseudoranges to measure their noise; "
            "give it (--sequential-sigma-m) or a longer baseline"
        )
    rough = 1.4826 * float(np.median(np.abs(steps)))
    held = np.minimum(np.abs(steps), HELD * rough)
    return max(float(np.sqrt(np.mean(held**2) / HELD_SQUARE)), LEAST_SIGMA_M)
