"""The report of an antenna array: which signals do not come from the sky."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ndtr

from sdr_spoof.aiding.array.verdict import CLEAN, NO_SUPPORT, SPOOFED

from .aided_words import LEVELS
from .figures.array_way import draw_way
from .figures.looks import Look
from .page import Page, Part, Row, Table, listed
from .sequential_words import HEADLINES, by_noise

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sdr_spoof.aiding.array.config import ArrayConfig
    from sdr_spoof.aiding.array.examine import Finding, Vehicle
    from sdr_spoof.aiding.array.geometry import AntennaArray

LOOKS = 200
"""Epochs of the sky's picture."""
MOTION = (
    "Motion of the direction",
    "whether the direction of a signal, freed from the vehicle's attitude, stands still while the "
    "vehicle moves on, as a satellite's does and a near transmitter's does not",
    "a transmitter along the line of motion, or one that moves with the vehicle; several far away; "
    "anything before the first metres of way",
)
ARRIVAL = (
    "Direction of arrival",
    "whether a signal comes from where the ephemeris has its satellite; the vehicle may stand",
    "a transmitter in the direction of the satellite, or in one that differs from it by whole "
    "cycles; errors of the INS's level, and delays of the lines beyond their stated error, look "
    "like an attack",
)


def array_page(
    findings: Sequence[Finding],
    array: AntennaArray,
    vehicle: Vehicle,
    config: ArrayConfig,
    *,
    name: str,
    known: bool,
    calibrated: bool,
    picture: bytes,
) -> Page:
    """What the report says.

    Args:
        findings: of all signals.
        array: the antennas.
        vehicle: what the INS said.
        config: how was tested.
        name: of the reference's recording.
        known: whether orbits were.
        calibrated: whether the lines are, so that directions of arrival were tested.
        picture: of the scores, PNG.
    """
    said = _verdict(findings)
    return Page(
        subject=name,
        by=f" and {len(array.baselines_m)} other antennas",
        span=f"{np.ptp(vehicle.time_s):.0f} s examined · {len(findings)} signals",
        level=LEVELS[said],
        headline=HEADLINES[said],
        sentences=tuple(_sentences(findings)),
        facts=tuple(_facts(findings, config)),
        notes=tuple(_notes(findings, known=known, calibrated=calibrated)),
        parts=tuple(_parts(findings, array, vehicle, config, picture, calibrated=calibrated)),
        times="times are seconds since the first sample of the recordings",
    )


def _verdict(findings: Sequence[Finding]) -> str:
    found = {f.verdict for f in findings}
    return next((v for v in (SPOOFED, CLEAN) if v in found), NO_SUPPORT)


def _spoofed(findings: Sequence[Finding]) -> list[Finding]:
    return [f for f in findings if f.verdict == SPOOFED]


def _name(f: Finding) -> str:
    return f"{f.satellite} {f.signal}"


def _sentences(findings: Sequence[Finding]) -> Iterator[str]:
    for f in _spoofed(findings):
        yield f"{_name(f)} does not come from its satellite; found at {f.alarm_s:.1f} s."


def _facts(findings: Sequence[Finding], config: ArrayConfig) -> Iterator[tuple[str, str]]:
    spoofed = _spoofed(findings)
    for k, f in enumerate(spoofed):
        yield "" if k else "Why", f"{_name(f)}: {f.reason}"
    if spoofed:
        yield "How sure", by_noise(_by_chance(findings))
        names = sorted({f.satellite for f in spoofed})
        yield "What to do", f"leave {listed(names)} out, and search for the transmitter near by"
    elif findings:
        yield "Why", "no direction has moved or arrived other than a satellite's"
    tested = [f for f in findings if f.verdict != NO_SUPPORT]
    way = max((float(f.way_m.max()) for f in tested if f.way_m.size), default=0.0)
    tests = sum(_tests(f) for f in tested)
    yield (
        "What was tested",
        f"{len(tested)} of {len(findings)} signals, {tests} tests, over up to {way:.0f} m of way",
    )
    yield (
        "Limits",
        "“No spoofing found” means that the tests found nothing; what they cannot see is listed "
        f"under Tests. All together raise a false alarm in a recording with a probability of "
        f"{config.false_alarm_probability:g}. When it began is not told: an alarm comes once the "
        "vehicle has gone far enough.",
    )


