"""The closed loop as published: capture, and lock-out after it."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.tight import TightSolution, as_published
from sdr_spoof.reproduce.study import Number, Picture, Section, Table

from . import published
from .attacks import LIST
from .figures import draw_literal
from .simulation import ATTACK_S, Case, horizontal_m, runs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

CALIBRATION_RUNS = 20
CALIBRATION_FIRST = 500
LEAST_RUNS = 5
END = round(ATTACK_S[1])
LATE = 1490
DRAGS = {0.2: "all_0.2", 0.5: "all_0.5", 1.0: "all_1", 2.0: "all_2"}


@lru_cache(maxsize=1)
def divisors(effort: Effort) -> dict[str, tuple[float, float, float, float]]:
    """Of R of position, velocity, pseudorange and rate: as printed, and self-normalised."""
    largest: list[Floats] = []
    own: list[Floats] = []
    for length, into in ((2, largest), (10, own)):
        config = as_published(11, exclusion="off", statistic_length=length)
        case = Case(config=config, runs=CALIBRATION_RUNS, first=CALIBRATION_FIRST)
        for s in runs(case, effort, detailed=True):
            into.append(_largest(s))
    # Two epochs in a row hold the largest deviation: half of its square at least.
    printed = 2.0 * np.max(largest, axis=0)
    return {"printed": _four(printed), "self-normalised": _four(np.max(own, axis=0))}


def _four(values: Floats) -> tuple[float, float, float, float]:
    a, b, c, d = (float(v) for v in values)
    return a, b, c, d


def _largest(s: TightSolution) -> Floats:
    solution = np.nanmax(s.solution_statistic[60:, :, 0], axis=0)
    channel = np.nanmax(s.channel_statistic[60:, :, :, 0], axis=(0, 1))
    return np.concatenate([solution, channel])


def section(effort: Effort, stages: Stages) -> Section:
    """Drags of all channels, with and without the published exclusion."""
    attacks = {a.name: a.attack for a in LIST}
    count = max(LEAST_RUNS, effort.runs // 10)
    rows: list[Sequence[Cell]] = []
    numbers: list[Number] = []
    drawn: dict[str, Floats] = {}
    with stages("As published") as progress:
        kinds = divisors(effort)
        for done, (speed, name) in enumerate(DRAGS.items(), 1):
            for how in ("off", "printed", "self-normalised"):
                if effort.quick and how == "self-normalised":
                    continue
                config = as_published(
                    11,
                    exclusion="off" if how == "off" else "printed",
                    divisors=kinds["printed" if how == "off" else how],
                )
                case = Case((attacks[name],), config=config, runs=count)
                made = list(runs(case, effort, detailed=True))
                error = np.array([horizontal_m(s) for s in made])
                rows.append([f"{speed:g} m/s", how, *_row(made, error)])
                drawn[f"{speed:g} {how}"] = np.median(error, axis=0)
                numbers += _numbers(speed, how, error)
            if progress:
                progress(done, len(DRAGS))
    columns = (
        "drag of all",
        "exclusion",
        "first R > 1 (s)",
        "all R > 1 ever (share of runs)",
        "error at the end (m)",
        "largest afterwards (m)",
        "at 1490 s (m)",
        "excluded afterwards (share)",
    )
    return Section(
        "The closed loop as published: capture and lock-out",
        text=(
            "The INS is corrected by what it is to judge. Slow drags take it along, so that R "
            "never exceeds 1 before the attack ends; the end itself, a jump of all channels, then "
            "looks like the attack. Channels that are left out against a displaced INS stay out: "
            "hundreds of seconds after the end the position is still wrong, and most channels "
            "excluded.",
            f"11 states, divisors from {CALIBRATION_RUNS} clean runs, {count} runs. The "
            "publication has no rule for R of position or velocity over 1 with no satellite named; "
            "all are left out then.",
        ),
        tables=[Table("literal", "Drags of all satellites from 600 to 1000 s", columns, rows)],
        pictures=[
            Picture(
                "literal",
                "Error with the published exclusion",
                draw_literal(drawn),
                "Median horizontal error; the attack is shaded.",
            )
        ],
        numbers=numbers,
    )


def _row(made: Sequence[TightSolution], error: Floats) -> list[Cell]:
    begin = round(ATTACK_S[0])
    over = np.array([s.threat[begin:] > 0 for s in made])
    first = np.where(over.any(axis=1), over.argmax(axis=1), np.inf)
    median = float(np.median(first))
    return [
        "never" if np.isinf(median) else median,
        float(np.mean([(s.threat == 2).any() for s in made])),
        float(np.median(error[:, END - 1])),
        float(np.median(error[:, END:].max(axis=1))),
        float(np.median(error[:, LATE])),
        float(np.mean([(s.usage[END:] == 3).mean() for s in made])),
    ]


def _numbers(speed: float, how: str, error: Floats) -> Sequence[Number]:
    if how == "off":
        value = float(np.median(error[:, END - 1]))
        reference = published.CAPTURED_M[speed]
        part = published.CAPTURED_TOLERANCE * reference
        what = f"error after 400 s of {speed:g} m/s without exclusion"
        low, high = reference - part, reference + part
        return [Number(f"captured_{speed:g}", what, value, low, high, "m", reference)]
    if how == "printed" and speed == 0.5:
        value = float(np.median(error[:, :END].max(axis=1)))
        late = float(np.median(error[:, LATE]))
        inf = float("inf")
        what = "largest error up to the end of 0.5 m/s, as published"
        return [
            Number("literal_captured", what, value, *published.LITERAL_M, "m", 200.0),
            Number(
                "literal_locked",
                "error at 1490 s, as published",
                late,
                published.LOCKED_M,
                inf,
                "m",
            ),
        ]
    return []
