"""The report of aided navigation: one offline HTML file with everything inside it."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING

from sdr_spoof.aided.records import Use, stretches
from sdr_spoof.errors import OutputError
from sdr_spoof.sinks.atomic import replacing

from . import aided_words
from .figures import aided as figures
from .html import LIBRARIES, flatten, template

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.aided.run import Aided


SMOOTHED = " Smoothed: what is known afterwards, from measurements before and after each instant."


@dataclass(frozen=True)
class Part:
    """A figure and what it shows."""

    title: str
    note: str
    figure: str


@dataclass(frozen=True)
class Row:
    """A stretch in which a satellite was left out."""

    name: str
    by: str
    from_s: float
    until_s: float


def write_aided_report(
    path: Path,
    aided: Aided,
    *,
    names: tuple[str, str],
    config: Mapping[str, object],
    truth_m: NDArray[np.float64] | None = None,
    force: bool = False,
) -> Path:
    """Write it; the same input gives the same bytes.

    Args:
        path: of the file.
        aided: what was found.
        names: of the observations and of the IMU's file.
        config: effective configuration, nested.
        truth_m: true antenna at the epochs of the track (E, 3), where it is known.
        force: replace a file that exists.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written.
    """
    if path.exists() and not force:
        raise OutputError(f"{path}: exists already; add --force to replace it")
    first, last = aided.span_s
    reference = aided.reference.utc()
    content = template("aided.html.j2").stream(
        words=aided_words,
        verdict=aided.verdict,
        level=aided_words.level(aided.verdict),
        name=names[0],
        imu=names[1],
        span=f"{last - first:.0f} s examined · {aided.satellites} satellites",
        parts=list(_parts(aided, truth_m)),
        excluded=list(_rows(aided)),
        story=aided.story,
        reference=f"{reference:%Y-%m-%d %H:%M:%S} UTC",
        config=list(flatten(config)),
        versions=[(name, version(name)) for name in LIBRARIES]
        + [("Python", platform.python_version())],
    )
    with replacing(path, force=force) as temporary:
        content.dump(str(temporary), encoding="utf-8")
    return path


def _parts(aided: Aided, truth_m: NDArray[np.float64] | None) -> Iterator[Part]:
    track = aided.track
    if track is not None:
        later = "" if track.smoothed is None else SMOOTHED
        wrong = "" if track.horizontal_one_wrong_m is None else "; dashed: or all but one of them"
        yield Part(
            "Map",
            "The way by GNSS alone, every satellite believed, and by the aided receiver. Shaded: "
            f"where it did not believe all satellites.{later}",
            figures.draw_map(track, truth_m),
        )
        what = "the truth" if truth_m is not None else "the aided place, since the truth is unknown"
        yield Part(
            "Error and protection levels",
            f"Distances from {what}. Green: what the aided place's error stays below with all but "
            f"{aided.risk:g} probability if the satellites in use are right{wrong}. Shaded red: "
            f"not all satellites are believed.{later}",
            figures.draw_errors(track, truth_m),
        )
        yield Part(
            "Satellites",
            "What the filter used, and whom it left out.",
            figures.draw_satellites(track),
        )
    if aided.monitors:
        yield Part(
            "Tests",
            "Each test by its threshold: from 1 on it alarms; dotted: its first alarm.",
            figures.draw_monitors(aided.monitors, track),
        )
    if aided.published:
        yield Part(
            "R statistics",
            "Published sums of squared deviations of GNSS from the INS, by what they reach without "
            f"interference. The published verdict: {aided.three_way}.",
            figures.draw_monitors(aided.published, track),
        )
    if aided.residuals:
        yield Part(
            "Rates by carrier phase against the INS",
            "What is left of the velocity after the INS's is taken off, with the threshold of the "
            "test in green; red where it is exceeded.",
            figures.draw_rates(aided.residuals, track),
        )


def _rows(aided: Aided) -> Iterator[Row]:
    """Stretches in which all were left out, then those of single satellites."""
    track = aided.track
    if track is None:
        return
    heard = track.use != Use.NONE
    everyone = heard.any(axis=1) & (~heard | (track.use == Use.EXCLUDED)).all(axis=1)
    for begin, end in stretches(track.time_s, everyone):
        yield Row("all", "the filter", begin, end)
    by = {Use.EXCLUDED: "the filter", Use.NAMED: "the receiver's detectors"}
    for k, name in enumerate(track.satellites):
        for use, who in by.items():
            for begin, end in stretches(track.time_s, (track.use[:, k] == use) & ~everyone):
                yield Row(name, who, begin, end)
