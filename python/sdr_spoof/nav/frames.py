"""From tracks to what satellites say: frames, ephemerides, time anchors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby
from typing import TYPE_CHECKING

from ..gaps import gaps_of, sentences, uncounted
from ..phase_jumps import phase_jumps_of
from ..phase_jumps import sentences as told_of_jumps
from ..signals import satellite_name, signal_spec
from . import anchors
from .broadcast import Contents
from .messages import MESSAGES, message_on
from .missing import missing, out_of_step, outages, overlap, touch
from .missing import sentences as told_in_words
from .plausible import objection
from .possible_gaps import Told, undenied
from .records import Anchor, Frame, Navigation, SymbolRun
from .symbols import Stretch, stretches_of, symbols_of
from .weeks import dated

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from ..gaps import Gap, Span
    from ..phase_jumps import PhaseJump
    from ..records import SignalTrack, TrackLog
    from .missing import Missing
    from .records import Message
    from .steps import Reach
    from .time import GnssTime

__all__ = ["Anchor", "Frame", "Navigation", "decode", "decode_runs"]

LENDINGS = 2
"""A pilot that outlives the signal whose message dated it dates that one again."""


@dataclass(frozen=True)
class _Decoded:
    """Frames of one run, and the stretch of the track that it is from."""

    stretch: Stretch
    frames: tuple[Frame, ...]
    reach: Callable[[Frame], Reach]
    """How far the run is in step with a frame."""


def decode(log: TrackLog, near: GnssTime | None = None) -> Navigation:
    """Decode all messages in a log.

    ``near`` is any instant within some hours of the recording, where it is known: recordings too
    short for the week to be sent need it, and it resolves rollovers.
    """
    decoded = [d for t in log.signals for d in _decoded(t, uncounted(log, t), near)]
    alive = [s for t in log.signals for s in stretches_of(t, uncounted(log, t))]
    lost = outages([(s.from_s, s.until_s) for s in alive], log.duration_s)
    navigation, gaps = _navigation(decoded, near, gaps_of(log), lost, phase_jumps_of(log))
    found = navigation.anchors
    for _ in range(LENDINGS):
        found = (*found, *_borrowed(log, found, gaps))
    return replace(navigation, anchors=found)


def decode_runs(runs: Iterable[SymbolRun], near: GnssTime | None = None) -> Navigation:
    """Decode runs of symbols, whose track is not at hand; see :func:`decode`."""
    decoded = []
    for run in runs:
        message = message_on(run.signal, run.prn)
        if message is not None:
            end = float(run.time_s[-1]) + run.symbol_s
            stretch = Stretch(run.signal, run.prn, float(run.time_s[0]), end)
            decoded.append(_decode_run(message, run, stretch, near))
    return _navigation(decoded, near)[0]


def _navigation(
    decoded: list[_Decoded],
    near: GnssTime | None,
    seen: Sequence[Gap] = (),
    lost: Sequence[Span] = (),
    jumps: Sequence[PhaseJump] = (),
) -> tuple[Navigation, list[Span]]:
    """What frames say, and within which spans samples are missing; ``seen`` by the tracker, or
    perhaps missing as all was ``lost`` or the carriers jumped."""
    decoded, notes = _with_weeks(decoded, near)
    signals, reach = _by_signal(decoded)
    gaps = missing(signals, reach)
    told = [m.span for m in gaps]
    unexplained = [g for g in seen if not any(overlap(g.span, t) for t in told)]
    for spans in ([g.span for g in seen], out_of_step(_ends(decoded)), lost):
        told += [span for span in spans if not any(touch(span, other) for other in told)]
    jumps = [j for j in jumps if not any(touch(j.span, other) for other in told)]
    jumps = undenied(jumps, signals, [Told(d.frames, d.reach) for d in decoded])
    told += [j.span for j in jumps]
    notes = [*sentences(unexplained), *told_in_words(gaps), *told_of_jumps(jumps), *notes]
    notes += _disagreements(decoded, gaps)
    found = []
    for d in decoded:
        own = anchors.from_frames(d.frames, d.stretch, d.reach, told)
        notes += anchors.jumps(own, told) + anchors.silences(d.frames, d.stretch)
        found += anchors.exact(own, d.stretch)
    frames = tuple(sorted((f for d in decoded for f in d.frames), key=lambda f: f.time_s))
    contents, more = _contents(frames)
    anchored, notes = tuple(found), [*notes, *more]
    navigation = Navigation(**vars(contents), frames=frames, anchors=anchored, notes=tuple(notes))
    return navigation, told


def _ends(decoded: Iterable[_Decoded]) -> list[tuple[str, Reach, Reach]]:
    """Of each run with frames its satellite, and what is in step with the first and the last."""
    return [
        (
            satellite_name(d.frames[0].system, d.frames[0].prn),
            d.reach(d.frames[0]),
            d.reach(d.frames[-1]),
        )
        for d in decoded
        if d.frames
    ]


def _by_signal(
    decoded: Iterable[_Decoded],
) -> tuple[list[list[Frame]], Callable[[Frame], Reach]]:
    """The frames of each signal in order of time, and what is in step with one."""
    signals: dict[tuple[str, int], list[Frame]] = {}
    reach: dict[int, Callable[[Frame], Reach]] = {}
    for d in decoded:
        signals.setdefault((d.stretch.signal, d.stretch.prn), []).extend(d.frames)
        reach |= {id(f): d.reach for f in d.frames}
    in_order = [sorted(frames, key=lambda f: f.time_s) for frames in signals.values()]
    return in_order, lambda frame: reach[id(frame)](frame)


def _decoded(
    track: SignalTrack, uncounted: Sequence[Span], near: GnssTime | None
) -> list[_Decoded]:
    """Frames of a track by run; of a pilot those of its companion, in the pilot's count."""
    decoded = []
    stretches = stretches_of(track, uncounted)
    for run in symbols_of(track, uncounted):
        message = message_on(run.signal, run.prn)
        if message is None:
            return []
        begin = float(run.time_s[0])
        inside = [s for s in stretches if s.from_s <= begin + run.symbol_s <= s.until_s]
        if inside:
            decoded.append(_decode_run(message, run, inside[0], near))
    return decoded


