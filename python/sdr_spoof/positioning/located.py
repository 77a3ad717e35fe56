"""From tracks to positions: messages, observations, fixes; and why there are none."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.errors import NavigationError
from sdr_spoof.fixes import Status
from sdr_spoof.nav.frames import decode
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.store import Store, conflicts
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.observables import ReceiverClock, observe
from sdr_spoof.signals import LIGHT_M_S

from .hot import anchors_by, unconfirmed
from .reasons import reasons, unmodelled
from .route import route_of
from .single import single_fix
from .trust import solve_trusted

if TYPE_CHECKING:
    from collections.abc import Sequence
    from datetime import datetime

    from numpy.typing import NDArray

    from sdr_spoof.config import Config
    from sdr_spoof.fixes import Fixes
    from sdr_spoof.nav.records import Navigation
    from sdr_spoof.observations import Observations
    from sdr_spoof.records import Acquisition, TrackLog, Verdict
    from sdr_spoof.route import Route


@dataclass(frozen=True)
class Located:
    """All that positioning found in a recording."""

    navigation: Navigation
    """What was received, and what the files given say."""
    observations: Observations
    fixes: Fixes
    route: Route
    notes: tuple[str, ...]
    """What was missing, and why there is no fix, a sentence each."""

    def records(self) -> dict[str, Any]:
        """What a result file holds of it."""
        return {
            "navigation": self.navigation,
            "observations": self.observations,
            "fixes": self.fixes,
        }

    @property
    def middle_m(self) -> NDArray[np.float64] | None:
        """Median position (3,), ECEF; None without a fix."""
        found = self.fixes.position_m[self.fixes.fixed]
        return np.asarray(np.median(found, axis=0)) if len(found) else None


def locate(
    log: TrackLog,
    config: Config,
    verdict: Verdict | None = None,
    *,
    start: datetime | None = None,
    acquisitions: Sequence[Acquisition] = (),
) -> Located:
    """Positions from a log of tracks; satellites that the verdict calls spoofed are left out.

    Args:
        log: tracks.
        config: its groups ``navigation``, ``observables`` and ``pvt``.
        verdict: what the detectors said.
        start: UTC of the first sample, where ``config.navigation.time`` does not tell it.
        acquisitions: used where the recording is too short for any track.

    Raises:
        NavigationError: a navigation file cannot be read, or a model that the configuration
            demands is not there.
    """
    began = config.navigation.time or start
    near = GnssTime.of_utc(began) if began is not None else None
    navigation = decode(log, near)
    received = navigation
    for path in config.navigation.files:
        file = read_navigation(path)
        differ = [f"{path} and the message contradict: {c}" for c in conflicts(file, received)]
        navigation = _noted(navigation + file, *file.notes, *differ)
    found, place = None, config.navigation.place
    hot = not navigation.anchors
    if hot:
        navigation, found = _hot(log, navigation, config, near, acquisitions)
    seen, fixes = found or _fixes(log, navigation, config, verdict)
    if hot and place is not None and fixes.fixed.any():
        within_m = config.pvt.place_uncertainty_m
        fixes, told = unconfirmed(fixes, geodetic_to_ecef(place), within_m)
        navigation = _noted(navigation, told)
    route = route_of(fixes, seen, verdict)
    lacks = unmodelled(fixes, navigation, config.pvt)
    notes = (*navigation.notes, *seen.notes, *reasons(fixes), *lacks)
    return Located(navigation, seen, fixes, route, tuple(dict.fromkeys(notes)))


def try_locate(
    log: TrackLog, config: Config, verdict: Verdict | None = None, **more: Any
) -> tuple[Located | None, str]:
    """As :func:`locate` where the recording allows; otherwise None, and why, in a sentence."""
    if not config.navigation.position:
        return None, "not asked for (navigation.position = false)"
    try:
        return locate(log, config, verdict, **more), ""
    except NavigationError as error:
        return None, str(error)


def _noted(navigation: Navigation, *notes: str) -> Navigation:
    return replace(navigation, notes=(*navigation.notes, *notes))


def _hot(
    log: TrackLog,
    navigation: Navigation,
    config: Config,
    near: GnssTime | None,
    acquisitions: Sequence[Acquisition],
) -> tuple[Navigation, tuple[Observations, Fixes] | None]:
    """Add anchors by a known time, place and orbits, where no message tells them.

    Also the fix, where nothing was tracked and code phases of the acquisition must do.
    """
    place = config.navigation.place
    needed = {
        "a navigation file": bool(navigation.ephemerides),
        "the time of the first sample": near is not None,
        "a place": place is not None,
    }
    missing = [name for name, there in needed.items() if not there]
    if near is None or place is None or missing:
        lacking = f"no message was received in full; a fix needs {', '.join(missing)} too"
        return _noted(navigation, lacking), None
    aid = Store(navigation), near, geodetic_to_ecef(place), config.pvt
    anchors, told = anchors_by(log, *aid)
    navigation = _noted(replace(navigation, anchors=anchors), *told)
    if anchors or any(t.epochs for t in log.signals):
        return navigation, None
    return navigation, single_fix(acquisitions, log.sample_rate_hz, *aid)


def _fixes(
    log: TrackLog, navigation: Navigation, config: Config, verdict: Verdict | None
) -> tuple[Observations, Fixes]:
    """Observations and fixes, by a clock that a first round of fixes has set right."""
    rate_hz = 1 if log.duration_s >= ENOUGH_S else 10
    coarse = config.observables.model_copy(update={"rate_hz": rate_hz})
    first = observe(log, navigation, coarse, verdict)
    clock = first.clock
    if clock is not None:
        clock = corrected(clock, first, solve_trusted(first, navigation, config.pvt, verdict))
    seen = observe(log, navigation, config.observables, verdict, clock=clock)
    return seen, solve_trusted(seen, navigation, config.pvt, verdict)


def corrected(clock: ReceiverClock, seen: Observations, fixes: Fixes) -> ReceiverClock:
    """The clock less a straight line through what trusted fixes found of it, piece by piece."""
    trusted = np.isin(fixes.status, (Status.FIX, Status.UNCHECKED)) & np.isfinite(fixes.clock_s)
    starts = [p.sample_s for p in clock.pieces[1:]]
    piece_of = np.searchsorted(starts, seen.sample_time_s, side="right")
    pieces = []
    for number, piece in enumerate(clock.pieces):
        rows = np.flatnonzero(trusted & (piece_of == number))
        if not rows.size:
            pieces.append(piece)
            continue
        middle_s = float(np.mean(seen.sample_time_s[rows]))
        bias_s, drift = _line(seen.sample_time_s[rows] - middle_s, fixes, rows)
        pieces.append(piece.corrected(middle_s, bias_s, drift))
    return ReceiverClock(tuple(pieces))


def _line(time_s: NDArray[np.float64], fixes: Fixes, rows: NDArray[np.intp]) -> tuple[float, float]:
    """Bias in s at time 0 and drift, by medians, which a few wrong fixes do not move."""
    bias = fixes.clock_s[rows]
    if rows.size < LINE_FIXES:
        return float(np.median(bias)), float(
            np.nan_to_num(np.median(fixes.drift_m_s[rows]))
        ) / LIGHT_M_S
    half = rows.size // 2
    run = np.median(time_s[-half:]) - np.median(time_s[:half])
    drift = float((np.median(bias[-half:]) - np.median(bias[:half])) / run)
    return float(np.median(bias - drift * time_s)), drift


ENOUGH_S = 10.0
"""Of shorter recordings the first round takes ten epochs a second."""
LINE_FIXES = 10
"""Of fewer fixes the drift is that of their velocities."""
