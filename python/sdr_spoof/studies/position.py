"""Positions from samples, against the truth: the numbers of a whole receiver.

Recordings of whole skies are synthesised, received from their samples, and deleted again. Errors of
the fixes are those against the receiver's state in the truth sidecar, by a cubic Hermite spline
through its 10 Hz.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from sdr_spoof.config import load_config
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix
from sdr_spoof.positioning import locate
from sdr_spoof.progress import silent
from sdr_spoof.receive import receive
from sdr_spoof.scenario import Scenario, builtin_scenario, synthesize, truth_path
from sdr_spoof.sources import open_recording
from sdr_spoof.verdict import detect

from .position_first import PHASE_S, first_fixes, started

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sdr_spoof.config import Config
    from sdr_spoof.positioning import Located
    from sdr_spoof.progress import Progress
    from sdr_spoof.records import TrackLog, Verdict

    Floats = NDArray[np.float64]

COMBO = {"sample_rate_hz": 30e6, "lo_hz": 1568.259e6, "bandwidth_hz": 28e6, "seed": 54}
CASES: dict[str, tuple[str, dict[str, Any], tuple[str, ...], dict[str, str]]] = {
    "static B1I": ("sky-static", {}, ("B1I",), {}),
    "static B1I + B1C": (
        "sky-static",
        COMBO,
        ("B1I", "B1C"),
        {"pvt.subcarrier": "true", "pvt.zenith_sigma_m": "0"},
    ),
    "moving B1I + B1C": ("sky-moving", {}, ("B1I", "B1C"), {}),
    "spoofed B1I": ("sky-spoofed", {}, ("B1I",), {}),
}
"""Scenario of the package, changes of its recording, signals, settings that are not defaults."""
SHORTEST_S = 42.0
"""A cold start takes up to 36 s of signal."""


@dataclass(frozen=True)
class Accuracy:
    """Errors of all fixes of one recording."""

    case: str
    settings: str
    signal_s: float
    satellites: int
    """Used in the median fix."""
    fixes: int
    epochs: int
    horizontal_m: float
    """Root mean square, as all that follow."""
    vertical_m: float
    velocity_m_s: float
    """Of the vector."""
    trusted: int
    """Fixes that nothing speaks against."""
    trusted_horizontal_m: float
    losses: int
    """Times that a pseudorange which had been there was missing."""
    slips: int
    """Times that a carrier phase may have slipped, by the observations' flags."""
    spoofed: int
    """Satellites that the detectors call so."""
    suspect: int


@dataclass(frozen=True)
class Received:
    """A recording, received."""

    log: TrackLog
    verdict: Verdict
    located: Located
    truth: Mapping[str, Any]


