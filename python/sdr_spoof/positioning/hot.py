"""Hot start: what was sent when, told by a known time, place and orbits instead of a message.

A code counter is known up to whole code periods (of what carries symbols: up to whole symbols).
Time and place predict the transmit time of every satellite; the multiple nearest to the prediction
is the right one if that is good to half of it. An error of the time is common to all satellites:
it is taken out by the signal with the longest period first, so that only the differences between
satellites must be predicted to half a code period (150 km of range for 1 ms).

Van Diggelen, A-GPS: Assisted GPS, GNSS, and SBAS, 2009, chapter 4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.fixes import Status
from sdr_spoof.nav.orbit import positions
from sdr_spoof.nav.records import Anchor
from sdr_spoof.nav.symbols import symbols_of
from sdr_spoof.pvt import timed_snapshot
from sdr_spoof.signals import LIGHT_M_S

from .pieces import Going, beyond, going, instants, phases_at, pieces_of
from .reasons import left_out

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.fixes import Fixes
    from sdr_spoof.nav.ephemeris import Ephemeris
    from sdr_spoof.nav.store import Store
    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.observables.runs import Run
    from sdr_spoof.pvt import PvtConfig
    from sdr_spoof.records import TrackLog

EARTH_RATE = 7.2921150e-5
"""rad/s: WGS-84 and CGCS2000 alike, to 5e-9 of it."""
UNSURE = 0.35
"""A counter that lies farther than this from a multiple, in periods, is not resolved."""
SURE = math.log(1e5)
"""Logarithm of how much likelier a time must be than one by a symbol earlier or later."""

TOO_COARSE = (
    "a snapshot of code phases tells the time to {:.1f} ms (one sigma), too coarsely to tell which "
    "symbol it is: give a longer recording, or one with a message"
)
FARTHER_OFF = (
    "time, place or navigation file may be farther off than said, or samples of the recording "
    "missing"
)


@dataclass(frozen=True)
class _Counter:
    """A run's code counter against the prediction."""

    signal: str
    prn: int
    run: Run
    period_s: float
    """Spacing of the instants that may belong to ``chips``."""
    chips: float
    """A code phase at the start of a code period or symbol."""
    expected: GnssTime
    """Predicted transmit time of that code phase, by the satellite's clock."""


def anchors_by(
    log: TrackLog,
    store: Store,
    start: GnssTime,
    place_m: NDArray[np.float64],
    config: PvtConfig,
) -> tuple[tuple[Anchor, ...], tuple[str, ...]]:
    """Anchors, and what is to be said of them, by a coarse time and place.

    A snapshot of all code phases at one instant first finds both well enough; anew in each part of
    the recording between gaps.

    Args:
        log: tracks.
        store: ephemerides.
        start: GPST of the first sample, to ``config.time_uncertainty_s``.
        place_m: where the receiver was, ECEF (3,), to ``config.place_uncertainty_m``.
        config: what the snapshot uses.
    """
    anchors: list[Anchor] = []
    told: list[str] = []
    for piece in pieces_of(log):
        runs = going(log, piece)
        if runs:
            found, notes = _anchors(log, runs, store, start, place_m, config)
            anchors += found
            told += notes
    if not told and not anchors:
        told = ["no signal was tracked long enough for a snapshot"]
    return tuple(anchors), tuple(told)


def _anchors(
    log: TrackLog,
    runs: Sequence[Going],
    store: Store,
    start: GnssTime,
    place_m: NDArray[np.float64],
    config: PvtConfig,
) -> tuple[tuple[Anchor, ...], list[str]]:
    """Of one part of a recording, by the first instant that tells the time well enough."""
    notes: list[str] = []
    for at_s in instants(runs):
        phases = phases_at(runs, at_s)
        fix, sigma_s = timed_snapshot(phases, store, place_m, start + at_s, config)
        if not fix.fixed.any():
            told = f"no fix by a snapshot of code phases: {fix.reason(0)}; {FARTHER_OFF}"
            notes = notes or [*left_out(fix), told]
            continue
        if fix.status[0] == Status.SUSPECT:
            told = f"a snapshot of code phases contradicts itself; {FARTHER_OFF}"
            return (), [*left_out(fix), told]
        late_s = fix.time(0) - (start + at_s)
        counters = _counters(log, runs, store, start + late_s, fix.position_m[0])
        beyond_s = _common_error_s(counters)
        if _certain(counters, beyond_s, sigma_s):
            found = (_resolved(c, beyond_s) for c in counters)
            told = f"time from a snapshot of code phases, {late_s:+.3f} s against the one given"
            return tuple(a for a in found if a is not None), [told]
        notes = [*left_out(fix), TOO_COARSE.format(1e3 * sigma_s)]
    return (), notes


