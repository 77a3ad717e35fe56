"""What a campaign says: detection and false alarms at each point, latency, ROC, coverage.

A trial is one satellite in one run. It is detected if the alarm comes after the attacker went on
the air; an alarm before that is an early one, and one on a satellite that nobody attacks a false
one. Satellites that could not be tested count as not detected. Intervals are Wilson's.
"""

from __future__ import annotations

import csv
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import norm

from .trials import Trials

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray

    from .table import Table

CONFIDENCE = 0.95
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
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
    """Probability of detection and of false alarm at each point, by detector."""
    rows: Rows = []
    for values, here in _by_point(table, trials):
        for detector, mine in _by_detector(here):
            clean = mine.where(~mine.attacked)
            rows.append(
                {
                    **values,
                    "detector": detector,
                    **_share("pd", int(mine.detected.sum()), int(mine.attacked.sum())),
                    **_latency(mine),
                    "early_count": int(mine.early.sum()),
                    **_share("pfa", int(clean.alarmed.sum()), clean.point.size),
                }
            )
    return rows


def latency_table(table: Table, trials: Trials) -> Rows:
    """Quantiles of the time to an alarm at each point, by detector, from either start."""
    rows: Rows = []
    for values, here in _by_point(table, trials.where(trials.attacked)):
        for detector, mine in _by_detector(here):
            for start, latency in (
                ("on air", mine.on_air_latency_s),
                ("drag", mine.drag_latency_s),
            ):
                known = latency[~np.isnan(latency)]
                if known.size:
                    quantiles = np.quantile(known, QUANTILES)
                    named = {
                        f"q{100 * q:02.0f}_s": float(v)
                        for q, v in zip(QUANTILES, quantiles, strict=True)
                    }
                    row = {**values, "detector": detector, "from": start}
                    rows.append({**row, "trials": mine.point.size, "detected": known.size, **named})
    return rows


def coverage_table(table: Table, trials: Trials) -> Rows:
    """Attacks, as the table's labels or their kinds name them, by detector."""
    attacked = trials.where(trials.attacked)
    names = attack_names(table, attacked)
    rows: Rows = []
    for name in dict.fromkeys(names.tolist()):
        for detector, mine in _by_detector(attacked.where(names == name)):
            share = _share("pd", int(mine.detected.sum()), mine.point.size)
            rows.append({"attack": name, "detector": detector, **share, **_latency(mine)})
    return rows


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
    clean = trials.where(~trials.attacked)
    rows: Rows = []
    for values, here in _by_point(table, trials.where(trials.attacked)):
        for detector, mine in _by_detector(here):
            others = clean.where(clean.detector == detector)
            at_point = others.where(others.point == mine.point[0])
            against = at_point if at_point.point.size else others
            for row in _roc(_scores(mine), _scores(against)):
                rows.append({**values, "detector": detector, **row})
    return rows


def _roc(attacked: NDArray[np.float64], clean: NDArray[np.float64]) -> Iterator[dict[str, Any]]:
    """One row per threshold, from the strictest down."""
    if not clean.size or not attacked.any():
        return
    every = np.unique(np.concatenate([attacked, clean]))[::-1]
    step = -(-every.size // MOST_THRESHOLDS)
    for threshold in every[::step].tolist():
        pd = _share("pd", int((attacked >= threshold).sum()), attacked.size)
        pfa = _share("pfa", int((clean >= threshold).sum()), clean.size)
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


def _by_detector(trials: Trials) -> Iterator[tuple[str, Trials]]:
    for detector in dict.fromkeys(trials.detector.tolist()):
        yield detector, trials.where(trials.detector == detector)


def _share(name: str, count: int, trials: int) -> dict[str, Any]:
    """A probability with its interval."""
    low, high = wilson(count, trials)
    share = count / trials if trials else float("nan")
    counts = {f"{name}_trials": trials, f"{name}_count": count, name: share}
    return {**counts, f"{name}_low": float(low), f"{name}_high": float(high)}


def _latency(trials: Trials) -> dict[str, Any]:
    return {
        "median_on_air_s": _median(trials.on_air_latency_s),
        "median_drag_s": _median(trials.drag_latency_s),
    }


def _median(values: Sequence[float] | NDArray[np.float64]) -> float:
    known = np.asarray(values)[~np.isnan(values)]
    return float(np.median(known)) if known.size else float("nan")
