"""A position from code phases of one instant, when place and time are known coarsely only.

Coarse-time navigation: van Diggelen, "A-GPS" (2009), chapter 4. No message need be received;
ephemerides come from elsewhere. 10 ms of signal are enough.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof import _core
from sdr_spoof.errors import NavigationError
from sdr_spoof.fixes import TOO_FEW, Cause, Fixes, Status
from sdr_spoof.nav.geodesy import azimuth_elevation
from sdr_spoof.nav.orbit import states, table
from sdr_spoof.nav.store import Store
from sdr_spoof.observations import Observations, ObservedSignal
from sdr_spoof.signals import LIGHT_M_S, signal_spec

from . import models, ranges
from .config import PvtConfig
from .ephemerides import choose
from .solution import TRAVEL_S, causes, fixes_of, layout_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from sdr_spoof.nav.broadcast import Contents
    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.records import Acquisition

    from .ephemerides import Choice
    from .solution import Layout

    Found = tuple[int, list[float], float, list[float], list[float], float, int, int | None]

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
    unsettled_m: float = 0.0
    """Standard deviation of what it may be off beyond the noise of a settled code loop."""


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
    ``time`` is ahead, so that :meth:`Fixes.time` gives the time found. One satellite that
    contradicts all others is left out (``raim_exclusions`` permitting). The status is UNCHECKED
    where there are only as many satellites as unknowns (5, or 6 with two systems), or where
    another place fits too.

    Raises:
        NavigationError: as :func:`solve`; or a signal is given whose code tells no range.
    """
    return timed_snapshot(phases, navigation, place_m, time, config)[0]


def timed_snapshot(
    phases: Sequence[CodePhase],
    navigation: Contents | Store,
    place_m: ArrayLike,
    time: GnssTime,
    config: PvtConfig | None = None,
) -> tuple[Fixes, float]:
    """As :func:`snapshot`, and the standard deviation of the time found, in s."""
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
    sigma_s = np.inf if found is None else float(np.sqrt(found[3][-1]))
    return _fixes(observations, choice, cause, layout, chosen, found), sigma_s


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
        unsettled_m=np.array([p.unsettled_m for p in phases]).reshape(values.shape),
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
    config = config.model_copy(update={"smoothing_s": 0.0})
    whole = ranges.ranges_m(observations, choice, config)
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
    found: Found | None,
) -> Fixes:
    signals = len(observations.signals)
    columns, angles = _nothing(signals, layout), np.full((1, signals, 2), np.nan)
    cause = cause.copy()
    if found is None:
        cause[0, chosen] = Cause.NO_FIX
    else:
        left = np.array(found[4])
        cause[0, chosen] = np.where(np.isfinite(left), Cause.USED, Cause.LOW)
        cause[0, [k for k in chosen if layout.columns[k][0] == found[7]]] = Cause.RESIDUAL
        columns |= _found(found, chosen, columns)
        angles = _directions(choice, observations.reference + found[2], found[1])
    usable = np.array([len({layout.columns[k][0] for k in chosen})], np.int64)
    return fixes_of(observations, layout, cause, angles, usable, columns)


def _nothing(signals: int, layout: Layout) -> dict[str, NDArray[Any]]:
    """Columns of one epoch without a fix."""
    widths = {"position_m": 3, "velocity_m_s": 3, "dop": 5, "residual_m": signals}
    widths |= {"clock_m": len(layout.systems), "bias_m": len(layout.groups)}
    squares = dict.fromkeys(("covariance_m2", "velocity_covariance"), (1, 3, 3))
    numbers = dict.fromkeys(("drift_m_s", "square_sum"), (1,))
    shapes = {name: (1, width) for name, width in widths.items()} | squares | numbers
    return {name: np.full(shape, np.nan) for name, shape in shapes.items()} | {
        "status": np.array([Status.NO_FIX], np.uint8),
        "failure": np.array([TOO_FEW], np.uint8),
        "freedom": np.zeros(1, np.int64),
    }


def _found(
    found: Found, chosen: Sequence[int], empty: dict[str, NDArray[Any]]
) -> dict[str, NDArray[Any]]:
    """Columns that a snapshot tells."""
    status, place, time_s, covariance, left, square_sum, freedom, _ = found
    residual = empty["residual_m"].copy()
    residual[0, chosen] = left
    return {
        "status": np.array([status], np.uint8),
        "failure": np.zeros(1, np.uint8),
        "position_m": np.array([place]),
        "clock_m": np.full_like(empty["clock_m"], -LIGHT_M_S * time_s),
        "covariance_m2": np.array(covariance).reshape(1, 4, 4)[:, :3, :3],
        "residual_m": residual,
        "square_sum": np.array([square_sum]),
        "freedom": np.array([freedom], np.int64),
    }


def _directions(choice: Choice, time: GnssTime, place: Sequence[float]) -> NDArray[np.float64]:
    """Azimuth and elevation (1, S, 2) of what has an ephemeris."""
    angles = np.full((*choice.known.shape, 2), np.nan)
    known = np.flatnonzero(choice.known[0] >= 0)
    sent_s = np.full(known.size, -TRAVEL_S)
    seen = states(choice.ephemerides, choice.known[0, known], sent_s, time)
    angles[0, known] = azimuth_elevation(place, seen.position_m)
    return angles
