"""Searches for a second signal of each tracked satellite.

A tracking loop hears nothing of a signal that lies elsewhere in code: a counterfeit one that was
not aligned with the satellite's, or the satellite's own after the loop has been led away. Every so
often the tracked signals are taken out of some milliseconds of samples, and their PRNs are searched
for again, over the whole code and the whole Doppler range, as at the start. Of each satellite the
signal with the shortest code is searched, which takes milliseconds.
"""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING

from .acquisition import search_plan
from .errors import RecordingError
from .records import SecondPeak, State
from .signal_search import SignalSearch
from .signals import signal_spec

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .acquisition import AcquisitionConfig
    from .progress import Progress
    from .records import Acquisition, SignalTrack, TrackLog
    from .sources.source import Source

NEAR_S = 0.05
"""A signal counts as tracked at an instant where it has an epoch this near."""
Known = tuple[int, float, float]
"""PRN, Doppler in Hz and code delay in s of a tracked signal."""


def second_peaks(
    recording: Source,
    log: TrackLog,
    config: AcquisitionConfig,
    *,
    threads: int,
    progress: Progress | None = None,
) -> tuple[SecondPeak, ...]:
    """Search where the log says what is tracked, each ``second_peak_every_s``; 0 for never.

    Returns:
        One record per search, found or not, in the order of time, signal and PRN.
    """
    if config.second_peak_every_s == 0.0:
        return ()
    tracks = _cheapest(log.signals)
    found: list[SecondPeak] = []
    count = math.floor(log.duration_s / config.second_peak_every_s + 0.5)
    with suppress(KeyboardInterrupt):  # what was found is kept
        for k in range(count):
            time_s = (k + 0.5) * config.second_peak_every_s
            for signal in dict.fromkeys(t.signal for t in tracks):
                of_signal = [t for t in tracks if t.signal == signal]
                found += _searched(recording, of_signal, time_s, config, threads)
            if progress is not None:
                progress(k + 1, count)
    return tuple(found)


def _cheapest(tracks: Sequence[SignalTrack]) -> list[SignalTrack]:
    """Of each satellite, the track of the signal with the shortest code."""
    cheapest: dict[tuple[str, int], SignalTrack] = {}
    for track in sorted(tracks, key=lambda t: signal_spec(t.signal).period_s):
        cheapest.setdefault((signal_spec(track.signal).system, track.prn), track)
    return list(cheapest.values())


def _searched(
    recording: Source,
    tracks: Sequence[SignalTrack],
    time_s: float,
    config: AcquisitionConfig,
    threads: int,
) -> Iterator[SecondPeak]:
    sample = round(time_s * recording.format.sample_rate_hz)
    known = [k for t in tracks if (k := _known(t, sample / recording.format.sample_rate_hz))]
    if not known:
        return
    signal, prns = tracks[0].signal, [k[0] for k in known]
    try:
        plan, ranges = search_plan(recording, config, signal, prns, sample)
        pfa = config.second_peak_pfa
        search = SignalSearch(recording, plan, ranges, pfa, sample, threads)
    except RecordingError:  # silence, or too little left: nothing to find
        return
    others = {a.prn: (a, log10_p) for a, log10_p in search.beside(known)}
    for one in known:
        yield _record(one, *others[one[0]], config)


def _known(track: SignalTrack, time_s: float) -> Known | None:
    """Where a tracked signal is at an instant; None where it is not."""
    near = track.between(time_s - NEAR_S, time_s + NEAR_S)
    rows = [i for i in range(near.epochs) if near.state[i] >= State.SYNCED]
    if not rows:
        return None
    row = min(rows, key=lambda i: abs(float(near.time_s[i]) - time_s))
    spec = signal_spec(track.signal)
    doppler_hz = float(near.doppler_hz[row])
    rate_hz = spec.chip_rate_hz * (1.0 + doppler_hz / spec.carrier_hz)
    chips = float(near.code_phase_chips[row]) + rate_hz * (time_s - float(near.time_s[row]))
    return track.prn, doppler_hz, (-chips % spec.code_length) / rate_hz


def _record(
    known: Known, other: Acquisition, log10_p: float, config: AcquisitionConfig
) -> SecondPeak:
    spec = signal_spec(other.signal)
    late_s = other.code_delay_s - known[2]
    late_chips = math.remainder(late_s * spec.chip_rate_hz, spec.code_length)
    apart = abs(late_chips) >= config.second_peak_apart_chips
    return SecondPeak(
        signal=other.signal,
        prn=other.prn,
        found=other.detected and apart,
        sample_index=other.sample_index,
        code_offset_chips=late_chips,
        doppler_offset_hz=other.doppler_hz - known[1],
        cn0_dbhz=other.cn0_dbhz,
        statistic=other.statistic,
        threshold=other.threshold,
        log10_p=log10_p if apart else 0.0,
        false_alarm_probability=config.second_peak_pfa,
    )
