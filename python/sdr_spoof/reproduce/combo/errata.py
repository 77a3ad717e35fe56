"""Errors of the publication, each with what is done instead and the numbers that show it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sdr_spoof.detectors import combo_model as model
from sdr_spoof.reproduce.study import Erratum

from . import published

RANGE_RATE_M_S = 800.0
LIGHT_M_S = 299_792_458.0


def errata() -> Sequence[Erratum]:
    """Known errors, in the order of the publication's argument."""
    return (_units(), _unscaled(), _small_angle(), _integration(), _decoupling(), _axis(), *_open())


def leak_hz(range_rate_m_s: float = RANGE_RATE_M_S) -> float:
    """Rate of the unscaled difference that motion alone causes."""
    return (published.UPPER_HZ - published.LOWER_HZ) * range_rate_m_s / LIGHT_M_S


def decoupling_degrees(main: float, subcarrier: float) -> tuple[float, float]:
    """Angles of the plain difference and of the conjugate sum, for given errors, in degrees."""
    theta, psi = np.radians([main, subcarrier])
    upper, lower = np.exp(1j * (theta + psi)), np.exp(1j * (theta - psi))
    both = np.angle([upper - lower, upper + lower.conjugate()], deg=True)
    return float(both[0]), float(both[1])


def _units() -> Erratum:
    return Erratum(
        "Units of C/N0 and of the threshold",
        'C/N0 of "30 dB" and a threshold of 18.83 Hz.',
        "30 enters as a ratio (14.77 dB-Hz), which gives 4.511 Hz; the printed number is that plus "
        "14.322, the difference of the carriers in MHz. A true 30 dB-Hz gives 0.680 Hz. Both "
        "readings are given throughout.",
    )


def _unscaled() -> Erratum:
    return Erratum(
        "Difference not scaled by the carriers",
        "The test is on f2 - f1, taken as the constant 14.322.",
        f"Doppler scales with the carrier: at {RANGE_RATE_M_S:g} m/s the plain difference moves by "
        f"{leak_hz():.1f} Hz, more than any published drag. Tested is phi_u - (f_u / f_l) phi_l, "
        "which no motion and no clock moves.",
    )


def _small_angle() -> Erratum:
    small = float(model.capture_rate_small_angle_hz(published.DRAG_HZ, published.ETA))
    return Erratum(
        "Small-angle capture",
        "The rate under attack is eta / (1 + eta) f_e (equations 13 and 17).",
        f"That is the slope of the first instant only ({small:g} Hz of 10 at eta 1.5). With eta "
        "over 1 the loop follows the stronger signal: f_e on average, plus a beat of at most "
        f"asin(1 / eta) = {np.degrees(np.arcsin(1 / published.ETA)):.0f} degrees. Both models are "
        "implemented and compared below.",
    )


def _integration() -> Erratum:
    gain = float(model.correlation_gain(published.DRAG_HZ, published.INTEGRATION_S))
    folded = float(model.folded_hz(8.0, published.INTEGRATION_S))
    return Erratum(
        "Integration of 100 ms",
        "Drags of 8 to 12.5 Hz with 100 ms of coherent integration.",
        f"A signal 10 Hz off is in the null of the correlation (amplitude {abs(gain):.2f}) and a "
        f"frequency discriminator folds at ±5 Hz (8 Hz reads {folded:+.0f} Hz): such a sweep "
        "cannot come from loops with those settings. Here the loops update each 10 ms and the "
        "narrow bandwidth is had by filtering the phase.",
    )


def _decoupling() -> Erratum:
    plain, conjugate = decoupling_degrees(20.0, 10.0)
    return Erratum(
        "Decoupling of carrier and subcarrier",
        "Equation 6 takes the sum and the plain difference of the normalised sidebands.",
        "The plain difference turns with the main carrier: with errors of 20 degrees (main) and 10 "
        f"(subcarrier) its angle is {plain:.0f}, not 10. The sum with one sideband conjugated "
        f"gives {conjugate:.0f}. Weights are inverse amplitudes, not inverse powers.",
    )


def _axis() -> Erratum:
    return Erratum(
        "Time axis of Figure 2",
        'The attack begins at "t = 300 ns".',
        "No integration of the receiver fits into 300 ns, and it is no sample number either; the "
        "figure is made again from samples with an axis in seconds.",
    )


def _open() -> Sequence[Erratum]:
    return (
        Erratum(
            "Static multipath",
            "A constant phase of an echo never alarms.",
            "Only while it stays: its arrival is a jump of the difference, which a slope over a "
            "window W sees as a transient for W (1 s here). Moving echoes are in Figure 4 below.",
        ),
        Erratum(
            "Equation 24",
            "The fraction bar runs under the whole right-hand side.",
            "What follows from equation 23 is (2 (1 + eta) sigma² ln gamma) / (eta f_e) + "
            "eta f_e / (2 (1 + eta)), plus the mean under H0, with sigma² that of one loop.",
        ),
    )
