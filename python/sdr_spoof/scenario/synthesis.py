"""From a scenario to a recording on disk, with its truth beside it."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.errors import OutputError
from sdr_spoof.gain import gain_text
from sdr_spoof.sources import RecordingFormat
from sdr_spoof.sources.sigmf_file import DATA, META, write_meta

from .dme_table import dme_csv
from .emitters import transmissions
from .front_end import gain_control, gain_log, noise_knots
from .imu_data import imu_of
from .truth import truth
from .vehicle_data import moves_array, vehicle_csv

if TYPE_CHECKING:
    from collections.abc import Callable

    from sdr_spoof._core import Synthesizer
    from sdr_spoof.progress import Progress

    from .model import Scenario
    from .recording_plan import RecordingPlan

_BLOCK_S = 0.25
_GRID = 16384
"""Blocks are whole numbers of the synthesis's segments: nothing is computed twice."""


def open_synthesizer(scenario: Scenario, threads: int | None = None) -> Synthesizer:
    """The generator of a scenario's samples.

    Args:
        scenario: what to synthesise.
        threads: threads to use; None for one per core. The samples do not depend on it.
    """
    plan = scenario.recording
    emitters = [t.emitter for t in transmissions(scenario)]
    return _core.Synthesizer(
        plan.sample_format,
        plan.sample_rate_hz,
        plan.lo_hz,
        emitters,
        noise_rms_lsb=plan.rms_lsb,
        seed=scenario.noise_seed,
        bandwidth_hz=plan.bandwidth_hz,
        centre_hz=plan.front_end_centre_hz,
        filter_taps=plan.filter_taps,
        noise_db=noise_knots(plan),
        gain=gain_control(plan, emitters),
        threads=threads or 0,
    )


