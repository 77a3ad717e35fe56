"""Thresholds and detection probabilities of the published model, and draws that check them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.campaign.analysis import wilson
from sdr_spoof.detectors import combo_model as model
from sdr_spoof.reproduce.study import Number, Picture, Section, Table, near

from . import published
from .threshold_figure import draw_sweeps

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

SEED = 20_180_001
ACCEPTED = 0.99993666
"""Confidence of four standard errors: that of the intervals in which the model must lie."""
THRESHOLDS = {"as_ratio": 4.511, "as_dbhz": 0.680}
"""What each reading must give, in Hz."""


@dataclass(frozen=True)
class Law:
    """Law of the published statistic for one reading of the C/N0."""

    reading: str
    sigma_fll_hz: float
    sigma_hz: float
    """Of the difference."""
    threshold_hz: float


@dataclass(frozen=True)
class Sweep:
    """Detection probability along one of the published sweeps."""

    name: str
    label: str
    """Of the swept quantity, for axes and columns."""
    swept: Floats
    shift_hz: Floats
    """Mean of the statistic under H1."""
    reference: Sequence[float]


def law(reading: str) -> Law:
    """Law and threshold with the printed settings."""
    cn0_hz = model.PUBLISHED_CN0_HZ[reading]
    fll = model.fll_sigma_hz(cn0_hz, published.INTEGRATION_S, published.LOOP_BANDWIDTH_HZ)
    sigma = model.difference_sigma_hz(fll, fll)
    threshold = model.threshold_for_pfa_hz(sigma, published.PFA)
    return Law(reading, float(fll), float(sigma), float(threshold))


def sweeps() -> tuple[Sweep, Sweep]:
    """The drags of Figure 3a and the amplitude ratios of Figure 3b."""
    shift = model.capture_rate_small_angle_hz
    return (
        Sweep(
            "pd_by_drag",
            "drag f_e (Hz)",
            published.DRAGS_HZ,
            shift(published.DRAGS_HZ, published.ETA),
            published.PD_OF_DRAG,
        ),
        Sweep(
            "pd_by_amplitude_ratio",
            "amplitude ratio eta",
            published.ETAS,
            shift(published.DRAG_HZ, published.ETAS),
            published.PD_OF_ETA,
        ),
    )


def drawn_hits(of: Law, shift_hz: float, draws: int, seed: Sequence[int]) -> int:
    """Draws of the difference of two loops' frequencies that cross the threshold."""
    rng = np.random.default_rng(seed)
    upper, lower = of.sigma_fll_hz * rng.standard_normal((2, draws))
    return int(np.count_nonzero(shift_hz + upper - lower > of.threshold_hz))


def section(effort: Effort, stages: Stages) -> Section:
    """Thresholds, both sweeps for both readings, and the likelihood-ratio method."""
    laws = [law(reading) for reading in published.READINGS]
    with stages("Published model"):
        tables = [_sweep_table(s, laws, effort.draws) for s in sweeps()]
    png = draw_sweeps(sweeps(), laws, tables)
    numbers = [*_threshold_numbers(laws)]
    for sweep, table in zip(sweeps(), tables, strict=True):
        numbers += _sweep_numbers(sweep, laws, table, effort.draws)
    return Section(
        "Thresholds and detection probability as published (Figure 3)",
        text=(
            "The rate difference is N(0, 2 sigma²) without an attack and shifted by "
            "eta / (1 + eta) f_e with one. The printed curves follow only if the stated C/N0 of "
            "30 dB enters as the ratio 30, and the printed threshold of 18.83 Hz is then 4.511 Hz "
            "plus 14.322, the difference of the carriers in MHz, added as if it were Hz. At a true "
            "30 dB-Hz the threshold is 0.680 Hz and no point of either sweep is ever missed.",
        ),
        tables=[_threshold_table(laws), *tables, _likelihood_table(laws)],
        pictures=[
            Picture(
                "figure3",
                "Detection probability against drag and amplitude ratio",
                png,
                "Figure 3 of the publication: lines are equation 26, marks are "
                f"{effort.draws} draws a point with 95 % Wilson intervals. In the true reading of "
                "30 dB-Hz both curves are flat at 1.",
            )
        ],
        numbers=numbers,
    )


def _threshold_table(laws: Sequence[Law]) -> Table:
    rows: list[tuple[Cell, ...]] = [
        (
            published.READINGS[of.reading],
            of.sigma_fll_hz,
            of.sigma_hz,
            of.threshold_hz,
            of.threshold_hz + published.CARRIER_DIFFERENCE_MHZ,
        )
        for of in laws
    ]
    columns = (
        "C/N0 read as",
        "sigma FLL (Hz)",
        "sigma of difference (Hz)",
        "threshold (Hz)",
        "plus 14.322 (as printed)",
    )
    return Table("thresholds", "Thresholds at a false-alarm probability of 1e-6", columns, rows)