def unconfirmed(fixes: Fixes, place_m: NDArray[np.float64], within_m: float) -> tuple[Fixes, str]:
    """Fixes by a given time and given orbits, which no message confirmed, and a sentence on them.

    Orbits turned as a whole about the Earth's axis fit any sky as well: the place found turns with
    them, time and residuals stay. Only the given place speaks against it, as far as it is known:
    what is farther off is suspect.
    """
    status = np.where(fixes.status == Status.FIX, Status.UNCHECKED, fixes.status).astype(np.uint8)
    away_m = np.linalg.norm(fixes.position_m - place_m, axis=1)
    status[fixes.fixed & (away_m > within_m)] = Status.SUSPECT
    middle_m = float(np.linalg.norm(np.median(fixes.position_m[fixes.fixed], axis=0) - place_m))
    return replace(fixes, status=status), (
        f"no message confirms time and orbits: were the sky turned about the Earth's axis, all "
        f"positions would be; they lie {middle_m / 1e3:.1f} km from the place given, which may be "
        f"{within_m / 1e3:.0f} km off (pvt.place_uncertainty_m)"
    )


def _counters(
    log: TrackLog,
    runs: Sequence[Going],
    store: Store,
    start: GnssTime,
    place_m: NDArray[np.float64],
) -> list[_Counter]:
    """Of all runs of satellites with an ephemeris.

    Args:
        log: tracks.
        runs: some of theirs, from one part of the recording.
        store: ephemerides.
        start: GPST of the first sample, to half the longest period among the signals (20 ms for
            B1I D1) or, where only differences matter, to seconds.
        place_m: where the receiver was, ECEF (3,), to 100 km.
    """
    counters = []
    for one in runs:
        track, run, (begin, end) = one.track, one.run, one.span
        spec = run.spec
        selected = store.select(spec.system, track.prn, start)
        if selected is None:
            continue
        period_s, chips = spec.period_s, 0.0
        inside = symbols_of(track, beyond(log, track, one.span))
        if inside and inside[0].grouped:
            period_s, chips = inside[0].symbol_s, float(inside[0].code_phase_chips[0])
        at_s = 0.5 * (begin + end)
        # Transmit time minus sample time; the counter's time of ``chips`` lies as far back.
        sent = _sent(selected.ephemeris, start + at_s, place_m)
        counted_s = float(np.interp(at_s, run.time_s, run.code_s)) + at_s
        expected = sent + (chips / spec.chip_rate_hz - counted_s)
        counters.append(_Counter(track.signal, track.prn, run, period_s, chips, expected))
    return counters


def _certain(counters: Sequence[_Counter], late_s: float, sigma_s: float) -> bool:
    """Whether a time that is off by ``late_s`` hardly is off by a period more: the logarithm of how
    much likelier, where the snapshot tells it with a standard deviation."""
    longest_s = max((c.period_s for c in counters), default=0.0)
    return longest_s * (longest_s - 2.0 * abs(late_s)) > 2.0 * SURE * sigma_s**2


def _sent(ephemeris: Ephemeris, received: GnssTime, place_m: NDArray[np.float64]) -> GnssTime:
    """When what is received was sent, by the satellite's clock."""
    travel_s, clock_s = 0.075, 0.0
    for _ in range(4):
        state = positions([ephemeris], [received + -travel_s])
        turn = EARTH_RATE * travel_s
        x, y, z = state.position_m[0]
        moved = np.array([x + turn * y, y - turn * x, z])
        travel_s = float(np.linalg.norm(moved - place_m)) / LIGHT_M_S
        clock_s = float(state.clock_s[0])
    return received + (clock_s - travel_s)


def _common_error_s(counters: Sequence[_Counter]) -> float:
    """How much later than predicted all satellites sent, by those with the longest period."""
    if not counters:
        return 0.0
    longest = max(c.period_s for c in counters)
    turns = [2 * np.pi * _beyond_s(c, 0.0) / longest for c in counters if c.period_s == longest]
    mean = np.angle(np.mean(np.exp(1j * np.array(turns))))
    return float(mean) * longest / (2 * np.pi)


def _beyond_s(counter: _Counter, late_s: float) -> float:
    """From the expected instant to the nearest one that may be."""
    expected = counter.expected + late_s
    # Whole seconds are multiples of every period.
    periods = expected.fraction / counter.period_s
    return (round(periods) - periods) * counter.period_s


def _resolved(counter: _Counter, late_s: float) -> Anchor | None:
    beyond_s = _beyond_s(counter, late_s)
    if abs(beyond_s) > UNSURE * counter.period_s:
        return None
    expected = counter.expected + late_s
    whole = round(expected.fraction / counter.period_s) * counter.period_s
    run = counter.run
    return Anchor(
        signal=counter.signal,
        prn=counter.prn,
        from_s=float(run.time_s[0]),
        until_s=float(run.time_s[-1]),
        code_phase_chips=counter.chips,
        transmitted=type(expected)(expected.seconds) + whole,
    )