def run(
    output: Path,
    *,
    duration_s: float = 60.0,
    starts: int = 6,
    threads: int = 1,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Measure; write position.{json,png}, position.csv and position_first.csv.

    Args:
        output: folder to write to; recordings of up to 3.6 GB come and go there.
        duration_s: length of the recordings.
        starts: cold starts, 5 s apart.
        threads: worker threads.
        progress: called with (done, total).

    Returns:
        What position.json holds.
    """
    output.mkdir(parents=True, exist_ok=True)
    total = len(CASES) + starts + 1
    accuracy, errors, first, same = [], {}, [], False
    for done, name in enumerate(CASES):
        plan, config = case(name, max(duration_s, SHORTEST_S))
        runs = (1, 2) if name == "static B1I" else (threads,)
        received = from_samples(plan, config, output, runs)
        errors[name] = errors_of(received[0])
        accuracy.append(accuracy_of(name, plan, received[0], errors[name]))
        if len(received) > 1:
            same = alike(received[0].located, received[1].located)
            first += first_fixes(received[0].log, "samples", 4.0)
        if progress:
            progress(done + 1, total)
    for number in range(starts):
        first += first_fixes(started(number * PHASE_S), "correlator", 4.0 + number * PHASE_S)
        if progress:
            progress(len(CASES) + number + 1, total)
    positions, starts_of = [asdict(a) for a in accuracy], [asdict(f) for f in first]
    result = {
        "identical_with_1_and_2_threads": same,
        "positions": positions,
        "first_fixes": starts_of,
    }
    (output / "position.json").write_text(json.dumps(result, indent=1) + "\n")
    _write(output / "position.csv", positions)
    _write(output / "position_first.csv", starts_of)
    from .position_figure import draw  # noqa: PLC0415 - matplotlib is slow to import

    draw(output / "position.png", errors)
    if progress:
        progress(total, total)
    return result


def case(name: str, duration_s: float) -> tuple[Scenario, Config]:
    """Scenario and settings of one of :data:`CASES`."""
    builtin, changes, signals, flags = CASES[name]
    values = builtin_scenario(builtin).model_dump()
    values["recording"] |= changes | {"duration_s": duration_s}
    values["sky"]["signals"] = signals
    return Scenario.model_validate(values), load_config(flags=flags)


def from_samples(
    plan: Scenario, config: Config, folder: Path, threads: tuple[int, ...]
) -> list[Received]:
    """Synthesise a recording, receive it with each number of threads, and delete it."""
    found = []
    with TemporaryDirectory(prefix="position-", dir=folder) as temporary:
        meta = synthesize(plan, Path(temporary) / "sky")
        truth = json.loads(truth_path(meta).read_text(encoding="utf-8"))
        recording = open_recording(meta)
        for count in threads:
            seen, rows = receive(recording, config, None, None, count, silent, Path(temporary))
            log = replace(
                rows,
                signals=tuple(t.in_memory() for t in rows.signals),
                combos=tuple(t.in_memory() for t in rows.combos),
            )
            verdict = detect(log, config.detection)
            located = locate(log, config, verdict, start=recording.start, acquisitions=seen)
            found.append(Received(log, verdict, located, truth))
    return found


def errors_of(received: Received) -> Floats:
    """East, north, up in m, and their rates in m/s, of each epoch (E, 7) after its time in s."""
    state, fixes = received.truth["sky"]["receiver"], received.located.fixes
    places, speeds = (np.array(state[k]) for k in ("position_m", "velocity_m_s"))
    way = CubicHermiteSpline(np.array(received.truth["time_s"]), places, speeds)
    time_s = received.located.observations.sample_time_s
    latitude, longitude, _ = ecef_to_geodetic(places[0])
    turn = enu_matrix(float(latitude), float(longitude)).T
    # A rate is that at the instant; between the knots that of the spline.
    return np.column_stack(
        [
            time_s,
            (fixes.position_m - way(time_s)) @ turn,
            (fixes.velocity_m_s - way.derivative()(time_s)) @ turn,
        ]
    )


def accuracy_of(name: str, plan: Scenario, received: Received, errors: Floats) -> Accuracy:
    """Root mean squares of one recording."""
    located = received.located
    fixed, trusted = located.fixes.fixed, located.route.quality == 1
    losses, slips = _broken(located)
    names = np.array([s.satellite for s in located.fixes.signals])
    used = [np.unique(names[row]).size for row in located.fixes.used[fixed]]
    verdicts = [s.verdict for s in received.verdict.satellites]
    return Accuracy(
        case=name,
        settings=", ".join(f"{k} = {v}" for k, v in CASES[name][3].items()) or "default",
        signal_s=plan.recording.duration_s,
        satellites=int(np.median(used)) if used else 0,
        fixes=int(fixed.sum()),
        epochs=located.fixes.epochs,
        horizontal_m=rms(errors[fixed, 1:3]),
        vertical_m=rms(errors[fixed, 3:4]),
        velocity_m_s=rms(errors[fixed, 4:7]),
        trusted=int(trusted.sum()),
        trusted_horizontal_m=rms(errors[trusted, 1:3]),
        losses=losses,
        slips=slips,
        spoofed=verdicts.count("spoofed"),
        suspect=verdicts.count("suspect"),
    )


def rms(vectors: Floats) -> float:
    """Root of the mean squared length of vectors (N, D)."""
    return float(np.sqrt(np.mean(np.sum(vectors**2, axis=1)))) if len(vectors) else float("nan")


def _broken(located: Located) -> tuple[int, int]:
    """Ranges lost, and phases that may have slipped, after the first epoch of each signal."""
    seen = located.observations
    there = np.isfinite(seen.pseudorange_m)
    later = np.arange(seen.epochs)[:, None] > np.argmax(there, axis=0)
    return int((there[:-1] & ~there[1:]).sum()), int((seen.lock_lost & later).sum())


def alike(one: Located, other: Located) -> bool:
    """Whether all columns of the fixes are the same, bit for bit."""
    columns = ("position_m", "velocity_m_s", "clock_m", "residual_m", "status", "cause")
    pairs = [(getattr(one.fixes, c), getattr(other.fixes, c)) for c in columns]
    return all(a.tobytes() == b.tobytes() for a, b in pairs)


def _write(path: Path, rows: list[dict[str, Any]]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
