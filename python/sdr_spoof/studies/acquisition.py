"""Studies of the FFT search: empirical false-alarm probability, and detection against C/N0.

``run`` does both with the default settings of :class:`~sdr_spoof.acquisition.AcquisitionConfig`
and writes a figure, a CSV and a JSON file. Everything is reproducible from the seed.

Theory of detection: the cell nearest to the signal, offset from it by a uniformly distributed
part of a delay cell and of a Doppler bin, follows the non-central chi-square law of 2K degrees of
freedom with non-centrality ``2 K (C/N0) T eta R(dt)^2 sinc(df T)^2``: T is the code period, eta
the share of power in the search band, R the correlation of the band-limited code. Neighbouring
cells, which detect a little more, are left out.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import binomtest, ncx2

from sdr_spoof import _core
from sdr_spoof.acquisition import AcquisitionConfig
from sdr_spoof.acquisition_threshold import threshold

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Progress = Callable[[float, float], None]

SAMPLE_RATE = 16 / 4.096
"""Of the complex samples that hold signals, in rates of the search; high enough that the code's
spectrum hardly folds."""
NOISE_RATE = 5 / 4.096
"""Of those of noise alone: all of the search's band must be there."""
LEAST_SEARCH_RATE_HZ = 4.096e6
"""Slower searches (C/A) get the samples of this one."""
SATELLITES = 4
"""In one synthetic recording of the detection study; their mutual noise is below 0.1 dB."""