def _sweep_table(sweep: Sweep, laws: Sequence[Law], draws: int) -> Table:
    columns = [sweep.label, "published"]
    values: list[Sequence[Cell]] = [[round(float(v), 1) for v in sweep.swept], sweep.reference]
    for number, of in enumerate(laws):
        pd = model.detection_probability(sweep.shift_hz, of.sigma_hz, of.threshold_hz)
        which = int(sweep.name == "pd_by_amplitude_ratio")
        seeds = [(SEED, number, which, row) for row in range(sweep.swept.size)]
        hits = [
            drawn_hits(of, float(shift), draws, seed)
            for shift, seed in zip(sweep.shift_hz, seeds, strict=True)
        ]
        low, high = wilson(hits, np.full(len(hits), draws))
        reading = {"as_ratio": "ratio", "as_dbhz": "dB-Hz"}[of.reading]
        columns += [f"Pd, {reading}", f"deviation, {reading}", f"drawn, {reading}"]
        columns += [f"low, {reading}", f"high, {reading}"]
        values += [
            pd.tolist(),
            (pd - np.asarray(sweep.reference)).tolist(),
            [h / draws for h in hits],
            low.tolist(),
            high.tolist(),
        ]
    title = {"pd_by_drag": "Drag at eta 1.5", "pd_by_amplitude_ratio": "Amplitude ratio at 10 Hz"}
    return Table(
        sweep.name,
        f"{title[sweep.name]}: detection probability",
        columns,
        list(zip(*values, strict=True)),
        f"Drawn: {draws} draws of the rate difference a point; the CSV has 95 % Wilson intervals.",
        details=[c for c in columns if c.startswith(("low", "high", "deviation, dB-Hz"))],
    )


def _likelihood_table(laws: Sequence[Law]) -> Table:
    """The first method of section 2.3: threshold at a likelihood ratio, equations 20 to 24."""
    rows: list[tuple[Cell, ...]] = []
    for of in laws:
        for drag in (8.0, 10.0, 12.5):
            shift = float(model.capture_rate_small_angle_hz(drag, published.ETA))
            at_pfa = float(model.log_likelihood_ratio(of.threshold_hz, of.sigma_hz, shift))
            even = float(model.threshold_for_likelihood_ratio_hz(of.sigma_hz, 1.0, shift))
            rows.append(
                (
                    published.READINGS[of.reading],
                    drag,
                    shift,
                    at_pfa,
                    even,
                    float(model.false_alarm_probability(of.sigma_hz, even)),
                    float(model.detection_probability(shift, of.sigma_hz, even)),
                )
            )
    columns = (
        "C/N0 read as",
        "drag (Hz)",
        "shift under H1 (Hz)",
        "ln ratio at the Pfa threshold",
        "threshold at ratio 1 (Hz)",
        "Pfa there",
        "Pd there",
    )
    return Table(
        "likelihood_ratio",
        "The other threshold method: a given likelihood ratio",
        columns,
        rows,
        "Equation 24 prints one fraction bar too wide; the threshold here is what equation 23 "
        "gives: (sigma² / shift) ln gamma + shift / 2.",
    )


def _threshold_numbers(laws: Sequence[Law]) -> Iterator[Number]:
    for of in laws:
        wanted = THRESHOLDS[of.reading]
        what = f"threshold, C/N0 {published.READINGS[of.reading]}"
        yield near(f"threshold_{of.reading}_hz", what, of.threshold_hz, wanted, 0.001, "Hz")
    printed = laws[0].threshold_hz + published.CARRIER_DIFFERENCE_MHZ
    yield near("threshold_printed", "threshold plus 14.322, as printed", printed, 18.833, 0.001)
    yield near(
        "sigma_fll_as_ratio_hz",
        "sigma FLL, C/N0 as a ratio",
        laws[0].sigma_fll_hz,
        0.67106,
        1e-4,
        "Hz",
    )
    yield near(
        "sigma_fll_as_dbhz_hz", "sigma FLL, 30 dB-Hz", laws[1].sigma_fll_hz, 0.10116, 1e-4, "Hz"
    )


def _sweep_numbers(sweep: Sweep, laws: Sequence[Law], table: Table, draws: int) -> Iterator[Number]:
    """Every point against its reference, and its draws against the model."""
    for number, of in enumerate(laws):
        pd = model.detection_probability(sweep.shift_hz, of.sigma_hz, of.threshold_hz)
        wanted = sweep.reference if number == 0 else [1.0] * pd.size
        for row, (at, value, reference) in enumerate(zip(sweep.swept, pd, wanted, strict=True)):
            name = f"{sweep.name}_{at:.1f}_{of.reading}"
            what = f"Pd at {sweep.label.split()[-2 if 'Hz' in sweep.label else -1]} {at:.1f}, "
            what += {"as_ratio": "14.77 dB-Hz", "as_dbhz": "30 dB-Hz"}[of.reading]
            yield near(name, what, float(value), reference, 0.001)
            drawn = float(table.rows[row][4 + 5 * number] or 0.0)
            low, high = wilson(round(drawn * draws), draws, ACCEPTED)
            # The model's value must lie in the interval of the draws.
            yield Number(
                f"{name}_in_drawn_interval",
                f"{what}, within 4 standard errors of {draws} draws",
                float(value),
                float(low),
                float(high),
                reference=drawn,
            )
