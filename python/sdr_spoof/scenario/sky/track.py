"""One satellite of a sky: how its signals move, and what they say."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.broadcast import Broadcast
from sdr_spoof.nav.time import SYSTEM_EPOCH_S, GnssTime
from sdr_spoof.scenario.base import SPEED_OF_LIGHT
from sdr_spoof.scenario.motion import Motion
from sdr_spoof.scenario.satellite import Satellite
from sdr_spoof.signals import components, signal_spec

from . import messages, orbits
from .clock import STEP_S

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof import _core
    from sdr_spoof.nav.ephemeris import Ephemeris
    from sdr_spoof.scenario.knots import Knots
    from sdr_spoof.signals import SignalSpec

    from .model import Sky, View

CODE_GRID_S = 18
"""Secondary codes and messages of all signals begin together at multiples of this of a week: the
frame of B-CNAV1 (BDS-SIS-ICD-B1C-1.0, 5.2.3 and 6.2.1); subframes of D1 and LNAV are a third of it,
those of D2 a 30th."""
BDS3_FROM = 19
"""PRN from which on BDS satellites are of the third generation, which sends B1C."""
_SLOW_S = 1.0
"""Spacing of what changes slowly: ionosphere and power; straight in between."""


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
        end = self.sky.start + (self.sky.duration_s + 2.0)
        parts = [
            messages.symbols(self._content(e), spec.id, begin, until - begin)
            for begin, until, e in self.issues(self.reference, end)
        ]
        known = [p for p in parts if p is not None]
        return np.concatenate(known) if known else None

    def issues(self, start: GnssTime, end: GnssTime) -> list[tuple[GnssTime, GnssTime, Ephemeris]]:
        """From when until when it sends which ephemeris."""
        sent = orbits.issues(self.sky.navigation, self.sky.table, self.ephemeris)
        found = []
        for n, (begin, e) in enumerate(sent):
            first = start if n == 0 else max(begin, start)
            last = min(sent[n + 1][0], end) if n + 1 < len(sent) else end
            if first < last:
                found.append((first, last, e))
        return found

    def _content(self, ephemeris: Ephemeris) -> Broadcast:
        propagation, system = self.sky.propagation, self.ephemeris.system
        utc = (u for u in self.sky.navigation.utc if u.system == system)
        return Broadcast(
            ephemeris,
            self.sky.ephemerides,
            klobuchar=propagation.klobuchar(system),
            bdgim=propagation.bdgim,
            utc=next(utc, None),
            integrity=self.sky.table.integrity,
            grid=self.sky.grid,
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
