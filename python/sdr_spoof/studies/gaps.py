"""Fixes of recordings from which samples are missing, against the truth.

Skies are simulated at correlator level; one to three gaps of 1 to 300 ms, at random times, are
whole symbols, whole code periods or neither. What counts is whether a fix that nothing speaks
against (``FIX`` or ``UNCHECKED``) is wrong: by more than its own account of its noise allows, and
by more than a code loop that settles.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.config import load_config
from sdr_spoof.correlator_level import simulate
from sdr_spoof.fixes import Status
from sdr_spoof.nav.beidou_satellites import GEO
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.positioning import locate
from sdr_spoof.scenario import Scenario
from sdr_spoof.scenario.load import scenario_path
from sdr_spoof.tracking import TrackingConfig

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.positioning import Located
    from sdr_spoof.progress import Progress
    from sdr_spoof.records import TrackLog

PLACE = (31.2, 121.5, 30.0)
NEAR = "31.5,121.0,0"
"""What a hot start is told: 58 km off."""
BEGIN, WITHIN_S = datetime(2023, 3, 12, 12, tzinfo=UTC), 1800.0
CN0_DBHZ = (38.0, 45.0, 45.0)
SIGMAS, LEAST_M = 4.2, 10.0
"""A fix is wrong if it is farther off than both."""
SHORTEST_S, LONGEST_S = 1e-3, 0.3
"""Gaps."""
APART_S = 0.02


@dataclass(frozen=True)
class Sky:
    """What is received."""

    signals: tuple[str, ...]
    systems: tuple[str, ...]
    rate_hz: float
    lo_hz: float
    symbol_s: float
    period_s: float = 1e-3
    geostationary: bool | None = None
    """Only those that are, or are not."""
    message_s: tuple[float, float] = (8.0, 34.0)
    """Lengths of recordings that hold messages."""


SKIES = {
    "B1I, D1 and D2": Sky(("B1I",), ("C",), 10e6, 1561.098e6, 0.02),
    "B1I, D1": Sky(("B1I",), ("C",), 10e6, 1561.098e6, 0.02, geostationary=False),
    "B1I, D2": Sky(("B1I",), ("C",), 10e6, 1561.098e6, 0.002, geostationary=True),
    "B1C": Sky(("B1C",), ("C",), 10e6, 1575.42e6, 0.01, 0.01, message_s=(20.0, 40.0)),
    "L1 C/A": Sky(("L1CA",), ("G",), 10e6, 1575.42e6, 0.02),
    "all": Sky(("B1I", "B1C", "L1CA"), ("C", "G"), 25e6, 1568.259e6, 0.02),
}
KNOWN = ("messages", "early gap", "hot")
"""Messages and orbits; the same, the gap by whole symbols before the first frame or after the last;
orbits, time and place, in 2 to 5 s."""


@dataclass(frozen=True)
class Case:
    """One recording."""

    start: datetime
    duration_s: float
    gaps: tuple[tuple[float, float], ...]
    cn0_dbhz: float
    seed: int


@dataclass(frozen=True)
class Outcome:
    """Fixes of all recordings of a kind."""

    sky: str
    known: str
    recordings: int
    with_fixes: int
    good: int
    """Fixes that nothing speaks against; as the next."""
    unchecked: int
    suspect: int
    wrong: int
    """Of the good and unchecked ones."""
    largest_sigmas: float
    """Error over its own standard deviation, of those."""


def draw(sky: Sky, known: str, seed: int) -> Case:
    """A recording of its own for each seed."""
    rng = np.random.default_rng([seed, list(SKIES.values()).index(sky), KNOWN.index(known)])
    length_s = {"messages": sky.message_s, "early gap": sky.message_s, "hot": (2.0, 5.0)}[known]
    duration_s = rng.uniform(*length_s)
    gaps: list[tuple[float, float]] = []
    for at_s in sorted(_instant(rng, known, duration_s) for _ in range(rng.choice((1, 1, 2, 3)))):
        if not gaps or at_s > gaps[-1][0] + APART_S:
            gaps.append((round(at_s, 4), round(_missing_s(rng, sky, known), 6)))
    start = BEGIN + timedelta(seconds=round(rng.uniform(0.0, WITHIN_S), 1))
    return Case(start, round(duration_s, 3), tuple(gaps), float(rng.choice(CN0_DBHZ)), seed)


def _instant(rng: np.random.Generator, known: str, duration_s: float) -> float:
    begin_s, end_s = 0.05, 0.95 * duration_s
    if known == "early gap":
        early = rng.random() < 0.7
        begin_s, end_s = (0.1, 1.5) if early else (duration_s - 1.5, duration_s - 0.1)
    return float(rng.uniform(begin_s, end_s))


def _missing_s(rng: np.random.Generator, sky: Sky, known: str) -> float:
    kind = "symbols" if known == "early gap" else rng.choice(("any", "periods", "symbols"))
    if kind == "any":
        return float(np.exp(rng.uniform(np.log(SHORTEST_S), np.log(LONGEST_S))))
    step_s = sky.symbol_s if kind == "symbols" else sky.period_s
    return float(step_s * rng.integers(1, round(LONGEST_S / step_s), endpoint=True))


def received(sky: Sky, known: str, case: Case) -> tuple[TrackLog, Located]:
    """Tracks and fixes of a recording."""
    log = simulate(_scenario(sky, case), TrackingConfig(data_component=True), gaps=case.gaps)
    if sky.geostationary is not None:
        signals = tuple(t for t in log.signals if (t.prn in GEO) == sky.geostationary)
        breaks = tuple(b for b in log.breaks if (b.prn in GEO) == sky.geostationary)
        log = replace(log, signals=signals, breaks=breaks)
    flags = {
        "pvt.ionosphere": "none",
        "pvt.troposphere": "none",
        "navigation.files": str(scenario_path("sky-static").with_name("brdc-2023-03-12.rnx")),
        "navigation.time": case.start.isoformat(),
        "observables.rate_hz": "10",
    }
    if known == "hot":
        flags["navigation.place"] = NEAR
    return log, locate(log, load_config(flags=flags))


def _scenario(sky: Sky, case: Case) -> Scenario:
    missing_s = sum(length_s for _, length_s in case.gaps)
    latitude_deg, longitude_deg, height_m = PLACE
    recording = {
        "duration_s": round(case.duration_s + missing_s + 0.01, 3),
        "sample_rate_hz": sky.rate_hz,
        "lo_hz": sky.lo_hz,
        "sample_format": "ci8",
        "seed": case.seed,
    }
    receiver = {
        "kind": "static",
        "latitude_deg": latitude_deg,
        "longitude_deg": longitude_deg,
        "height_m": height_m,
    }
    over = {
        "start": case.start.replace(tzinfo=None).isoformat(),
        "systems": list(sky.systems),
        "signals": list(sky.signals),
        "elevation_mask_deg": 10.0 if sky.geostationary else 25.0,
        "cn0_zenith_dbhz": case.cn0_dbhz,
        "ionosphere": "none",
        "troposphere": "none",
        "receiver": receiver,
    }
    return Scenario.model_validate({"recording": recording, "sky": over})


@dataclass(frozen=True)
class Judged:
    """Fixes of one recording."""

    status: NDArray[np.uint8]
    away_m: NDArray[np.float64]
    sigmas: NDArray[np.float64]
    """Errors over what the fixes state."""

    @property
    def trusted(self) -> NDArray[np.bool_]:
        """Which ones nothing speaks against."""
        return np.isin(self.status, (Status.FIX, Status.UNCHECKED))

    @property
    def wrong(self) -> NDArray[np.bool_]:
        """Which of these are wrong."""
        return self.trusted & (self.sigmas > SIGMAS) & (self.away_m > LEAST_M)


def judged(found: Located) -> Judged:
    """Fixes against the place of the receiver."""
    fixes, rows = found.fixes, np.flatnonzero(found.fixes.fixed)
    away_m = np.linalg.norm(fixes.position_m[rows] - geodetic_to_ecef(PLACE), axis=1)
    stated_m = np.sqrt(np.trace(fixes.covariance_m2[rows], axis1=1, axis2=2))
    return Judged(fixes.status[rows], away_m, away_m / stated_m)


def measure(name: str, known: str, recordings: int) -> Outcome:
    """Fixes of so many recordings."""
    sky = SKIES[name]
    cases = (draw(sky, known, seed) for seed in range(recordings))
    all_of = [judged(received(sky, known, case)[1]) for case in cases]
    status = np.concatenate([j.status for j in all_of])
    return Outcome(
        sky=name,
        known=known,
        recordings=recordings,
        with_fixes=sum(j.status.size > 0 for j in all_of),
        good=int((status == Status.FIX).sum()),
        unchecked=int((status == Status.UNCHECKED).sum()),
        suspect=int((status == Status.SUSPECT).sum()),
        wrong=sum(int(j.wrong.sum()) for j in all_of),
        largest_sigmas=max(float(j.sigmas[j.trusted].max(initial=0.0)) for j in all_of),
    )


def run(output: Path, *, recordings: int = 50, progress: Progress | None = None) -> dict[str, Any]:
    """Measure every kind; write gaps.{json,csv}."""
    cases = [(name, known) for name in SKIES for known in KNOWN]
    table = []
    for done, (name, known) in enumerate(cases):
        table.append(asdict(measure(name, known, recordings)))
        if progress:
            progress(done + 1, len(cases))
    output.mkdir(parents=True, exist_ok=True)
    with (output / "gaps.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    result = {"gaps": table}
    (output / "gaps.json").write_text(json.dumps(result, indent=1) + "\n")
    return result
