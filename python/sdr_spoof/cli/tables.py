"""Tables of records for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sdr_spoof.records import State
from sdr_spoof.signals import signal_spec

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rich.table import Table

    from sdr_spoof.pipeline import TruthComparison
    from sdr_spoof.records import Acquisition, SignalTrack


def table(title: str, *columns: str, left: Sequence[str] = ()) -> Table:
    """Build an empty table; numbers go to the right, columns named in ``left`` to the left."""
    from rich import box  # noqa: PLC0415 - slow to import
    from rich.table import Table  # noqa: PLC0415

    made = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left", title_style="bold")
    for column in columns:
        made.add_column(column, justify="left" if column in left else "right")
    return made


def acquisitions(found: Sequence[Acquisition]) -> Table:
    """One row per detected signal; code phase in chips at the sample of the estimate."""
    made = table(
        "Acquired signals",
        *("signal", "PRN", "C/N0 dB-Hz", "Doppler Hz", "delay chips", "statistic", "threshold"),
        left=["signal"],
    )
    for a in found:
        if a.detected:
            chips = a.code_delay_s * signal_spec(a.signal).chip_rate_hz
            made.add_row(
                *(a.signal, str(a.prn), f"{a.cn0_dbhz:.1f}", f"{a.doppler_hz:+.1f}"),
                *(f"{chips:.2f}", f"{a.statistic:.1f}", f"{a.threshold:.1f}"),
            )
    return made


def tracks(signals: Sequence[SignalTrack]) -> Table:
    """One row per tracked signal, its state and estimates at the end."""
    made = table(
        "Tracked signals",
        *("signal", "PRN", "epochs", "until s", "C/N0 dB-Hz", "Doppler Hz", "lock", "state"),
        left=["signal", "state"],
    )
    for t in signals:
        made.add_row(*_track_row(t))
    return made


def _track_row(track: SignalTrack) -> tuple[str, ...]:
    head = (track.signal, str(track.prn), str(track.epochs))
    if not track.epochs:
        return (*head, "-", "-", "-", "-", "-")
    last = track.part(track.epochs - 1, track.epochs)
    return (
        *head,
        f"{last.time_s[0]:.3f}",
        f"{last.cn0_dbhz[0]:.1f}",
        f"{last.doppler_hz[0]:+.1f}",
        f"{last.phase_lock[0]:.2f}",
        State(int(last.state[0])).name.lower(),
    )


def scenarios(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Name, title and length of each scenario that comes with the package."""
    made = table("Scenarios", "name", "length s", "what it shows", left=["name", "what it shows"])
    for row in rows:
        made.add_row(row["name"], f"{row['duration_s']:g}", row["title"])
    return made


def truth(comparison: Sequence[TruthComparison]) -> Table:
    """What was synthesised against what was found, one row per satellite."""
    made = table(
        "Against the truth",
        *("satellite", "truth", "verdict", "right"),
        left=["satellite", "truth", "verdict", "right"],
    )
    for c in comparison:
        name, bands = f"{c.system}{c.prn:02d}", _bands(c.attacked)
        true = f"{bands} spoofed from {c.start_s:.2f} s" if c.attacked else "untouched"
        found = c.verdict
        if c.onset_s is not None:
            found = f"{_bands([c.band] if c.band else [])} spoofed, onset {c.onset_s:.2f} s"
        made.add_row(name, true, found, "yes" if c.agrees else "NO")
    return made


def timeline(c: TruthComparison) -> str:
    """The course of an attack against what was found, in words; empty where there is none."""
    if c.start_s is None:
        return ""
    steps = [f"came on the air at {c.start_s:.2f} s"]
    if c.capture_s is not None:
        steps.append(f"was as strong as the satellite at {c.capture_s:.2f} s")
    if c.drag_start_s is not None:
        steps.append(f"began to drag at {c.drag_start_s:.2f} s")
    course = f"{', '.join(steps[:-1])} and {steps[-1]}" if len(steps) > 1 else steps[0]
    if c.onset_s is None or c.alarm_s is None:
        return f"The spoofer {course}. It was not found."
    late_s, alarm_s = c.onset_s - c.start_s, c.alarm_s - c.start_s
    side = "after" if late_s >= 0.0 else "before"
    return (
        f"The spoofer {course}. Found: onset estimated at {c.onset_s:.2f} s, {abs(late_s):.2f} s "
        f"{side} it came on the air; alarm at {c.alarm_s:.2f} s, {alarm_s:.2f} s after."
    )


def _bands(signals: Sequence[str]) -> str:
    names = dict.fromkeys(signal_spec(s).composite for s in signals)
    return ", ".join(names) or "one band"


def cell(value: Any) -> str:
    """A value of any table."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
