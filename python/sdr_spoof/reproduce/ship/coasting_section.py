"""The INS alone: how far it drifts without GNSS, by grade and number of states."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from sdr_spoof.aiding.tight import as_published
from sdr_spoof.reproduce.study import Number, Section, Table

from . import published
from .simulation import ATTACK_S, Case, default_set, horizontal_m, runs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.aiding.tight import TightConfig
    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

LEAST_RUNS = 20
GRADE_B: dict[str, Any] = {
    "gyro_bias_deg_h": 1.0,
    "gyro_walk_deg_sqrt_h": 0.1,
    "accelerometer_bias_ug": 300.0,
    "accelerometer_walk_ug_sqrt_hz": 50.0,
}
"""What the filter believes of the worse INS."""


def config(grade: str, states: Literal[17, 11], **other: Any) -> TightConfig:
    """Filter of a grade with this many states and no exclusion."""
    ours = GRADE_B if grade == "B" else {}
    if states == 11:
        return as_published(11, exclusion="off", **other)
    return default_set(exclusion="off", **ours, **other)


def drift(grade: str, states: Literal[17, 11], count: int, effort: Effort) -> tuple[Floats, Floats]:
    """Errors of each run after the times of the study (R, 4), and the filter's sigma (4,)."""
    case = Case(
        grade=f"ship-{grade.lower()}",
        config=config(grade, states, outages_s=(ATTACK_S,)),
        runs=count,
    )
    at = [round(ATTACK_S[0]) + s for s in published.COASTING_S]
    errors, sigmas = [], []
    for solution in runs(case, effort):
        errors.append(horizontal_m(solution)[at])
        sigmas.append(solution.horizontal_sigma_m[at])
    return np.array(errors), np.mean(sigmas, axis=0)


def section(effort: Effort, stages: Stages) -> Section:
    """All grades."""
    count = max(LEAST_RUNS, min(effort.runs, 2 * LEAST_RUNS))
    rows: list[Sequence[Cell]] = []
    numbers: list[Number] = []
    with stages("Coasting") as progress:
        for done, (key, wanted) in enumerate(published.COASTING_M.items(), 1):
            grade, states = key
            found, sigma = drift(grade, states, count, effort)  # type: ignore[arg-type]
            median = np.median(found, axis=0)
            name = f"{grade}, {states} states"
            rows.append([name, "found, median", *(float(v) for v in median)])
            rows.append([name, "believed by the filter", *(float(v) for v in sigma)])
            rows.append([name, "study", *wanted])
            for k, (value, reference) in enumerate(zip(median, wanted, strict=True)):
                after = published.COASTING_S[k]
                numbers.append(_number(grade, states, after, float(value), reference))
            if progress:
                progress(done, len(published.COASTING_M))
    columns = ["INS", "", *(f"{s} s (m)" for s in published.COASTING_S)]
    return Section(
        "INS alone",
        text=(
            "GNSS is switched off at 600 s. Grade A is 0.1 deg/h, 50 ug, 0.01 deg/sqrt(h) and 10 "
            "ug/sqrt(Hz), grade B 1 deg/h, 300 ug, 0.1 deg/sqrt(h) and 50 ug/sqrt(Hz); biases have "
            "these sizes and random signs. Biases as states (17) halve the drift against 11. The "
            f"distance from the truth is horizontal; {count} runs.",
        ),
        tables=[Table("coasting", "Horizontal error without GNSS", columns, rows)],
        numbers=numbers,
    )


def _number(grade: str, states: int, after: int, value: float, reference: float) -> Number:
    part = published.COASTING_TOLERANCE
    return Number(
        f"coasting_{grade.lower()}{states}_{after}",
        f"error after {after} s alone, grade {grade}, {states} states",
        value,
        (1 - part) * reference,
        (1 + part) * reference,
        "m",
        reference,
    )
