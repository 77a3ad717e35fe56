"""The rule's own errors: recursion of the variance, start-up, sum of the compensation."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import decision
from sdr_spoof.aiding.dme import stations
from sdr_spoof.decision.rule import first_alarm
from sdr_spoof.reproduce.study import Number, Section, Table, near

from . import published, trials

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

SAMPLES = 400


def section(effort: Effort, stages: Stages) -> Section:
    """What equations 14, 17, 18 and 28 to 32 give."""
    stages("the rule's equations")
    runs = 10 * effort.runs
    z = trials.random_of(1).standard_normal((runs, SAMPLES))
    printed = printed_variance(z)
    early = start_up(z)
    rows: list[Sequence[Cell]] = [
        ("threshold ln((1 - beta) / alpha), equation 32", published.THRESHOLD, 11.5119),
        ("lower threshold ln(beta)", published.LOWER, -6.9077),
        ("variance by equation 18 at 400 samples, mean", float(printed.mean()), 0.6424),
        ("variance by equation 18 at 400 samples, standard deviation", float(printed.std()), 0.407),
        ("false alarm at the second sample, equation 14", early[0], 0.1825),
        ("false alarm within 200 s, equation 18", early[1], 0.29),
        ("false alarm within 200 s, equation 14, ten samples not tested", early[2], None),
        *((f"sum of zeta after {n} s, equations 28 to 30", zeta_sum(n), v) for n, v in ZETA),
    ]
    columns = ("quantity", "here", "reference")
    return Section(
        "The equations of the rule",
        text=(
            "Equation 18 leaves out the factors of the true recursion of equation 14, "
            "v_k = (k - 1) / k v_(k-1) + (k - 1) (m_k - m_(k-1))². It does not settle at the "
            "variance but at a random value. With either, two samples that happen to agree raise "
            "the statistic beyond the threshold at once. The compensation of equation 28 is "
            "negative without an attack, and is added with every sample: nothing lifts the sum "
            "again.",
        ),
        tables=[Table("equations", "Numbers of the equations", columns, rows)],
        numbers=list(_numbers(printed, early, runs)),
    )


ZETA = ((200, -1117.0), (3600, -30458.0))


def printed_variance(z: np.ndarray) -> np.ndarray:
    """Equation 18 after all samples of each run, (R,)."""
    count = np.arange(1.0, z.shape[1] + 1.0)
    mean = np.cumsum(z, axis=1) / count
    steps = (count[1:] - 1.0) / count[1:] * np.diff(mean, axis=1) ** 2
    return np.asarray(steps.sum(axis=1))


def start_up(z: np.ndarray) -> tuple[float, float, float]:
    """False alarms at the second sample; within 200 s as printed; and with a guard."""
    rule = decision.find("sprt-classic")
    found = []
    for variance, guard, last in (("sample", 0, 2), ("as-printed", 0, 200), ("sample", 10, 200)):
        path = rule.with_(variance=variance, guard=guard).run(z[:, :last])
        found.append(float(np.mean(first_alarm(path, published.THRESHOLD) < last)))
    return found[0], found[1], found[2]


def zeta_sum(samples: int) -> float:
    """Expected sum of ln(m_k²) without an attack: -ln k! - 1.27 k."""
    euler = 0.5772156649015329
    return -math.lgamma(samples + 1.0) - samples * (euler + math.log(2.0))


def _numbers(printed: np.ndarray, early: tuple[float, float, float], runs: int) -> Sequence[Number]:
    error = trials.ERRORS / runs**0.5
    exact = 2.0 / math.pi * math.atan(published.THRESHOLD**-0.5)
    sigma = stations.sigma_m([80e3, 100e3, 150e3])
    return (
        near("threshold", "threshold, equation 32", published.THRESHOLD, 11.5119, 1e-4),
        near("lower_threshold", "ln B", published.LOWER, -6.9077, 1e-4),
        near("sigma_dme_80km_m", "noise of DME at 80 km", float(sigma[0]), 182.6, 0.05, "m"),
        near("sigma_dme_100km_m", "noise of DME at 100 km", float(sigma[1]), 182.6, 0.05, "m"),
        near("sigma_dme_150km_m", "noise of DME at 150 km", float(sigma[2]), 209.1, 0.05, "m"),
        near("equation18_mean", "mean of equation 18", float(printed.mean()), 0.6424, 0.41 * error),
        near(
            "equation18_sd",
            "standard deviation of equation 18",
            float(printed.std()),
            0.407,
            0.01 + 0.7 * error,
        ),
        near("second_sample_exact", "P(alarm at k = 2), closed form", exact, 0.1825, 5e-5),
        trials.share_number("second_sample", "P(alarm at k = 2), drawn", early[0], runs, 0.1825),
        trials.share_number(
            "equation18_false_alarm",
            "false alarm in 200 s, equation 18",
            early[1],
            runs,
            0.29,
            0.03,
        ),
        near("zeta_200", "sum of zeta at 200 s", zeta_sum(200), -1117.0, 1.0),
        near("zeta_3600", "sum of zeta at 1 h", zeta_sum(3600), -30458.0, 3.0),
    )
