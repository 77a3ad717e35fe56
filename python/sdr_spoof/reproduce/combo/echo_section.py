"""Multipath through the whole receiver, with the detectors as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import detectors
from sdr_spoof.campaign.analysis import wilson
from sdr_spoof.reproduce.parallel import repeat, seed_of
from sdr_spoof.reproduce.study import Section, Table

from . import published
from .echo_runs import (
    ARRIVING,
    CN0_DBHZ,
    DRAG_HZ,
    END_S,
    START_S,
    STATIC,
    Case,
    compared,
    run,
    spoofing,
)
from .multipath import DELAYS_M, DETECTION

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

SEED = 20_182_000
AMPLITUDES = (0.1, 0.3, 0.5, 0.7, 0.9)
KINDS = {
    "static": (STATIC, 0.0),
    "static, arriving": (ARRIVING, 0.0),
    "moving, fading at 0.2 Hz": ("moving", 0.2),
    "moving, fading at 1 Hz": ("moving", 1.0),
}
SHARE = 5
"""One run for so many of the effort's: they are long."""
LEAST_SPOOFED = 10


def section(effort: Effort, stages: Stages, executor: Executor | None = None) -> Section:
    """False alarms of the registered detectors, calibrated and at equal detection."""
    runs = max(1, effort.runs // SHARE)
    cases = [Case(kind, a, fading) for kind, fading in KINDS.values() for a in AMPLITUDES]
    jobs = [(spoofing(), seed_of(SEED, (0.0,), k)) for k in range(max(LEAST_SPOOFED, runs))]
    spoofed = len(jobs)
    for number, case in enumerate(cases, 1):
        jobs += [(case, seed_of(SEED, (float(number),), k)) for k in range(runs)]
    with stages("Multipath, receiver") as progress:
        scores = np.array(repeat(run, jobs, executor, progress))
    equal = np.quantile(scores[:spoofed], 1.0 - DETECTION, axis=0)
    echoes = scores[spoofed:].reshape(len(cases), runs, -1)
    return Section(
        "Multipath through the receiver",
        text=(
            f"Correlator level, {CN0_DBHZ:g} dB-Hz, {END_S:g} s a run, alarms counted after "
            f"{START_S:g} s. The signal-quality detectors of this receiver compare with the "
            "past, so that an echo which has always been there is part of their reference; the "
            "publication compares with the clean shape instead, as the figure above does. The "
            f"spoofing case is B1C captured at eta {published.ETA:g} and dragged by {DRAG_HZ:g} "
            "Hz, which the loops hold.",
            "A static echo that stays is in the reference of every detector. One that arrives is a "
            "jump of the phase difference, which the jump-and-slope test must take for an attack: "
            "a spoofer with another phase does the same. The rate test sees it for its window of 1 "
            "s, and alarms only where the jump is large. Of moving echoes the phase difference "
            "carries "
            "the beat, whatever the test.",
        ),
        tables=[_threshold_table(scores[:spoofed], equal), *_tables(echoes, cases, equal)],
    )


def _threshold_table(scores: Floats, equal: Floats) -> Table:
    rows: list[tuple[Cell, ...]] = [
        (title, float(np.median(score)), float(np.mean(score > 1.0)), float(threshold))
        for title, score, threshold in zip(_titles(), scores.T, equal, strict=True)
    ]
    names = ("detector", "median score", "Pd as calibrated", "threshold for a Pd of 95 %")
    note = f"{scores.shape[0]} runs. Score: largest statistic over the calibrated threshold."
    return Table("multipath_receiver_spoofing", "The spoofing case", names, rows, note)


def _tables(echoes: Floats, cases: list[Case], equal: Floats) -> list[Table]:
    return [
        _table(echoes, cases, np.ones(equal.size), "as calibrated", "calibrated"),
        _table(echoes, cases, equal, "at equal Pd of 95 %", "equal_pd"),
    ]


def _table(echoes: Floats, cases: list[Case], levels: Floats, how: str, name: str) -> Table:
    names = {value: key for key, value in KINDS.items()}
    columns = ["echo", "amplitude ratio"]
    bounds = []
    for title in _titles():
        bounds += [f"low, {title}", f"high, {title}"]
        columns += [title, f"low, {title}", f"high, {title}"]
    rows: list[list[Cell]] = []
    for case, scores in zip(cases, echoes, strict=True):
        cells: list[Cell] = [names[case.kind, case.fading_hz], case.amplitude]
        hits = (scores > levels).sum(axis=0)
        low, high = wilson(hits, np.full(hits.size, len(scores)))
        for k, count in enumerate(hits):
            cells += [float(count) / len(scores), float(low[k]), float(high[k])]
        rows.append(cells)
    return Table(
        f"multipath_receiver_{name}",
        f"Runs with a false alarm, {how}",
        columns,
        rows,
        f"{echoes.shape[1]} runs a row, extra path {DELAYS_M[0]:g} to {DELAYS_M[1]:g} m. The CSV "
        "has 95 % Wilson intervals.",
        details=bounds,
    )


def _titles() -> list[str]:
    return [detectors.DETECTORS[name].title for name in compared()]
