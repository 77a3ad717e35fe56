"""Without an attack: accuracy, consistency, false alarms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtri

from sdr_spoof.aiding.tight import TESTS, TightConfig, TightSolution, as_published
from sdr_spoof.reproduce.study import Number, Section, Table, near

from . import published
from .simulation import Case, errors_ned_m, horizontal_m, runs, velocity_errors_ned_m_s

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

FIRST = 2000
"""Numbers of these runs; thresholds come from runs 1000 to 1199, but were set finely on these."""
SETTLED = 60
WHITE_RUNS = 10
LOCKED_S = 320.0
"""A false alarm must be over after so long: it lapses after 300 s."""
ENOUGH = 300
"""Runs that a share of false alarms is judged by."""
NEES_RUNS = 100
NEES_AT = (60, 120, 300, 600, 900, 1200, 1499)


@dataclass
class Tally:
    """What is kept of each run."""

    nees: list[Floats]
    """Of position and velocity (2, E)."""
    largest: list[Floats]
    """Of each test."""
    squares: list[float]
    alarms: int = 0
    locked: int = 0
    worst_m: float = 0.0


def nees(errors: Floats, covariance: Floats) -> Floats:
    """Errors weighed with their covariance (E,)."""
    weighed = np.linalg.solve(covariance, errors[..., None])[..., 0]
    return np.asarray((errors * weighed).sum(axis=-1))


def tally(effort: Effort, count: int) -> Tally:
    """The default set on clean runs."""
    found = Tally([], [], [])
    for s in runs(Case(runs=count, first=FIRST), effort):
        _add(found, s)
    return found


def _add(found: Tally, s: TightSolution) -> None:
    distance = horizontal_m(s)[SETTLED:]
    found.squares.append(float((distance**2).mean()))
    found.worst_m = max(found.worst_m, float(distance.max()))
    found.alarms += any(e.test for e in s.events)
    last = max((e.time_s for e in s.events if e.test), default=float("inf"))
    found.locked += s.state[-1] != 1 and s.time_s[-1] - last > LOCKED_S
    found.largest.append(s.deviates[SETTLED:].max(axis=0))
    if len(found.nees) < NEES_RUNS:
        position = nees(errors_ned_m(s), s.covariance[:, 0])
        velocity = nees(velocity_errors_ned_m_s(s), s.covariance[:, 1])
        found.nees.append(np.stack([position, velocity]))


def white(effort: Effort) -> tuple[float, float]:
    """Horizontal RMS, and NIS over its number, of the filter that takes code noise for white."""
    config = as_published(17, exclusion="off")
    squares, innovations = [], []
    case = Case(config=config, runs=max(WHITE_RUNS, effort.runs // 5), first=FIRST)
    for s in runs(case, effort, detailed=True):
        squares.append((horizontal_m(s)[SETTLED:] ** 2).mean())
        range_part = (s.range_innovation_m / s.range_sigma_m) ** 2
        rate_part = (s.rate_innovation_m_s / s.rate_sigma_m_s) ** 2
        innovations.append(np.concatenate([range_part, rate_part], axis=1)[SETTLED:].mean())
    return float(np.sqrt(np.mean(squares))), float(np.mean(innovations))


def section(effort: Effort, stages: Stages) -> Section:
    """Clean runs."""
    count = published.CLEAN_RUNS * effort.runs
    with stages("Clean runs"):
        found = tally(effort, count)
        rms_m, nis = white(effort)
    mean = np.mean(found.nees, axis=0)
    return Section(
        "Without an attack",
        text=(
            f"{count} voyages of 1500 s. The filter of the study takes code noise (1 m white, 1.5 "
            "m Gauss-Markov with 200 s) for white of 3 m, and its sums of innovations over 10 s or "
            "more are useless. The default has a Gauss-Markov state for each satellite: its "
            "innovations are white over all windows up to 100 s, so that thresholds are those of a "
            "normal deviate, and its covariance is that of its errors.",
            f"The default set alarms in {found.alarms} of {count} runs; {found.locked} of them "
            f"have not got back to all satellites {LOCKED_S:g} s later; the largest error is "
            f"{found.worst_m:.1f} m.",
        ),
        tables=[_nees_table(mean, len(found.nees)), _threshold_table(found)],
        numbers=[
            near("clean_rms", "horizontal RMS, white noise of 3 m", rms_m, *published.CLEAN_M, "m"),
            Number("clean_nis", "NIS/20, white noise of 3 m", nis, *published.NIS, "", 0.40),
            *_nees_numbers(mean, len(found.nees)),
            *_alarm_number(found, count),
            Number("locked_out", "clean runs locked out", float(found.locked), 0.0, 0.0),
        ],
    )


def _alarm_number(found: Tally, count: int) -> Sequence[Number]:
    """Only of enough runs: one alarm in thirty says nothing of two in a hundred."""
    if count < ENOUGH:
        return []
    what = f"share of {count} clean runs with an alarm"
    share = found.alarms / count
    return [Number("false_alarms", what, share, 0.0, published.FALSE_ALARMS, "", 0.04)]


def band(count: int) -> tuple[float, float]:
    """95 % of means of so many squares with 3 degrees of freedom."""
    freedom = 3.0 * count
    return float(chdtri(freedom, 0.975)) / count, float(chdtri(freedom, 0.025)) / count


def _nees_table(mean: Floats, count: int) -> Table:
    low, high = band(count)
    rows: list[Sequence[Cell]] = [
        [t, float(mean[0, t]), float(mean[1, t]), low, high] for t in NEES_AT
    ]
    columns = ("time (s)", "position", "velocity", "low", "high")
    title = f"NEES with 3 degrees of freedom, mean of {count} runs, and its 95 % band"
    return Table("nees", title, columns, rows)


def _nees_numbers(mean: Floats, count: int) -> Sequence[Number]:
    low, high = band(count)
    return [
        Number(
            f"nees_{kind}",
            f"NEES of {kind}, mean of {count} runs and all epochs",
            float(values[SETTLED:].mean()),
            low,
            high,
            "",
            3.0,
        )
        for kind, values in zip(("position", "velocity"), mean, strict=True)
    ]


def _threshold_table(found: Tally) -> Table:
    config = TightConfig()
    of = {
        "rates": config.threshold_rate,
        "phase": config.threshold_change,
        "codes": config.threshold_code,
        "separation": config.threshold_separation,
        "clock": config.threshold_clock,
        "power": config.threshold_power_db,
    }
    largest = np.array(found.largest)
    rows: list[Sequence[Cell]] = [
        [
            name,
            *(float(v) for v in np.quantile(values, [0.5, 0.99, 1.0])),
            of[name.split()[0].rstrip(",")],
        ]
        for name, values in zip(TESTS, largest.T, strict=True)
        if values.any()
    ]
    columns = ("test", "median", "99 %", "largest", "threshold")
    return Table("deviates", "Largest deviate of each test in a clean run", columns, rows)
