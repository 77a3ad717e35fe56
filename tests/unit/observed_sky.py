"""Observations in closed form: real ephemerides, known place, velocity, clock and noise."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.nav.atmosphere import gpst_s, ionosphere_m, troposphere_m
from sdr_spoof.nav.beidou_satellites import GEO
from sdr_spoof.nav.broadcast import Klobuchar
from sdr_spoof.nav.ephemeris import Ephemeris
from sdr_spoof.nav.geodesy import azimuth_elevation, ecef_to_geodetic, geodetic_to_ecef
from sdr_spoof.nav.orbit import states
from sdr_spoof.nav.records import Navigation
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.observations import SUBCARRIER, Observations, ObservedSignal
from sdr_spoof.pvt import PvtConfig
from sdr_spoof.pvt.ranges import carrier_hz

LIGHT = 299_792_458.0
EARTH_RATE = 7.292115e-5
PLACE = geodetic_to_ecef([39.9, 116.4, 60.0])
START = GnssTime.of_week(2253, 6 * 3600.0)
VECTORS = Path(__file__).parents[1] / "vectors/navigation"


EXACT = PvtConfig(ionosphere="none", troposphere="none", zenith_sigma_m=0.0, weights="equal")
"""What the closed form holds."""


@cache
def navigation() -> Navigation:
    return read_navigation(VECTORS / "brd4_2023071_04h_08h.rnx")


def nearest(time: GnssTime) -> dict[tuple[str, int], Ephemeris]:
    """Of every healthy satellite the ephemeris whose reference is nearest."""
    found: dict[tuple[str, int], Ephemeris] = {}
    for e in navigation().ephemerides:
        key = (e.system, e.prn)
        if key not in found or abs(e.toe - time) < abs(found[key].toe - time):
            found[key] = e
    return {k: e for k, e in found.items() if e.health == 0 and abs(e.toe - time) < 3600}


@dataclass
class Sky:
    """What is observed from where; everything is exact but for ``sigma_m`` and the like."""

    systems: str = "C"
    signals: dict[str, tuple[str, ...]] = field(
        default_factory=lambda: {"C": ("B1I",), "G": ("L1CA",)}
    )
    epochs: int = 1
    interval_s: float = 1.0
    satellites: int | None = None
    """So many of each system, from high to low."""
    mask_deg: float = 10.0
    place: NDArray[np.float64] = field(default_factory=lambda: PLACE)
    velocity: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    track: NDArray[np.float64] | None = None
    """Places (E, 3) and velocities instead of the two above."""
    track_velocity: NDArray[np.float64] | None = None
    clock_m: NDArray[np.float64] | float = 1234.5
    drift_m_s: NDArray[np.float64] | float = 0.0
    offsets_m: dict[str, float] = field(default_factory=dict)
    """Delay of systems and signals in the receiver."""
    sigma_m: float = 0.0
    rate_sigma_m_s: float = 0.0
    cn0_dbhz: float = 45.0
    klobuchar: Klobuchar | None = None
    troposphere: bool = False
    seed: int = 1

    def observe(self) -> Observations:
        time_s = np.arange(self.epochs) * self.interval_s
        place = self.place + time_s[:, None] * self.velocity if self.track is None else self.track
        velocity = self.track_velocity
        if velocity is None:
            velocity = np.broadcast_to(self.velocity, place.shape)
        clock_m = np.broadcast_to(self.clock_m, time_s.shape) + time_s * self.drift_m_s * (
            np.ndim(self.drift_m_s) == 0
        )
        drift = np.broadcast_to(self.drift_m_s, time_s.shape)
        chosen = self._chosen(place[0])
        columns, ranges, rates = [], [], []
        for e in chosen:
            for signal in self.signals[e.system]:
                columns.append(ObservedSignal(e.system, e.prn, signal))
                extra = self.offsets_m.get(e.system, 0.0) + self.offsets_m.get(signal, 0.0)
                range_m, rate = self._measured(e, signal, time_s, place, velocity, clock_m, drift)
                ranges.append(range_m + extra)
                rates.append(rate)
        return self._observations(time_s, columns, np.array(ranges).T, np.array(rates).T)

    def _observations(self, time_s, columns, ranges, rates) -> Observations:
        random = np.random.default_rng(self.seed)
        noisy = ranges + self.sigma_m * random.standard_normal(ranges.shape)
        rates = rates + self.rate_sigma_m_s * random.standard_normal(ranges.shape)
        wavelengths = np.array([LIGHT / carrier_hz(c.signal) for c in columns])
        beat = np.array([c.signal == SUBCARRIER for c in columns])
        nothing = np.zeros(ranges.shape, np.bool_)
        return Observations(
            reference=START,
            time_s=time_s,
            sample_time_s=time_s,
            interval_s=self.interval_s,
            signals=tuple(columns),
            pseudorange_m=noisy,
            carrier_phase_cycles=np.where(beat, np.nan, ranges / wavelengths),
            doppler_hz=np.where(beat, np.nan, -rates / wavelengths),
            cn0_dbhz=np.full(ranges.shape, self.cn0_dbhz),
            lock_lost=nothing,
            half_cycle=nothing,
            spoofed=nothing,
        )

    def _chosen(self, place) -> list[Ephemeris]:
        chosen: list[Ephemeris] = []
        for system in self.systems:
            own = [e for (s, _), e in sorted(nearest(START).items()) if s == system]
            seen = states(own, np.arange(len(own)), np.zeros(len(own)), START)
            elevation = azimuth_elevation(place, seen.position_m)[:, 1]
            order = np.argsort(-elevation)
            sent = "B1CP" not in self.signals[system]
            high = [
                k
                for k in order
                # Geostationary satellites send no B1C.
                if elevation[k] > self.mask_deg and (sent or own[k].prn not in GEO)
            ]
            count = min(self.satellites or len(high), len(high))
            spread = np.linspace(0, len(high) - 1, count).round().astype(int)
            chosen += [own[high[k]] for k in sorted(spread, key=lambda k: high[k])]
        return chosen

    def _measured(self, e, signal, time_s, place, velocity, clock_m, drift):
        """Pseudorange and its rate at receiver times, by steps of the travel time."""

        def one(shift: float):
            # A second of receiver time is 1 / (1 + drift) seconds long.
            true_s = time_s + shift / (1 + drift / LIGHT) - clock_m / LIGHT
            own = place + velocity * shift
            travel = np.full(time_s.shape, 0.08)
            for _ in range(5):
                state = states([e], np.zeros(time_s.size, int), true_s - travel, START)
                angle = EARTH_RATE * travel
                x, y, z = state.position_m.T
                turned = np.stack(
                    [
                        x * np.cos(angle) + y * np.sin(angle),
                        y * np.cos(angle) - x * np.sin(angle),
                        z,
                    ],
                    axis=1,
                )
                travel = np.linalg.norm(turned - own, axis=1) / LIGHT
            sent = LIGHT * (state.clock_s - e.group_delay_s(signal))
            delay = self._atmosphere(own, turned, time_s, signal)
            return LIGHT * travel + clock_m + drift * shift - sent + delay

        return one(0.0), (one(0.05) - one(-0.05)) / 0.1

    def _atmosphere(self, own, turned, time_s, signal):
        look = azimuth_elevation(own, turned)
        instants = gpst_s(START, time_s)
        ground = ecef_to_geodetic(own)
        delay = ionosphere_m(self.klobuchar, ground, look, instants, carrier_hz(signal))
        if self.troposphere:
            delay = delay + troposphere_m(ground, look, instants)
        return delay


def part(observations: Observations, rows: slice) -> Observations:
    names = ("time_s", "sample_time_s", "pseudorange_m", "carrier_phase_cycles", "doppler_hz")
    names += ("cn0_dbhz", "lock_lost", "half_cycle", "spoofed")
    return dataclasses.replace(observations, **{n: getattr(observations, n)[rows] for n in names})


def errors(fixes) -> np.ndarray:
    return np.linalg.norm(fixes.position_m - PLACE, axis=1)


def exact(**changes) -> PvtConfig:
    return EXACT.model_copy(update=changes)