def _tests(f: Finding) -> int:
    return int(f.time_s.size) + (int(f.arrivals.time_s.size) if f.arrivals else 0)


def _by_chance(findings: Sequence[Finding]) -> float:
    """Probability that noise alone gives so large a score in any of the tests."""
    scores = [f.score for f in findings] + [f.arrivals.score for f in findings if f.arrivals]
    largest = max(float(s.max()) for s in scores if s.size)
    tests = sum(_tests(f) for f in findings)
    return min(1.0, tests * float(ndtr(-largest)))


def _notes(findings: Sequence[Finding], *, known: bool, calibrated: bool) -> Iterator[str]:
    for f in findings:
        if f.verdict == NO_SUPPORT:
            yield f"{_name(f)}: {f.reason}"
    if not findings:
        yield "No signal was held on all antennas."
    if not known:
        yield (
            "No orbits (--nav, and a recording that knows its time): satellites are taken to stand "
            "still, which holds for half a minute."
        )
    if not calibrated:
        yield (
            "Directions of arrival were not tested: they need lines whose lengths are calibrated "
            "(--lines)."
        )


def _parts(
    findings: Sequence[Finding],
    array: AntennaArray,
    vehicle: Vehicle,
    config: ArrayConfig,
    picture: bytes,
    *,
    calibrated: bool,
) -> Iterator[Part]:
    if any(_tests(f) for f in findings):
        yield Part(
            "Tests against their threshold",
            f"The form “{config.form}” of the test of motion, as a normal deviate: a test each "
            f"{config.test_every_m:g} m of way. A source over the dashed line is no satellite.",
            (("Scores of all signals over time", picture),),
        )
    yield Part("Signals", table=_signals(findings))
    alarms = [
        (_name(f), int(np.searchsorted(vehicle.time_s, f.alarm_s)))
        for f in _spoofed(findings)
        if f.alarm_s is not None
    ]
    yield Part(
        "Where they stand",
        "Left, where orbits are known: where the satellites are, and what was said of the signals "
        "that claim to be theirs. Right: the vehicle; the test of motion lives by its way.",
        (
            (
                "Sky, and map of the vehicle's way",
                draw_way(list(_looks(findings, vehicle)), vehicle.place_m, alarms),
            ),
        ),
        _elements(array),
    )
    used = [MOTION, ARRIVAL] if calibrated else [MOTION]
    columns = ("Test", "What it tests", "What it cannot see")
    yield Part("Tests", table=Table(columns, tuple(Row(t) for t in used), columns))


def _signals(findings: Sequence[Finding]) -> Table:
    order = {SPOOFED: 0, CLEAN: 1, NO_SUPPORT: 2}
    rows = []
    for f in sorted(findings, key=lambda f: (order[f.verdict], f.satellite, f.signal)):
        way = f"{f.way_m.max():.0f}" if f.way_m.size else "–"
        alarm = "" if f.alarm_s is None else f"{f.alarm_s:.1f}"
        noise = "–" if np.isnan(f.sigma_cycles) else f"{f.sigma_cycles:.4f}"
        cells = (_name(f), f.verdict, str(_tests(f)), way, alarm, noise, f.reason)
        rows.append(Row(cells, LEVELS[f.verdict]))
    columns = ("Signal", "Verdict", "Tests", "Way (m)", "Alarm (s)", "Phase noise (cycles)", "Why")
    return Table(columns, tuple(rows), ("Signal", "Verdict", "Why"), "Verdict")


def _looks(findings: Sequence[Finding], vehicle: Vehicle) -> Iterator[Look]:
    every = np.unique(np.linspace(0, len(vehicle.time_s) - 1, LOOKS).round().astype(np.intp))
    seen: dict[str, str] = {}
    for f in findings:
        if seen.get(f.satellite) != SPOOFED:
            seen[f.satellite] = f.verdict
    for name, said in seen.items():
        unit = vehicle.look(name)
        if unit is not None:
            yield Look(name, unit[every][:, [1, 0, 2]] * (1.0, 1.0, -1.0), LEVELS[said])


def _elements(array: AntennaArray) -> Table:
    rows = [
        Row((f"Antenna {k}{', reference' if not k else ''}", *(f"{v:.3f}" for v in place)))
        for k, place in enumerate(array.elements_m)
    ]
    columns = ("Antenna", "Forward (m)", "Right (m)", "Down (m)")
    return Table(columns, tuple(rows), ("Antenna",))
