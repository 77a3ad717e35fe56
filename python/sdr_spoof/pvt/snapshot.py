"""A position from code phases of one instant, when place and time are known coarsely only.

Coarse-time navigation: van Diggelen, "A-GPS" (2009), chapter 4. No message need be received;
ephemerides come from elsewhere. 10 ms of signal are enough.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.errors import NavigationError
from sdr_spoof.fixes import TOO_FEW, Cause, Fixes, Status
from sdr_spoof.nav.geodesy import azimuth_elevation
from sdr_spoof.nav.orbit import states, table
from sdr_spoof.nav.store import Store
from sdr_spoof.observations import Observations, ObservedSignal
from sdr_spoof.signals import signal_spec

from . import models, ranges
from .config import PvtConfig
from .ephemerides import choose
from .solution import TRAVEL_S, causes, layout_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from sdr_spoof.nav.broadcast import Contents
    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.records import Acquisition

    from .ephemerides import Choice
    from .solution import Layout

LIGHT_M_S = 299_792_458.0
TOLD_APART = 1e-3
"""Codes of this period in s need a coarse place; longer ones hardly do."""


@dataclass(frozen=True)
class CodePhase:
    """When the next code period of a signal begins."""

    system: str
    prn: int
    signal: str
    """Registry signal."""
    delay_s: float
    """From the instant of the snapshot to the next start of a code period, in [0, period)."""
    cn0_dbhz: float
    doppler_hz: float = 0.0
    """Shortens the code period: 9 m in 10 ms at 5 kHz."""


def code_phases(
    acquisitions: Sequence[Acquisition], sample_rate_hz: float, sample: int = 0
) -> tuple[CodePhase, ...]:
    """What an acquisition says of the instant of a sample, as far as it detected anything."""
    found = []
    for a in acquisitions:
        if a.detected:
            spec = signal_spec(a.signal)
            period_s = spec.period_s / (1.0 + a.doppler_hz / spec.carrier_hz)
            later_s = (a.sample_index - sample) / sample_rate_hz + a.code_delay_s
            delay_s = later_s % period_s
            found.append(CodePhase(spec.system, a.prn, a.signal, delay_s, a.cn0_dbhz, a.doppler_hz))
    return tuple(found)


def snapshot(
    phases: Sequence[CodePhase],
    navigation: Contents | Store,
    place_m: ArrayLike,
    time: GnssTime,
    config: PvtConfig | None = None,
) -> Fixes:
    """A single fix from code phases, Earth-fixed place (3,) and GPST of the snapshot.

    Place and time may be off by what the configuration says. ``clock_m`` of the fix is how much
    ``time`` is ahead, so that :meth:`Fixes.time` gives the time found. The status is UNCHECKED
    where there are only as many satellites as unknowns (5, or 6 with two systems), or where
    another place fits too.

    Raises:
        NavigationError: as :func:`solve`; or a signal is given whose code tells no range.
    """
    config = config or PvtConfig()
    store = navigation if isinstance(navigation, Store) else Store(navigation)
    observations = _observations(phases, time)
    choice = choose(observations, store)
    cause = causes(observations, choice, config)
    layout = layout_of(observations.signals, config)
    chosen = [k for k in range(len(phases)) if cause[0, k] == Cause.USED]
    found = _core.solve_snapshot(
        table(choice.ephemerides, time),
        float(time.seconds) + time.fraction,
        _core_phases(observations, choice, config, layout, chosen),
        models.settings(config, layout.systems, store, time),
        np.asarray(place_m, np.float64).tolist(),
        0.0,
        config.place_uncertainty_m,
        config.time_uncertainty_s,
    )
    return _fixes(observations, choice, cause, layout, chosen, found)


def _observations(phases: Sequence[CodePhase], time: GnssTime) -> Observations:
    """One epoch; ``pseudorange_m`` is known but for whole code periods."""
    values = np.array([_range_m(p) for p in phases]).reshape(1, len(phases))
    nothing = np.zeros(values.shape, np.bool_)
    instant = np.zeros(1)
    return Observations(
        reference=time,
        time_s=instant,
        sample_time_s=instant,
        interval_s=1.0,
        signals=tuple(ObservedSignal(p.system, p.prn, p.signal) for p in phases),
        pseudorange_m=values,
        carrier_phase_cycles=np.full(values.shape, np.nan),
        doppler_hz=np.array([p.doppler_hz for p in phases]).reshape(values.shape),
        cn0_dbhz=np.array([p.cn0_dbhz for p in phases]).reshape(values.shape),
        lock_lost=nothing,
        half_cycle=nothing,
        spoofed=nothing,
    )


def _range_m(phase: CodePhase) -> float:
    """The code's own time at the snapshot is as long before a whole period."""
    spec = signal_spec(phase.signal)
    if round(spec.period_s / TOLD_APART) < 1:
        raise NavigationError(f"signal {phase.signal} has too short a code for a snapshot")
    return LIGHT_M_S * phase.delay_s * (1.0 + phase.doppler_hz / spec.carrier_hz)


