"""What each statistic is under H0, coloured noise, and detection against false alarms (ROC)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import norm

from sdr_spoof import decision
from sdr_spoof.aiding.dme import integrity
from sdr_spoof.aiding.dme.statistics import STATISTICS
from sdr_spoof.decision.calibration import curve
from sdr_spoof.decision.laws import Law
from sdr_spoof.decision.rule import first_alarm
from sdr_spoof.decision.whitening import fit, whiten
from sdr_spoof.reproduce.study import Number, Picture, Section, Table, near

from . import figures, published, trials
from .delay_section import RULES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.decision.rule import SequentialRule
    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

RHO = 0.9
HOUR_S = 3600
ROC_SHIFT = 1.0
THRESHOLDS = np.linspace(1.0, 30.0, 120)
EPOCHS = 100


def section(effort: Effort, stages: Stages) -> Section:
    """Histograms, colour, ROC."""
    stages("laws under H0")
    histograms, moments = _laws(effort)
    stages("coloured noise")
    coloured = {name: _coloured(decision.find(name), effort) for name in RULES}
    stages("ROC")
    roc = {name: _roc(decision.find(name), effort) for name in RULES}
    rows: list[Sequence[Cell]] = [(name, *values) for name, values in moments.items()]
    return Section(
        "Laws without an attack, coloured noise, ROC",
        text=(
            "All statistics are linear in white normal noise, so that their channels are "
            "standard normal from epoch to epoch.",
            f"Every rule takes its samples to be white. With a memory of {RHO:g} from sample to "
            "sample (multipath, smoothed code) each alarms within the hour. Fitted to the 200 s "
            "before the tests and taken out, the memory leaves the false alarms that the threshold "
            "promises, and a steady shift is worth sqrt((1 - rho) / (1 + rho)) = "
            f"{((1 - RHO) / (1 + RHO)) ** 0.5:.2f} of itself. Samples whose colour is another are "
            "refused: of noise averaged over eight samples the share that is judged stands in the "
            "table.",
        ),
        tables=[
            Table(
                "laws",
                "Channels of unit variance without an attack",
                ("statistic", "mean", "standard deviation", "beyond 3.29 (1e-3)"),
                rows,
            ),
            Table(
                "coloured",
                f"False alarm in 1 h at the published threshold, memory {RHO:g}",
                ("rule", "as it is", "whitened", "refused", "moving mean of 8: refused"),
                [(name, *values) for name, values in coloured.items()],
            ),
            Table(
                "roc",
                f"Share found within 30 s at r = {ROC_SHIFT:g} against false alarms in 1 h",
                ("rule", "threshold", "false alarm in 1 h", "share found"),
                [(name, *point) for name, points in roc.items() for point in points],
                shown=False,
            ),
        ],
        pictures=[
            Picture(
                "laws",
                "Statistics without an attack",
                figures.laws(histograms),
                "Histogram of all channels and epochs, and the law (line).",
            ),
            Picture(
                "roc",
                "Detection within 30 s against false alarms",
                figures.roc(roc, ROC_SHIFT),
                "A shift of one standard deviation; false alarms by importance sampling.",
            ),
        ],
        numbers=_numbers(moments, coloured, effort),
    )


def _laws(
    effort: Effort,
) -> tuple[dict[str, tuple[np.ndarray, str]], dict[str, tuple[float, float, float]]]:
    geometry = published.geometry(published.SIGMA_FIGURE5_M)
    case = trials.Case(geometry, None, onset=0, after=EPOCHS)
    y = case.run(min(effort.runs, 1000), trials.random_of(14)).differences_m
    drawn = {s.title: s.values(y, geometry).ravel() for s in STATISTICS.values()}
    moments = {
        name: (float(z.mean()), float(z.std()), float(np.mean(np.abs(z) > norm.isf(5e-4))))
        for name, z in drawn.items()
    }
    histograms = {name: (z, "normal") for name, z in drawn.items()}
    histograms["RAIM"] = (integrity.raim(y, geometry, published.ALPHA).statistic.ravel(), "chi2-1")
    histograms["AAIM"] = (integrity.aaim(y, geometry, published.ALPHA).statistic.ravel(), "chi2-2")
    return histograms, moments


def _coloured(rule: SequentialRule[Any], effort: Effort) -> tuple[float, float, float, float]:
    """False alarms as it is and whitened, shares that are refused."""
    runs = min(effort.runs, 400)
    before = published.ONSET_S
    z = Law("ar1", RHO).draw(trials.random_of(15), (runs, before + HOUR_S))
    fits = [fit(row[:before]) for row in z]
    judged = [k for k, f in enumerate(fits) if f.refusal is None]
    white = np.stack([whiten(z[k], fits[k].rho)[1:] for k in judged])
    smooth = trials.random_of(16).standard_normal((runs, before + 7))
    means = np.stack([np.convolve(row, np.full(8, 8**-0.5), "valid") for row in smooth])
    refused = np.mean([fit(row).refusal is not None for row in means])
    return (
        _alarmed(rule, z),
        _alarmed(rule, white),
        1.0 - len(judged) / runs,
        float(refused),
    )


def _alarmed(rule: SequentialRule[Any], z: np.ndarray) -> float:
    first = first_alarm(rule.run(z), published.THRESHOLD)
    return float(np.mean(first < z.shape[1]))


def _roc(rule: SequentialRule[Any], effort: Effort) -> list[tuple[float, float, float]]:
    """Threshold, false alarms in an hour, share found."""
    runs = max(effort.runs // 4, 20) if effort.quick else None
    false = curve(rule, THRESHOLDS, runs=runs)
    z = trials.shifted(
        ROC_SHIFT, published.ONSET_S, published.WITHIN_S, effort.runs, trials.random_of(17)
    )
    path = rule.run(z)
    found = [trials.delays_of(path, float(h), published.ONSET_S).within() for h in THRESHOLDS]
    return list(zip(THRESHOLDS.tolist(), false.tolist(), found, strict=True))


def _numbers(
    moments: dict[str, tuple[float, float, float]],
    coloured: dict[str, tuple[float, float, float, float]],
    effort: Effort,
) -> Sequence[Number]:
    count = min(effort.runs, 1000) * EPOCHS
    error = trials.ERRORS / min(effort.runs, 400) ** 0.5
    widest = max(abs(sd - 1.0) for _, sd, _ in moments.values())
    return (
        near(
            "laws_sd",
            "largest departure of a standard deviation from 1",
            widest,
            0.0,
            trials.ERRORS / count**0.5,
        ),
        *(
            Number(
                f"coloured_{name}",
                f"{name}: false alarm in 1 h, memory 0.9",
                values[0],
                0.99 if name != "sprt-classic" else 0.5,
                1.0,
                "",
                0.99,
            )
            for name, values in coloured.items()
        ),
        *(
            Number(
                f"whitened_{name}",
                f"{name}: the same, whitened",
                values[1],
                0.0,
                0.06 + 0.5 * error,
            )
            for name, values in coloured.items()
        ),
    )
