"""Every rule at equal false alarms on the same flights: which of them the INS breaks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import t

from sdr_spoof.reproduce.parallel import repeat
from sdr_spoof.reproduce.study import Number, Section, Table

from . import published
from .drag_runs import CARRIER_M, LAST_S, Case
from .rule_runs import (
    EPOCH,
    FIRST_S,
    LINE,
    PATIENCE_S,
    RATE,
    STATED,
    WINDOW_S,
    Rule,
    delay_s,
    judge,
    rules,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from concurrent.futures import Executor

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    from .rule_runs import Judged

    Floats = NDArray[np.float64]
    Interval = tuple[float, float, float]

SEED = 20_220_406
FULL = Case("", (published.DRAG_M_S,), imus=4, onsets=8, flight=0, first_s=FIRST_S)
QUICK = replace(FULL, onsets=4)
FLIGHTS, QUICK_FLIGHTS = 16, 1


@dataclass(frozen=True)
class Compared:
    """One rule with one grade of INS."""

    grade: str
    rule: Rule
    stated: float
    """Threshold by its own law."""
    by_law: Interval
    """Share of clean windows beyond it, and its interval."""
    fitted: float
    """Threshold that the stated share of clean windows exceeds, mean of both halves."""
    achieved: Interval
    """Share of clean windows beyond that of the other half of the INS."""
    delay_s: Floats
    """At that threshold, (K, R)."""

    @property
    def broken(self) -> bool:
        """Whether its law does not hold for this INS."""
        return self.by_law[1] > STATED

    def within(self, seconds: float) -> float:
        """Share of the drags that are found so soon."""
        return float((self.delay_s <= seconds).mean())

    def median_s(self) -> float | None:
        """Delay of half of them, None where fewer are found."""
        value = float(np.median(self.delay_s))
        return value if np.isfinite(value) else None


def section(effort: Effort, stages: Stages, executor: Executor | None) -> Section:
    """All rules on the flights of N1 and of N2."""
    base, flights = (QUICK, QUICK_FLIGHTS) if effort.quick else (FULL, FLIGHTS)
    jobs = [
        (replace(base, grade=grade, flight=number), SEED)
        for grade in published.GRADES
        for number in range(flights)
    ]
    with stages("Rules at equal false alarms") as progress:
        done = repeat(judge, jobs, executor, progress)
    found = [
        compared(grade, rule, [flight[number] for flight in done[k * flights :][:flights]])
        for k, grade in enumerate(published.GRADES)
        for number, rule in enumerate(rules())
    ]
    return Section(
        "Every rule at equal false alarms",
        text=(*_words(found, base), _loss(found)),
        tables=[_table(found, base, flights)],
        numbers=[*_numbers(found)],
    )


def compared(grade: str, rule: Rule, flights: Sequence[Judged]) -> Compared:
    """One rule on all flights of a grade."""
    clean = np.concatenate([f.clean for f in flights])
    after = np.concatenate([f.after for f in flights])
    stated = rule.stated
    if stated is None:
        stated = float(np.quantile(np.concatenate([f.noise for f in flights]), 1.0 - STATED))
    half = np.arange(len(clean)) % 2
    # Each half of the INS is judged with what the other one has fitted.
    limits = np.array([np.quantile(clean[half != k], 1.0 - STATED) for k in (0, 1)])
    own = limits[half]
    return Compared(
        grade,
        rule,
        stated,
        _share(clean > stated),
        float(limits.mean()),
        _share(clean > own[:, None]),
        delay_s(after, own),
    )


def _share(beyond: NDArray[np.bool_]) -> Interval:
    """Of windows (K, W), and its 95 % interval: the K INS are the independent draws."""
    each = beyond.mean(axis=1)
    error = float(each.std(ddof=1) / np.sqrt(each.size) * t.isf(0.025, each.size - 1))
    mean = float(each.mean())
    return mean, max(mean - error, 0.0), min(mean + error, 1.0)


def _words(found: Sequence[Compared], base: Case) -> tuple[str, ...]:
    broken = [_named(c) for c in found if c.broken]
    kept = [_named(c) for c in found if not c.broken]
    return (
        f"A drag of {published.DRAG_M_S:g} m/s, {1000 * CARRIER_M:g} mm of phase noise, the "
        "strapdown computer and turns as below; directions are random, onsets between "
        f"{FIRST_S} and {LAST_S} s, when the last alignment is as old as that. Each threshold is "
        f"set twice: by the rule's own law (noise alone, or noise and INS) for {100 * STATED:g} % "
        f"of all windows of {WINDOW_S} s, and so that {100 * STATED:g} % of the windows of clean "
        "flights exceed it, which no user can do: that makes false alarms equal, and is "
        "fitted on one half of the INS and used on the other.",
        "Broken by the drift (clean windows beyond the threshold of their law, where the lower "
        f"end of the interval lies above {100 * STATED:g} %): {'; '.join(broken)}.",
        f"Not broken: {'; '.join(kept)}.",
    )


def _named(one: Compared) -> str:
    share = 100 * one.by_law[0]
    return f"{one.rule.name} on {one.rule.on}, {one.grade.upper()} ({share:.3g} %)"


def _loss(found: Sequence[Compared]) -> str:
    def soon(name: str, on: str) -> str:
        both = [_one(found, grade, name, on).within(10.0) for grade in published.GRADES]
        return " and ".join(f"{100 * share:.0f} %" for share in both)

    return (
        "Share of the drags found within 10 s at equal false alarms, N1 and N2: threshold trained "
        f"on the first {published.TRAINED_S:g} s {soon('trained-threshold', EPOCH)}, cusum "
        f"{soon('cusum', EPOCH)}, glr-windows {soon('glr-windows', EPOCH)}. What was learned from "
        "the first minutes does not hold for the next ones, and who adds evidence up adds the "
        "drift up. With a line through the minute before taken off the three find "
        f"{soon('trained-threshold', LINE)}, {soon('cusum', LINE)} and "
        f"{soon('glr-windows', LINE)}. With the covariance of the INS in its law one sample holds, "
        f"and finds {soon('one sample', RATE)}: minutes after alignment the INS may do all of it. "
        f"The local mean with that covariance finds {soon('local mean', 'rate_local')}, the filter "
        f"that learns the errors of the INS {soon('likelihood ratio', 'rate_drag')}."
    )


def _one(found: Sequence[Compared], grade: str, name: str, on: str) -> Compared:
    return next(c for c in found if (c.grade, c.rule.name, c.rule.on) == (grade, name, on))


def _table(found: Sequence[Compared], base: Case, flights: int) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for one in found:
        rows.append(
            (
                one.grade,
                one.rule.name,
                one.rule.on,
                one.rule.law,
                one.stated,
                *(100 * v for v in one.by_law),
                one.fitted,
                *(100 * v for v in one.achieved),
                one.within(3.0),
                one.within(10.0),
                one.median_s(),
            )
        )
    columns = ("INS", "rule", "on", "law", "threshold by law")
    law = ("clean windows beyond it (%)", "low, law", "high, law")
    equal = ("threshold for 1 %", "achieved (%)", "low", "high")
    drags = ("found within 3 s", "found within 10 s", "median delay (s)")
    return Table(
        "rules",
        f"Rules at {100 * STATED:g} % of clean windows of {WINDOW_S} s, drag of "
        f"{published.DRAG_M_S:g} m/s",
        (*columns, *law, *equal, *drags),
        rows,
        f"{flights * base.imus} INS of each grade on {flights} flights, {base.onsets} runs each. "
        "95 % intervals of Student's t over the INS, since windows of one go together. A drag "
        f"counts as found if no alarm stood at its onset and one came within {PATIENCE_S} s. No "
        "median: fewer than half.",
    )


def _numbers(found: Sequence[Compared]) -> Iterator[Number]:
    for grade in published.GRADES:
        which = grade.upper()
        for name in ("trained-threshold", "t-test", "cusum", "glr-windows"):
            share = 100 * _one(found, grade, name, EPOCH).by_law[0]
            what = f"clean windows beyond the threshold of noise alone, {name}, {which}"
            yield Number(f"rule_broken_{name}_{grade}", what, share, 90.0, 100.0, "%")
        drag = _one(found, grade, "likelihood ratio", "rate_drag")
        what = f"drags that rate_drag finds within 3 s at equal false alarms, {which}"
        yield Number(f"rule_drag_pd_{grade}", what, drag.within(3.0), 0.99, 1.0)
        what = f"clean windows beyond rate_drag's own threshold, {which}: lower end at 95 %"
        yield Number(f"rule_drag_alarms_{grade}", what, 100 * drag.by_law[1], 0.0, 1.0, "%")
