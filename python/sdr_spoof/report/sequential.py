"""The report of sequential tests against an INS and DME."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.dme.course import fix_course
from sdr_spoof.aiding.dme.statistics import STATISTICS

from . import sequential_words as words
from .figures.looks import Look, azimuth_elevation_deg
from .figures.sequential_place import ALL, DRIFT, draw_places
from .page import Page, Part, Row, Table, listed
from .words import times

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from sdr_spoof.aiding.dme.config import SequentialConfig
    from sdr_spoof.aiding.dme.judge import Judgement
    from sdr_spoof.aiding.dme.watch import Watched
    from sdr_spoof.nav.time import GnssTime

MOST_FIXES = 600
"""Of the picture of the fix over time."""
LIMITS = (
    "“No spoofing found” means that the tests found nothing. What each of them cannot see is "
    "listed under Tests. Ranges cannot tell a majority of satellites that is moved alike from "
    "healthy ones with another clock."
)
LEARNT = (
    " The drift of the INS is learnt from the satellites, and with it drags that are no faster "
    "than it may drift."
)


def sequential_page(
    found: Judgement,
    watched: Sequence[Watched],
    config: SequentialConfig,
    *,
    name: str,
    by: Sequence[str],
    reference: GnssTime | None,
    picture: bytes,
    notes: Sequence[str] = (),
) -> Page:
    """What the report says.

    Args:
        found: what the tests found.
        watched: the course of their statistics.
        config: how they were made.
        name: of the observations.
        by: names of the files of INS and DME.
        reference: what times count from.
        picture: of the statistics, PNG.
        notes: what reading the files had to say.
    """
    time_s = found.differences.time_s
    span = f"{np.ptp(time_s):.0f} s examined · {found.differences.count} satellites"
    since = "the first epoch's own zero" if reference is None else f"{_utc(reference)} UTC"
    return Page(
        subject=name,
        by=f", against {listed(by)}",
        span=span,
        level=words.level(found),
        headline=words.headline(found),
        sentences=tuple(words.sentences(found)),
        facts=tuple(_facts(found, config)),
        notes=(*notes, *found.notes),
        parts=tuple(_parts(found, watched, config, picture)),
        times=f"times are seconds of system time since {since}",
    )


def _utc(reference: GnssTime) -> str:
    return f"{reference.utc():%Y-%m-%d %H:%M:%S}"


def _facts(found: Judgement, config: SequentialConfig) -> Iterator[tuple[str, str]]:
    yield "Why", words.why(found)
    if found.alarm_s is not None:
        yield "How sure", words.sureness(found)
        yield "What to do", words.action(found)
    if (where := words.place(found)) is not None:
        yield "The fix", where
    if config.ins_grade is not None:
        yield "The INS", words.drift(found, config)
    yield "What was tested", words.tested(found)
    yield "Limits", LIMITS


def _parts(
    found: Judgement, watched: Sequence[Watched], config: SequentialConfig, picture: bytes
) -> Iterator[Part]:
    if watched:
        yield Part(
            "Statistics against their thresholds",
            f"What the rule “{config.rule}” has gathered over time, a line a channel: over the "
            "dashed line it alarms; the upright one is the first alarm of all. Right: the samples "
            "before it and the normal law that the thresholds rest on.",
            (("Statistics of all channels", picture),),
        )
    yield Part(
        "Satellites and stations",
        "Largest statistic by its threshold, from 1 on it alarms, and when; –: not judged. Drawn "
        "by the others: it alarms only since it is compared with those that are spoofed; without "
        "them, it agrees.",
        table=_channels(found, watched),
    )
    yield _geometry(found, config)
    yield _tests(found, config)


def _channels(found: Judgement, watched: Sequence[Watched]) -> Table:
    """A row a satellite, then the pairs of stations; two columns a test."""
    tests = list(dict.fromkeys(t.test for t in found.tested))
    largest = {(w.test, w.channel): float(np.nanmax(w.path)) / w.threshold for w in watched}
    alarm = {(t.test, t.channel): t.decided for t in found.tested}
    rows = []
    for channel in dict.fromkeys(t.channel for t in found.tested):
        cells = [channel, _said(found, channel)]
        for test in tests:
            size, decided = largest.get((test, channel)), alarm.get((test, channel))
            cells.append("–" if size is None else times(size))
            cells.append("" if decided is None else f"{decided.alarm_s:.1f}")
        rows.append(Row(tuple(cells), _level(found, channel)))
    columns = [c for test in tests for c in (words.TITLES[test], "Alarm (s)")]
    return Table(("Channel", "Verdict", *columns), tuple(rows), ("Channel", "Verdict"), "Verdict")


def _level(found: Judgement, channel: str) -> str:
    if channel in found.spoofed:
        return "spoofed"
    of = [t for t in found.tested if t.channel == channel]
    if all(t.note for t in of):
        return "unsupported"
    if found.captured:
        satellite = channel in found.differences.satellites
        doubted = not found.spoofed if satellite else any(t.decided for t in of)
    else:
        named = found.isolation is not None and found.isolation.satellites is not None
        doubted = not named and any(t.decided for t in of)
    return "suspect" if doubted else "clean"


def _said(found: Judgement, channel: str) -> str:
    level, satellite = _level(found, channel), channel in found.differences.satellites
    if level == "suspect" and found.captured:
        return "contradicted by DME" if satellite else "contradicts them"
    if level == "clean" and any(t.decided for t in found.tested if t.channel == channel):
        return "drawn by the others"
    return {"clean": "no objection", "unsupported": "not tested"}.get(level, level)


def _geometry(found: Judgement, config: SequentialConfig) -> Part:
    differences = found.differences
    epochs = np.unique(
        np.linspace(0, differences.time_s.size - 1, MOST_FIXES).round().astype(np.int64)
    )
    offsets = {ALL: fix_course(differences, epochs)}
    if found.spoofed:
        out = [differences.satellites.index(s) for s in found.spoofed]
        offsets[f"without {listed(found.spoofed)}"] = fix_course(differences, epochs, out)
    if config.ins_grade is not None:
        offsets[DRIFT] = -differences.error_m[epochs]
    looks = list(_looks(found, epochs))
    picture = draw_places(looks, differences.time_s[epochs], offsets, found.alarm_s)
    return Part(
        "Where they stand",
        "Left: the sky, with DME stations. Right: how far a fix by least squares of each epoch is "
        "from where the INS says; an INS that drifts or is captured moves it too.",
        (("Sky, and distance of the fix from the INS", picture),),
        _where(looks, np.nanmean(differences.sigma_m, axis=0)),
    )


def _looks(found: Judgement, epochs: NDArray[np.int64]) -> Iterator[Look]:
    differences = found.differences
    seen = np.isfinite(differences.differences_m)[epochs]
    for k in range(seen.shape[1]):
        unit = np.where(seen[:, k, None], differences.to[epochs, k], np.nan)
        if k < differences.count:
            yield Look(differences.satellites[k], unit, _level(found, differences.satellites[k]))
        else:
            yield Look(f"DME {k - differences.count + 1}", unit, "station")


def _where(looks: Sequence[Look], sigma_m: NDArray[np.float64]) -> Table:
    rows = []
    for look, sigma in zip(looks, sigma_m, strict=True):
        place = azimuth_elevation_deg(look.unit[np.isfinite(look.unit).all(axis=1)])
        cells = (
            [f"{a:.0f}°, {e:.0f}°" for a, e in (place[0], place[-1])] if place.size else ["–"] * 2
        )
        rows.append(Row((look.name, *cells, f"{sigma:.1f}")))
    columns = ("Transmitter", "Azimuth, elevation at first", "at last", "Noise (m)")
    return Table(columns, tuple(rows), ("Transmitter",))


def _tests(found: Judgement, config: SequentialConfig) -> Part:
    """What each test asks and cannot see, and by what it decides."""
    learnt = LEARNT if config.ins_grade is not None else ""
    names = list(dict.fromkeys(t.test for t in found.tested))
    rows = [Row((words.TITLES[n], STATISTICS[n].tests, STATISTICS[n].blind_to)) for n in names]
    columns = ("Test", "What it tests", "What it cannot see")
    each = config.false_alarms_per_hour
    return Part(
        "Tests",
        f"All together raise a false alarm in an hour with a probability of {each:g}, shared "
        f"equally by {len(found.tested)} channels, as long as noise is white and normal; the "
        f"first {config.baseline_s:g} s and the first third of the samples tell whether it is."
        + learnt,
        table=Table(columns, tuple(rows), columns),
    )
