"""FFT search of a recording for satellites: what is there, with Doppler, code delay and C/N0.

Each signal is searched over all its PRNs, the whole code period and the whole Doppler range.
Where both signals of a BeiDou satellite are in the recording, B1I (1 ms code, cheap) is searched
blind and B1C only near the Doppler of the satellites found, but over the whole code period: a
spoofed B1C need not line up with B1I.

Strong signals can exceed the threshold with other satellites' codes (cross-correlation, up to
-21 dB for C/A). Weak detections are therefore confirmed in samples from which the strong ones
have been taken out. Codes of the same family that are not registered (QZSS L1S) stay and limit
C/A: sums longer than the default find their cross-correlations, at 30 to 34 dB-Hz.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field

from . import _core
from .acquisition_threshold import threshold
from .errors import RecordingError, SignalError
from .records import Acquisition

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .sources.source import Source

    Progress = Callable[[float, float], None]

HANDOVER = {"B1CP": "B1I", "B1CD": "B1I"}
"""Signal to the one that is searched in its stead first, where the recording holds both."""

NOT_BY_DEFAULT = ("B1CD",)
"""Searched only on demand: the pilot, on the same carrier, is 4.8 dB stronger."""

_PRNS_AT_ONCE = 8
_WORK_AT_ONCE = 50.0
"""Doppler bins times seconds of samples: a quarter of a second on one core."""
_STRONG = 2.0
"""A statistic of this many thresholds is beyond what cross-correlation makes of one's equals."""
_CLOSE = 10**-1.2
"""Cross-correlation (-21 dB at worst) cannot reach this share of the strongest statistic."""


class AcquisitionConfig(BaseModel):
    """Settings of the FFT search."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    pfa: float = Field(
        default=1e-5,
        gt=0,
        lt=0.5,
        description="false-alarm probability of the search for one PRN, over its whole grid of "
        "code delay and Doppler; a recording has one such search per signal and PRN",
    )
    doppler_max_hz: float = Field(
        default=5000.0,
        gt=0,
        le=100e3,
        description="largest Doppler searched, receiver offset included",
    )
    blocks_short: int = Field(
        default=20,
        ge=1,
        le=1000,
        description="non-coherent sums of one code period for codes of 1 ms (B1I, L1CA)",
    )
    blocks_long: int = Field(
        default=5,
        ge=1,
        le=1000,
        description="non-coherent sums of one code period for codes of 10 ms (B1C)",
    )
    handover: bool = Field(
        default=True,
        description="search B1C only near the Doppler of satellites found on B1I, where the "
        "recording holds both; false searches both blind",
    )
    handover_doppler_hz: float = Field(
        default=250.0, gt=0, description="half width of the Doppler range searched after a handover"
    )


@dataclass(frozen=True)
class _Plan:
    """One signal's part of the search."""

    signal: str
    prns: tuple[int, ...]
    blocks: int
    bin_hz: float
    period_s: float
    carrier_hz: float


