"""Correlator level against IF level: the distributions of what the detectors say.

One scenario, two satellites on B1I and the B1C pilot, is run many times at both levels
(:mod:`sdr_spoof.campaign.levels`), clean and with the pilot captured: dragged with its carrier, and
frequency-locked. Both satellites are attacked, so that a run gives two independent tracks. Of each
series of each configured detector the deviate (value over its standard deviation under H0) is
compared, and the time to its alarm: :mod:`.levels_compare`. Runs at correlator level cost next to
nothing; there are ``MORE`` times as many, so that the error is that of the IF level.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from sdr_spoof.campaign.levels import LEVELS
from sdr_spoof.campaign.points import Point
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.scenario import Scenario
from sdr_spoof.tracking import TrackingConfig

from . import tracking
from .levels_compare import Comparison, Observed, compare, observe, summary

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from sdr_spoof.progress import Progress

CN0_DBHZ = (30.0, 38.0, 45.0)
PRNS = (19, 27)
RATE_HZ = 20.03e6
"""No simple ratio to a chip rate: a code's edges fall everywhere between samples."""
DURATION_S = 32.0
ON_AIR_S, DRAG_S = 10.0, 12.0
MORE = 5
ATTACKS: dict[str, dict[str, Any]] = {
    "clean": {},
    "coherent": {"eta": 1.5, "drag_rate_m_s": -0.1903},
    "frequency-locked": {"eta": 2.0, "drag_rate_m_s": 2.0, "carrier": "frequency-locked"},
}
"""By name. The coherent drag turns the pilot's carrier by 1 Hz."""


def scenario(attack: str, cn0_dbhz: float, duration_s: float = DURATION_S) -> Scenario:
    """Two satellites, each signal at the given C/N0, and one of :data:`ATTACKS` on the pilots."""
    plan = tracking.scenario(cn0_dbhz, duration_s, prns=PRNS, sample_rate_hz=RATE_HZ)
    if not ATTACKS[attack]:
        return plan
    shared = {
        "prns": PRNS,
        "signals": ["B1CP"],
        "start_s": ON_AIR_S,
        "power_ramp_s": 1.0,
        "drag_start_s": DRAG_S,
        "carrier_phase_cycles": "aligned",
    }
    return Scenario.model_validate(plan.model_dump() | {"attack": [shared | ATTACKS[attack]]})


def tracks(
    plan: Scenario,
    level: str,
    runs: int,
    config: DetectionConfig | None = None,
    from_s: float = 0.0,
) -> Iterator[list[Observed]]:
    """What the detectors say in each run at a level (``if``, ``correlator``), from a time on.

    Seeds of the levels differ: nothing is compared run by run.
    """
    config = config or DetectionConfig()
    point = Point(0, (), "", level, plan, TrackingConfig(), config)
    for run in range(runs):
        yield observe(
            LEVELS[level](point, 1000 * (1 + list(LEVELS).index(level)) + run), config, from_s
        )


def run(output: Path, *, runs: int = 16, progress: Progress | None = None) -> dict[str, Any]:
    """Compare every case; write levels.{json,csv,png}.

    Args:
        output: folder to write to.
        runs: at IF level, for each attack and C/N0; two satellites of 32 s each.
        progress: called with (done, total).

    Returns:
        What levels.json holds.
    """
    cases = [(attack, cn0_dbhz) for attack in ATTACKS for cn0_dbhz in CN0_DBHZ]
    found: list[Comparison] = []
    for done, (attack, cn0_dbhz) in enumerate(cases):
        plan, from_s = scenario(attack, cn0_dbhz), DRAG_S if ATTACKS[attack] else 0.0
        seen = [o for r in tracks(plan, "if", runs, from_s=from_s) for o in r]
        made = [o for r in tracks(plan, "correlator", MORE * runs, from_s=from_s) for o in r]
        found += compare(attack, cn0_dbhz, seen, made, DRAG_S)
        if progress:
            progress(done + 1, len(cases))
    table = [c.row() for c in found]
    result = {"runs": runs, "seconds": DURATION_S, "summary": [asdict(s) for s in summary(found)]}
    output.mkdir(parents=True, exist_ok=True)
    with (output / "levels.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    from .levels_figure import draw  # noqa: PLC0415 - matplotlib is slow to import

    draw(output / "levels.png", found)
    (output / "levels.json").write_text(json.dumps(result, indent=1) + "\n")
    return result
