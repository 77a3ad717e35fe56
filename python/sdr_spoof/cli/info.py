"""``sdr-spoof info``: what a recording looks like."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.sinks.atomic import write_bytes

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from numpy.typing import NDArray
    from rich.console import Console

    from sdr_spoof.info import RecordingInfo

    from .ui import Ui

_COLUMNS = 76
_ROWS = 8
_BLOCKS = " ▁▂▃▄▅▆▇█"


def _configure(parser: argparse.ArgumentParser) -> None:
    options.add_recording(parser)
    options.add_output(parser, "PNG of spectrum and level histogram")


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.info import inspect  # noqa: PLC0415 - scipy is slow to import

    options.check_output(arguments.output, force=arguments.force)
    info = inspect(options.recording_from(arguments))
    if arguments.output is not None:
        from sdr_spoof.info_figure import figure_png  # noqa: PLC0415

        write_bytes(arguments.output, figure_png(info), force=arguments.force)
    data = {f: getattr(info, f) for f in info.__dataclass_fields__} | {"output": arguments.output}
    return Outcome(data, lambda console: _render(info, console))


def _render(info: RecordingInfo, console: Console) -> None:
    console.print(info.path, style="bold", highlight=False, markup=False, soft_wrap=True)
    made = tables.table("", "what", "value", left=["what", "value"])
    for name, value in _rows(info):
        made.add_row(name, value)
    console.print(made)
    console.print(_spectrum_text(info), highlight=False)
    console.print(_levels_text(info), highlight=False)
    for warning in info.warnings:
        console.print(f"warning: {warning}", style="yellow", highlight=False)


def _rows(info: RecordingInfo) -> list[tuple[str, str]]:
    fmt, levels = info.format, info.levels
    rows = [
        ("samples", f"{info.sample_count} {fmt.sample_format}, {info.duration_s:.6g} s"),
        ("sample rate", f"{fmt.sample_rate_hz / 1e6:g} Msps"),
        ("RF at 0 Hz", f"{fmt.lo_hz / 1e6:g} MHz"),
        ("signals that fit", ", ".join(info.signals) or "none"),
        ("levels", f"{levels.distinct} used, {levels.bits_used:.1f} bits, rms {levels.rms:.2f}"),
        ("DC offset", f"{levels.dc_share:.4f} of the rms"),
        ("clipped", f"{levels.clipped_share:.3%}"),
        ("longest constant", f"{levels.longest_constant_s * 1e6:.2f} us"),
        ("examined", f"{info.examined_samples} samples"),
    ]
    if np.isnan(levels.clipped_share):
        rows[6] = ("clipped", "cannot be told from 2-bit samples")
    if levels.iq_gain_db is not None:
        rows.append(
            ("I/Q imbalance", f"{levels.iq_gain_db:+.2f} dB, {levels.iq_phase_deg:+.2f} degrees")
        )
    return rows


def _spectrum_text(info: RecordingInfo) -> str:
    groups = np.array_split(info.spectrum.density_db, _COLUMNS)
    heights = np.array([g.max() for g in groups if g.size])
    low, high = np.percentile(heights, 2) - 3, heights.max()
    frequency = info.spectrum.frequency_hz / 1e6
    axis = f"{frequency[0]:<+12.3f}{'MHz in the file':^52}{frequency[-1]:>+12.3f}"
    title = f"Spectrum, {high - low:.0f} dB from bottom to top"
    return "\n".join([title, *_bars((heights - low) / max(high - low, 1e-9)), axis, ""])


def _levels_text(info: RecordingInfo) -> str:
    counts, edges = info.levels.counts, info.levels.edges
    axis = f"{edges[0] + 0.5:<+8.0f}{'':{max(counts.size - 16, 0)}}{edges[-1] - 0.5:>+8.0f}"
    return "\n".join(["Levels", *_bars(counts / counts.max()), axis])


def _bars(heights: NDArray[np.float64]) -> list[str]:
    """Rows of a bar chart, top first; ``heights`` in [0, 1], one column each."""
    steps = np.clip(np.rint(heights * _ROWS * 8), 0, _ROWS * 8).astype(int)
    return [
        "".join(_BLOCKS[max(0, min(8, s - 8 * row))] for s in steps).rstrip()
        for row in reversed(range(_ROWS))
    ]


COMMAND = Command(
    "info",
    "format, length, spectrum, levels and sanity of a recording",
    _configure,
    _run,
    usage="REC [options]",
    details="Reads a few sections of the file only, so that large files answer at once.",
    examples=(
        "sdr-spoof info recording.sigmf-meta",
        "sdr-spoof info b1.bin --sample-format ri8 --sample-rate-hz 120e6 --lo-hz 1538.259e6",
        "sdr-spoof info recording.sigmf-meta -o spectrum.png",
    ),
)
