"""Whether a signal comes from where its satellite is: direction of arrival against the ephemeris.

H0: the phase differences are those of a plane wave from the satellite, but for whole cycles. Their
residuals, each to the nearest whole cycle (half a one where data hide the carrier's sign), weighted
by the noise and by the error of the INS's yaw, are chi-square. It needs no motion of the vehicle,
but the antennas' lines must be calibrated, and a spoofer within a beam of about sigma / b of the
satellite, or of its aliases, is not seen.

``fixed_attitude`` is the classical single difference: the same without an INS, for an array that
does not turn. It is kept for comparison.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtrc, ndtri

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
    residual, shift = _residuals(array, phases)
    return _squares(_nearest(residual, phases), _covariance(shift, phases, 1))


def statistic_of_all(array: AntennaArray, phases: ArrayPhases) -> Floats:
    """The same of the mean over all epochs (...): noise averages out, heading and delays do not.

    Raises:
        AidingError: the satellite's direction is not known.
    """
    residual, shift = _residuals(array, phases)
    mean = _nearest(residual.mean(axis=-2), phases)
    return _squares(mean, _covariance(shift.mean(axis=-2), phases, phases.time_s.size))


def fixed_attitude(array: AntennaArray, phases: ArrayPhases) -> Floats:
    """The same, as if the vehicle stood as at the first epoch, by a true INS."""
    first = np.broadcast_to(phases.attitude_rad[0], phases.attitude_rad.shape)
    return statistic(array, replace(phases, attitude_rad=first, yaw_sigma_rad=0.0))


def p_value(values: Floats, array: AntennaArray) -> Floats:
    """Probability under H0 of so large a statistic of one epoch."""
    return np.asarray(chdtrc(len(array.baselines_m), values))


def score(values: Floats, array: AntennaArray) -> Floats:
    """The statistic as a standard normal number with the same one-sided significance."""
    return np.asarray(-ndtri(np.maximum(p_value(values, array), 1e-300)))


def _residuals(array: AntennaArray, phases: ArrayPhases) -> tuple[Floats, Floats]:
    """Differences less those of the satellite, and what a radian of yaw adds, (..., E, A - 1)."""
    if phases.expected is None:
        raise AidingError("direction of arrival needs the satellite's direction by its ephemeris")
    turn = rotations(phases.attitude_rad)
    beams = array.baselines_m / phases.wavelength_m
    body = np.einsum("eij,ei->ej", turn, phases.expected)
    north, east, _ = phases.expected.T
    turned = np.stack([-east, north, np.zeros_like(north)], axis=-1)
    return phases.difference_cycles + body @ beams.T, np.einsum(
        "eij,ei->ej", turn, turned
    ) @ beams.T


def _nearest(residual: Floats, phases: ArrayPhases) -> Floats:
    """Less the nearest whole (or half) cycles."""
    return np.asarray(residual - phases.cycle_step * np.round(residual / phases.cycle_step))


def _covariance(shift: Floats, phases: ArrayPhases, epochs: int) -> Floats:
    """Of residuals that are means of so many epochs, (..., A - 1, A - 1)."""
    beams = shift.shape[-1]
    noise = phases.sigma_cycles**2 / epochs * shared_noise(beams)
    noise = noise + phases.bias_sigma_cycles**2 * np.eye(beams)
    by_yaw = phases.yaw_sigma_rad**2 * shift[..., :, None] * shift[..., None, :]
    return np.asarray(noise + by_yaw)


def _squares(residual: Floats, covariance: Floats) -> Floats:
    white = np.linalg.solve(np.linalg.cholesky(covariance), residual[..., None])[..., 0]
    return np.asarray(np.sum(white**2, axis=-1))
