"""Signal that it takes to a first fix.

It is the shortest part of a recording, from its start, that gives a fix: tracks do not depend on
what comes later, so that they are cut instead of the samples. How long a cold start takes depends
on where in the message it falls.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import TYPE_CHECKING

from sdr_spoof.config import load_config
from sdr_spoof.correlator_level import simulate
from sdr_spoof.nav.beidou_satellites import GEO
from sdr_spoof.positioning import locate
from sdr_spoof.scenario import Scenario, builtin_scenario
from sdr_spoof.scenario.load import scenario_path

if TYPE_CHECKING:
    from sdr_spoof.config import Config
    from sdr_spoof.records import TrackLog

COLD_S, HOT_S, PHASE_S = 42.0, 2.0, 5.0
STEP_S = 0.1
EPOCHS_HZ = "10"


@dataclass(frozen=True)
class FirstFix:
    """Signal that it takes to a first fix."""

    start: str
    """What is known: cold (nothing), hot (orbits, time, place)."""
    level: str
    phase_s: float
    """Start of the recording after that of a frame of D1."""
    signal_s: float
    """NaN where there was none."""


def first_fixes(log: TrackLog, level: str, phase_s: float) -> list[FirstFix]:
    """Cold, by D1 alone, and hot."""
    log = replace(log, signals=tuple(t for t in log.signals if t.prn not in GEO), second_peaks=())
    begin = datetime.fromisoformat("2023-03-12T12:00:00") + timedelta(seconds=phase_s - 4.0)
    hot = {
        "navigation.files": str(scenario_path("sky-static").with_name("brdc-2023-03-12.rnx")),
        "navigation.time": begin.isoformat(),
        "navigation.place": "31.3,121.4,0",
        "observables.rate_hz": EPOCHS_HZ,
    }
    cold = load_config(flags={"observables.rate_hz": EPOCHS_HZ})
    phase_s %= 30.0
    return [
        FirstFix("cold", level, phase_s, shortest_s(log, cold, COLD_S)),
        FirstFix("hot", level, phase_s, shortest_s(log, load_config(flags=hot), HOT_S)),
    ]


def shortest_s(log: TrackLog, config: Config, longest_s: float) -> float:
    """Shortest start of a recording that gives a fix, in steps of :data:`STEP_S`, by halving."""
    low, high = 0, round(longest_s / STEP_S)
    if not _fixed(log, config, longest_s):
        return float("nan")
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if _fixed(log, config, middle * STEP_S) else (middle, high)
    return high * STEP_S


def _fixed(log: TrackLog, config: Config, until_s: float) -> bool:
    part = replace(
        log,
        duration_s=until_s,
        signals=tuple(t.between(0.0, until_s) for t in log.signals),
        combos=tuple(t.between(0.0, until_s) for t in log.combos),
    )
    return bool(locate(part, config).fixes.fixed.any())


def started(after_s: float) -> TrackLog:
    """Tracks of the static sky, begun later."""
    values = builtin_scenario("sky-static").model_dump()
    start = datetime.fromisoformat(values["sky"]["start"]) + timedelta(seconds=after_s)
    values["sky"]["start"] = start.isoformat()
    values["recording"]["duration_s"] = COLD_S
    return simulate(Scenario.model_validate(values))
