"""All fixes of a recording in one call of the core."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof import _core
from sdr_spoof.fixes import Cause, Fixes, Status
from sdr_spoof.nav.geodesy import azimuth_elevation
from sdr_spoof.nav.orbit import states, table
from sdr_spoof.nav.store import Store
from sdr_spoof.observations import SUBCARRIER

from . import models, ranges
from .config import PvtConfig
from .ephemerides import choose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.nav.broadcast import Contents
    from sdr_spoof.observations import Observations, ObservedSignal

    from .ephemerides import Choice

USED, IDLE, EXCLUDED = 1, 2, 3
"""What the core says became of a signal."""
COLUMNS = (
    *("status", "failure", "position_m", "velocity_m_s", "clock_m", "drift_m_s", "bias_m"),
    *("covariance_m2", "velocity_covariance", "dop", "residual_m", "square_sum", "freedom"),
)
"""Of a fix, as the core gives them."""
FARTHEST_M = 1e9
"""Pseudoranges beyond are none: receiver clocks are set to far better than 3 s."""
TRAVEL_S = 0.075
"""About what signals take; directions change by 1e-5 rad in that time."""


@dataclass(frozen=True)
class Layout:
    """Signals as the solver numbers them."""

    systems: tuple[str, ...]
    columns: list[tuple[int, int, int, float]]
    """Satellite, system, group and carrier in Hz of each signal."""
    groups: list[tuple[int, int]]
    """System and group, ascending."""
    names: tuple[str, ...]
    """Of the groups, such as C B1CP."""


def solve(
    observations: Observations,
    navigation: Contents | Store,
    config: PvtConfig | None = None,
    *,
    distrusted: NDArray[np.bool_] | None = None,
    threads: int = 1,
) -> Fixes:
    """Positions of all epochs; the same for any number of threads.

    Signals that must not be used (spoofed, unhealthy, stale, weak, without an ephemeris) are left
    out and named in the result.

    Args:
        observations: what was observed.
        navigation: ephemerides and models.
        config: what is used and how.
        distrusted: signals to leave out as under suspicion (E, S).
        threads: worker threads.

    Raises:
        NavigationError: if an ephemeris describes no orbit, or a model of the ionosphere is asked
            for that was not received.
    """
    config = config or PvtConfig()
    store = navigation if isinstance(navigation, Store) else Store(navigation)
    choice = choose(observations, store)
    cause = causes(observations, choice, config)
    if distrusted is not None:
        cause[distrusted & (cause == Cause.USED)] = Cause.SUSPECT
    layout = layout_of(observations.signals, config)
    middle = observations.reference
    if observations.epochs:
        middle = observations.time(observations.epochs // 2)
    found = _core.solve_fixes(
        table(choice.ephemerides, observations.reference),
        float(observations.reference.seconds) + observations.reference.fraction,
        layout.columns,
        layout.groups,
        len(layout.systems),
        models.settings(config, layout.systems, store, middle),
        np.ascontiguousarray(observations.time_s, np.float64),
        np.where(cause == Cause.USED, choice.row, -1).astype(np.int32),
        ranges.ranges_m(observations, choice, config),
        ranges.variance_m2(observations, config),
        ranges.rates_m_s(observations),
        ranges.rate_variance(observations, config),
        ekf=models.ekf(config),
        threads=threads,
    )
    return _fixes(observations, choice, cause, layout, found)


def causes(observations: Observations, choice: Choice, config: PvtConfig) -> NDArray[np.uint8]:
    """Why signals cannot be used (E, S), the strongest reason last; USED where they can."""
    cause = choice.cause.copy()
    # Written so that a C/N0 that is not a number fails.
    cause[~(observations.cn0_dbhz >= config.min_cn0_dbhz)] = Cause.WEAK
    bad = choice.cause != Cause.USED
    cause[bad] = choice.cause[bad]
    cause[observations.spoofed] = Cause.SPOOFED
    cause[:, [not _wanted(s, config) for s in observations.signals]] = Cause.NOT_WANTED
    cause[~(np.abs(observations.pseudorange_m) < FARTHEST_M)] = Cause.NOT_OBSERVED
    return cause


def _wanted(signal: ObservedSignal, config: PvtConfig) -> bool:
    if signal.signal == SUBCARRIER:
        return config.subcarrier
    return not config.signals or signal.signal in config.signals


def layout_of(signals: Sequence[ObservedSignal], config: PvtConfig) -> Layout:
    """Number satellites, systems and the signals of a system that have a delay of their own."""
    satellites = tuple(dict.fromkeys((s.system, s.prn) for s in signals))
    systems = tuple(sorted({s.system for s in signals}))
    kinds = {y: sorted({s.signal for s in signals if s.system == y}, key=_order) for y in systems}

    def group(signal: ObservedSignal) -> int:
        own = config.inter_signal_bias or signal.signal == SUBCARRIER
        return kinds[signal.system].index(signal.signal) if own else 0

    columns = [
        (
            satellites.index((s.system, s.prn)),
            systems.index(s.system),
            group(s),
            ranges.carrier_hz(s.signal),
        )
        for s in signals
    ]
    groups = sorted({(system, group) for _, system, group, _ in columns})
    names = tuple(f"{systems[y]} {kinds[systems[y]][g]}" for y, g in groups)
    return Layout(systems, columns, groups, names)


def _order(signal: str) -> tuple[bool, bool, str]:
    """B1I before B1C, codes before the subcarrier."""
    return (signal == SUBCARRIER, signal.startswith("B1C"), signal)


def _fixes(
    observations: Observations,
    choice: Choice,
    cause: NDArray[np.uint8],
    layout: Layout,
    found: dict[str, NDArray[Any]],
) -> Fixes:
    usable = _satellites(cause == Cause.USED, layout)
    fixed = found["status"] != Status.NO_FIX
    angles = _directions(observations, choice, found["position_m"])
    cause = cause.copy()
    cause[(found["usage"] == IDLE) & fixed[:, None]] = Cause.LOW
    cause[(found["usage"] == IDLE) & ~fixed[:, None]] = Cause.NO_FIX
    cause[found["usage"] == EXCLUDED] = Cause.RESIDUAL
    columns = {name: found[name] for name in COLUMNS}
    return fixes_of(observations, layout, cause, angles, usable, columns)


def fixes_of(
    observations: Observations,
    layout: Layout,
    cause: NDArray[np.uint8],
    angles: NDArray[np.float64],
    usable: NDArray[np.int64],
    columns: dict[str, NDArray[Any]],
) -> Fixes:
    """Fixes of observations: causes (E, S), directions (E, S, 2), usable satellites (E,) and what a
    solver told, by the names :data:`COLUMNS`."""
    return Fixes(
        reference=observations.reference,
        time_s=observations.time_s,
        signals=observations.signals,
        systems=layout.systems,
        biases=layout.names,
        cause=cause,
        azimuth_deg=angles[..., 0],
        elevation_deg=angles[..., 1],
        usable=usable,
        **columns,
    )


def _satellites(used: NDArray[np.bool_], layout: Layout) -> NDArray[np.int64]:
    """Different satellites in each epoch (E,)."""
    numbers = np.array([c[0] for c in layout.columns], np.intp)
    count = np.zeros((len(used), numbers.max(initial=-1) + 1), np.bool_)
    for column, satellite in enumerate(numbers):
        count[:, satellite] |= used[:, column]
    return np.asarray(count.sum(axis=1), np.int64)


def _directions(
    observations: Observations, choice: Choice, position_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Azimuth and elevation (E, S, 2) of what has an ephemeris, where there is a position."""
    angles = np.full((*choice.known.shape, 2), np.nan)
    epochs, columns = np.nonzero((choice.known >= 0) & np.isfinite(position_m[:, :1]))
    if epochs.size:
        rows = choice.known[epochs, columns]
        sent_s = observations.time_s[epochs] - TRAVEL_S
        seen = states(choice.ephemerides, rows, sent_s, observations.reference)
        angles[epochs, columns] = azimuth_elevation(position_m[epochs], seen.position_m)
    return angles
