"""From tracks to observations: pseudorange, phase, Doppler and C/N0 at common receiver times.

Rows of a track lie in the middle of its integrations, each signal's elsewhere. At the epochs,
whole multiples of an interval of receiver time, a parabola through the rows around gives the value
(:mod:`.fit`). The pseudorange is the speed of light times receiver time (:mod:`.clock`) minus
transmit time (:mod:`.transmit`). Its code phase is that of the loop's oscillator, whose noise has
the bandwidth of the code loop (1 Hz: 0.4 m for B1I at 45 dB-Hz), not the discriminator's of one
integration (3 m).
"""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.nav.time import GnssTime
from sdr_spoof.observations import Observations

from .clock import ClockPiece, ReceiverClock, set_clock
from .columns import Column
from .config import ObservablesConfig
from .epochs import Epochs, epochs_of
from .plan import plan
from .read import read_combos, read_signals
from .spoofed import mark_spoofed

if TYPE_CHECKING:
    from sdr_spoof.nav.records import Navigation
    from sdr_spoof.observations import ObservedSignal
    from sdr_spoof.records import TrackLog, Verdict

__all__ = ["ClockPiece", "ObservablesConfig", "ReceiverClock", "observe"]


def observe(
    log: TrackLog,
    navigation: Navigation,
    config: ObservablesConfig | None = None,
    verdict: Verdict | None = None,
    *,
    clock: ReceiverClock | None = None,
) -> Observations:
    """Observations of every signal whose transmit time is known, at common receiver times.

    Args:
        log: tracks.
        navigation: anchors tell transmit times, frames the sign of phases, ephemerides the group
            delays that lie between the codes of a combo.
        config: rate, and how to read the tracks.
        verdict: satellites to flag.
        clock: the receiver's, as an earlier fix corrected it; by default it is set to the transmit
            times plus 70 ms.

    Returns:
        Epochs from the first to the last at which anything was observed; none where no transmit
        time is known.
    """
    config = config or ObservablesConfig()
    spans = plan(log, navigation)
    known = [span for signal in spans.values() for span in signal]
    if not known:
        return _made(None, {}, config, ("no signal's transmit time is known",))
    clock = clock or set_clock(known)
    bounds = min(s.from_s for s in known), max(s.until_s for s in known)
    epochs = epochs_of(clock, config.rate_hz, *bounds)
    columns: dict[ObservedSignal, Column] = {}
    notes: list[str] = []
    for signal, column, fits in (
        *read_signals(log, navigation, spans, epochs, config),
        *read_combos(log, navigation, spans, epochs, config),
    ):
        if not fits:
            notes.append(
                f"{signal.satellite} {signal.signal}: left out where its delay is not a satellite's"
            )
        if not column.seen:
            continue
        if verdict is not None:
            times = epochs.sample_time_s, verdict
            mark_spoofed(column.spoofed, signal, *times, trust_fallback=config.trust_fallback)
        columns[signal] = column
    return _made(epochs, columns, config, tuple(notes), clock)


def _made(
    epochs: Epochs | None,
    columns: dict[ObservedSignal, Column],
    config: ObservablesConfig,
    notes: tuple[str, ...],
    clock: ReceiverClock | None = None,
) -> Observations:
    """Put the columns side by side; drops epochs before the first and after the last value."""
    signals = tuple(sorted(columns))
    count = 0 if epochs is None else epochs.time_s.size
    values: dict[str, Any] = {
        f.name: np.stack([getattr(columns[s], f.name) for s in signals], axis=1)
        if signals
        else np.zeros((count, 0), np.bool_ if f.name in FLAGS else np.float64)
        for f in fields(Column)
    }
    seen = np.flatnonzero(np.isfinite(values["cn0_dbhz"]).any(axis=1))
    kept = slice(int(seen[0]), int(seen[-1]) + 1) if seen.size else slice(0, 0)
    nothing = np.zeros(0)
    return Observations(
        reference=GnssTime(0) if epochs is None else epochs.reference,
        time_s=nothing if epochs is None else epochs.time_s[kept],
        sample_time_s=nothing if epochs is None else epochs.sample_time_s[kept],
        interval_s=1.0 / config.rate_hz,
        signals=signals,
        **{name: value[kept] for name, value in values.items()},
        clock=clock,
        notes=notes,
    )


FLAGS = ("lock_lost", "half_cycle", "spoofed")
