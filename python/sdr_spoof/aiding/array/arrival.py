"""Whether a signal comes from where its satellite is: direction of arrival against the ephemeris.

H0: the phase differences are those of a plane wave from the satellite, but for whole cycles. Their
residuals, each to the nearest whole cycle, weighted by the noise and by the error of the INS's yaw,
are chi-square. It needs no motion of the vehicle, but the antennas' lines must be calibrated, and a
spoofer within a beam of about sigma / b of the satellite, or of its aliases, is not seen.

``fixed_attitude`` is the classical single difference: the same without an INS, for an array that
does not turn. It is kept for comparison.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtrc

from sdr_spoof.errors import AidingError
from sdr_spoof.scenario.sky.trajectory import rotations

from .geometry import shared_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .geometry import AntennaArray
    from .phases import ArrayPhases

    Floats = NDArray[np.float64]


def statistic(array: AntennaArray, phases: ArrayPhases) -> Floats:
    """Weighted squares of the residuals of each epoch (..., E): chi-square, A - 1 of freedom.

    Raises:
        AidingError: the satellite's direction is not known.
    """
    if phases.expected is None:
        raise AidingError("direction of arrival needs the satellite's direction by its ephemeris")
    turn = rotations(phases.attitude_rad)
    beams = array.baselines_m / phases.wavelength_m
    body = np.einsum("eij,ei->ej", turn, phases.expected)
    residual = phases.difference_cycles + body @ beams.T
    residual = residual - np.round(residual)
    covariance = _covariance(turn, beams, phases)
    white = np.linalg.solve(np.linalg.cholesky(covariance), residual[..., None])[..., 0]
    return np.asarray(np.sum(white**2, axis=-1))


def fixed_attitude(array: AntennaArray, phases: ArrayPhases) -> Floats:
    """The same, as if the vehicle stood as at the first epoch, by a true INS."""
    first = np.broadcast_to(phases.attitude_rad[0], phases.attitude_rad.shape)
    return statistic(array, replace(phases, attitude_rad=first, yaw_sigma_rad=0.0))


def p_value(values: Floats, array: AntennaArray) -> Floats:
    """Probability under H0 of so large a statistic of one epoch."""
    return np.asarray(chdtrc(len(array.baselines_m), values))


def _covariance(turn: Floats, beams: Floats, phases: ArrayPhases) -> Floats:
    """Of the residuals of each epoch, (E, A - 1, A - 1)."""
    assert phases.expected is not None
    noise = phases.sigma_cycles**2 * shared_noise(len(beams))
    noise = noise + phases.bias_sigma_cycles**2 * np.eye(len(beams))
    north, east, _ = phases.expected.T
    turned = np.stack([-east, north, np.zeros_like(north)], axis=-1)
    shift = np.einsum("eij,ei->ej", turn, turned) @ beams.T
    return np.asarray(noise + phases.yaw_sigma_rad**2 * shift[:, :, None] * shift[:, None, :])
