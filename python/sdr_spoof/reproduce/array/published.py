"""Settings of the three-element-array publication, and the law of its test.

The text that we have lost its decimal points; the coordinates are those that reproduce its figures.
Lengths of the array are in wavelengths, its plane is the local horizontal of a spherical Earth.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtri, chndtr

from sdr_spoof.aiding.array.geometry import AntennaArray, triangle
from sdr_spoof.aiding.array.phases import ArrayPhases
from sdr_spoof.aiding.array.simulate import differences

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

PFA = 0.01
SIDE, SIGMA = 2.0, 0.01
"""Of the triangle in wavelengths, and noise of one antenna's phase in cycles."""
ANTENNA_KM = (
    (2992.90, 2095.70, 5128.0),
    (2992.93, 2095.67, 5128.0),
    (2992.97, 2095.63, 5128.0),
    (2993.01, 2095.60, 5128.0),
    (2993.05, 2095.58, 5128.0),
    (2993.09, 2095.55, 5128.0),
)
"""Earth-fixed places of the reference antenna at t0 to t5."""
SPOOFER_KM = (2993.7, 2094.2, 5128.7)
SATELLITE_M = (9_192_102.9, 20_358_246.1, 15_053_036.5)
ARRAY: AntennaArray = triangle(SIDE)
THRESHOLD = float(chdtri(2, PFA))

LAMBDA = (1.132, 6.527, 17.739, 36.279, 61.462)
AUC = (0.62328, 0.90220, 0.99407, 0.99994, 1.0000)
PD = (0.0455, 0.3834, 0.9063, 0.9990, 1.0000)
"""Noncentrality, area under the curve and detection probability at t1 to t5 by an independent
computation."""


def scenario() -> tuple[Floats, Floats, Floats]:
    """Displacements (6, 3), spoofer and satellite (3,): north, east, down from the first place."""
    places = 1e3 * np.asarray(ANTENNA_KM)
    up = places[0] / np.linalg.norm(places[0])
    east = np.cross([0.0, 0.0, 1.0], up)
    east /= np.linalg.norm(east)
    axes = np.array([np.cross(up, east), east, -up])
    spoofer = axes @ (1e3 * np.asarray(SPOOFER_KM) - places[0])
    satellite = axes @ (np.asarray(SATELLITE_M) - places[0])
    return (places - places[0]) @ axes.T, spoofer, satellite


def noncentrality(first: Floats, later: Floats, side: float = SIDE) -> Floats:
    """Of the pair test for directions (..., 3) north, east, down (equation 17)."""
    change = (later - first)[..., :2]
    return np.asarray(side**2 / (4 * SIGMA**2) * np.sum(change**2, axis=-1))


def detected(noncentral: ArrayLike, pfa: float = PFA) -> Floats:
    """Detection probability of the pair test: noncentral chi-square with 2 degrees of freedom."""
    below: Floats = chndtr(chdtri(2, pfa), 2, np.asarray(noncentral, np.float64))
    return 1.0 - below


def area(noncentral: ArrayLike) -> Floats:
    """Area under the receiver operating curve of the pair test, in closed form."""
    return np.asarray(1.0 - 0.5 * np.exp(-np.asarray(noncentral) / 4))


def needed(pd: float, pfa: float = PFA) -> float:
    """Noncentrality that gives a detection probability."""
    low, high = 0.0, 1e3
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if detected(middle, pfa) < pd else (low, middle)
    return high


def measured(
    unit: Floats,
    displacement: Floats,
    rng: np.random.Generator,
    *,
    attitude: Floats | None = None,
    believed: Floats | None = None,
    known_cycles: bool = True,
    yaw_sigma_rad: float = 0.0,
) -> ArrayPhases:
    """Phases of the published array, lengths in wavelengths.

    Args:
        unit: true directions (..., E, 3).
        displacement: (E, 3) in m.
        rng: source of the noise.
        attitude: true yaw, pitch, roll (E, 3) or (..., E, 3); None: level, to the north.
        believed: what the INS says, (E, 3); None: the truth.
        known_cycles: whether whole cycles are known to the test.
        yaw_sigma_rad: error of yaw that the test is told.
    """
    epochs = len(displacement)
    level = np.zeros((epochs, 3)) if attitude is None else attitude
    phases = differences(ARRAY, unit, level, 1.0, SIGMA, rng, whole_cycles=known_cycles)
    return ArrayPhases(
        np.arange(float(epochs)),
        phases,
        level if believed is None else believed,
        displacement,
        SIGMA,
        1.0,
        known_cycles=known_cycles,
        yaw_sigma_rad=yaw_sigma_rad,
    )
