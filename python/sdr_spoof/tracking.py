"""Tracking: runs the core's loops over a recording and gathers what they recorded.

The per-sample and per-epoch work is in the Rust core; here the recording is fed block by block,
what was recorded is taken out each second, and lost signals are searched for again at whole
seconds of the recording, so that the result does not depend on the size of the blocks.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from . import _core
from .acquisition import AcquisitionConfig, acquire
from .errors import ConfigError, RecordingError
from .gaps import CountBreak
from .interrupt import held_back
from .isolation import isolation_marks
from .records import Acquisition, ComboTrack, SignalTrack, TrackLog
from .row_store import RowStore
from .signals import coherent_pairs, signal_spec

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from .isolation import Isolation
    from .monitor import Monitor
    from .progress import Progress
    from .sources import RecordingFormat
    from .sources.source import Source

BLOCK_BYTES = 8 << 20
"""Samples read and fed at a time. Larger blocks leave the processor's cache and read slower."""
QMBOC_HALF_BANDWIDTH_HZ = 7.161e6
"""The BOC(6,1) part of the B1C pilot lies 6.138 MHz beside the carrier, one lobe each way."""


def _split(pair: Any) -> Any:
    """Read ``B1I+B1CP`` as two names."""
    return pair.split("+") if isinstance(pair, str) else pair


SignalPair = Annotated[tuple[str, str], BeforeValidator(_split)]
"""Two signals of a satellite; in text, with a plus sign between them."""


