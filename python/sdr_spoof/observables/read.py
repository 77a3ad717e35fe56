"""Second look, one track at a time: the columns of the observations."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sdr_spoof.gaps import uncounted
from sdr_spoof.nav.ephemeris import delay_s
from sdr_spoof.observations import SUBCARRIER, ObservedSignal
from sdr_spoof.signals import signal_spec

from .columns import Column, fill
from .polarity import Polarity, polarity
from .runs import Run, runs_of
from .smoothing import smoothed
from .subcarrier import subcarrier_spans

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sdr_spoof.nav.records import Navigation
    from sdr_spoof.records import ComboTrack, SignalTrack, TrackLog

    from .config import ObservablesConfig
    from .epochs import Epochs
    from .plan import Plan

Read = tuple[ObservedSignal, Column, bool]
"""A column, and whether all delays in it were those of a satellite."""


def read_signals(
    log: TrackLog,
    navigation: Navigation,
    plan: Plan,
    epochs: Epochs,
    config: ObservablesConfig,
) -> Iterator[Read]:
    """The columns of all signals."""
    for track in log.signals:
        signal = ObservedSignal(signal_spec(track.signal).system, track.prn, track.signal)
        column, fits = Column.empty(epochs.time_s.size), True
        runs = _runs(log, track, config) if plan[signal] else []
        for span in plan[signal]:
            run = runs[span.index]
            sign = _sign(track, run, navigation)
            whole = replace(span, run=run)
            fits &= fill(column, whole, sign, epochs, config.window_s)
        yield signal, column, fits


def _runs(log: TrackLog, track: SignalTrack, config: ObservablesConfig) -> list[Run]:
    spans = uncounted(log, track)
    if config.smoothing_s > 0.0:
        return [smoothed(run, config.smoothing_s) for run in runs_of(track, spans)]
    return runs_of(track, spans, measured=config.code == "measured")


def _sign(track: SignalTrack, run: Run, navigation: Navigation) -> Polarity:
    bounds = float(run.time_s[0]), float(run.time_s[-1])
    return polarity(track.signal, track.prn, navigation.frames, *bounds)


def read_combos(
    log: TrackLog,
    navigation: Navigation,
    plan: Plan,
    epochs: Epochs,
    config: ObservablesConfig,
) -> Iterator[Read]:
    """The columns of the subcarriers of B1I and B1C."""
    tracks = {(t.signal, t.prn): t for t in log.signals}
    for combo in log.combos:
        pair = [tracks.get((name, combo.prn)) for name in (combo.lower, combo.upper)]
        if (combo.lower, combo.upper) == ("B1I", "B1CP") and pair[0] and pair[1]:
            runs = [runs_of(t, uncounted(log, t)) for t in pair if t is not None]
            yield _read_combo(combo, pair[0], runs, navigation, plan, epochs, config)


def _read_combo(
    combo: ComboTrack,
    lower_track: SignalTrack,
    runs: Sequence[Sequence[Run]],
    navigation: Navigation,
    plan: Plan,
    epochs: Epochs,
    config: ObservablesConfig,
) -> Read:
    system = signal_spec(combo.upper).system
    signal = ObservedSignal(system, combo.prn, SUBCARRIER)
    column, fits = Column.empty(epochs.time_s.size), True
    spans = plan[ObservedSignal(system, combo.prn, combo.upper)]
    if spans:
        lower, upper = runs
        known = [replace(span, run=upper[span.index]) for span in spans]
        signed = [(run, _sign(lower_track, run, navigation)) for run in lower]
        delays = _group_delays(combo, system, navigation)
        for beat, half in subcarrier_spans(combo, known, signed, delays):
            span = beat
            if config.smoothing_s > 0.0:
                span = replace(span, run=smoothed(span.run, config.smoothing_s))
            fits &= fill(column, span, None, epochs, config.subcarrier_window_s)
            within = (epochs.sample_time_s >= span.from_s) & (epochs.sample_time_s <= span.until_s)
            column.half_cycle[within] = half
            begun = within.argmax()
            column.lock_lost[begun] |= within[begun]
    return signal, column, fits


def _group_delays(combo: ComboTrack, system: str, navigation: Navigation) -> tuple[float, float]:
    """Group delays of both signals as the satellite states them; 0 unless both are known."""
    stated: dict[str, float] = {}
    for ephemeris in navigation.ephemerides:
        if (ephemeris.system, ephemeris.prn) == (system, combo.prn):
            stated |= dict(ephemeris.group_delays_s)
    lower, upper = delay_s(stated, combo.lower), delay_s(stated, combo.upper)
    return (0.0, 0.0) if lower is None or upper is None else (lower, upper)
