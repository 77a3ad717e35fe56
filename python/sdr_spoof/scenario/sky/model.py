"""A table ``[sky]`` at work: times, antenna, clock, and the satellites in view."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.base import SPEED_OF_LIGHT

from . import orbits
from .clock import FIRST_S, STEP_S
from .propagation import REFERENCE_HZ, Delays, Propagation
from .ranges import Geometry, geometry, spline
from .track import SkySatellite, Track

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof import _core
    from sdr_spoof.nav.ephemeris import Ephemeris
    from sdr_spoof.nav.integrity import GridPoint
    from sdr_spoof.nav.time import GnssTime

    from .table import SkyTable
    from .trajectory import Trajectory

_LOOK_S = 30.0
"""Spacing at which satellites are looked for above the mask."""


@dataclass(frozen=True)
class View:
    """How one satellite is seen from an antenna, at the knots of a sky."""

    time_s: NDArray[np.float64]
    """Knots, by the receiver's clock, (N,)."""
    way: Geometry
    delays: Delays
    bias_s: NDArray[np.float64]
    """Receiver's clock less that of the satellite, (N,)."""

    @property
    def range_m(self) -> NDArray[np.float64]:
        """Pseudorange without ionosphere, (N,)."""
        total = self.way.distance_m + self.delays.troposphere_m
        return np.asarray(total + SPEED_OF_LIGHT * self.bias_s)

    def ionosphere_m(self, carrier_hz: float) -> NDArray[np.float64]:
        """Delay of a code, advance of a carrier, (N,)."""
        return np.asarray(self.delays.ionosphere_m * (REFERENCE_HZ / carrier_hz) ** 2)

    def spline(self, carrier_hz: float) -> _core.Spline:
        """Pseudorange of a carrier."""
        return spline(self.time_s, self.range_m - self.ionosphere_m(carrier_hz))


class Sky:
    """A table ``[sky]`` for a recording of some length."""

    def __init__(self, table: SkyTable, duration_s: float, seed: int) -> None:
        """Find the satellites.

        Raises:
            ValueError: no orbits for the time, or no satellite in view; the message names the key.
        """
        self.table = table
        self.start: GnssTime = table.start_time
        self.duration_s = duration_s
        steps = math.ceil((duration_s - 2 * FIRST_S) / STEP_S) + 1
        self.time_s: NDArray[np.float64] = FIRST_S + STEP_S * np.arange(steps, dtype=np.float64)
        """Knots, by the receiver's clock."""
        self.clock_s = table.clock.offset_s(steps, seed)
        self.system_s = self.time_s - self.clock_s
        """System time since the start."""
        self.trajectory: Trajectory = table.trajectory(duration_s)
        self.antenna_m = self.trajectory.position_m(self.system_s)
        self.navigation = orbits.navigation(table)
        self.propagation = Propagation.of(table, self.navigation)

    @cached_property
    def reference_m(self) -> NDArray[np.float64]:
        """Earth-fixed place of an array's reference antenna at the knots, (N, 3)."""
        if self.table.array is None:
            return self.antenna_m
        moving = self.table.trajectory(self.duration_s, reference=True)
        return moving.position_m(self.system_s)

    @cached_property
    def ephemerides(self) -> tuple[Ephemeris, ...]:
        """One of each satellite."""
        return orbits.chosen(self.navigation, self.table, self.start, self.duration_s)

    @cached_property
    def satellites(self) -> tuple[SkySatellite, ...]:
        """Those that come above the mask, by system and PRN."""
        tracks = [Track(self, e) for e in self.ephemerides if self._comes_up(e)]
        found = [t.satellite() for t in tracks if t.signals and t.span_s is not None]
        if not found:
            raise ValueError(
                f"elevation_mask_deg: none of the {len(self.ephemerides)} satellites with orbits "
                f"is above {self.table.elevation_mask_deg:g} degrees and sends "
                f"{', '.join(self.table.signals)}; lower it, or correct receiver, start or signals"
            )
        return tuple(sorted(found, key=lambda s: (s.system, s.prn)))

    @cached_property
    def grid(self) -> tuple[GridPoint, ...]:
        """What geostationary BDS satellites tell of the ionosphere, where they do: at the start."""
        return self.propagation.grid(self.start) if self.table.ionosphere_grid else ()

    def view(
        self,
        ephemeris: Ephemeris,
        antenna_m: NDArray[np.float64] | None = None,
        extra_s: NDArray[np.float64] | float = 0.0,
        every: int = 1,
    ) -> View:
        """One satellite from the antenna, or from another place.

        Args:
            ephemeris: its orbit.
            antenna_m: Earth-fixed places at the knots, (N, 3).
            extra_s: what another clock shows beyond the receiver's.
            every: leave all but every so many-th knot out.
        """
        places = (self.antenna_m if antenna_m is None else antenna_m)[::every]
        time_s = self.system_s[::every]
        orbit = orbits.orbit(ephemeris, self.start)
        way = geometry(orbit, orbits.earth_rate(ephemeris), time_s, places)
        offset_s = self.table.bdt_offset_ns * 1e-9 if ephemeris.system == "C" else 0.0
        bias_s = (self.clock_s + extra_s)[::every] - way.clock_s - offset_s
        delays = self.propagation.delays(ephemeris.system, self.start, time_s, places, way)
        return View(self.time_s[::every], way, delays, bias_s)

    def _comes_up(self, ephemeris: Ephemeris) -> bool:
        """Whether it is near or above the mask at one of a few times."""
        if not self.table.override(ephemeris.system, ephemeris.prn).on_air:
            return False
        every = max(1, min(round(_LOOK_S / STEP_S), self.time_s.size - 1))
        highest = float(self.view(ephemeris, every=every).way.elevation_rad.max())
        return math.degrees(highest) > self.table.elevation_mask_deg - 1.0


@lru_cache(maxsize=4)
def sky_of(table: SkyTable, duration_s: float, seed: int) -> Sky:
    """The sky of a table, kept for the next one who asks."""
    return Sky(table, duration_s, seed)
