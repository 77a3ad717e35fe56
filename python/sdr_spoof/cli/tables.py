"""Tables of records for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

from sdr_spoof.records import State
from sdr_spoof.signals import signal_spec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.pipeline import TruthComparison
    from sdr_spoof.records import Acquisition, SignalTrack


def table(title: str, *columns: str, left: Sequence[str] = ()) -> Table:
    """Build an empty table; numbers go to the right, columns named in ``left`` to the left."""
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
    head = (track.signal, str(track.prn), str(track.time_s.size))
    if not track.time_s.size:
        return (*head, "-", "-", "-", "-", "-")
    return (
        *head,
        f"{track.time_s[-1]:.3f}",
        f"{track.cn0_dbhz[-1]:.1f}",
        f"{track.doppler_hz[-1]:+.1f}",
        f"{track.phase_lock[-1]:.2f}",
        State(int(track.state[-1])).name.lower(),
    )


def truth(comparison: Sequence[TruthComparison]) -> Table:
    """What was synthesised against what was found, one row per satellite."""
    made = table(
        "Against the truth",
        *("PRN", "attacked", "captured s", "dragged from s", "verdict", "band", "onset s"),
        left=["attacked", "verdict", "band"],
    )
    for c in comparison:
        made.add_row(
            *(f"{c.system}{c.prn:02d}", ", ".join(c.attacked) or "no"),
            *(_seconds(c.capture_s), _seconds(c.drag_start_s)),
            *(c.verdict, c.band or "-", _seconds(c.onset_s)),
        )
    return made


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"
