"""The whole way from a recording to a verdict, as ``process`` and ``demo`` run it."""

from __future__ import annotations

import gc
import json
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import OutputError
from .fusion import deciding
from .positioning import try_locate
from .progress import silent
from .receive import receive
from .report.crew import crew_for
from .report.evidence import EvidenceBook
from .report.figures.truth import TruthMark
from .report.html import write_report
from .report.pictures import Pictures
from .report.words import ordered
from .scenario import builtin_scenario, synthesize, truth_path
from .sinks.hdf5 import Result, write_result
from .sources import open_recording
from .verdict import CLEAN, SPOOFED, detect

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .config import Config
    from .positioning import Located
    from .progress import Stages
    from .records import Acquisition, SatelliteVerdict, TrackLog, Verdict
    from .sources import Recording


ONSET_SLACK_S = 0.3
"""An estimated onset may lie this far before the true one: the estimate has noise (the demo, 16
seeds: 0.17 s at most)."""


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
    located: Located | None = None
    why_not_located: str = ""
    """Why there is no position at all, in words."""


@dataclass(frozen=True)
class TruthComparison:
    """What was synthesised for a satellite against what was found."""

    system: str
    prn: int
    attacked: tuple[str, ...]
    """Components (registry signals) that the scenario attacks; none for an untouched satellite."""
    start_s: float | None
    """When the spoofer comes on the air."""
    capture_s: float | None
    """When it is as strong as the satellite."""
    drag_start_s: float | None
    """When it begins to pull code and carrier away."""
    verdict: str
    band: str | None
    """Signal that the detectors point to."""
    onset_s: float | None
    """Onset that the detectors estimate."""
    alarm_s: float | None
    """When they raise the alarm."""

    @property
    def agrees(self) -> bool:
        """Whether the verdict is right: an attack is found, on its band, after it began."""
        if not self.attacked:
            return self.verdict == CLEAN
        if self.verdict != SPOOFED or self.onset_s is None or self.start_s is None:
            return False
        return self.band in self.attacked and self.onset_s >= self.start_s - ONSET_SLACK_S


@dataclass(frozen=True)
class Demo:
    """Outcome of the demonstration."""

    processed: Processed
    comparison: tuple[TruthComparison, ...]


def process(
    recording: Recording,
    config: Config,
    *,
    out: Path | str,
    signals: Sequence[str] | None = None,
    prns: Sequence[int] | None = None,
    threads: int | None = None,
    force: bool = False,
    stages: Stages = silent,
    truth: TruthMark | None = None,
) -> Processed:
    """Acquire, track, detect, and write ``out/result.h5`` and ``out/report.html``.

    ``truth`` is drawn in the report where it is known; nothing else looks at it.

    Raises:
        OutputError: an output exists and ``force`` is not set, or it cannot be written.
        SignalError: the recording cannot hold a signal asked for.
    """
    out = Path(out)
    result_path, report_path = output_paths(out, ("result.h5", "report.html"), force=force)
    with output_folder(out), _settled(), crew_for(threads) as crew:
        pictures = Pictures(crew)
        chosen = signals, prns, threads
        found, log = receive(recording, config, *chosen, stages, out, pictures.acquired)
        pictures.tracked(log)
        with stages("Detecting"):
            book = EvidenceBook(config.detection)
            verdict = detect(log, config.detection, look=book.take)
        pictures.judged(log, verdict, book, ordered(verdict))
        with stages("Positioning"):
            located, why_not = try_locate(
                log, config, verdict, start=recording.start, acquisitions=found
            )
        if located is not None and located.fixes.fixed.any():
            pictures.located(located.route)
        with stages("Reporting") as progress:
            known: dict[str, Any] = {"acquisitions": found, "log": log, "verdict": verdict}
            more = located.records() if located is not None else {}
            result = Result.of(recording, config, **known, **more)
            write_result(result_path, result, force=force)
            if progress:
                progress(1, 4)
            write_report(
                report_path,
                recording=recording,
                acquisitions=found,
                log=log,
                verdict=verdict,
                detection=config.detection,
                effective_config=config.model_dump(mode="json"),
                truth=truth,
                located=located,
                why_not_located=why_not,
                book=book,
                pictures=pictures,
                force=force,
            )
            if progress:
                progress(4, 4)
    paths = result_path, report_path
    return Processed(recording, config, tuple(found), log, verdict, *paths, located, why_not)


@contextmanager
def _settled() -> Iterator[None]:
    """Spare the collector of garbage what is there already: modules, for the most part."""
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


def output_paths(out: Path, names: Sequence[str], *, force: bool) -> list[Path]:
    """Paths in the output folder, none of which may exist.

    Raises:
        OutputError: a file exists and ``force`` is not set, or the folder is a file.
    """
    if out.exists() and not out.is_dir():
        raise OutputError(f"{out}: is a file; name a folder for the output")
    paths = [out / name for name in names]
    for path in paths:
        if path.exists() and not force:
            raise OutputError(f"{path}: exists already; add --force to replace it")
    return paths


@contextmanager
def output_folder(out: Path) -> Iterator[None]:
    """Make the output folder; if nothing came to lie in it, take it away again.

    Raises:
        OutputError: it cannot be made.
    """
    missing = [p for p in (out, *out.parents) if not p.exists()]
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{out}: the folder cannot be made: {error.strerror}") from error
    try:
        yield
    finally:
        with suppress(OSError):  # not empty: there is something to keep
            for folder in missing:
                folder.rmdir()


def demo(
    config: Config,
    *,
    out: Path | str,
    threads: int | None = None,
    force: bool = False,
    stages: Stages = silent,
) -> Demo:
    """Synthesise the demonstration scenario, process it as an unknown recording, compare.

    Raises:
        OutputError: an output exists and ``force`` is not set, or it cannot be written.
    """
    out = Path(out)
    names = ("demo.sigmf-data", "demo.sigmf-meta", "demo.truth.json", "result.h5", "report.html")
    output_paths(out, names, force=force)
    scenario = builtin_scenario("demo")
    with output_folder(out), stages("Synthesising") as progress:
        meta = synthesize(scenario, out / "demo", threads=threads, force=force, progress=progress)
    truth = json.loads(truth_path(meta).read_text(encoding="utf-8"))
    processed = process(
        open_recording(meta),
        config,
        out=out,
        threads=threads,
        force=force,
        stages=stages,
        truth=_truth_mark(truth["attacks"]),
    )
    rows = (_compare(s, truth["attacks"]) for s in processed.verdict.satellites)
    return Demo(processed, tuple(rows))


def _truth_mark(attacks: list[dict[str, Any]]) -> TruthMark | None:
    """Mark of the first attack for the report."""
    if not attacks:
        return None
    times = ("start_s", "capture_s", "drag_start_s", "system", "prn")
    return TruthMark(**{name: attacks[0][name] for name in times})


def _compare(found: SatelliteVerdict, attacks: list[dict[str, Any]]) -> TruthComparison:
    mine = [a for a in attacks if (a["system"], a["prn"]) == (found.system, found.prn)]
    attack = mine[0] if mine else {}
    alarm = min(deciding(found.alarms), key=lambda a: a.alarm_s, default=None)
    return TruthComparison(
        system=found.system,
        prn=found.prn,
        attacked=tuple(attack.get("components", ())),
        start_s=attack.get("start_s"),
        capture_s=attack.get("capture_s"),
        drag_start_s=attack.get("drag_start_s"),
        verdict=found.verdict,
        band=found.band,
        onset_s=found.onset_s,
        alarm_s=alarm.alarm_s if alarm else None,
    )
