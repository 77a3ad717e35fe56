"""Where the receiver was, epoch by epoch, as maps, loggers and people want it told."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from .nav.time import GnssTime


class Alarm(IntEnum):
    """What the detectors had said by then."""

    NONE = 0
    SUSPECT = 1
    """A satellite is under suspicion; it is still used, but while another is spoofed only where
    there is no fix without it."""
    SPOOFED = 2
    """A satellite is spoofed; what is used is what is left."""


ALARM_COLOURS = {Alarm.NONE: "#00694f", Alarm.SUSPECT: "#c98a00", Alarm.SPOOFED: "#c0392b"}


class Quality(IntEnum):
    """Whether there is a fix, and whether anything speaks against it: its own residuals, or that
    it rests on satellites under suspicion while others are spoofed."""

    NONE = 0
    FIX = 1
    SUSPECT = 2


@dataclass(frozen=True)
class SatelliteView:
    """A satellite as seen from the receiver: columns of E epochs, NaN where it was not seen."""

    name: str
    """RINEX name."""
    azimuth_deg: NDArray[np.float64]
    elevation_deg: NDArray[np.float64]
    cn0_dbhz: dict[str, NDArray[np.float64]]
    """By registry signal."""
    used: NDArray[np.bool_]
    alarm: NDArray[np.uint8]
    """Values of :class:`Alarm`: what the detectors had said of this satellite by then."""
    residual_m: dict[str, NDArray[np.float64]]
    """Pseudorange less what the fix expects of it, by signal."""


@dataclass(frozen=True)
class Route:
    """E epochs; positions are NaN without a fix."""

    times: tuple[GnssTime, ...]
    """GPST of each epoch, the clock's bias taken out where it is known."""
    sample_time_s: NDArray[np.float64]
    latitude_deg: NDArray[np.float64]
    longitude_deg: NDArray[np.float64]
    height_m: NDArray[np.float64]
    """Above the WGS-84 ellipsoid."""
    velocity_enu_m_s: NDArray[np.float64]
    """(E, 3): east, north, up."""
    sigma_enu_m: NDArray[np.float64]
    """(E, 3): standard deviations by the fix's own account."""
    dop: NDArray[np.float64]
    """(E, 3): of position, horizontal, vertical."""
    quality: NDArray[np.uint8]
    """Values of :class:`Quality`."""
    alarm: NDArray[np.uint8]
    """Values of :class:`Alarm`."""
    satellites: tuple[SatelliteView, ...]

    @property
    def fixed(self) -> NDArray[np.bool_]:
        """Epochs with a position."""
        return np.asarray(self.quality != Quality.NONE)

    def stretches(self) -> Iterator[tuple[Alarm, list[int]]]:
        """Epochs with a position, in stretches of one alarm state; each begins where the last
        one ended, so that lines hang together.
        """
        epochs = [i for i, fixed in enumerate(self.fixed) if fixed]
        last: list[int] = []
        for alarm, group in groupby(epochs, key=lambda i: int(self.alarm[i])):
            members = list(group)
            yield Alarm(alarm), last + members
            last = members[-1:]

    def used(self, epoch: int) -> list[str]:
        """Names of the satellites that the fix of an epoch rests on."""
        return [s.name for s in self.satellites if s.used[epoch]]
