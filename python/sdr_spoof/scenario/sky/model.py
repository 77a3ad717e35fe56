"""The satellites of a ``[sky]``, and how each of them moves."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.nav.broadcast import Broadcast
from sdr_spoof.nav.time import SYSTEM_EPOCH_S, GnssTime
from sdr_spoof.scenario.base import SPEED_OF_LIGHT
from sdr_spoof.scenario.motion import Motion
from sdr_spoof.scenario.satellite import Satellite
from sdr_spoof.signals import components, satellite_name, signal_spec

from . import messages, orbits
from .clock import FIRST_S, STEP_S
from .propagation import REFERENCE_HZ, Delays, Propagation
from .ranges import Geometry, geometry, spline
from .table import SkyTable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.ephemeris import Ephemeris
    from sdr_spoof.scenario.knots import Knots
    from sdr_spoof.signals import SignalSpec

    from .trajectory import Trajectory

CODE_GRID_S = 18
"""Secondary codes and messages of all signals begin together at multiples of this of a week: the
frame of B-CNAV1 (BDS-SIS-ICD-B1C-1.0, 5.2.3 and 6.2.1); subframes of D1 and LNAV are a third of it,
those of D2 a 30th."""
BDS3_FROM = 19
"""PRN from which on BDS satellites are of the third generation, which sends B1C."""
_LOOK_S = 30.0
"""Spacing at which satellites are looked for above the mask."""
_SLOW_S = 1.0
"""Spacing of what changes slowly: ionosphere and power; straight in between."""


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
        self.trajectory: Trajectory = table.receiver.trajectory(duration_s)
        self.antenna_m = self.trajectory.position_m(self.system_s)
        self.navigation = orbits.navigation(table)
        self.propagation = Propagation.of(table, self.navigation)

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


@dataclass(frozen=True, eq=False)
class Track:
    """One satellite of a sky over a recording."""

    sky: Sky
    ephemeris: Ephemeris
    _shared: dict[float, _core.Spline] = field(default_factory=dict)

    @cached_property
    def view(self) -> View:
        """From the antenna."""
        return self.sky.view(self.ephemeris)

    @property
    def name(self) -> str:
        """RINEX name."""
        return satellite_name(self.ephemeris.system, self.ephemeris.prn)

    @property
    def signals(self) -> tuple[str, ...]:
        """What it sends of the signals of the table."""
        system, prn = self.ephemeris.system, self.ephemeris.prn
        named = self.sky.table.override(system, prn).signals
        wanted = named or self.sky.table.signals
        parts = {s: [signal_spec(c) for c in components(s)] for s in wanted}
        if named is None and system == "C" and prn < BDS3_FROM:
            parts = {s: specs for s, specs in parts.items() if specs[0].composite != "B1C"}
        return tuple(
            s
            for s, specs in parts.items()
            if all(spec.system == system and prn in spec.prns for spec in specs)
        )

    @cached_property
    def span_s(self) -> tuple[float, float] | None:
        """From when to when it is above the mask; infinite where the recording ends earlier."""
        mask = math.radians(self.sky.table.elevation_mask_deg)
        height, time_s = self.view.way.elevation_rad - mask, self.sky.time_s
        above = np.flatnonzero(height > 0)
        if above.size == 0:
            return None
        first, last = int(above[0]), int(above[-1])
        start_s = -math.inf if first == 0 else _crossing_s(time_s, height, first - 1)
        end_s = math.inf if last == height.size - 1 else _crossing_s(time_s, height, last)
        return (start_s, end_s) if start_s < self.sky.duration_s and end_s > 0 else None

    def satellite(self) -> SkySatellite:
        """As the rest of a scenario knows it."""
        table = self.sky.table
        system, prn = self.ephemeris.system, self.ephemeris.prn
        fixed = table.override(system, prn).cn0_dbhz
        made = SkySatellite(
            prn=prn,
            system=system,
            signals=self.signals,
            cn0_dbhz=table.cn0_zenith_dbhz if fixed is None else fixed,
        )
        made._track = self
        return made

    @property
    def reference(self) -> GnssTime:
        """When code phase 0 leaves the satellite, by its own clock: see :data:`CODE_GRID_S`."""
        second = self.sky.start.seconds - 1
        since_s = (second - SYSTEM_EPOCH_S[self.ephemeris.system]) % CODE_GRID_S
        return GnssTime(second - since_s)

    def motion(self, spec: SignalSpec, view: View | None = None) -> Motion:
        """How a component moves, as seen from the antenna or in another view."""
        start_s, end_s = self.span_s or (math.inf, math.inf)
        return Motion(
            delay_s=self.reference - self.sky.start,
            range_m=self._spline(spec.carrier_hz) if view is None else view.spline(spec.carrier_hz),
            code_offset_m=self._code_offset_m(spec, view or self.view),
            power_db=self._power_db(),
            start_s=start_s,
            end_s=end_s,
        )

    def symbols(self, spec: SignalSpec) -> NDArray[np.int8] | None:
        """Data symbols from code phase 0 on; None where the message is not to be had."""
        if not self.sky.table.messages:
            return None
        length_s = self.sky.start - self.reference + self.sky.duration_s + 2.0
        return messages.symbols(self._content(), spec.id, self.reference, length_s)

    def _content(self) -> Broadcast:
        propagation, system = self.sky.propagation, self.ephemeris.system
        utc = (u for u in self.sky.navigation.utc if u.system == system)
        return Broadcast(
            self.ephemeris,
            self.sky.ephemerides,
            klobuchar=propagation.klobuchar(system),
            bdgim=propagation.bdgim,
            utc=next(utc, None),
        )

    def _spline(self, carrier_hz: float) -> _core.Spline:
        """The same object for all components of a carrier."""
        if carrier_hz not in self._shared:
            self._shared[carrier_hz] = self.view.spline(carrier_hz)
        return self._shared[carrier_hz]

    def _code_offset_m(self, spec: SignalSpec, view: View) -> Knots:
        """Group delay, and twice the ionosphere, which the range has as an advance."""
        constant = SPEED_OF_LIGHT * self.ephemeris.group_delay_s(spec.id)
        delay = 2 * view.ionosphere_m(spec.carrier_hz)
        if not delay.any():
            return [(0.0, constant)] if constant else []
        return self._slow_knots(constant + delay)

    def _power_db(self) -> Knots:
        table, ephemeris = self.sky.table, self.ephemeris
        horizon = table.cn0_horizon_dbhz
        if horizon is None or table.override(ephemeris.system, ephemeris.prn).cn0_dbhz is not None:
            return []
        sine = np.sin(np.clip(self.view.way.elevation_rad, 0.0, None))
        return self._slow_knots((horizon - table.cn0_zenith_dbhz) * (1 - sine))

    def _slow_knots(self, values: NDArray[np.float64]) -> Knots:
        every = round(_SLOW_S / STEP_S)
        times = self.sky.time_s[::every].tolist()
        return list(zip(times, values[::every].tolist(), strict=True))


class SkySatellite(Satellite):
    """An authentic satellite on its orbit."""

    _track: Track

    @property
    def track(self) -> Track:
        """Its orbit and how it is seen."""
        return self._track

    def motion(self, spec: SignalSpec, signal: str, seed: int) -> Motion:
        """As its orbit says."""
        del signal, seed
        return self._track.motion(spec)

    def symbols(self, spec: SignalSpec) -> NDArray[np.int8] | None:
        """Those of its message."""
        return self._track.symbols(spec)


def _crossing_s(time_s: NDArray[np.float64], height: NDArray[np.float64], k: int) -> float:
    """Where a line through the values at k and k + 1 is zero."""
    share = height[k] / (height[k] - height[k + 1])
    return float(time_s[k] + share * (time_s[k + 1] - time_s[k]))
