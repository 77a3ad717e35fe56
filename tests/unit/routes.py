"""A small route: south-west, without a fix at first, then under suspicion, then spoofed."""

from __future__ import annotations

import numpy as np

from sdr_spoof.nav.time import GnssTime
from sdr_spoof.route import Alarm, Quality, Route, SatelliteView

NAMES = ("C06", "C27", "C28", "C30", "C33", "G12")


def small_route(epochs=8, names=NAMES) -> Route:
    at = np.arange(epochs)
    fixed = at >= 2
    quality = np.where(fixed, Quality.FIX, Quality.NONE).astype(np.uint8)
    quality[3:4] = Quality.SUSPECT
    alarm = np.select([at >= 6, at >= 5], [Alarm.SPOOFED, Alarm.SUSPECT], Alarm.NONE)
    views = []
    for i, name in enumerate(names):
        used = fixed & ~((at >= 6) & (i == 1))
        cn0 = np.full(epochs, 40.0 + i)
        signals = {"L1CA": cn0} if name[0] == "G" else {"B1I": cn0, "B1CP": cn0 + 1}
        spoofed = np.where((at >= 6) & (i == 1), Alarm.SPOOFED, Alarm.NONE).astype(np.uint8)
        residuals = {s: np.where(used, 0.1 * np.cos(at + i), np.nan) for s in signals}
        elevation = np.full(epochs, 20.0 + 10 * i) + 0.2 * at
        azimuth = np.full(epochs, 60.0 * i) + 0.5 * at
        views.append(SatelliteView(name, azimuth, elevation, signals, used, spoofed, residuals))
    blank = np.where(fixed, 1.0, np.nan)
    return Route(
        times=tuple(GnssTime(1_362_571_218 + int(i), 0.5) for i in at),
        sample_time_s=at + 0.25,
        latitude_deg=blank * (-33.85 - 1e-5 * at),
        longitude_deg=blank * (-70.25 - 2e-5 * at),
        height_m=blank * 570.1234,
        velocity_enu_m_s=blank[:, None] * np.array([-1.8, -1.1, 0.0]),
        sigma_enu_m=blank[:, None] * np.array([0.4, 0.5, 0.9]),
        dop=blank[:, None] * np.array([1.5, 0.8, 1.2]),
        quality=quality,
        alarm=alarm.astype(np.uint8),
        satellites=tuple(views),
    )
