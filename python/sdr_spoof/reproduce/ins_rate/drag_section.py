"""What is reached: drags of 0.1 m/s at any time, with real carrier noise, turns and free INS."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.stats import chi2

from sdr_spoof.campaign.analysis import wilson
from sdr_spoof.reproduce.parallel import repeat
from sdr_spoof.reproduce.study import Number, Picture, Section, Table

from .drag_figure import draw_drags
from .drag_runs import BASELINE, CARRIER_M, LEVELS_PER_HOUR, MEAN, Case, Judged, Outcome, fly

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from concurrent.futures import Executor

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]
    Outcomes = dict[str, list[Outcome]]

Detector = Literal["drag", "local"]
DETECTORS: tuple[Detector, ...] = ("drag", "local")

SEED = 20_220_405
DRAGS_M_S = (0.1, 0.05, 0.02, 0.01, 0.005)
FULL = Case("", DRAGS_M_S, imus=8, onsets=8, flight=0)
QUICK = Case("", DRAGS_M_S, imus=2, onsets=16, flight=0)
HARD = replace(FULL, drags_m_s=(0.1,), between_s=60.0, across_m_s2=(3.0, 3.0))
"""A turn of 3 m/s^2 each minute."""
FLEETS = {
    "n1": (FULL, 16),
    "n2": (FULL, 16),
    "navigation": (FULL, 4),
    "tactical": (FULL, 4),
    "n1, hard turns": (HARD, 4),
    "n2, hard turns": (HARD, 4),
}
"""What is flown, and on how many flights; 64 runs a flight, clean and with each drag."""
QUICK_FLEETS = {"n1": (QUICK, 1), "n2": (QUICK, 1)}
WITHIN_S = {"n1": 3.0, "n2": 10.0}
LEAST_PD = 0.99
STATED = LEVELS_PER_HOUR.index(0.01)
LOCAL_FIRST_S = BASELINE + MEAN
"""The local test has nothing to compare with before."""


def section(effort: Effort, stages: Stages, executor: Executor | None) -> Section:
    """Detection and false alarms of ``rate_drag`` and ``rate_local``."""
    fleets = QUICK_FLEETS if effort.quick else FLEETS
    jobs = [
        (replace(base, grade=name.partition(",")[0], flight=number), SEED)
        for name, (base, count) in fleets.items()
        for number in range(count)
    ]
    with stages("Drags through the strapdown computer") as progress:
        done = iter(repeat(fly, jobs, executor, progress))
    found: Outcomes = {name: [next(done) for _ in range(n)] for name, (_, n) in fleets.items()}
    return Section(
        "To beat: drags at any time, with turns",
        text=(
            "Detector rate_drag: the filter learns the errors of the INS from the phases, so that "
            "a test at any time after the alignment, in turns too, knows what the INS may do; a "
            "likelihood ratio asks for drags of any direction. Each run: the strapdown computer "
            f"with an IMU of its own, phase noise of {1000 * CARRIER_M:g} mm a satellite, turns of "
            "1 to 3 m/s², a drag of random horizontal direction from a random second between 10 "
            "and 1740 s on. Alarms latch; the threshold is that for 0.01 false alarms an hour. "
            "Hard turns: 3 m/s² each minute.",
            "The same runs through rate_local, the mean of 10 s against a line through the minute "
            f"before, from {LOCAL_FIRST_S} s on. Its law holds the INS as it is after so long a "
            "time alone: it is as sure, and sees less.",
        ),
        tables=[
            _detection_table(found, "drag"),
            _alarm_table(found, "drag"),
            _detection_table(found, "local"),
            _alarm_table(found, "local"),
        ],
        pictures=[
            Picture(
                "drags",
                "Time to the alarm",
                draw_drags(found, DRAGS_M_S),
                "Share of drags found by rate_drag within a time after their beginning.",
            )
        ],
        numbers=[*_numbers(found)],
    )


def _judged(outcome: Outcome, detector: Detector) -> Judged:
    return outcome.drag if detector == "drag" else outcome.local


def _delays(outcomes: Sequence[Outcome], drag: int, detector: Detector = "drag") -> Floats:
    """Of the drags that begin where the detector tests."""
    first_s = 0 if detector == "drag" else LOCAL_FIRST_S
    return np.concatenate(
        [_judged(o, detector).delay_s[:, drag][o.onset_s[:, drag] >= first_s] for o in outcomes]
    )


def _turning(outcomes: Sequence[Outcome], drag: int, detector: Detector) -> NDArray[np.bool_]:
    first_s = 0 if detector == "drag" else LOCAL_FIRST_S
    return np.concatenate([o.turning[:, drag][o.onset_s[:, drag] >= first_s] for o in outcomes])


def _detection_table(found: Outcomes, detector: Detector) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for name, outcomes in found.items():
        for number, drag in enumerate(DRAGS_M_S[: outcomes[0].onset_s.shape[1]]):
            delay = _delays(outcomes, number, detector)
            turning = _turning(outcomes, number, detector)
            within = WITHIN_S.get(name.partition(",")[0], 10.0)
            hits, size = int((delay <= within).sum()), delay.size
            low, high = wilson(hits, size)
            row: list[Cell] = [name, drag, size, within, hits / size, float(low), float(high)]
            in_turns = delay[turning] <= within
            row.append(float(in_turns.mean()) if in_turns.size else None)
            row += [float((delay <= s).mean()) for s in (1.0, 3.0, 10.0, 60.0)]
            row += [_quantile(delay, q) for q in (0.5, 0.99)]
            rows.append(tuple(row))
    columns = ("INS", "drag (m/s)", "runs", "within (s)", "Pd", "low", "high", "Pd in turns")
    more = ("within 1 s", "within 3 s", "within 10 s", "within 60 s", "median (s)", "99 % (s)")
    return Table(
        "drags" if detector == "drag" else "drags_local",
        f"Drags found by rate_{detector}, and when",
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


def _alarm_table(found: Outcomes, detector: Detector) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for name, outcomes in found.items():
        seen = [_judged(o, detector) for o in outcomes]
        hours = sum(o.hours for o in seen)
        for level, stated in enumerate(LEVELS_PER_HOUR):
            count = sum(o.alarms[level] for o in seen)
            rows.append((name, stated, hours, count, *per_hour(count, hours)))
    columns = ("INS", "stated an hour", "hours", "alarms", "an hour", "low", "high")
    return Table(
        "drag_false_alarms" if detector == "drag" else "local_false_alarms",
        f"False alarms of rate_{detector} on clean flights with turns",
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
        for detector in DETECTORS:
            yield from _false_alarms(grade, [_judged(o, detector) for o in found[grade]], detector)


def _false_alarms(grade: str, seen: Sequence[Judged], detector: Detector) -> Iterator[Number]:
    label = grade if detector == "drag" else f"local_{grade}"
    hours = sum(o.hours for o in seen)
    for level, stated in enumerate(LEVELS_PER_HOUR):
        # Kept: the stated rate is not below what the count allows.
        lower = per_hour(sum(o.alarms[level] for o in seen), hours)[1]
        what = f"false alarms of rate_{detector} an hour, {grade.upper()}, stated {stated:g}"
        yield Number(
            f"alarms_{label}_{stated:g}", f"{what}: lower end at 95 %", lower, 0.0, stated, "1/h"
        )
    early, shown = sum(o.early for o in seen), sum(o.delay_s.size for o in seen)
    what = f"alarms of rate_{detector} before the drag, {grade.upper()}, of {shown} runs"
    yield Number(f"early_{label}", what, early / shown, 0.0, 0.02)
