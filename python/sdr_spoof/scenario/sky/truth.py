"""The truth of a sky: the receiver's state, and where its satellites are.

``sky`` beside a recording holds, at the times of the truth's table (every 0.1 s up to an hour):

- ``receiver``: Earth-fixed ``position_m`` and ``velocity_m_s`` of the antenna, ``latitude_deg``,
  ``longitude_deg``, ``height_m`` (WGS 84), ``attitude_deg`` (yaw, pitch, roll of the body),
  ``clock_s`` (receiver's clock less system time) and ``clock_drift``;
- ``satellites``: ``distance_m`` (the light's way), ``azimuth_deg``, ``elevation_deg``,
  ``satellite_clock_s`` (relativity included, group delays not), ``ionosphere_m`` (of a code at
  1575.42 MHz), ``troposphere_m``, and ``pseudorange_m`` of each component: c times the time of the
  receiver's clock, less that of the satellite's code; ``issues``, what ephemeris its messages tell
  from when on;
- ``counterfeit``: for each false position ``position_m`` and ``clock_s`` beyond the receiver's.

``delay_s`` is what ``code_delay_s`` of the satellite's emitters has beyond its pseudorange over c:
code phase 0 left at that time after ``start``, by the satellite's clock.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.nav.geodesy import ecef_to_geodetic
from sdr_spoof.scenario.base import SPEED_OF_LIGHT
from sdr_spoof.signals import signal_spec

from .clock import FIRST_S, STEP_S

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.scenario.attack.position import Position
    from sdr_spoof.scenario.emitters import Transmission

    from .model import Sky
    from .track import Track


def sky_truth(
    sky: Sky,
    time_s: NDArray[np.float64],
    sent: Sequence[Transmission],
    attacks: Sequence[Position],
) -> dict[str, Any]:
    """JSON-ready tables.

    Args:
        sky: the model.
        time_s: times of the table, multiples of 0.1 s.
        sent: what the satellites themselves send.
        attacks: false positions.
    """
    at = np.round((time_s - FIRST_S) / STEP_S).astype(np.int64)
    return {
        "start": {
            "utc": sky.start.utc().isoformat(),
            "gpst_s": sky.start.seconds,
            "gpst_fraction_s": sky.start.fraction,
        },
        "definitions": __doc__,
        "receiver": _receiver(sky, at),
        "satellites": [
            _satellite(
                s.track, at, time_s, [t for t in sent if (t.system, t.prn) == (s.system, s.prn)]
            )
            for s in sky.satellites
        ],
        "counterfeit": [
            {
                "start_s": a.start_s,
                "position_m": _rounded(a.place_m(sky)[at], 4),
                "clock_s": _rounded(a.late_s(sky.time_s)[at], 15),
            }
            for a in attacks
        ],
    }


def _receiver(sky: Sky, at: NDArray[np.int64]) -> dict[str, Any]:
    system_s = sky.system_s[at]
    position = sky.antenna_m[at]
    latitude, longitude, height = ecef_to_geodetic(position).T
    drift = np.gradient(sky.clock_s, STEP_S)[at]
    return {
        "position_m": _rounded(position, 4),
        "velocity_m_s": _rounded(sky.trajectory.velocity_m_s(system_s), 5),
        "latitude_deg": _rounded(latitude, 10),
        "longitude_deg": _rounded(longitude, 10),
        "height_m": _rounded(height, 4),
        "attitude_deg": _rounded(np.degrees(sky.trajectory.attitude_rad(system_s)), 4),
        "clock_s": _rounded(sky.clock_s[at], 15),
        "clock_drift": _rounded(drift, 15),
    }


def _satellite(
    track: Track,
    at: NDArray[np.int64],
    time_s: NDArray[np.float64],
    sent: Sequence[Transmission],
) -> dict[str, Any]:
    view, ephemeris, sky = track.view, track.ephemeris, track.sky
    delay_s = track.reference - track.sky.start
    pseudoranges = {}
    for t in sent:
        chips = t.emitter.code_phase_chips(time_s)
        behind_s = time_s - chips / signal_spec(t.signal).chip_rate_hz - delay_s
        pseudoranges[t.signal] = _rounded(SPEED_OF_LIGHT * behind_s, 4)
    return {
        "system": ephemeris.system,
        "prn": ephemeris.prn,
        "message": ephemeris.message,
        "toe_gpst_s": ephemeris.toe.seconds,
        "delay_s": delay_s,
        "issues": [
            {"from_s": begin - sky.start, "toe_gpst_s": e.toe.seconds, "iode": e.iode}
            for begin, _, e in track.issues(sky.start, sky.start + sky.duration_s)
        ],
        "distance_m": _rounded(view.way.distance_m[at], 4),
        "azimuth_deg": _rounded(np.degrees(view.way.azimuth_rad[at]), 5),
        "elevation_deg": _rounded(np.degrees(view.way.elevation_rad[at]), 5),
        "satellite_clock_s": _rounded(view.way.clock_s[at], 15),
        "ionosphere_m": _rounded(view.delays.ionosphere_m[at], 4),
        "troposphere_m": _rounded(view.delays.troposphere_m[at], 4),
        "pseudorange_m": pseudoranges,
    }


def _rounded(values: NDArray[np.float64], digits: int) -> Any:
    return np.round(values, digits).tolist()
