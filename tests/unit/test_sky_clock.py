"""The receiver's clock."""

import math

import numpy as np
import pytest
from skies import satellite, sky

from sdr_spoof.scenario.sky.clock import (
    ALLAN,
    FIRST_S,
    STEP_S,
    ReceiverClock,
    oscillator_noise_s,
)


def _allan_variance(x: np.ndarray, steps: int) -> float:
    """Overlapping, of time errors (IEEE Std 1139)."""
    second = x[2 * steps :] - 2 * x[steps:-steps] + x[: -2 * steps]
    return float(np.mean(second**2)) / (2 * (steps * STEP_S) ** 2)


@pytest.mark.parametrize(
    "allan",
    [(2e-19, 0.0, 0.0), (0.0, 7e-21, 0.0), (0.0, 0.0, 2e-20), ALLAN["TCXO"], ALLAN["OCXO"]],
)
def test_allan_variance_is_that_of_the_parameters(allan: tuple[float, float, float]) -> None:
    h0, h_1, h_2 = allan
    noises = [oscillator_noise_s(allan, 10_000, seed) for seed in range(24)]
    for steps in (30, 100, 300):
        tau = steps * STEP_S
        found = np.array([_allan_variance(x, steps) for x in noises])
        expected = h0 / (2 * tau) + 2 * math.log(2) * h_1 + 2 * math.pi**2 / 3 * h_2 * tau
        standard_error = found.std(ddof=1) / math.sqrt(found.size)
        assert abs(found.mean() - expected) < 4 * standard_error, tau


def test_it_is_a_pure_function_of_time() -> None:
    clock = ReceiverClock(oscillator="TCXO", offset_us=1.0, drift_ppb=20.0)
    short, long = clock.offset_s(300, seed=4), clock.offset_s(4000, seed=4)
    assert np.array_equal(short, long[:300])
    assert not np.array_equal(short, clock.offset_s(300, seed=5))
    at_zero = round(-FIRST_S / STEP_S)
    assert short[at_zero] == pytest.approx(1e-6, abs=1e-15)
    ideal = ReceiverClock(offset_us=1.0, drift_ppb=20.0).offset_s(41, seed=1)
    assert ideal == pytest.approx(1e-6 + 20e-9 * (FIRST_S + STEP_S * np.arange(41)), abs=1e-18)


def test_all_ranges_share_it() -> None:
    right, wrong = sky(), sky(clock={"oscillator": "TCXO", "offset_us": 5.0, "drift_ppb": 100.0})
    offset_m = wrong.sky_model().clock_s * 299_792_458.0  # type: ignore[union-attr]
    for system, prn in (("C", 30), ("G", 25)):
        first, second = (satellite(s, system, prn).track.view.range_m for s in (right, wrong))
        # 1.5 km of clock are 5 us, in which a satellite moves by mm.
        assert second - first == pytest.approx(offset_m, abs=6e-3)


def test_own_parameters_replace_the_usual_ones() -> None:
    assert ReceiverClock(oscillator="OCXO", h_1=0.0).allan == (2e-25, 0.0, 6e-25)
    with pytest.raises(ValueError, match="half a second"):
        ReceiverClock(offset_us=6e5)
    with pytest.raises(ValueError, match="100 ppm"):
        ReceiverClock(drift_ppb=-2e5)
