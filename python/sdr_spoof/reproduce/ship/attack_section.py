"""The list of attacks with the default set: delays, errors, what is left out, what comes after."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.reproduce.study import Number, Picture, Section, Table

from . import published
from .attack_runs import Outcome, outcome
from .attacks import LIST
from .figures import draw_delays, draw_errors
from .simulation import default_set

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

CARRIER_M = 0.002
PHASE_CASES = (
    "all_0.2",
    "all_0.02_s2",
    "all_0.005_s2",
    "all_0.002_s2",
    "all_0.001_s2",
    "three_0.005_s2",
)


def section(effort: Effort, stages: Stages) -> Section:
    """All attacks with the default configuration."""
    chosen = [a for a in LIST if a.quick or not effort.quick]
    found = []
    with stages("Attacks") as progress:
        for done, named in enumerate(chosen, 1):
            found.append(outcome(named, effort))
            if progress:
                progress(done, len(chosen))
    return Section(
        "Attacks and the default exclusion",
        text=(
            "Every attack is on the air from 600 to 1000 s. On an alarm the navigator goes back to "
            "a trusted copy and coasts; satellites are used again as the state machine of the "
            "guard says. The largest error during an attack on all satellites is that of the INS "
            "alone from the copy on; three satellites are left out by name.",
            f"Grade A, 17 states, {effort.runs} runs each. 'Held' is the share of the runs in "
            "which the alarm was not taken for a false one before the attack ended.",
        ),
        tables=[_table(found)],
        pictures=[
            Picture(
                "attack_errors",
                "Error with exclusion",
                draw_errors(found),
                "Median horizontal error; the attack is shaded.",
            ),
            Picture(
                "attack_delays",
                "Delay of the alarm",
                draw_delays(found),
                f"{effort.runs} runs an attack, those found.",
            ),
        ],
        numbers=[n for o in found for n in _numbers(o)],
    )


def floor_section(effort: Effort, stages: Stages) -> Section:
    """What cannot be decided, and what carrier phase adds."""
    cases = [a for a in LIST if a.name in PHASE_CASES]
    config = default_set(carrier_noise_m=CARRIER_M)
    rows: list[Sequence[Cell]] = []
    with stages("Floor and carrier phase") as progress:
        for done, named in enumerate(cases, 1):
            plain = outcome(named, effort)
            phase = outcome(named, effort, config)
            rows.append([named.title, *_brief(plain), *_brief(phase)])
            if named.name == "all_0.001_s2":
                said = plain.said
            if progress:
                progress(done, len(cases))
    columns = ["attack"]
    for how in ("rates", "with carrier phase"):
        columns += [f"found, {how}", f"delay (s), {how}", f"largest error (m), {how}"]
    return Section(
        "The floor, and what carrier phase adds",
        text=(
            "A drag of all satellites of 0.001 to 0.002 m/s² is as large as what the INS may do by "
            "itself: it is found in a part of the runs only. Captured so, the navigator has no "
            "trusted copy left that is older than the attack; the end of the attack, a jump back "
            "to the truth, looks exactly like an onset. No automatic rule is right for both. What "
            f"the operator is told then: “{said}.”",
            "Changes of carrier phase (2 mm) instead of rates alone (5 cm/s) tell the INS its "
            "velocity within mm/s; the floor falls and the INS coasts better.",
        ),
        tables=[Table("floor", "With rates, and with carrier phase besides", columns, rows)],
        numbers=_floor_numbers(rows),
    )


def _brief(o: Outcome) -> list[Cell]:
    delay: Cell = None if np.isinf(o.median_s) else o.median_s
    return [o.found, delay, float(np.median(o.largest_m))]


def _floor_numbers(rows: Sequence[Sequence[Cell]]) -> Sequence[Number]:
    titles = {a.name: a.title for a in LIST}
    numbers = []
    for name, reference in published.FLOOR.items():
        row = next(r for r in rows if r[0] == titles[name])
        share = float(row[1] or 0.0)
        # Not fewer than the study found, within two standard errors of 20 runs.
        what = f"share found, {titles[name]}"
        numbers.append(Number(f"found_{name}", what, share, reference - 0.1, 1.0, "", reference))
    return numbers


def _table(found: Sequence[Outcome]) -> Table:
    rows: list[Sequence[Cell]] = [
        [
            o.named.title,
            o.found,
            float(np.mean(o.held)),
            None if np.isinf(o.median_s) else o.median_s,
            published.ROBUST_S.get(o.named.name),
            float(np.median(o.largest_m)),
            float(o.largest_m.max()),
            float(np.median(o.after_m)),
            float(o.after_m[o.held].max()) if o.held.any() else None,
            o.named_right if "three" in o.named.name else None,
            o.early,
        ]
        for o in found
    ]
    columns = (
        "attack",
        "found",
        "held",
        "delay, median (s)",
        "study (s)",
        "largest error, median (m)",
        "largest error, worst (m)",
        "error 120 s after, median (m)",
        "error 120 s after, worst of held (m)",
        "three named right",
        "alarms before",
    )
    return Table("attacks", "Default set, attack from 600 to 1000 s", columns, rows)


def _numbers(o: Outcome) -> Sequence[Number]:
    name, title = o.named.name, o.named.title
    numbers = []
    if name in published.ROBUST_S:
        limit = published.ROBUST_S[name]
        numbers.append(
            Number(f"delay_{name}", f"delay, {title}", o.median_s, 0.0, limit, "s", limit)
        )
    if not o.named.floor:
        numbers.append(Number(f"found_{name}", f"share found, {title}", o.found, 1.0, 1.0, "", 1.0))
    if o.held.any() and not o.named.floor:
        worst = float(o.after_m[o.held].max())
        what = f"error 120 s after the end, worst run, {title}"
        numbers.append(Number(f"after_{name}", what, worst, 0.0, published.BACK_M, "m"))
    return numbers
