"""Measurements as tables of text, for the terminal and for docs/validation.md."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .targets import Quantity, markdown_targets

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from . import Measurement
    from .machine import Machine

NOTES = (
    "W1: 12 satellites, B1I and the B1C pilot as BOC(1,1), 5 taps; 5 Msps hold B1I only.\n"
    "W2: the same with the whole QMBOC pilot and the prompt of the data component.\n"
    "receiver: recording to result file as `track` does it once it has acquired, pull-in included; "
    "its MB are those of the whole process.\n"
    "engine: the correlators alone. synthesis: a channel is an emitter.\n"
    "Medians of the runs, and their range. Channels per core: how many would run in real time; "
    "µs per ms: core time.\n"
)


@dataclass(frozen=True)
class Section:
    """A table; the first column holds words."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def sections(machine: Machine, measurements: Sequence[Measurement]) -> Iterator[Section]:
    """Tables of what was measured; none of what was not."""
    for stages, title, columns, row in _TABLES:
        chosen = [m for m in measurements if m.stage in stages]
        if chosen:
            rows = tuple((_name(m, machine), *row(m)) for m in chosen)
            yield Section(title, columns, rows)


def _name(m: Measurement, machine: Machine) -> str:
    """What was measured; vector instructions are named where they are not the best."""
    subject = m.workload if m.stage == "acquisition" else f"{m.stage} {m.workload}"
    return subject if m.level == machine.levels[-1] else f"{subject}, {m.level}"


def _stream_row(m: Measurement) -> tuple[str, ...]:
    return (
        *(_msps(m), str(m.threads), str(m.channels), *_spread(Quantity.TIMES_REAL_TIME, m)),
        *(f"{m.channels_per_core:.0f}", f"{m.us_per_ms_channel:.2f}", f"{m.peak_memory_mb:.0f}"),
    )


def _search_row(m: Measurement) -> tuple[str, ...]:
    return (_msps(m), str(m.threads), str(m.channels), *_spread(Quantity.SECONDS, m))


def _slope_row(m: Measurement) -> tuple[str, ...]:
    return (_msps(m), *_spread(Quantity.CHANNEL_COST, m))


_STREAM = ("", "Msps", "threads", "channels", "x real\ntime", "range")
_TABLES: tuple[
    tuple[tuple[str, ...], str, tuple[str, ...], Callable[..., tuple[str, ...]]], ...
] = (
    (
        ("receiver", "engine", "synthesis"),
        "Streams of samples",
        (*_STREAM, "channels\nper core", "µs per ms\n& channel", "MB"),
        _stream_row,
    ),
    (
        ("acquisition",),
        "Acquisition",
        ("blind search", "Msps", "threads", "PRNs", "seconds", "range"),
        _search_row,
    ),
    (("channel",), "One channel more", ("", "Msps", "µs per ms", "range"), _slope_row),
)


def _msps(m: Measurement) -> str:
    return f"{m.sample_rate_hz / 1e6:g}"


def _spread(quantity: Quantity, m: Measurement) -> tuple[str, str]:
    middle, low, high = quantity.of(m)
    return f"{middle:.2f}", f"{low:.2f}-{high:.2f}"


def machine_line(machine: Machine, load_after: float) -> str:
    """The machine, and how busy it was."""
    return (
        f"{machine.processor}, {machine.cores} cores, {machine.levels[-1]}; load average "
        f"{machine.load_average:.2f} before, {load_after:.2f} after (the benchmark's own in it)."
    )


def markdown(machine: Machine, load_after: float, measurements: Sequence[Measurement]) -> str:
    """The tables of docs/validation.md: targets at 120 Msps first, then everything."""
    parts = [machine_line(machine, load_after), markdown_targets(measurements)]
    for section in sections(machine, measurements):
        head = [column.replace("\n", " ") or section.title for column in section.columns]
        rule = ["---", *["---:"] * (len(head) - 1)]
        lines = (head, rule, *section.rows)
        parts.append("\n".join(f"| {' | '.join(line)} |" for line in lines))
    return "\n\n".join(parts)
