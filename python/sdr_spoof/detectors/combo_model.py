"""The published combo-signal model: laws, thresholds and detection probability.

Source: the combo-signal carrier-difference spoofing detector for BeiDou B1I + B1C (sections 2.2
and 2.3, equations 13 to 26). Every function names its equation. Frequencies are in Hz, C/N0 is a
ratio in Hz unless the name says dB-Hz.

Points where the printed text cannot be taken as it stands:

* Its "C/N0 of 30 dB" enters the printed threshold as the *ratio* 30 (14.8 dB-Hz), see
  :data:`PUBLISHED_CN0_HZ`; the printed 18.83 "Hz" is that threshold plus 14.322, the difference
  of the carriers in MHz.
* The difference is taken without scaling by the carriers, so the Doppler leaks into it. Here the
  mean under H0 is zero because the difference is carrier scaled before it is tested.
* Equation 24 prints one fraction bar too wide; the threshold below is what equation 23 gives.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

PUBLISHED_CN0_HZ: dict[str, float] = {"as_ratio": 30.0, "as_dbhz": 1000.0}
"""The two readings of the published "30 dB": the ratio 30 (printed numbers), or 30 dB-Hz."""


def fll_sigma_hz(
    cn0_hz: ArrayLike,
    integration_s: float,
    loop_bandwidth_hz: float,
    fll_factor: float = 1.0,
) -> NDArray[np.float64]:
    """Thermal frequency jitter of one sideband's frequency-locked loop (equation 19).

    ``cn0_hz`` is the carrier-to-noise density as a ratio (10^(dB-Hz / 10)); ``fll_factor`` is F,
    1 at high C/N0 and 2 near threshold.
    """
    cn0 = np.asarray(cn0_hz, dtype=np.float64)
    squaring = 1.0 + 1.0 / (integration_s * cn0)
    spread = np.sqrt(4.0 * fll_factor * loop_bandwidth_hz / cn0 * squaring)
    return np.asarray(spread / (2.0 * np.pi * integration_s))


def difference_sigma_hz(
    sigma_upper_hz: ArrayLike, sigma_lower_hz: ArrayLike, carrier_ratio: float = 1.0
) -> NDArray[np.float64]:
    """Standard deviation of the rate difference under H0 (text after equation 19).

    ``carrier_ratio`` = f_u / f_l scales the lower sideband; 1 gives the published 2 sigma^2.
    """
    upper = np.asarray(sigma_upper_hz, dtype=np.float64)
    lower = np.asarray(sigma_lower_hz, dtype=np.float64)
    return np.hypot(upper, carrier_ratio * lower)


def threshold_for_pfa_hz(
    sigma_hz: ArrayLike, pfa: float, *, two_sided: bool = False
) -> NDArray[np.float64]:
    """Threshold on the rate difference for a false-alarm probability (equation 25).

    One-sided as published, or on the absolute value with half of ``pfa`` in each tail. Against an
    attack of unknown sign use the latter.
    """
    quantile = -float(scipy.special.ndtri(pfa / 2.0 if two_sided else pfa))
    return np.asarray(np.asarray(sigma_hz, dtype=np.float64) * quantile)


def threshold_for_likelihood_ratio_hz(
    sigma_hz: ArrayLike, likelihood_ratio: float, shift_hz: float
) -> NDArray[np.float64]:
    """One-sided threshold at which p(x; H1) / p(x; H0) reaches a ratio (equations 20 to 24).

    ``sigma_hz`` is that of the difference, ``shift_hz`` its mean under H1 (equation 17).
    """
    variance = np.asarray(sigma_hz, dtype=np.float64) ** 2
    return np.asarray(variance * np.log(likelihood_ratio) / shift_hz + shift_hz / 2.0)


def log_likelihood_ratio(
    x_hz: ArrayLike, sigma_hz: ArrayLike, shift_hz: float
) -> NDArray[np.float64]:
    """Logarithm of p(x; H1) / p(x; H0) of a measured rate difference (equations 20 to 23).

    ``sigma_hz`` is that of the difference, ``shift_hz`` its mean under H1 (equation 17).
    """
    x = np.asarray(x_hz, dtype=np.float64)
    variance = np.asarray(sigma_hz, dtype=np.float64) ** 2
    return np.asarray(shift_hz * (2.0 * x - shift_hz) / (2.0 * variance))


def false_alarm_probability(
    sigma_hz: ArrayLike, threshold_hz: ArrayLike, *, two_sided: bool = False
) -> NDArray[np.float64]:
    """Probability that noise alone crosses the threshold (equation 25)."""
    return detection_probability(0.0, sigma_hz, threshold_hz, two_sided=two_sided)


def detection_probability(
    shift_hz: ArrayLike, sigma_hz: ArrayLike, threshold_hz: ArrayLike, *, two_sided: bool = False
) -> NDArray[np.float64]:
    """Probability that the rate difference crosses the threshold under H1 (equation 26)."""
    shift = np.asarray(shift_hz, dtype=np.float64)
    sigma = np.asarray(sigma_hz, dtype=np.float64)
    threshold = np.asarray(threshold_hz, dtype=np.float64)
    above = scipy.special.ndtr((shift - threshold) / sigma)
    below = scipy.special.ndtr((-threshold - shift) / sigma) if two_sided else 0.0
    return np.asarray(above + below)


def capture_rate_small_angle_hz(
    drag_hz: ArrayLike, amplitude_ratio: ArrayLike
) -> NDArray[np.float64]:
    """Rate shift under H1 as published, eta / (1 + eta) f_e (equations 13 and 17).

    Holds only while both phase errors are small; ``amplitude_ratio`` is eta, spoofer over
    authentic amplitude.
    """
    eta = np.asarray(amplitude_ratio, dtype=np.float64)
    return np.asarray(eta / (1.0 + eta) * np.asarray(drag_hz, dtype=np.float64))


def capture_rate_mean_hz(drag_hz: ArrayLike, amplitude_ratio: ArrayLike) -> NDArray[np.float64]:
    """Mean rate shift of a loop that follows the sum of both signals over many beats.

    The phase of 1 + eta exp(j 2 pi f_e t) turns with the stronger phasor: f_e where eta > 1, none
    where eta < 1, half where equal; on top comes a beat, bounded by asin(min(eta, 1/eta)).
    """
    eta = np.asarray(amplitude_ratio, dtype=np.float64)
    return np.asarray((1.0 + np.sign(eta - 1.0)) / 2.0 * np.asarray(drag_hz, dtype=np.float64))


def capture_phase_cycles(beat_cycles: ArrayLike, amplitude_ratio: ArrayLike) -> NDArray[np.float64]:
    """Phase of the sum of both signals against the authentic one, in (-1/2, 1/2] cycle.

    ``beat_cycles`` is the spoofer's phase against the authentic signal, f_e t plus its start. The
    loop follows this phase where it is fast enough; equation 13 is its small-angle form.
    """
    turned = np.exp(2j * np.pi * np.asarray(beat_cycles, dtype=np.float64))
    eta = np.asarray(amplitude_ratio, dtype=np.float64)
    return np.asarray(np.angle(1.0 + eta * turned) / (2.0 * np.pi))


def capture_phase_small_angle_cycles(
    beat_cycles: ArrayLike, amplitude_ratio: ArrayLike
) -> NDArray[np.float64]:
    """Phase of the loop as published, eta / (1 + eta) times the spoofer's phase (equation 13)."""
    return capture_rate_small_angle_hz(beat_cycles, amplitude_ratio)


def correlation_gain(offset_hz: ArrayLike, integration_s: float) -> NDArray[np.float64]:
    """Amplitude that a coherent integration keeps of a signal off in frequency: sinc(f T)."""
    return np.asarray(np.sinc(np.asarray(offset_hz, dtype=np.float64) * integration_s))


def folded_hz(offset_hz: ArrayLike, integration_s: float) -> NDArray[np.float64]:
    """What a frequency discriminator with updates each T makes of an offset: within +-1 / (2 T)."""
    turns = np.asarray(offset_hz, dtype=np.float64) * integration_s
    return np.asarray((turns - np.round(turns)) / integration_s)
