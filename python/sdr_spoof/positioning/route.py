"""From fixes to a route: geodetic, local axes, and what the detectors had said by then."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.fixes import DOP_NAMES, Status
from sdr_spoof.fusion import SPOOFED, SUSPECT
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix
from sdr_spoof.observations import SUBCARRIER
from sdr_spoof.route import Alarm, Quality, Route, SatelliteView
from sdr_spoof.signals import satellite_name

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from sdr_spoof.fixes import Fixes
    from sdr_spoof.observations import Observations
    from sdr_spoof.records import Verdict

QUALITIES = {
    Status.NO_FIX: Quality.NONE,
    Status.FIX: Quality.FIX,
    Status.UNCHECKED: Quality.FIX,
    Status.SUSPECT: Quality.SUSPECT,
}
ALARMS = {SUSPECT: Alarm.SUSPECT, SPOOFED: Alarm.SPOOFED}
Said = dict[str, "NDArray[np.uint8]"]
"""Alarm at each epoch by satellite."""


def route_of(fixes: Fixes, seen: Observations, verdict: Verdict | None = None) -> Route:
    """The epochs of fixes and of the observations that they are from."""
    place = np.full((fixes.epochs, 3), np.nan)
    place[fixes.fixed] = ecef_to_geodetic(fixes.position_m[fixes.fixed])
    turn = np.full((fixes.epochs, 3, 3), np.nan)
    for i in np.flatnonzero(fixes.fixed):
        turn[i] = enu_matrix(float(place[i, 0]), float(place[i, 1]))
    said = _said(seen, verdict)
    views = tuple(_views(fixes, seen, said))
    variance = np.einsum("eij,ejk,eik->ei", turn, fixes.covariance_m2, turn)
    return Route(
        times=tuple(fixes.time(i) for i in range(fixes.epochs)),
        sample_time_s=seen.sample_time_s,
        latitude_deg=place[:, 0],
        longitude_deg=place[:, 1],
        height_m=place[:, 2],
        velocity_enu_m_s=np.einsum("eij,ej->ei", turn, fixes.velocity_m_s),
        sigma_enu_m=np.sqrt(np.maximum(variance, 0.0)),
        dop=fixes.dop[:, [DOP_NAMES.index(name) for name in ("PDOP", "HDOP", "VDOP")]],
        quality=_quality(fixes, views),
        alarm=np.max([np.zeros(fixes.epochs, np.uint8), *said.values()], axis=0),
        satellites=views,
    )


def _quality(fixes: Fixes, views: Sequence[SatelliteView]) -> NDArray[np.uint8]:
    """Of each fix: suspect if its residuals say so, or if, while satellites are spoofed, it rests
    on others under suspicion, which hardly are innocent then, or on too few for residuals.
    """
    quality = np.array([QUALITIES[Status(s)] for s in fixes.status], np.uint8)
    under_attack = np.zeros(fixes.epochs, np.bool_)
    relied_on = np.zeros(fixes.epochs, np.bool_)
    for view in views:
        under_attack |= view.alarm == Alarm.SPOOFED
        relied_on |= view.used & (view.alarm == Alarm.SUSPECT)
    doubtful = relied_on | (fixes.status == Status.UNCHECKED)
    quality[under_attack & doubtful & fixes.fixed] = Quality.SUSPECT
    return quality


def _said(seen: Observations, verdict: Verdict | None) -> Said:
    """Whoever is spoofed later is under suspicion from the first one's onset on."""
    said: Said = {}
    judged = verdict.satellites if verdict is not None else ()
    first_s = min((s.onset_s or 0.0 for s in judged if s.verdict == SPOOFED), default=np.inf)
    for satellite in judged:
        if satellite.verdict in ALARMS:
            on = seen.sample_time_s >= (satellite.onset_s or 0.0)
            name = satellite_name(satellite.system, satellite.prn)
            said[name] = np.where(on, ALARMS[satellite.verdict], Alarm.NONE).astype(np.uint8)
            if satellite.verdict == SPOOFED:
                said[name][~on & (seen.sample_time_s >= first_s)] = Alarm.SUSPECT
    return said


def _views(fixes: Fixes, seen: Observations, said: Said) -> Iterator[SatelliteView]:
    """Satellites in order of their names."""
    quiet = np.zeros(fixes.epochs, np.uint8)
    for name in dict.fromkeys(s.satellite for s in fixes.signals):
        columns = {s.signal: i for i, s in enumerate(fixes.signals) if s.satellite == name}
        first = next(iter(columns.values()))
        yield SatelliteView(
            name=name,
            azimuth_deg=fixes.azimuth_deg[:, first],
            elevation_deg=fixes.elevation_deg[:, first],
            cn0_dbhz={s: seen.cn0_dbhz[:, i] for s, i in columns.items() if s != SUBCARRIER},
            used=np.asarray(fixes.used[:, list(columns.values())].any(axis=1)),
            alarm=said.get(name, quiet),
            residual_m={s: fixes.residual_m[:, i] for s, i in columns.items()},
        )
