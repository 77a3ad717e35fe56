"""The whole way from a recording to a verdict, as ``process`` and ``demo`` run it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .acquisition import acquire
from .errors import OutputError
from .progress import silent
from .report import write_report
from .sinks.hdf5 import Result, write_result
from .tracking import track
from .verdict import detect

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .config import Config
    from .progress import Stages
    from .records import Acquisition, TrackLog, Verdict
    from .sources import Recording


@dataclass(frozen=True)
class Processed:
    """Everything that processing a recording gave."""

    recording: Recording
    config: Config
    acquisitions: tuple[Acquisition, ...]
    log: TrackLog
    verdict: Verdict
    result_path: Path
    report_path: Path


@dataclass(frozen=True)
class TruthComparison:
    """What was synthesised for a satellite against what was found."""

    prn: int
    truth: str
    verdict: str
    true_onset_s: float | None
    found_onset_s: float | None


@dataclass(frozen=True)
class Demo:
    """Outcome of the demonstration."""

    processed: Processed
    comparison: tuple[TruthComparison, ...]


def process(
    recording: Recording,
    config: Config,
    *,
    out: Path,
    signals: Sequence[str] | None = None,
    prns: Sequence[int] | None = None,
    threads: int | None = None,
    force: bool = False,
    stages: Stages = silent,
) -> Processed:
    """Acquire, track, detect, and write ``out/result.h5`` and ``out/report.html``.

    Raises:
        OutputError: an output exists and ``force`` is not set, or it cannot be written.
        SignalError: the recording cannot hold a signal asked for.
    """
    result_path, report_path = prepare(out, ("result.h5", "report.html"), force=force)
    with stages("Acquiring") as progress:
        found = acquire(
            recording,
            config.acquisition,
            signals=signals,
            prns=prns,
            threads=threads,
            progress=progress,
        )
    detected = [a for a in found if a.detected]
    with stages("Tracking") as progress:
        log = track(recording, detected, config.tracking, threads=threads, progress=progress)
    verdict = detect(log, config.detection)
    result = Result.of(recording, config, acquisitions=found, log=log, verdict=verdict)
    write_result(result_path, result, force=force)
    write_report(
        report_path,
        recording=recording,
        acquisitions=found,
        log=log,
        verdict=verdict,
        detection=config.detection,
        effective_config=config.model_dump(mode="json"),
        force=force,
    )
    return Processed(recording, config, tuple(found), log, verdict, result_path, report_path)


def prepare(out: Path, names: Sequence[str], *, force: bool) -> list[Path]:
    """Make the output folder and return the paths in it, none of which may exist.

    Raises:
        OutputError: a file exists and ``force`` is not set, or the folder cannot be made.
    """
    paths = [out / name for name in names]
    for path in paths:
        if path.exists() and not force:
            raise OutputError(f"{path}: exists already; add --force to replace it")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{out}: the folder cannot be made: {error.strerror}") from error
    return paths


def demo(
    config: Config,
    *,
    out: Path,
    threads: int | None = None,
    force: bool = False,
    stages: Stages = silent,
) -> Demo:
    """Synthesise the demonstration scenario, process it as an unknown recording, compare."""
    raise NotImplementedError