def acquire(
    recording: Source,
    config: AcquisitionConfig,
    *,
    signals: Sequence[str] | None = None,
    prns: Sequence[int] | None = None,
    start_sample: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> list[Acquisition]:
    """Search a recording for satellites.

    Args:
        recording: where to read; only the samples searched are read.
        config: settings.
        signals: registry names; default: all that fit and that one of ``prns`` sends, but not
            ``NOT_BY_DEFAULT``.
        prns: satellites; default: all that transmit the signal.
        start_sample: where the search starts.
        threads: default: one per processor. The result does not depend on it.
        progress: called with (done, total).

    Returns:
        One record per search, in the order of signals and PRNs; see ``detected``. PRNs that a
        handover left out are missing. C/N0 is that of the whole component (B1CP: all of QMBOC).

    Raises:
        SignalError: unknown signal, one that the recording cannot hold, or no PRN to search.
        RecordingError: ``start_sample`` negative, too short after it, or silent.
    """
    if start_sample < 0:
        raise RecordingError(f"start_sample is {start_sample}; the first sample of a file is 0")
    plans = [
        _plan(recording, config, signal, prns, start_sample)
        for signal in _ordered(recording, signals, prns)
    ]
    total = float(sum(len(p.prns) for p in plans))
    found: dict[str, list[Acquisition]] = {}
    done = 0.0
    for plan in plans:
        ranges = _doppler_ranges(plan, config, found)
        report = _offset(progress, done, total, len(plan.prns) / max(len(ranges), 1))
        found[plan.signal] = []
        if ranges:
            search = _SignalSearch(
                recording, plan, config, ranges, start_sample, threads or _processors()
            )
            found[plan.signal] = search.run(report)
        done += len(plan.prns)
    if progress is not None:
        progress(total, total)
    return [a for plan in plans for a in found[plan.signal]]


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _ordered(
    recording: Source, signals: Sequence[str] | None, prns: Sequence[int] | None
) -> list[str]:
    """Signals to search, each after the one that hands over to it."""
    if signals is None:
        signals = [s for s in recording.signals() if s not in NOT_BY_DEFAULT]
        # Of several signals, leave out those that none of the satellites asked for transmits.
        sent = [s for s in signals if not prns or {*prns} & {*_core.signal_spec(s)["prns"]}]
        signals = sent or signals
        if not signals:
            raise SignalError(
                "the recording holds no known signal; check its lo_hz and sample_rate_hz"
            )
    known = _core.signal_ids()
    for signal in signals:
        if signal not in known:
            raise SignalError(f"unknown signal '{signal}'; known signals: {', '.join(known)}")
        recording.check_signal(signal)
    return sorted(dict.fromkeys(signals), key=lambda s: s in HANDOVER)


def _plan(
    recording: Source,
    config: AcquisitionConfig,
    signal: str,
    prns: Sequence[int] | None,
    start_sample: int,
) -> _Plan:
    spec = _core.signal_spec(signal)
    wanted = None if prns is None else set(prns)
    chosen = tuple(p for p in spec["prns"] if wanted is None or p in wanted)
    if not chosen:
        names = ", ".join(map(str, sorted(wanted or ())))
        raise SignalError(
            f"{signal}: none of the PRNs asked for ({names}) transmits it; it is sent by PRN "
            f"{spec['prns'][0]} to {spec['prns'][-1]}"
        )
    period_s = spec["code_length"] / spec["chip_rate_hz"]
    blocks = config.blocks_short if period_s < 5e-3 else config.blocks_long
    rate = recording.format.sample_rate_hz
    held = math.floor((recording.sample_count - start_sample) / rate / period_s + 1e-6) - 1
    if held < 1:
        raise RecordingError(
            f"too short: {signal} needs {2e3 * period_s:g} ms after sample {start_sample}, the "
            f"recording ends at sample {recording.sample_count} ({rate / 1e6:g} Msps)"
        )
    return _Plan(signal, chosen, min(blocks, held), 0.5 / period_s, period_s, spec["carrier_hz"])


def _doppler_ranges(
    plan: _Plan, config: AcquisitionConfig, found: dict[str, list[Acquisition]]
) -> dict[int, tuple[int, int]]:
    """Doppler bins of each PRN to search, both ends included."""
    first = HANDOVER.get(plan.signal)
    if not config.handover or first not in found:
        reach = math.ceil(config.doppler_max_hz / plan.bin_hz)
        return dict.fromkeys(plan.prns, (-reach, reach))
    scale = plan.carrier_hz / _core.signal_spec(first)["carrier_hz"]
    reach = math.ceil(config.handover_doppler_hz / plan.bin_hz)
    middle = {a.prn: round(a.doppler_hz * scale / plan.bin_hz) for a in found[first] if a.detected}
    return {p: (middle[p] - reach, middle[p] + reach) for p in plan.prns if p in middle}


def _offset(
    progress: Progress | None, done: float, total: float, weight: float
) -> Callable[[int], None]:
    def report(count: int) -> None:
        if progress is not None:
            progress(done + weight * count, total)

    return report


class _SignalSearch:
    """Search for one signal of a recording."""

    def __init__(
        self,
        recording: Source,
        plan: _Plan,
        config: AcquisitionConfig,
        ranges: dict[int, tuple[int, int]],
        start_sample: int,
        threads: int,
    ) -> None:
        """``ranges``: first and last Doppler bin of each PRN to search; at least one."""
        self._plan, self._config, self._start = plan, config, start_sample
        self._ranges = ranges
        form = recording.format
        # From a whole byte of any format, with samples to fill the filter.
        begin = max(start_sample - 4096, 0) // 4 * 4
        count = math.ceil((plan.blocks + 1) * plan.period_s * form.sample_rate_hz) + 4096
        try:
            self._search = _core.Search(
                plan.signal,
                recording.read_raw(begin, start_sample - begin + count),
                form.sample_format,
                sample_rate_hz=form.sample_rate_hz,
                if_hz=plan.carrier_hz - form.lo_hz,
                blocks=plan.blocks,
                bins=(min(low for low, _ in ranges.values()), max(h for _, h in ranges.values())),
                threads=threads,
                first=start_sample - begin,
                scale=form.float_scale,
                conjugate=form.conjugate,
            )
        except ValueError as error:
            raise RecordingError(f"{plan.signal}: {error}") from error
        widest = max(high - low + 1 for low, high in ranges.values())
        work = widest * plan.blocks * plan.period_s
        self._at_once = max(1, min(_PRNS_AT_ONCE, int(_WORK_AT_ONCE / work)))
        self._correlation = tuple(_core.search_peak_shape(plan.signal, [1.0, 2.0, 3.0])[1])

    def run(self, report: Callable[[int], None]) -> list[Acquisition]:
        """Search all PRNs, then confirm the weak detections with the strong ones taken out.

        Args:
            report: called with the number of PRNs done.
        """
        results = self._searched(list(self._ranges), report)
        unsure = [a for a in results.values() if a.detected]
        while (strong := _strong(unsure)) and len(strong) < len(unsure):
            self._search.cancel([(a.prn, a.doppler_hz, a.code_delay_s) for a in strong])
            again = self._searched([a.prn for a in unsure if a not in strong])
            results |= again
            unsure = [a for a in again.values() if a.detected]
        return list(results.values())

    def _searched(
        self, prns: list[int], report: Callable[[int], None] | None = None
    ) -> dict[int, Acquisition]:
        """Search in short calls: the core notices Ctrl-C only between them."""
        results: dict[int, Acquisition] = {}
        while rest := prns[len(results) :]:
            if report is not None:
                report(len(results))
            jobs = [(prn, *self._ranges[prn]) for prn in rest[: self._at_once]]
            for peak, (_, low, high) in zip(self._search.run(jobs), jobs, strict=True):
                results[peak.prn] = self._record(peak, high - low + 1)
        return results

    def _record(self, peak: _core.SearchPeak, bins: int) -> Acquisition:
        plan = self._plan
        level = threshold(
            self._config.pfa, bins, peak.cells // bins, plan.blocks, self._correlation
        )
        return Acquisition(
            signal=plan.signal,
            prn=peak.prn,
            detected=peak.statistic > level,
            sample_index=self._start,
            doppler_hz=peak.doppler_hz,
            code_delay_s=peak.code_delay_s,
            cn0_dbhz=peak.cn0_dbhz,
            statistic=peak.statistic,
            threshold=level,
            doppler_bin_hz=plan.bin_hz,
        )


def _strong(searched: list[Acquisition]) -> list[Acquisition]:
    """Those that cannot be another's cross-correlation, strongest first."""
    top = max((a.statistic for a in searched), default=0.0)
    return sorted(
        (a for a in searched if a.statistic > max(_STRONG * a.threshold, _CLOSE * top)),
        key=lambda a: -a.statistic,
    )
