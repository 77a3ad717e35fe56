"""What aiding finds: where the receiver is, by whom, and who is not believed."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime


class Use(IntEnum):
    """What became of a satellite at an epoch."""

    NONE = 0
    """Not received, or not fit for use."""
    USED = 1
    EXCLUDED = 2
    """The filter does not believe it."""
    NAMED = 3
    """The receiver's own detectors call it spoofed."""


class Guard(IntEnum):
    """What the filter makes of its satellites; the machine is in docs/design.md."""

    STARTING = 0
    TRUSTED = 1
    DECIDING = 2
    PARTIAL = 3
    COASTING = 4


GUARDS = {
    Guard.STARTING: "settling, not tested yet",
    Guard.TRUSTED: "all satellites believed",
    Guard.DECIDING: "alarm: back at a trusted copy, deciding who is wrong",
    Guard.PARTIAL: "some satellites left out",
    Guard.COASTING: "all satellites left out, by the INS alone",
}
"""In words."""


@dataclass(frozen=True)
class Monitor:
    """A number that is watched against a threshold over E epochs."""

    name: str
    time_s: NDArray[np.float64]
    """(E,)"""
    value: NDArray[np.float64]
    """NaN where nothing could be tested, (E,)."""
    threshold: NDArray[np.float64]
    """(E,)"""
    unit: str
    alarm_s: float | None = None
    """First alarm."""
    onset_s: float | None = None
    """Where the disturbance seems to begin."""
    log10_p: float = 0.0
    """Of the strongest value under noise alone."""
    decides: bool = False
    """Whether its alarm alone means spoofing; those of the filter only ask its guard."""


@dataclass(frozen=True)
class SmoothedTrack:
    """The antenna at E epochs by everything that was measured, also later; NaN without an INS."""

    position_m: NDArray[np.float64]
    """Earth-fixed, (E, 3)."""
    velocity_m_s: NDArray[np.float64]
    """Likewise."""
    attitude_rad: NDArray[np.float64]
    """Yaw, pitch, roll, (E, 3)."""
    sigma_enu_m: NDArray[np.float64]
    """East, north, up, (E, 3)."""


@dataclass(frozen=True)
class AidedTrack:
    """E epochs of S satellites."""

    reference: GnssTime
    time_s: NDArray[np.float64]
    """System time since ``reference``, (E,)."""
    position_m: NDArray[np.float64]
    """Antenna, Earth-fixed, (E, 3); NaN where there is no INS."""
    velocity_m_s: NDArray[np.float64]
    """Likewise."""
    attitude_rad: NDArray[np.float64]
    """Yaw, pitch, roll, (E, 3)."""
    sigma_enu_m: NDArray[np.float64]
    """East, north, up, by the filter's own covariance, (E, 3)."""
    horizontal_m: NDArray[np.float64]
    """Horizontal protection level, (E,)."""
    vertical_m: NDArray[np.float64]
    """Vertical protection level, (E,)."""
    alone_m: NDArray[np.float64]
    """Antenna by GNSS alone, all satellites believed, (E, 3); NaN without a fix."""
    satellites: tuple[str, ...]
    """RINEX names."""
    use: NDArray[np.uint8]
    """Values of :class:`Use`, (E, S)."""
    guard: NDArray[np.uint8]
    """Values of :class:`Guard`, (E,)."""
    smoothed: SmoothedTrack | None = None
    """None unless it was asked for."""
    horizontal_one_wrong_m: NDArray[np.float64] | None = None
    """Horizontal protection level whichever one satellite is wrong, (E,); None unless asked for."""
    vertical_one_wrong_m: NDArray[np.float64] | None = None
    """Likewise."""

    def excluded(self) -> dict[str, tuple[tuple[float, float], ...]]:
        """Stretches (from, until) in s in which each satellite was left out."""
        out = (self.use == Use.EXCLUDED) | (self.use == Use.NAMED)
        found = {name: stretches(self.time_s, out[:, k]) for k, name in enumerate(self.satellites)}
        return {name: spans for name, spans in found.items() if spans}


def stretches(
    time_s: NDArray[np.float64], where: NDArray[np.bool_]
) -> tuple[tuple[float, float], ...]:
    """First and last time of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]])))
    return tuple((float(time_s[a]), float(time_s[b - 1])) for a, b in edges.reshape(-1, 2).tolist())