class TrackingConfig(BaseModel):
    """Settings of the tracking loops; bandwidths are single-sided noise bandwidths."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    pll_bandwidth_hz: float = Field(
        10.0, gt=0, description="phase-locked loop of a single sideband, once synchronised"
    )
    pull_in_pll_bandwidth_hz: float = Field(
        20.0, gt=0, description="phase-locked loop on 1 ms integrations, before that"
    )
    fll_bandwidth_hz: float = Field(
        1.0, gt=0, description="frequency-locked loop that assists it, before that"
    )
    dll_bandwidth_hz: float = Field(
        1.0, gt=0, description="carrier-aided code loop, once synchronised"
    )
    main_bandwidth_hz: float = Field(10.0, gt=0, description="main-carrier loop of a combo")
    subcarrier_bandwidth_hz: float = Field(5.0, gt=0, description="subcarrier loop of a combo")
    code_bias_bandwidth_hz: float = Field(
        0.1, gt=0, description="loop of a combo that follows the difference of the two codes"
    )
    integration_ms: int = Field(
        10,
        description="longest coherent integration, 1, 2, 4, 5, 10 or 20 ms; never beyond a symbol",
    )
    cn0_min_dbhz: float = Field(25.0, description="below this C/N0 a signal counts as lost")
    qmboc: bool | None = Field(
        None,
        description="receive the B1C pilot's BOC(6,1) part too; unset = where the bandwidth allows",
    )
    combo: bool = Field(True, description="track the pairs of signals of a satellite jointly")
    pairs: tuple[SignalPair, ...] = Field(
        default_factory=coherent_pairs,
        description="signals with coherent carriers that are tracked as one, such as B1I+B1CP; "
        "where a satellite has several such pairs, the first",
    )
    data_component: bool = Field(
        False, description="correlate the B1C data component too, with the pilot's oscillators"
    )
    reacquire: bool = Field(True, description="search for lost signals again, each second")
    fallback: bool = Field(
        True,
        description="watch while tracking, each second, and go on with the clean signal alone "
        "where the other one of a satellite was captured",
    )


def track(
    recording: Source,
    acquisitions: Sequence[Acquisition],
    config: TrackingConfig | None = None,
    *,
    isolations: Sequence[Isolation] = (),
    monitor: Monitor | None = None,
    threads: int | None = None,
    block_s: float | None = None,
    rows_in: Path | None = None,
    progress: Progress | None = None,
) -> TrackLog:
    """Track every detected acquisition from its sample to the end of the recording.

    Args:
        recording: what to track in.
        acquisitions: where to start; entries that are not ``detected`` are passed over. All
            must hold at the same sample.
        config: loop settings.
        isolations: signals that are not to be trusted, and when.
        monitor: asked at each whole second which signals are captured (``config.fallback``).
        threads: worker threads, all cores by default; the result does not depend on it.
        block_s: signal fed to the core at a time, 8 MB by default; the result does not depend on
            it.
        rows_in: folder for a temporary file that holds the rows, which the tracks then read when
            they are asked for them; by default all rows are held in memory.
        progress: called with seconds done and seconds in all.

    Returns:
        One :class:`SignalTrack` per acquisition and one :class:`ComboTrack` per satellite with
        two signals. An interrupt (Ctrl-C) ends tracking early and gives a log marked partial.

    Raises:
        ConfigError: a setting is out of range, the acquisitions are of different samples, or a
            signal to isolate is not tracked.
        SignalError: the recording cannot hold a signal.
        RecordingError: the recording cannot be read.
        OutputError: the rows cannot be written to ``rows_in``.
    """
    config = config or TrackingConfig()
    start, targets = _targets(acquisitions)
    if start * recording.format.bits_per_sample % 8:
        raise ConfigError(f"sample {start} starts inside a byte; choose a multiple of 8")
    for signal in sorted({a.signal for a in acquisitions if a.detected}):
        recording.check_signal(signal)
    tracker = _tracker(recording, targets, config, start, threads or os.cpu_count() or 1)
    rows = RowStore(rows_in)
    rate = recording.format.sample_rate_hz
    marks = isolation_marks(isolations, rate)
    partial = False
    try:
        for begin, count in _blocks(recording, start, block_s, [at for at, _ in marks]):
            if begin > start and _is_whole_second(recording, begin):
                _take_rows(tracker, rows)
                for isolation in watched(monitor, config, rows, rate, begin):
                    isolation.begin(tracker)
                if config.reacquire:
                    _reacquire(tracker, recording, begin, threads)
            while marks and marks[0][0] <= begin:
                marks.pop(0)[1](tracker)
            tracker.feed(recording.read_raw(begin, count))
            if progress:
                progress((begin + count - start) / rate, (recording.sample_count - start) / rate)
    except KeyboardInterrupt:
        partial = True
    _take_rows(tracker, rows)
    return TrackLog(
        recording=recording.path.name,
        sample_rate_hz=rate,
        duration_s=(tracker.position() - start) / rate,
        partial=partial,
        signals=rows.tracks(SignalTrack),
        combos=rows.tracks(ComboTrack),
        breaks=breaks_of(tracker),
        gain=recording.gain,
    )


def breaks_of(tracker: _core.Tracker | _core.Simulator) -> tuple[CountBreak, ...]:
    """Where counts of code periods broke, in order of their ends."""
    found = (CountBreak(*taken) for taken in tracker.take_breaks())
    return tuple(sorted(found, key=lambda b: (b.until_s, b.signal, b.prn)))


def watched(
    monitor: Monitor | None, config: TrackingConfig, rows: RowStore, rate: float, sample: int
) -> Sequence[Isolation]:
    """What the monitor says at a whole second."""
    if monitor is None or not config.fallback:
        return ()
    return monitor.look(rows, rate, sample / rate)


def _take_rows(tracker: _core.Tracker, rows: RowStore) -> None:
    """Move what was recorded since the last time out of the tracker."""
    with held_back():  # rows that are out of the one must get into the other
        rows.append(SignalTrack, tracker.take_signals())
        rows.append(ComboTrack, tracker.take_combos())


def _target(a: Acquisition) -> tuple[str, int, int, float, float]:
    return (a.signal, a.prn, a.sample_index, a.doppler_hz, a.code_delay_s)


def _targets(
    acquisitions: Sequence[Acquisition],
) -> tuple[int, list[tuple[str, int, int, float, float]]]:
    """Sample to start at, and what to track."""
    found = [a for a in acquisitions if a.detected]
    starts = {a.sample_index for a in found}
    if len(starts) > 1:
        raise ConfigError(
            f"acquisitions hold at different samples ({min(starts)} to {max(starts)}); "
            "acquire all of them with the same start_sample"
        )
    return min(starts, default=0), [_target(a) for a in found]


def _tracker(
    recording: Source,
    targets: list[tuple[str, int, int, float, float]],
    config: TrackingConfig,
    start: int,
    threads: int,
) -> _core.Tracker:
    form = recording.format
    values = core_settings(config, form)
    try:
        return _core.Tracker(
            form.sample_format,
            form.sample_rate_hz,
            form.lo_hz,
            values,
            targets,
            conjugate=form.conjugate,
            float_scale=form.float_scale,
            start_sample=start,
            threads=threads,
        )
    except ValueError as error:
        raise ConfigError(str(error)) from error


def core_settings(config: TrackingConfig, form: RecordingFormat) -> dict[str, Any]:
    """Settings as the core takes them, with what depends on the recorded band."""
    values: dict[str, Any] = config.model_dump(exclude={"reacquire", "fallback"})
    if values["qmboc"] is None:
        values["qmboc"] = _holds_qmboc(form)
    return values


def _holds_qmboc(form: RecordingFormat) -> bool:
    """Whether the recorded band reaches the BOC(6,1) lobes of the B1C pilot."""
    offset = abs(signal_spec("B1CP").carrier_hz - form.lo_hz)
    low, high = (edge - form.lo_hz for edge in form.band_hz)
    if form.bandwidth_hz is not None:
        centre = 0.5 * (low + high)
        low, high = centre - 0.5 * form.bandwidth_hz, centre + 0.5 * form.bandwidth_hz
    return min(offset - low, high - offset) >= QMBOC_HALF_BANDWIDTH_HZ


def _blocks(
    recording: Source, start: int, block_s: float | None, cuts: Sequence[int] = ()
) -> Iterator[tuple[int, int]]:
    """(first sample, count) of the blocks; cut also at whole seconds of the recording."""
    form, rate = recording.format, recording.format.sample_rate_hz
    size = BLOCK_BYTES * 8 // form.bits_per_sample if block_s is None else round(block_s * rate)
    size = max(8, size // 8 * 8)
    begin = start
    while begin < recording.sample_count:
        second = _second(recording, int(begin / rate) + 1)
        if second <= begin:
            second = _second(recording, int(begin / rate) + 2)
        others = (cut for cut in cuts if cut > begin)
        end = min(begin + size, second, recording.sample_count, *others)
        yield begin, end - begin
        begin = end


def _second(recording: Source, number: int) -> int:
    """First sample of a second of the recording, on a whole byte in any format."""
    return round(number * recording.format.sample_rate_hz) // 8 * 8


def _is_whole_second(recording: Source, sample: int) -> bool:
    return sample == _second(recording, round(sample / recording.format.sample_rate_hz))


def _reacquire(tracker: _core.Tracker, recording: Source, sample: int, threads: int | None) -> None:
    """Search for the signals that are lost at this sample; those not found stay lost."""
    for signal, prn, doppler_hz in tracker.lost():
        widest_hz = max(5000.0, abs(doppler_hz) + 500.0)
        try:
            found = acquire(
                recording,
                AcquisitionConfig(doppler_max_hz=widest_hz),
                signals=[signal],
                prns=[prn],
                start_sample=sample,
                threads=threads,
            )
        except RecordingError:  # too little left, or silence: nothing to find
            continue
        for acquisition in found:
            if acquisition.detected and acquisition.signal == signal:
                tracker.restart(_target(acquisition))