def _core_phases(
    observations: Observations,
    choice: Choice,
    config: PvtConfig,
    layout: Layout,
    chosen: Sequence[int],
) -> list[tuple[int, int, int, float, int, float, float, float]]:
    whole = ranges.ranges_m(observations, choice, config.model_copy(update={"smoothing_s": 0.0}))
    variance = ranges.variance_m2(observations, config)
    return [
        (
            *layout.columns[k],
            int(choice.row[0, k]),
            float(whole[0, k]),
            LIGHT_M_S * signal_spec(observations.signals[k].signal).period_s,
            float(variance[0, k]),
        )
        for k in chosen
    ]


def _fixes(
    observations: Observations,
    choice: Choice,
    cause: NDArray[np.uint8],
    layout: Layout,
    chosen: Sequence[int],
    found: tuple[int, list[float], float, list[float], list[float], float, int] | None,
) -> Fixes:
    signals, systems = len(observations.signals), len(layout.systems)
    residual, angles = np.full((1, signals), np.nan), np.full((1, signals, 2), np.nan)
    status, place, time_s = int(Status.NO_FIX), [np.nan] * 3, np.nan
    covariance, square_sum, freedom = np.full((4, 4), np.nan), np.nan, 0
    cause = cause.copy()
    if found is None:
        cause[0, chosen] = Cause.NO_FIX
    else:
        status, place, time_s, flat, left, square_sum, freedom = found
        covariance = np.array(flat).reshape(4, 4)
        residual[0, chosen] = left
        cause[0, chosen] = np.where(np.isfinite(left), Cause.USED, Cause.LOW)
        known = np.flatnonzero(choice.known[0] >= 0)
        sent_s = np.full(known.size, time_s - TRAVEL_S)
        seen = states(choice.ephemerides, choice.known[0, known], sent_s, observations.reference)
        angles[0, known] = azimuth_elevation(place, seen.position_m)
    satellites = {layout.columns[k][0] for k in chosen}
    return Fixes(
        reference=observations.reference,
        time_s=observations.time_s,
        signals=observations.signals,
        systems=layout.systems,
        status=np.array([status], np.uint8),
        failure=np.array([TOO_FEW if found is None else 0], np.uint8),
        position_m=np.array([place]),
        velocity_m_s=np.full((1, 3), np.nan),
        clock_m=np.full((1, systems), -LIGHT_M_S * time_s),
        drift_m_s=np.full(1, np.nan),
        biases=layout.names,
        bias_m=np.full((1, len(layout.groups)), np.nan),
        covariance_m2=covariance[None, :3, :3],
        velocity_covariance=np.full((1, 3, 3), np.nan),
        dop=np.full((1, 5), np.nan),
        cause=cause,
        residual_m=residual,
        azimuth_deg=angles[..., 0],
        elevation_deg=angles[..., 1],
        square_sum=np.array([square_sum]),
        freedom=np.array([freedom], np.int64),
        usable=np.array([len(satellites)], np.int64),
    )
