"""Which jumps of the carriers may be gaps: those that no message denies.

A message that goes on over a jump in step denies that samples are missing there: by two frames
between which as much time passes as samples do, or by words of a run that hold on the far side of
a jump from its frames. Words that are out of step by whole symbols hold by chance (see
:mod:`.steps`), so that many must hold, of all satellites together.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..signals import satellite_name
from .bits import PAGE_BITS
from .missing import DRIFT, HEAD, LEAST_S, SATELLITES
from .steps import WORD

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from ..phase_jumps import PhaseJump
    from .records import Frame
    from .steps import Reach

LONGEST_S = 20.0
"""Two frames farther apart may miss a millisecond that the drift of a clock hides."""
BITS = {"LNAV": 5, "D1": 1, "D2": 1}
"""How much a word that holds says, as if each bit halved the chance that it is out of step. In D1
and D2 every other word holds one symbol off."""
ENOUGH_BITS = 20


@dataclass(frozen=True)
class Told:
    """Frames of a run, in order, and how far it is in step with each."""

    frames: Sequence[Frame]
    reach: Callable[[Frame], Reach]


def undenied(
    jumps: Iterable[PhaseJump], signals: Iterable[Sequence[Frame]], runs: Sequence[Told]
) -> list[PhaseJump]:
    """Those at which samples may be missing, by the frames of each signal and by single runs."""
    signals = tuple(signals)
    return [j for j in jumps if not _bridged(j, signals) and not _in_step(j, runs)]


def _bridged(jump: PhaseJump, signals: Iterable[Sequence[Frame]]) -> bool:
    """Whether frames of two satellites agree across it."""
    agree = set()
    for frames in signals:
        after = bisect_left(frames, jump.until_s, key=lambda f: f.time_s)
        before = bisect_right(frames, jump.from_s, key=_head_until_s)
        if before == 0 or after == len(frames):
            continue
        a, b = frames[before - 1], frames[after]
        passed_s, sampled_s = b.transmitted - a.transmitted, b.time_s - a.time_s
        same = abs(passed_s - sampled_s) < LEAST_S + DRIFT * passed_s
        if same and passed_s < LONGEST_S:
            agree.add(satellite_name(a.system, a.prn))
    return len(agree) >= SATELLITES


def _head_until_s(frame: Frame) -> float:
    """When a frame has told its time: one that begins before a gap may have told it after."""
    return frame.time_s + HEAD * frame.duration_s


def _in_step(jump: PhaseJump, runs: Iterable[Told]) -> bool:
    """Whether enough words hold beyond it."""
    bits: dict[str, int] = {}
    for run in runs:
        if not run.frames:
            continue
        frame = run.frames[0]
        name = satellite_name(frame.system, frame.prn)
        words = max((_words(jump, f, run.reach(f)) for f in run.frames), default=0)
        bits[name] = bits.get(name, 0) + words * BITS.get(frame.message, 0)
    several = sum(b > 0 for b in bits.values()) >= SATELLITES
    return several and sum(bits.values()) >= ENOUGH_BITS


def _words(jump: PhaseJump, frame: Frame, reach: Reach) -> int:
    """Words in step with a frame, wholly beyond a jump that lies before or after its start."""
    word_s = frame.duration_s * WORD / PAGE_BITS
    if frame.time_s >= jump.until_s:
        return sum(start_s + word_s <= jump.from_s for start_s in reach.before_s)
    if _head_until_s(frame) <= jump.from_s:
        return sum(end_s - word_s >= jump.until_s for end_s in reach.after_s)
    return 0
