"""Which satellite: leaks of the fitted value, the parity vector, exclusion and the position."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import decision
from sdr_spoof.aiding.dme.feedback import Feedback
from sdr_spoof.aiding.dme.isolation import isolate
from sdr_spoof.aiding.dme.statistics import STATISTICS
from sdr_spoof.decision.calibration import threshold_for
from sdr_spoof.reproduce.study import Number, Section, Table

from . import published, trials

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

LEAKS = {10.0: 0.23, 15.0: 0.97, 25.0: 1.0}
"""Probability that a healthy satellite is flagged, of the independent study."""
CAPTURED = Feedback("loose", 10.0, noisy=False)
CAPTURED_M = 25.0
WINDOW = 30
CASES = ((1, 10.0), (1, 25.0), (2, 25.0), (3, 25.0), (5, 25.0))
"""Spoofed satellites and size."""


def section(effort: Effort, stages: Stages) -> Section:
    """Leak, capture, isolation."""
    stages("isolation")
    leaks = {size: _leak(size, effort) for size in LEAKS}
    captured = _captured(effort)
    isolated = [_isolated(count, size, effort) for count, size in CASES]
    return Section(
        "Which satellite",
        text=(
            "The fitted value of equation 13 cannot name a satellite: least squares explains one "
            "spoofed satellite by an error of position, and with it moves the fitted values of "
            "healthy ones, which are then flagged too.",
            "With an INS that is not captured, the differences themselves name the satellites: "
            "the smallest set without which the means of the last 30 s agree with the INS and one "
            "clock. Five satellites alike are a clock, and none is excluded: the position is "
            "right. Three of five alike outvote the other two: to the measurements they are the "
            "healthy ones, with another clock, and the two healthy ones are excluded. Only a "
            "known clock could tell.",
        ),
        tables=[
            Table(
                "leak",
                "Healthy satellites flagged by the fitted value within 30 s, noise 3.4 m",
                ("spoofed by (m)", "any healthy one flagged", "reference"),
                [(s, v, LEAKS[s]) for s, v in leaks.items()],
            ),
            Table(
                "captured",
                f"{CAPTURED_M:g} m on the third satellite, captured INS (10 s), noise 10 m",
                ("test", "share found within 30 s"),
                list(captured.items()),
            ),
            Table(
                "isolation",
                "Exclusion 30 s after the onset, noise 3.4 m, INS not captured",
                (
                    "spoofed",
                    "size (m)",
                    "excluded exactly those",
                    "horizontal error before (m)",
                    "after (m)",
                ),
                isolated,
                "Medians of the error of the fix; none is given where fewer than four satellites "
                "are left: then the INS is what is left.",
            ),
        ],
        numbers=_numbers(leaks, captured, isolated, effort),
    )


def _leak(size_m: float, effort: Effort) -> float:
    rule = decision.find("improved-sprt")
    case = trials.steps(published.SIGMA_FIGURE5_M, size_m, 1)
    y = case.run(effort.runs, trials.random_of(11, size_m)).differences_m
    z = trials.channels(STATISTICS["fitted"], y, case.geometry)
    healthy = np.delete(z, published.ORDER[0], axis=1)
    return trials.delays_of(rule.run(healthy), published.THRESHOLD, published.ONSET_S).within()


def _captured(effort: Effort) -> dict[str, float]:
    case = trials.steps(published.SIGMA_FIGURE6_M, CAPTURED_M, 1, CAPTURED)
    y = case.run(effort.runs, trials.random_of(12)).differences_m
    gnss = case.geometry.without_stations()
    parity = trials.channels(STATISTICS["parity"], y[..., : gnss.satellites], gnss)
    fitted = trials.channels(STATISTICS["fitted"], y, case.geometry)
    own = fitted[:, published.ORDER[0]]
    found = {}
    for name, z, rule_name, threshold in (
        ("likelihood ratio on parity", parity, "glr-windows", None),
        ("improved on Delta, that satellite", own, "improved-sprt", published.THRESHOLD),
        ("improved on Delta, any satellite", fitted, "improved-sprt", published.THRESHOLD),
    ):
        rule = decision.find(rule_name)
        at = threshold_for(rule, published.PER_HOUR) if threshold is None else threshold
        found[name] = trials.delays_of(rule.run(z), at, published.ONSET_S).within()
    return found


def _isolated(count: int, size_m: float, effort: Effort) -> Sequence[Cell]:
    case = trials.steps(published.SIGMA_FIGURE5_M, size_m, count)
    runs = min(effort.runs, 500)
    y = case.run(runs, trials.random_of(13, count, size_m)).differences_m
    means = y[:, -WINDOW:].mean(axis=1)
    wanted = tuple(sorted(published.ORDER[:count])) if count < 5 else ()
    found = [isolate(m, case.geometry, WINDOW) for m in means]
    right = float(np.mean([f.satellites == wanted for f in found]))
    before, after = (
        [float(np.linalg.norm(p[:2])) for p in fixes if p is not None]
        for fixes in ([f.before_m for f in found], [f.after_m for f in found])
    )
    errors = (float(np.median(e)) if e else None for e in (before, after))
    return (count, size_m, right, *errors)


def _numbers(
    leaks: dict[float, float],
    captured: dict[str, float],
    isolated: Sequence[Sequence[Cell]],
    effort: Effort,
) -> Sequence[Number]:
    error = trials.ERRORS / effort.runs**0.5
    slack = error / 2.0 if effort.quick else 0.0
    found = list(captured.values())
    by_case = {(row[0], row[1]): float(row[2] or 0.0) for row in isolated}
    return (
        *(
            trials.share_number(
                f"leak_{size:g}",
                f"healthy satellite flagged, {size:g} m",
                leaks[size],
                effort.runs,
                wanted,
                0.01,
            )
            for size, wanted in LEAKS.items()
        ),
        trials.share_number(
            "captured_parity", "captured INS: found on parity", found[0], effort.runs, 0.97, 0.01
        ),
        Number(
            "captured_delta", "captured INS: found on Delta", found[1], 0.0, 0.11 + slack, "", 0.11
        ),
        Number(
            "isolated_one", "25 m on one: excluded exactly", by_case[1, 25.0], 0.98 - slack, 1.0
        ),
        Number(
            "isolated_two", "25 m on two: excluded exactly", by_case[2, 25.0], 0.98 - slack, 1.0
        ),
        Number("isolated_clock", "all alike: none excluded", by_case[5, 25.0], 0.98 - slack, 1.0),
    )
