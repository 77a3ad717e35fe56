"""What is reached: drags of 0.1 m/s at any time, with real carrier noise, turns and free INS."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2

from sdr_spoof.campaign.analysis import wilson
from sdr_spoof.reproduce.parallel import repeat
from sdr_spoof.reproduce.study import Number, Picture, Section, Table

from .drag_figure import draw_drags
from .drag_runs import CARRIER_M, LEVELS_PER_HOUR, Case, Outcome, fly

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from concurrent.futures import Executor

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]
    Outcomes = dict[str, list[Outcome]]

SEED = 20_220_405
DRAGS_M_S = (0.1, 0.05, 0.02, 0.01, 0.005)
FULL = Case("", DRAGS_M_S, imus=8, onsets=8, flight=0)
QUICK = Case("", DRAGS_M_S, imus=2, onsets=16, flight=0)
GRADES = {"n1": 16, "n2": 16, "navigation": 4, "tactical": 4}
"""Flights each; 64 runs a flight, clean and with each drag."""
QUICK_GRADES = {"n1": 1, "n2": 1}
WITHIN_S = {"n1": 3.0, "n2": 10.0}
LEAST_PD = 0.99
STATED = LEVELS_PER_HOUR.index(0.01)


def section(effort: Effort, stages: Stages, executor: Executor | None) -> Section:
    """Detection and false alarms of ``rate_drag`` through the strapdown computer."""
    base, grades = (QUICK, QUICK_GRADES) if effort.quick else (FULL, GRADES)
    jobs = [
        (replace(base, grade=grade, flight=number), SEED)
        for grade, count in grades.items()
        for number in range(count)
    ]
    with stages("Drags through the strapdown computer") as progress:
        done = repeat(fly, jobs, executor, progress)
    found: Outcomes = {grade: [] for grade in grades}
    for (case, _), outcome in zip(jobs, done, strict=True):
        found[case.grade].append(outcome)
    return Section(
        "To beat: drags at any time, with turns",
        text=(
            "Detector rate_drag: the filter learns the errors of the INS from the phases, so that "
            "a test at any time after the alignment, in turns too, knows what the INS may do; a "
            "likelihood ratio asks for drags of any direction. Each run: the strapdown computer "
            f"with an IMU of its own, phase noise of {1000 * CARRIER_M:g} mm a satellite, turns of "
            "1 to 3 m/s², a drag of random horizontal direction from a random second between 10 "
            "and 1740 s on. Alarms latch; the threshold is that for 0.01 false alarms an hour.",
        ),
        tables=[_detection_table(found), _alarm_table(found)],
        pictures=[
            Picture(
                "drags",
                "Time to the alarm",
                draw_drags(found, DRAGS_M_S),
                "Share of drags found within a time after their beginning.",
            )
        ],
        numbers=[*_numbers(found)],
    )


def _delays(outcomes: Sequence[Outcome], drag: int) -> Floats:
    return np.concatenate([o.delay_s[:, drag].ravel() for o in outcomes])


def _turning(outcomes: Sequence[Outcome], drag: int) -> NDArray[np.bool_]:
    return np.concatenate([o.turning[:, drag].ravel() for o in outcomes])


def _detection_table(found: Outcomes) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for grade, outcomes in found.items():
        for number, drag in enumerate(DRAGS_M_S):
            delay, turning = _delays(outcomes, number), _turning(outcomes, number)
            within = WITHIN_S.get(grade, 10.0)
            hits, size = int((delay <= within).sum()), delay.size
            low, high = wilson(hits, size)
            row: list[Cell] = [grade, drag, size, within, hits / size, float(low), float(high)]
            in_turns = delay[turning] <= within
            row.append(float(in_turns.mean()) if in_turns.size else None)
            row += [float((delay <= s).mean()) for s in (1.0, 3.0, 10.0, 60.0)]
            row += [_quantile(delay, q) for q in (0.5, 0.99)]
            rows.append(tuple(row))
    columns = ("INS", "drag (m/s)", "runs", "within (s)", "Pd", "low", "high", "Pd in turns")
    more = ("within 1 s", "within 3 s", "within 10 s", "within 60 s", "median (s)", "99 % (s)")
    return Table(
        "drags",
        "Drags found, and when",
        (*columns, *more),
        rows,
        "Pd within the time of the fourth column, with its 95 % Wilson interval; of drags that "
        "begin in a turn by themselves.",
    )


def _quantile(delay: Floats, q: float) -> float | None:
    value = float(np.quantile(delay, q, method="higher"))
    return value if np.isfinite(value) else None


def per_hour(count: int, hours: float) -> tuple[float, float, float]:
    """Rate of alarms and its exact 95 % Poisson interval."""
    low = chi2.ppf(0.025, 2 * count) / 2 / hours if count else 0.0
    return count / hours, float(low), float(chi2.ppf(0.975, 2 * count + 2) / 2 / hours)


def _alarm_table(found: Outcomes) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for grade, outcomes in found.items():
        hours = sum(o.hours for o in outcomes)
        for level, stated in enumerate(LEVELS_PER_HOUR):
            count = sum(o.alarms[level] for o in outcomes)
            rows.append((grade, stated, hours, count, *per_hour(count, hours)))
    columns = ("INS", "stated an hour", "hours", "alarms", "an hour", "low", "high")
    return Table(
        "drag_false_alarms",
        "False alarms of rate_drag on clean flights with turns",
        columns,
        rows,
        "Exact 95 % Poisson intervals; alarms within 20 s of another one are counted once.",
    )


def _numbers(found: Outcomes) -> Iterator[Number]:
    for grade, within in WITHIN_S.items():
        delay = _delays(found[grade], 0)
        hits = int((delay <= within).sum())
        low = float(wilson(hits, delay.size)[0])
        what = f"Pd of 0.1 m/s within {within:g} s, {grade.upper()}, {delay.size} drags"
        yield Number(f"pd_{grade}", what, hits / delay.size, LEAST_PD, 1.0)
        if delay.size >= 1000:
            yield Number(f"pd_{grade}_low", f"{what}, lower end at 95 %", low, LEAST_PD, 1.0)
        hours = sum(o.hours for o in found[grade])
        for level, stated in enumerate(LEVELS_PER_HOUR):
            count = sum(o.alarms[level] for o in found[grade])
            # Kept: the stated rate is not below what the count allows.
            lower = per_hour(count, hours)[1]
            what = f"false alarms an hour, {grade.upper()}, stated {stated:g}: lower end at 95 %"
            yield Number(f"alarms_{grade}_{stated:g}", what, lower, 0.0, stated, "1/h")
        early = sum(o.early for o in found[grade])
        shown = sum(o.delay_s.size for o in found[grade])
        what = f"alarms before the drag, {grade.upper()}, of {shown} runs"
        yield Number(f"early_{grade}", what, early / shown, 0.0, 0.02)