@dataclass(frozen=True)
class Grid:
    """One way to search a signal."""

    signal: str
    blocks: int
    reach: int
    """Doppler bins searched on each side of the middle."""

    @property
    def bins(self) -> int:
        """Doppler bins."""
        return 2 * self.reach + 1

    @property
    def period_s(self) -> float:
        """Code period, the coherent integration."""
        spec = _core.signal_spec(self.signal)
        return float(spec["code_length"] / spec["chip_rate_hz"])

    @property
    def rate_hz(self) -> float:
        """Rate of the search, to which that of the samples is chosen."""
        return max(_core.search_rate_hz(self.signal), LEAST_SEARCH_RATE_HZ)

    def threshold(self, pfa: float, cells: int) -> float:
        """Threshold of one search of ``cells`` cells."""
        correlation = tuple(_core.search_peak_shape(self.signal, [1.0, 2.0, 3.0])[1])
        return threshold(pfa, self.bins, cells // self.bins, self.blocks, correlation)


def default_grid(signal: str, config: AcquisitionConfig | None = None) -> Grid:
    """What ``acquire`` searches by default: B1C after a handover, others blind."""
    config = config or AcquisitionConfig()
    if signal == "B1CP":
        return Grid(signal, config.blocks_long, round(config.handover_doppler_hz / 50.0))
    return Grid(signal, config.blocks_short, round(config.doppler_max_hz / 500.0))


@dataclass(frozen=True)
class PfaResult:
    """False alarms of searches of pure noise."""

    signal: str
    asked: float
    searches: int
    alarms: int
    low: float
    """Lower end of the 95 % confidence interval (Clopper-Pearson) of the probability."""
    high: float


def false_alarms(
    grid: Grid,
    pfas: Sequence[float],
    searches: int,
    *,
    seed: int = 1,
    threads: int = 1,
) -> list[PfaResult]:
    """Search white Gaussian int8 noise for every PRN, again and again with new noise.

    Returns:
        One result for each of ``pfas``, all from the same searches.
    """
    prns = _core.signal_spec(grid.signal)["prns"]
    statistics: list[float] = []
    cells, rate_hz = 0, NOISE_RATE * grid.rate_hz
    for trial in range(-(-searches // len(prns))):
        rng = np.random.default_rng([seed, trial])
        count = round((grid.blocks + 1) * grid.period_s * rate_hz) + 4096
        noise = np.clip(np.rint(rng.normal(0.0, 25.0, 2 * count)), -128, 127).astype(np.int8)
        search = _search(grid, noise.view(np.uint8), rate_hz, threads)
        peaks = search.run([(p, -grid.reach, grid.reach) for p in prns])
        statistics += [p.statistic for p in peaks]
        cells = peaks[0].cells
    return [_pfa_result(grid, pfa, cells, statistics) for pfa in pfas]


def _pfa_result(grid: Grid, pfa: float, cells: int, statistics: Sequence[float]) -> PfaResult:
    alarms = int(np.sum(np.asarray(statistics) > grid.threshold(pfa, cells)))
    interval = binomtest(alarms, len(statistics)).proportion_ci(0.95)
    return PfaResult(grid.signal, pfa, len(statistics), alarms, interval.low, interval.high)


def _search(grid: Grid, raw: NDArray[np.uint8], rate_hz: float, threads: int) -> _core.Search:
    return _core.Search(
        grid.signal,
        raw,
        "ci8",
        sample_rate_hz=rate_hz,
        if_hz=0.0,
        blocks=grid.blocks,
        bins=(-grid.reach, grid.reach),
        threads=threads,
    )


@dataclass(frozen=True)
class PdPoint:
    """Detections at one C/N0."""

    signal: str
    cn0_dbhz: float
    trials: int
    detected: int
    theory: float
    cn0_bias_db: float
    """Mean C/N0 estimate of the detections less the truth; nan if there are none."""


def detections(
    grid: Grid,
    cn0_dbhz: float,
    trials: int,
    *,
    pfa: float = AcquisitionConfig().pfa,
    seed: int = 2,
    threads: int = 1,
) -> PdPoint:
    """Search synthetic recordings for satellites of one C/N0, at random delays and Dopplers.

    A detection counts if delay and Doppler are right (1 chip, 1.5 bins).
    """
    errors: list[float] = []
    for trial in range(-(-trials // SATELLITES)):
        rng = np.random.default_rng([seed, round(10 * cn0_dbhz), trial])
        errors += _trial(grid, cn0_dbhz, pfa, rng, threads)
    count = -(-trials // SATELLITES) * SATELLITES
    bias = float(np.mean(errors)) if errors else float("nan")
    theory = float(theoretical_pd(grid, [cn0_dbhz], pfa)[0])
    return PdPoint(grid.signal, cn0_dbhz, count, len(errors), theory, bias)


def _trial(
    grid: Grid, cn0_dbhz: float, pfa: float, rng: np.random.Generator, threads: int
) -> list[float]:
    """C/N0 errors of the satellites detected in one synthetic recording."""
    spec = _core.signal_spec(grid.signal)
    bin_hz = 0.5 / grid.period_s
    prns = [int(p) for p in rng.choice(spec["prns"], SATELLITES, replace=False)]
    delays = rng.uniform(0.0, grid.period_s, SATELLITES)
    dopplers = rng.uniform(-grid.reach, grid.reach, SATELLITES) * bin_hz
    emitters = [
        _core.Emitter(
            grid.signal,
            prn,
            cn0_dbhz,
            delay_s=float(delay),
            doppler_hz=float(doppler),
            data_seed=int(rng.integers(2**32)),
        )
        for prn, delay, doppler in zip(prns, delays, dopplers, strict=True)
    ]
    rate_hz = SAMPLE_RATE * grid.rate_hz
    synthesizer = _core.Synthesizer(
        "ci8",
        rate_hz,
        spec["carrier_hz"],
        emitters,
        noise_rms_lsb=25.0,
        seed=int(rng.integers(2**32)),
        threads=threads,
    )
    count = round((grid.blocks + 1) * grid.period_s * rate_hz) + 4096
    search = _search(grid, synthesizer.generate(0, count), rate_hz, threads)
    peaks = search.run([(prn, -grid.reach, grid.reach) for prn in prns])
    return [
        peak.cn0_dbhz - cn0_dbhz
        for peak, emitter, doppler in zip(peaks, emitters, dopplers, strict=True)
        if peak.statistic > grid.threshold(pfa, peak.cells)
        and abs(peak.doppler_hz - doppler) < 1.5 * bin_hz
        and _delay_error_chips(peak, emitter, spec) < 1.0
    ]


def _delay_error_chips(
    peak: _core.SearchPeak, emitter: _core.Emitter, spec: dict[str, float]
) -> float:
    phase = float(emitter.code_phase_chips(np.zeros(1))[0])
    periods = (phase + peak.code_delay_s * spec["chip_rate_hz"]) / spec["code_length"]
    return float(abs(periods - round(periods)) * spec["code_length"])


def theoretical_pd(grid: Grid, cn0_dbhz: Sequence[float], pfa: float) -> NDArray[np.float64]:
    """Probability of detection by the nearest cell (see the module), shape of ``cn0_dbhz``."""
    offsets = (np.arange(16) + 0.5) / 32  # of a cell; the loss is even in both
    in_band, correlation = _core.search_peak_shape(grid.signal, offsets.tolist())
    delay_loss = np.square(correlation)
    doppler_loss = np.square(np.sinc(offsets / 2))
    lags = round(_core.search_rate_hz(grid.signal) * grid.period_s)
    level = grid.threshold(pfa, lags * grid.bins)
    cn0 = 10 ** (np.asarray(cn0_dbhz) / 10)
    snr = cn0[:, None, None] * grid.period_s * in_band * np.outer(delay_loss, doppler_loss)
    pd = ncx2.sf(level, 2 * grid.blocks, 2 * grid.blocks * snr)
    return np.asarray(pd.mean(axis=(1, 2)))


def run(
    output: Path,
    *,
    searches: int = 3000,
    trials: int = 240,
    pfas: Sequence[float] = (0.2, 0.05, 0.01),
    threads: int = 1,
    progress: Progress | None = None,
) -> dict[str, object]:
    """Run both studies for B1I, B1CP and L1CA; write acquisition_pd.{png,csv} and acquisition.json.

    Args:
        output: folder to write to.
        searches: noise-only searches for each signal.
        trials: searches with a signal, for each C/N0.
        pfas: false-alarm probabilities asked for in the noise-only study.
        threads: worker threads; the numbers do not depend on it.
        progress: called with (done, total).

    Returns:
        What acquisition.json holds.
    """
    plan = {
        "B1I": np.arange(30.0, 39.5, 1.0),
        "B1CP": np.arange(26.0, 35.5, 1.0),
        "L1CA": np.arange(30.0, 39.5, 1.0),
    }
    total = sum(len(c) for c in plan.values())
    alarms: list[PfaResult] = []
    points: list[PdPoint] = []
    for signal, levels in plan.items():
        grid = default_grid(signal)
        alarms += false_alarms(grid, pfas, searches, threads=threads)
        for cn0_dbhz in levels:
            points.append(detections(grid, float(cn0_dbhz), trials, threads=threads))
            if progress is not None:
                progress(len(points), total)
    result: dict[str, object] = {
        "pfa": [asdict(a) for a in alarms],
        "pd": [asdict(p) for p in points],
    }
    from .acquisition_figure import draw  # noqa: PLC0415 - matplotlib is slow to import

    output.mkdir(parents=True, exist_ok=True)
    (output / "acquisition.json").write_text(json.dumps(result, indent=1) + "\n")
    with (output / "acquisition_pd.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(asdict(points[0])), lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(p) for p in points)
    draw(output / "acquisition_pd.png", points)
    return result
