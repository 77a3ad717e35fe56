"""Orbits, light time and delays once more, written down from the interface specifications.

One satellite and one time at a time, in the inertial frame of the time of reception, by bisection
instead of iteration: nothing here is shared with the package.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from sdr_spoof.nav.ephemeris import Ephemeris
from sdr_spoof.nav.time import GnssTime

C = 299_792_458.0
GEO = (1, 2, 3, 4, 5, 59, 60, 61, 62, 63)


def constants(e: Ephemeris) -> tuple[float, float]:
    """mu and rotation rate: IS-GPS-200, 20.3.3.4.3.3.1; BDS-SIS-ICD-B1I-3.0, 3.2."""
    if e.system == "G":
        return 3.986005e14, 7.2921151467e-5
    return 3.986004418e14, 7.292115e-5


def anomaly(e: Ephemeris, tk: float) -> float:
    mu, _ = constants(e)
    mean = e.m0 + (math.sqrt(mu / e.a**3) + e.delta_n) * tk
    return float(brentq(lambda x: x - e.e * math.sin(x) - mean, mean - 1, mean + 1, xtol=1e-15))


def position(e: Ephemeris, at: GnssTime) -> np.ndarray:
    """Earth-fixed position at a time (IS-GPS-200, table 20-IV; B1I-3.0, table 5-11)."""
    _, rate = constants(e)
    tk = at - e.toe
    ea = anomaly(e, tk)
    nu = 2 * math.atan(math.sqrt((1 + e.e) / (1 - e.e)) * math.tan(ea / 2))
    phi = nu + e.omega
    c2, s2 = math.cos(2 * phi), math.sin(2 * phi)
    u = phi + e.cus * s2 + e.cuc * c2
    r = e.a * (1 - e.e * math.cos(ea)) + e.crs * s2 + e.crc * c2
    i = e.i0 + e.i_dot * tk + e.cis * s2 + e.cic * c2
    toe_tow = e.toe.week_tow(e.system)[1]
    geostationary = e.system == "C" and e.prn in GEO
    node = e.omega0 + (e.omega_dot - (0 if geostationary else rate)) * tk - rate * toe_tow
    x, y = r * math.cos(u), r * math.sin(u)
    place = np.array(
        [
            x * math.cos(node) - y * math.cos(i) * math.sin(node),
            x * math.sin(node) + y * math.cos(i) * math.cos(node),
            y * math.sin(i),
        ]
    )
    if not geostationary:
        return place
    tilt = math.radians(-5)
    about_x = np.array(
        [
            [1, 0, 0],
            [0, math.cos(tilt), math.sin(tilt)],
            [0, -math.sin(tilt), math.cos(tilt)],
        ]
    )
    return turned(about_x @ place, rate * tk)


def turned(place: np.ndarray, angle: float) -> np.ndarray:
    """Coordinates in a frame turned about Z."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ place


def clock_s(e: Ephemeris, at: GnssTime) -> float:
    """Satellite clock with relativity."""
    mu, _ = constants(e)
    dt = at - e.toc
    relativity = -2 * math.sqrt(mu * e.a) / C**2 * e.e * math.sin(anomaly(e, at - e.toe))
    return e.a0 + e.a1 * dt + e.a2 * dt**2 + relativity


def range_m(e: Ephemeris, received: GnssTime, antenna: np.ndarray) -> tuple[float, float]:
    """Distance along the light's way, and the satellite's clock when it left."""
    _, rate = constants(e)
    # In the frame that is fixed to the stars and is the Earth's at the time of reception.

    def too_long(tau: float) -> float:
        place = turned(position(e, received + -tau), rate * tau)
        return float(np.linalg.norm(place - antenna)) - C * tau

    # In two steps: a root of a function of 1e7 m to 1e-9 m.
    tau = brentq(too_long, 0.05, 0.2, xtol=1e-17)
    tau += too_long(tau) / C
    return C * tau, clock_s(e, received + -tau)
