"""Settings and numbers of the INS/DME publication, and of an independent study of it.

The publication prints alpha 1e-5, beta 1e-3, r / K1 = 0.5, five satellites above 30 degrees,
spoofing of 10 to 55 m on one to five satellites, 2000 runs, detection within 30 s; delays of 51 s
and 17.5 s in its Figure 5 (5 m on three satellites, from 200 s on). It does not print the noise of
pseudoranges, the sample rate, the geometry, nor how GNSS corrects the INS. The geometry below is
that of the independent study, at one sample a second; so are the numbers named REFERENCE.
"""

from __future__ import annotations

import numpy as np

from sdr_spoof.aiding.dme.geometry import Geometry, directions
from sdr_spoof.aiding.dme.stations import sigma_m

ALPHA, BETA = 1e-5, 1e-3
RISK = 0.5
WITHIN_S = 30
ONSET_S = 200
SIZES_M = np.arange(10.0, 56.0, 5.0)
FIGURE5_S = {"sprt-classic": 51.0, "improved-sprt": 17.5}

SATELLITES_DEG = ((20, 72), (70, 36), (150, 42), (230, 34), (310, 47))
"""Azimuth and elevation."""
STATIONS_DEG = (40.0, 130.0)
"""Azimuth."""
SLANT_M = np.array([80e3, 100e3])
HEIGHT_M = 10e3
ORDER = (2, 4, 3, 0, 1)
"""In which satellites are spoofed, one after the other; the third is the single one."""

SHIFT = 1.48
"""In standard deviations: 5 m at 3.4 m of noise, which gives the delays of Figure 5."""
SIGMA_FIGURE5_M, SIGMA_FIGURE6_M = 3.4, 10.0

THRESHOLD = float(np.log((1.0 - BETA) / ALPHA))
"""Equation 32."""
LOWER = float(np.log(BETA))

REFERENCE_DELAYS = {
    "sprt-classic": (58.6, 38.2, 27.7, 18.3, 11.0),
    "improved-sprt": (75.0, 20.3, 10.0, 5.6, 3.7),
    "cusum": (28.0, 11.3, 7.0, 4.0, 2.3),
    "glr-windows": (25.7, 12.3, 7.1, 3.4, 1.5),
}
"""Mean delay in s at equal false alarms, by rule."""
REFERENCE_THRESHOLDS = {
    "sprt-classic": 6.5,
    "improved-sprt": 11.45,
    "cusum": 11.9,
    "glr-windows": 12.73,
}
SHIFTS = (1.0, 1.48, 2.0, 3.0, 5.0)
PER_HOUR = 0.01
"""False-alarm probability per hour and channel at which rules are compared."""
DEFAULT_RULE = "glr-windows"
"""Of this project, for a shift of unknown size."""


def geometry(sigma_gnss_m: float, stations: bool = True) -> Geometry:
    """The reference geometry with a given noise of pseudoranges."""
    if not stations:
        return Geometry.of(directions(SATELLITES_DEG), sigma_gnss_m)
    elevation = -np.degrees(np.arcsin(HEIGHT_M / SLANT_M))
    to = directions(np.column_stack([STATIONS_DEG, elevation]))
    return Geometry.of(directions(SATELLITES_DEG), sigma_gnss_m, to, sigma_m(SLANT_M))
