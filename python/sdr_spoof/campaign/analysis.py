"""What a campaign says: shares of alarms at each point, latency, ROC, coverage.

A trial is one satellite in one run. Of an attacked satellite the share of alarms is the
probability of detection, of any other (nothing happens, or multipath) that of a false alarm. An
alarm before the attack is on the air is an early one and finds nothing. Satellites that could not
be tested count as not alarmed. Intervals are Wilson's.
"""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import norm

from .trials import Trials

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray

    from .table import Table

CONFIDENCE = 0.95
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
WITHIN_S = 2.0
MOST_THRESHOLDS = 100
"""Points of a ROC curve."""

Rows = list[dict[str, Any]]


def wilson(
    count: ArrayLike, trials: ArrayLike, confidence: float = CONFIDENCE
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wilson's score interval of a probability; 0 to 1 where there are no trials.

    Wilson, Probable inference, the law of succession, and statistical inference, JASA 22 (1927).
    """
    k, n = np.asarray(count, np.float64), np.asarray(trials, np.float64)
    z = float(norm.isf((1.0 - confidence) / 2.0))
    some = np.maximum(n, 1.0)
    centre = (k + z**2 / 2.0) / (some + z**2)
    half = z / (some + z**2) * np.sqrt(k * (some - k) / some + z**2 / 4.0)
    # At the ends the interval reaches 0 and 1 exactly, which rounding must not spoil.
    low = np.where(k > 0, np.clip(centre - half, 0.0, 1.0), 0.0)
    high = np.where(k < n, np.clip(centre + half, 0.0, 1.0), 1.0)
    return np.asarray(np.where(n > 0, low, 0.0)), np.asarray(np.where(n > 0, high, 1.0))


def detection_table(table: Table, trials: Trials) -> Rows:
    """Share of alarms at each point, by what happens to the satellite and by detector."""
    return [
        {**values, **_named(mine), **_share("alarm", mine.found), **_latency(mine)}
        for values, here in _by_point(table, trials)
        for mine in _parts(here)
    ]


def latency_table(table: Table, trials: Trials) -> Rows:
    """Alarms in time and quantiles of the time from either start, at each point, by attack.

    Those before the start are not in time: of ``from`` drag, they are of the capture.
    """
    rows: Rows = []
    within_s = float(table.spec.get("output", {}).get("within_s", WITHIN_S))
    for values, here in _by_point(table, trials.where(trials.hostile)):
        for mine in _parts(here):
            times = {"on air": mine.on_air_latency_s, "drag": mine.drag_latency_s}
            for start, latency in times.items():
                known = latency[~np.isnan(latency)]
                if known.size:
                    count = {"from": start, "trials": latency.size, "found": known.size}
                    count |= {"before": int((known < 0.0).sum()), "within_s": within_s}
                    in_time = _share("within", (latency >= 0.0) & (latency <= within_s))
                    named = {**values, **_named(mine)}
                    rows.append({**named, **count, **in_time, **_quantiles(known)})
    return rows


def coverage_table(table: Table, trials: Trials) -> Rows:
    """Share of alarms by attack, as the table's labels or their kinds name it, and detector."""
    struck = trials.where(trials.attack != "")
    named = replace(struck, attack=attack_names(table, struck))
    return [
        {**_named(mine), **_share("alarm", mine.found), **_latency(mine)} for mine in _parts(named)
    ]


def attack_names(table: Table, trials: Trials) -> NDArray[np.str_]:
    """What the attack of each trial is called: its label on an axis over attacks, or its kind."""
    axis = _attack_axis(table)
    if axis is None:
        return trials.attack
    label_of = dict(zip(table["point"].tolist(), table[axis].tolist(), strict=True))
    return np.array([label_of[point] for point in trials.point.tolist()], dtype=np.str_)


def roc_table(table: Table, trials: Trials) -> Rows:
    """Detections against false alarms as the threshold is moved, at each point, by detector.

    The share of attacked satellites whose largest statistic of the run is beyond the threshold,
    against that of satellites nobody attacks: of the same point, or of all where it has none.
    """
    clean = trials.where(~trials.hostile)
    rows: Rows = []
    for values, here in _by_point(table, trials.where(trials.hostile)):
        for mine in _parts(here):
            others = clean.where(clean.detector == mine.detector[0])
            at_point = others.where(others.point == mine.point[0])
            against = at_point if at_point.point.size else others
            curve = _roc(_scores(mine), _scores(against))
            rows += [{**values, **_named(mine), **row} for row in curve]
    return rows


def _roc(attacked: NDArray[np.float64], clean: NDArray[np.float64]) -> Iterator[dict[str, Any]]:
    """One row per threshold, from the strictest down."""
    if not clean.size or not attacked.any():
        return
    every = np.unique(np.concatenate([attacked, clean]))[::-1]
    step = -(-every.size // MOST_THRESHOLDS)
    for threshold in every[::step].tolist():
        pd, pfa = _share("pd", attacked >= threshold), _share("pfa", clean >= threshold)
        yield {"threshold": threshold, **pd, **pfa}


def _scores(trials: Trials) -> NDArray[np.float64]:
    """Scores, 0 where nothing could be tested."""
    return np.nan_to_num(trials.score, nan=0.0)


def write_csv(path: Path, rows: Rows) -> None:
    """Write rows that have the same keys; NaN is left empty."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]) if rows else [], lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: _shown(value) for name, value in row.items()} for row in rows)


def _shown(value: Any) -> Any:
    return "" if isinstance(value, float) and math.isnan(value) else value


def _attack_axis(table: Table) -> str | None:
    """Axis whose values are attacks or scenarios with labels."""
    keys = [s for s in table.spec.get("sweep", ()) if s.get("labels") is not None]
    names = [name for name in table.axes if table[name].dtype.kind == "U"]
    of_attacks = [s for s in keys if s["key"] == "scenario" or ".attack" in s["key"]]
    columns = [s["name"] or s["key"].split(".")[-1] for s in of_attacks]
    return next((n for n in names if n in columns), None)


def _by_point(table: Table, trials: Trials) -> Iterator[tuple[dict[str, Any], Trials]]:
    """Values of the axes at each point, and its trials."""
    for point in np.unique(trials.point).tolist():
        row = int(np.flatnonzero(table["point"] == point)[0])
        values = {name: table[name][row].item() for name in table.axes}
        yield {"point": point, **values}, trials.where(trials.point == point)


def _parts(trials: Trials) -> Iterator[Trials]:
    """The trials of each attack (first, so hostile ones, what is none, nothing) and detector."""
    kinds = dict.fromkeys(zip(trials.attack.tolist(), trials.hostile.tolist(), strict=True))
    for attack, hostile in sorted(kinds, key=lambda kind: (not kind[1], kind[0] == "")):
        same = trials.where((trials.attack == attack) & (trials.hostile == hostile))
        for detector in dict.fromkeys(same.detector.tolist()):
            yield same.where(same.detector == detector)


def _named(part: Trials) -> dict[str, Any]:
    """What a part of the trials has in common: what happens to the satellite, and the detector."""
    attack, hostile = str(part.attack[0]), bool(part.hostile[0])
    return {"what": attack, "hostile": hostile, "detector": str(part.detector[0])}


def _share(name: str, hits: NDArray[np.bool_]) -> dict[str, Any]:
    """A probability with its interval."""
    count, trials = int(hits.sum()), hits.size
    low, high = wilson(count, trials)
    ends = {f"{name}_low": float(low), f"{name}_high": float(high)}
    return {f"{name}_trials": trials, f"{name}_count": count, name: count / trials, **ends}


def _latency(part: Trials) -> dict[str, Any]:
    return {
        "early_count": int(part.early.sum()),
        "median_on_air_s": _median(part.on_air_latency_s),
        "median_drag_s": _median(part.drag_latency_s),
    }


def _quantiles(values: NDArray[np.float64]) -> dict[str, float]:
    names = (f"q{100 * q:02.0f}_s" for q in QUANTILES)
    return dict(zip(names, np.quantile(values, QUANTILES).tolist(), strict=True))


def _median(values: NDArray[np.float64]) -> float:
    known = values[~np.isnan(values)]
    return float(np.median(known)) if known.size else float("nan")