def _decode_run(
    message: Message, run: SymbolRun, stretch: Stretch, near: GnssTime | None
) -> _Decoded:
    return _Decoded(stretch, tuple(message.decode(run, near)), partial(message.reach, run))


def _with_weeks(decoded: list[_Decoded], near: GnssTime | None) -> tuple[list[_Decoded], list[str]]:
    """Date the frames of runs that told no week by those of others, which arrived together."""
    told = [f for d in decoded for f in d.frames if f.week_known]
    if not told:
        if near is None and any(d.frames for d in decoded):
            note = "no satellite told the week: give the date of the recording to use its time"
            return [replace(d, frames=()) for d in decoded], [note]
        return decoded, []
    starts = sorted(f.transmitted + -f.time_s for f in told)
    start = starts[len(starts) // 2]

    def date(frame: Frame) -> Frame:
        return frame if frame.week_known else dated(frame, start + frame.time_s)

    return [replace(d, frames=tuple(date(f) for f in d.frames)) for d in decoded], []


def _disagreements(decoded: list[_Decoded], gaps: Sequence[Missing]) -> list[str]:
    """Runs whose time differs from that of most others by more than travel times can."""
    frames = [d.frames[0] for d in decoded if d.frames]
    if len(frames) < 3:
        return []

    def missing_s(frame: Frame) -> float:
        return sum(g.missing_s for g in gaps if g.until_s < frame.end_s)

    starts = [f.transmitted + (-f.time_s - missing_s(f)) for f in frames]
    middle = sorted(starts)[len(starts) // 2]
    return [
        f"{satellite_name(f.system, f.prn)} {f.signal} tells a time {start - middle:+.3f} s from "
        f"that of the others: it is wrong, repeated late or not from the satellite"
        for f, start in zip(frames, starts, strict=True)
        if abs(start - middle) > anchors.SAME_TIME_S
    ]


def _borrowed(log: TrackLog, known: tuple[Anchor, ...], gaps: Sequence[Span]) -> list[Anchor]:
    """Anchors of stretches that have none, from another signal of the satellite."""
    tracks = {(t.signal, t.prn): t for t in log.signals}
    borrowed = []
    for track in log.signals:
        system = signal_spec(track.signal).system
        others = [
            a
            for a in known
            if a.prn == track.prn
            and a.signal != track.signal
            and signal_spec(a.signal).system == system
        ]
        own = [a for a in known if (a.signal, a.prn) == (track.signal, track.prn)]
        for stretch in stretches_of(track, uncounted(log, track)) if others else ():
            if any(a.from_s < stretch.until_s and stretch.from_s < a.until_s for a in own):
                continue
            borrowed += anchors.from_others(
                stretch, track, [(a, tracks[a.signal, a.prn]) for a in others], gaps
            )
    return borrowed


def _contents(frames: tuple[Frame, ...]) -> tuple[Contents, list[str]]:
    """What frames say, satellite by satellite; and what cannot be."""

    def key(frame: Frame) -> tuple[str, int, str]:
        return frame.message, frame.prn, frame.signal

    contents, notes = Contents(), []
    for (message, prn, _), group in groupby(sorted(frames, key=key), key):
        read = MESSAGES[message].read(sorted(group, key=lambda f: f.transmitted))
        objections = {e: objection(e) for e in read.ephemerides}
        notes += [
            f"an ephemeris of {satellite_name(e.system, prn)} in {message} is left out: {why}"
            for e, why in objections.items()
            if why is not None
        ]
        good = tuple(e for e, why in objections.items() if why is None)
        contents += replace(read, ephemerides=good)
    return contents, notes