def synthesize(
    scenario: Scenario,
    out: Path | str,
    *,
    threads: int | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Write ``<out>.sigmf-data``, ``<out>.sigmf-meta`` and ``<out>.truth.json``.

    A scenario with an IMU writes what it reads to ``<out>.imu.csv``; one with DME stations, the
    slant ranges to them to ``<out>.dme.csv``; one with an array, what a perfect INS would say to
    ``<out>.a0.vehicle.csv``; one with automatic gain control, the gain to ``<out>.agc.csv``, which
    the metadata name.

    2-bit samples, which SigMF does not know, go to ``<out>.bin`` with ``<out>.bin.toml``. Ctrl-C
    leaves a valid, shorter recording, marked partial in its metadata and truth; KeyboardInterrupt
    is raised on once it is in place.

    Args:
        scenario: what to synthesise; of an array, one recording for each antenna, ``<out>.a0`` and
            so on.
        out: path of the recording, with or without ``.sigmf-data`` or ``.sigmf-meta``.
        threads: threads to use; None for one per core.
        force: replace existing files.
        progress: called with (samples done, samples in all).

    Returns:
        The metadata file (SigMF, or the TOML sidecar of 2-bit samples), for ``open_recording``; of
        an array, that of its reference antenna.

    Raises:
        OutputError: files exist already, the folder is missing, or the disk is full.
    """
    parts = scenario.antennas()
    stem = _stem(Path(out))
    stems = [stem] if len(parts) == 1 else [_with(stem, f".a{k}") for k in range(len(parts))]
    metas = []
    for number, (part, name) in enumerate(zip(parts, stems, strict=True)):
        shown = _share_of(progress, number, len(parts))
        metas.append(_synthesize(part, name, threads, force, shown))
    return metas[0]


def _share_of(progress: Progress | None, number: int, parts: int) -> Progress | None:
    """Progress of one of several recordings as part of them all."""
    if progress is None or parts == 1:
        return progress
    return lambda done, total: progress(number * total + done, parts * total)


def _synthesize(
    scenario: Scenario, stem: Path, threads: int | None, force: bool, progress: Progress | None
) -> Path:
    """One recording."""
    files = _Files(stem, scenario)
    if not force:
        files.check_absent()
    synthesizer = open_synthesizer(scenario, threads)
    imu_of(scenario)  # What is wrong with it is said before the long work.
    try:
        done = _write_samples(synthesizer, scenario.recording, files.partial, progress)
        if done:
            files.finish(done)
    except OSError as error:
        files.partial.unlink(missing_ok=True)
        if isinstance(error, OutputError):
            raise
        raise OutputError(
            f"{files.data}: cannot be written: {error.strerror or error}; nothing was kept"
        ) from error
    if done < scenario.recording.sample_count:
        files.partial.unlink(missing_ok=True)
        raise KeyboardInterrupt(f"{done} samples kept in {files.data}, marked partial")
    return files.meta


def truth_path(recording: Path | str) -> Path:
    """Path of the truth beside a synthetic recording, named by any of its files."""
    return _with(_stem(Path(recording)), ".truth.json")


def dme_path(recording: Path | str) -> Path:
    """Path of the DME ranges beside a synthetic recording, named by any of its files."""
    return _with(_stem(Path(recording)), ".dme.csv")


def imu_path(recording: Path | str) -> Path:
    """Path of the IMU's file beside a synthetic recording, named by any of its files."""
    return _with(_stem(Path(recording)), ".imu.csv")


class _Files:
    """Names of the output files."""

    def __init__(self, stem: Path, scenario: Scenario) -> None:
        raw = scenario.recording.bits_per_sample < 8
        self.scenario = scenario
        self.stem = stem
        self.data = _with(stem, ".bin" if raw else DATA)
        self.meta = _with(stem, ".bin.toml" if raw else META)
        self.truth = _with(stem, ".truth.json")
        self.imu = None if scenario.imu is None else _with(stem, ".imu.csv")
        self.dme = _with(stem, ".dme.csv") if scenario.dme else None
        self.vehicle = _with(stem, ".vehicle.csv") if moves_array(scenario) else None
        self.agc = None if scenario.recording.agc is None else _with(stem, ".agc.csv")
        self.partial = _with(stem, ".part")
        self._raw = raw

    def check_absent(self) -> None:
        others = (self.imu, self.dme, self.vehicle, self.agc)
        for path in (self.data, self.meta, self.truth, *others):
            if path is not None and path.exists():
                raise OutputError(f"{path}: exists already; give another name or use --force")

    def finish(self, count: int) -> None:
        """Metadata and truth, then the data under its own name: complete or not there."""
        scenario, plan = self.scenario, self.scenario.recording
        partial = count < plan.sample_count
        shared = {"sample_format", "sample_rate_hz", "lo_hz", "bandwidth_hz"}
        known = plan.model_dump(include=shared)
        if self.agc is not None:
            known["gain_file"] = self.agc.name
        format = RecordingFormat.model_validate(known)
        if self._raw:
            self.meta.write_text(_sidecar(format, partial), encoding="utf-8")
        else:
            extra = {"synthetic": True, "partial": partial}
            start = scenario.sky.start_time.utc() if scenario.sky is not None else None
            write_meta(self.stem, format, extra, start)
        imu = imu_of(scenario, duration_s=count / plan.sample_rate_hz)
        if imu is not None and self.imu is not None:
            self.imu.write_text(imu.csv(), encoding="ascii")
        dme = dme_csv(scenario, count / plan.sample_rate_hz)
        if dme is not None and self.dme is not None:
            self.dme.write_text(dme, encoding="utf-8")
        gain = gain_log(scenario, count / plan.sample_rate_hz)
        if gain is not None and self.agc is not None:
            self.agc.write_text(gain_text(gain), encoding="ascii")
        if self.vehicle is not None:
            self.vehicle.write_text(vehicle_csv(scenario), encoding="ascii")
        text = json.dumps(truth(scenario, sample_count=count))
        self.truth.write_text(text + "\n", encoding="utf-8")
        os.replace(self.partial, self.data)


def _write_samples(
    synthesizer: Synthesizer,
    plan: RecordingPlan,
    path: Path,
    progress: Progress | None,
) -> int:
    """Streams samples to a file; stops at Ctrl-C. Returns the number of samples written."""
    total = plan.sample_count
    block = max(1, round(_BLOCK_S * plan.sample_rate_hz / _GRID)) * _GRID
    _check_space(path, total * plan.bits_per_sample // 8)
    done = 0
    with path.open("wb", buffering=0) as file:
        try:
            while done < total:
                count = min(block, total - done)
                _write_all(file.write, synthesizer.generate(done, count).data)
                done += count
                if progress is not None:
                    progress(done, total)
        except KeyboardInterrupt:
            file.truncate(done * plan.bits_per_sample // 8)
    return done


def _write_all(write: Callable[[memoryview], int | None], data: memoryview) -> None:
    """An unbuffered write may take only a part."""
    while data:
        data = data[write(data) or 0 :]


def _check_space(path: Path, size: int) -> None:
    folder = path.parent
    if not folder.is_dir():
        raise OutputError(f"{folder}: no such folder; create it first")
    free = shutil.disk_usage(folder).free
    if size > free:
        raise OutputError(
            f"{path.parent}: the disk is full: the recording needs {size / 1e9:.2f} GB, "
            f"{free / 1e9:.2f} GB are free; free some space or shorten duration_s"
        )


def _stem(out: Path) -> Path:
    name = out.name
    for suffix in (DATA, META, ".bin.toml", ".bin"):
        name = name.removesuffix(suffix)
    return out.with_name(name)


def _with(stem: Path, suffix: str) -> Path:
    return stem.with_name(stem.name + suffix)


def _sidecar(format: RecordingFormat, partial: bool) -> str:
    fields = format.model_dump(exclude_none=True, exclude_defaults=True)
    lines = [f"{k} = {json.dumps(v)}" for k, v in fields.items()]
    comment = "# partial: synthesis was interrupted\n" if partial else ""
    return comment + "[recording]\n" + "\n".join(lines) + "\n"
