"""FFT search of a recording for one signal.

Strong signals can exceed the threshold with other satellites' codes (cross-correlation, up to
-21 dB for C/A). Weak detections are therefore confirmed in samples from which the strong ones
have been taken out. Codes of the same family that are not registered (QZSS L1S) stay and limit
C/A: sums longer than the default find their cross-correlations, at 30 to 34 dB-Hz.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import _core
from .acquisition_threshold import log10_probability, threshold
from .errors import RecordingError
from .records import Acquisition

if TYPE_CHECKING:
    from collections.abc import Callable

    from .sources.source import Source

_PRNS_AT_ONCE = 8
_WORK_AT_ONCE = 2e8
"""Doppler bins times samples of the search: a quarter of a second on one core."""
_STRONG = 2.0
"""A statistic of this many thresholds is beyond what cross-correlation makes of one's equals."""
_CLOSE = 10**-1.2
"""Cross-correlation (-21 dB at worst) cannot reach this share of the strongest statistic."""


@dataclass(frozen=True)
class Plan:
    """One signal's part of the search."""

    signal: str
    prns: tuple[int, ...]
    blocks: int
    bin_hz: float
    period_s: float
    carrier_hz: float


class SignalSearch:
    """Search for one signal of a recording."""

    def __init__(
        self,
        recording: Source,
        plan: Plan,
        ranges: dict[int, tuple[int, int]],
        pfa: float,
        start_sample: int,
        threads: int,
    ) -> None:
        """Take in the samples.

        Args:
            recording: where to read.
            plan: what to search.
            ranges: first and last Doppler bin of each PRN to search; at least one.
            pfa: false-alarm probability of the search for one PRN.
            start_sample: where the search starts.
            threads: the result does not depend on it.

        Raises:
            RecordingError: the samples are silent.
        """
        self._plan, self._ranges, self._pfa, self._start = plan, ranges, pfa, start_sample
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
        samples = plan.blocks * plan.period_s * _core.search_rate_hz(plan.signal)
        self._at_once = max(1, min(_PRNS_AT_ONCE, int(_WORK_AT_ONCE / (widest * samples))))
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

    def beside(self, known: list[tuple[int, float, float]]) -> list[tuple[Acquisition, float]]:
        """Search all PRNs with these signals (PRN, Doppler, code delay) taken out.

        Returns:
            As :meth:`run`, each with log10 of the probability that noise makes as much.
        """
        self._search.cancel(known)
        return [(a, self._log10_p(a)) for a in self.run(lambda done: None)]

    def _log10_p(self, found: Acquisition) -> float:
        low, high = self._ranges[found.prn]
        lags = round(self._plan.period_s * _core.search_rate_hz(self._plan.signal))
        grid = (high - low + 1, lags, self._plan.blocks, self._correlation)
        return log10_probability(found.statistic, *grid)

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
        lags = peak.cells // bins
        level = threshold(self._pfa, bins, lags, plan.blocks, self._correlation)
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
