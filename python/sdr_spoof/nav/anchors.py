"""Which instant a code phase left the satellite: from decoded frames, and from other signals."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby, pairwise
from typing import TYPE_CHECKING

from .. import _core
from ..signals import satellite_name, signal_spec
from .missing import between
from .records import Anchor, Frame
from .steps import Reach
from .symbols import code_phase_at
from .time import GnssTime

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from ..gaps import Span
    from ..records import SignalTrack
    from .symbols import Stretch

AGREE_S = 0.5e-3
"""Frames of one run agree within this: half a period of the shortest code."""
SAME_TIME_S = 0.2
"""Signals of all satellites that arrive together left within this."""
CERTAIN_FRAMES = 2
"""So many frames that agree are believed against other satellites."""
SILENT_FRAMES = 2
"""A message has ended where so many frames did not come."""


def from_frames(
    frames: Sequence[Frame],
    stretch: Stretch,
    reach: Callable[[Frame], Reach] = lambda _: Reach(),
    gaps: Sequence[Span] = (),
) -> list[Anchor]:
    """Anchors of an unbroken stretch; more than one where its frames tell of a jump in time.

    Args:
        frames: of the stretch, in order.
        stretch: where they are from.
        reach: says how far what is around a frame is in step with it.
        gaps: samples are missing somewhere within; there, only what was seen to be in step counts.
    """
    groups: list[list[Frame]] = []
    for _, part in groupby(frames, lambda f: sum(begin < f.time_s for begin, _ in gaps)):
        groups += _agreeing(part)
    gaps = [*gaps, *_jumps(groups, reach, gaps)]
    return [
        Anchor(
            stretch.signal,
            stretch.prn,
            *_bounds(group, stretch, reach, gaps),
            code_phase_chips=group[0].code_phase_chips,
            transmitted=group[0].transmitted,
        )
        for group in groups
    ]


def _agreeing(frames: Iterable[Frame]) -> list[list[Frame]]:
    """Groups of frames that agree on the time."""
    groups: list[list[Frame]] = []
    for frame in frames:
        if groups and _agree(groups[-1][-1], frame):
            groups[-1].append(frame)
        else:
            groups.append([frame])
    if len(groups) > 1 and any(len(g) >= CERTAIN_FRAMES for g in groups):
        # A single frame between others that agree is one whose time was misread.
        groups = _joined([g for g in groups if len(g) >= CERTAIN_FRAMES])
    return groups


def _jumps(
    groups: Sequence[Sequence[Frame]], reach: Callable[[Frame], Reach], gaps: Sequence[Span]
) -> list[Span]:
    """Where the time jumps between groups of frames, beyond gaps that are known."""
    spans = [
        between(a[-1], reach(a[-1]), b[0], reach(b[0]))
        for a, b in pairwise(groups)
        if not any(a[-1].time_s < end and begin < b[0].end_s for begin, end in gaps)
    ]
    return spans


def _bounds(
    group: Sequence[Frame],
    stretch: Stretch,
    reach: Callable[[Frame], Reach],
    gaps: Sequence[Span],
) -> Span:
    """From and until when the time that frames tell holds."""
    before = [end for begin, end in gaps if begin < group[0].end_s and end <= group[0].end_s]
    after = [begin for begin, end in gaps if end > group[-1].time_s and begin >= group[-1].time_s]
    from_s = max(before) if before else reach(group[0]).from_s
    until_s = min(after) if after else reach(group[-1]).until_s
    return max(stretch.from_s, from_s), min(stretch.until_s, until_s)


def _agree(a: Frame, b: Frame) -> bool:
    chips = b.code_phase_chips - a.code_phase_chips
    elapsed = chips / signal_spec(a.signal).chip_rate_hz
    return abs((b.transmitted - a.transmitted) - elapsed) < AGREE_S


def _joined(groups: list[list[Frame]]) -> list[list[Frame]]:
    joined = groups[:1]
    for group in groups[1:]:
        if _agree(joined[-1][-1], group[0]):
            joined[-1] = joined[-1] + group
        else:
            joined.append(group)
    return joined


def jumps(found: Sequence[Anchor], told: Sequence[Span] = ()) -> list[str]:
    """Sentences on the jumps between the anchors of one unbroken stretch, unless already told."""
    notes = []
    for a, b in pairwise(found):
        if any(begin <= b.from_s and a.until_s <= end for begin, end in told):
            continue
        name = satellite_name(signal_spec(a.signal).system, a.prn)
        jump = b.transmitted - at(a, b.code_phase_chips)
        notes.append(
            f"{name} {a.signal}: its time jumps by {jump:+.3f} s between {a.until_s:.1f} and "
            f"{b.from_s:.1f} s, as if samples were missing from the recording"
        )
    return notes


def silences(frames: Sequence[Frame], stretch: Stretch) -> list[str]:
    """A sentence on a signal that goes on after its message has ended.

    Missing samples of a whole number of code periods shift the symbols and nothing else: the loops
    go on, no frame follows, and the time is wrong by as much.
    """
    if not frames:
        return []
    last = frames[-1]
    end_s = last.end_s
    if stretch.until_s - end_s < SILENT_FRAMES * last.duration_s:
        return []
    name = satellite_name(last.system, last.prn)
    return [
        f"{name} {last.signal}: no message was received after {end_s:.1f} s, though the signal "
        "goes on: if samples are missing from the recording, times from there on are wrong"
    ]


def exact(found: Sequence[Anchor], stretch: Stretch) -> list[Anchor]:
    """Those of a stretch's anchors that tell the time exactly: up to the first jump that is no
    whole number of symbols, since it moved the symbols against the count of code periods.
    """
    kept = list(found[:1])
    for a, b in pairwise(found):
        jump_s = b.transmitted - at(a, b.code_phase_chips)
        symbols = jump_s / _symbol_s(stretch)
        if abs(symbols - round(symbols)) * _symbol_s(stretch) > AGREE_S:
            break
        kept.append(b)
    return kept


def _symbol_s(stretch: Stretch) -> float:
    spec = signal_spec(stretch.signal)
    return (_core.periods_per_symbol(stretch.signal, stretch.prn) or 1) * spec.period_s


def at(anchor: Anchor, code_phase_chips: float) -> GnssTime:
    """When a code phase left the satellite."""
    later = code_phase_chips - anchor.code_phase_chips
    return anchor.transmitted + later / signal_spec(anchor.signal).chip_rate_hz


def from_others(
    stretch: Stretch,
    track: SignalTrack,
    others: Sequence[tuple[Anchor, SignalTrack]],
    gaps: Sequence[Span] = (),
) -> list[Anchor]:
    """Anchors of a stretch from those of other signals of the satellite at the same time.

    One for all of the stretch; where they tell of a jump in time, each as far as the other holds,
    and none beyond gaps.
    """
    found: list[tuple[Anchor, Anchor]] = []
    for other, other_track in others:
        anchor = _from_other(stretch, track, other, other_track)
        if anchor is not None:
            found.append((_up_to(gaps, anchor, other), other))
    if not found:
        return []
    first = found[0][0]
    if all(abs(at(a, first.code_phase_chips) - first.transmitted) < AGREE_S for a, _ in found):
        return [first]
    return [
        replace(a, from_s=max(a.from_s, o.from_s), until_s=min(a.until_s, o.until_s))
        for a, o in found
    ]


def _up_to(gaps: Sequence[Span], anchor: Anchor, other: Anchor) -> Anchor:
    """An anchor that does not reach over gaps which the other, from which it is, does not."""
    from_s, until_s = anchor.from_s, anchor.until_s
    for begin, end in gaps:
        if other.until_s <= end:
            until_s = min(until_s, begin)
        if other.from_s >= begin:
            from_s = max(from_s, end)
    return replace(anchor, from_s=from_s, until_s=until_s)


def _from_other(
    stretch: Stretch, track: SignalTrack, anchor: Anchor, other: SignalTrack
) -> Anchor | None:
    """Anchor of a stretch from another signal's; None where they do not overlap.

    Signals of one satellite leave together and arrive together to far below half a code period;
    their codes begin at whole multiples of their periods.
    """
    begin, end = max(stretch.from_s, anchor.from_s), min(stretch.until_s, anchor.until_s)
    if begin >= end:
        return None
    spec = signal_spec(stretch.signal)
    middle = 0.5 * (begin + end)
    phase = code_phase_at(track, middle)
    period = int(phase // spec.code_length)
    chips = float(period * spec.code_length)
    sent = at(anchor, code_phase_at(other, middle)) + (chips - phase) / spec.chip_rate_hz
    per_second = round(1.0 / spec.period_s)
    return Anchor(
        signal=stretch.signal,
        prn=stretch.prn,
        from_s=stretch.from_s,
        until_s=stretch.until_s,
        code_phase_chips=chips,
        transmitted=GnssTime(sent.seconds) + round(sent.fraction * per_second) / per_second,
    )
