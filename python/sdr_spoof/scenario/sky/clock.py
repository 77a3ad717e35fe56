"""The receiver's clock: offset, drift and noise of an oscillator by its Allan parameters.

The fractional frequency has the power density h0 + h-1 / f + h-2 / f^2 (one-sided), and the clock
then the Allan variance h0 / (2 tau) + 2 ln 2 h-1 + (2 pi^2 / 3) h-2 tau (IEEE Std 1139-2008, annex
B). The values of oscillators are those of R. G. Brown and P. Y. C. Hwang, "Introduction to Random
Signals and Applied Kalman Filtering", 4th edition, section 9.3: a TCXO of high quality, one of low
quality, whose noise is too much for a carrier loop of 10 Hz, and an OCXO.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, Self

import numpy as np
from pydantic import BaseModel, Field, model_validator
from scipy.signal import lfilter

from sdr_spoof.scenario.base import FROZEN, NonNegative
from sdr_spoof.scenario.draw import integer

if TYPE_CHECKING:
    from numpy.typing import NDArray

STEP_S = 0.1
"""Spacing of the noise; the clock is smooth in between."""
FIRST_S = -2.0
"""The noise begins here, so that the filter of a front end finds it before 0 s."""

ALLAN = {
    "ideal": (0.0, 0.0, 0.0),
    "TCXO": (2e-21, 1e-22, 2e-20),
    "poor-TCXO": (2e-19, 7e-21, 2e-20),
    "OCXO": (2e-25, 7e-25, 6e-25),
}
"""h0 in s, h-1, h-2 in 1/s."""

_RATIO = math.sqrt(10.0)
"""Between the correlation times of the processes that make up the flicker noise."""
_LONGEST_S = 1e5


class ReceiverClock(BaseModel):
    """The receiver's clock: table ``[sky.clock]``."""

    model_config = FROZEN

    offset_us: float = Field(0.0, description="clock less system time at 0 s")
    drift_ppb: float = Field(0.0, description="constant frequency error, ns/s; positive: fast")
    oscillator: Literal["ideal", "TCXO", "poor-TCXO", "OCXO"] = Field(
        "ideal", description="noise: of a good or a poor TCXO, of an OCXO, or none"
    )
    h0: NonNegative | None = Field(None, description="white frequency noise, instead, in s")
    h_1: NonNegative | None = Field(None, description="flicker frequency noise, instead")
    h_2: NonNegative | None = Field(None, description="random-walk frequency noise, instead, 1/s")

    @model_validator(mode="after")
    def _in_bounds(self) -> Self:
        if abs(self.offset_us) > 5e5:
            raise ValueError("offset_us is over half a second; such a clock would be set first")
        if abs(self.drift_ppb) > 1e5:
            raise ValueError("drift_ppb is over 100 ppm, which no receiver's oscillator has")
        return self

    @property
    def allan(self) -> tuple[float, float, float]:
        """h0, h-1, h-2."""
        given = (self.h0, self.h_1, self.h_2)
        usual = ALLAN[self.oscillator]
        h0, h_1, h_2 = (u if g is None else g for g, u in zip(given, usual, strict=True))
        return h0, h_1, h_2

    @property
    def is_ideal(self) -> bool:
        """Whether it has no noise."""
        return not any(self.allan)

    def offset_s(self, steps: int, seed: int) -> NDArray[np.float64]:
        """Clock less system time, in s, at ``FIRST_S + STEP_S k``, k from 0 to ``steps`` - 1.

        A value depends on the seed and on its own k alone, not on how many there are.
        """
        time_s = FIRST_S + STEP_S * np.arange(steps)
        noise_s = np.zeros(steps)
        if not self.is_ideal:
            noise_s = oscillator_noise_s(self.allan, steps, integer("clock", seed))
            # Offset and drift are those at 0 s, whatever the noise has been before.
            origin = round(-FIRST_S / STEP_S)
            noise_s = noise_s - (noise_s[origin] if steps > origin else noise_s[-1])
        return np.asarray(self.offset_us * 1e-6 + self.drift_ppb * 1e-9 * time_s + noise_s)


def oscillator_noise_s(
    allan: tuple[float, float, float], steps: int, seed: int
) -> NDArray[np.float64]:
    """Time error of an oscillator at multiples of :data:`STEP_S`, in s, 0 at first.

    Random-walk and flicker noise are frequencies, white noise is that of the phase's increments.
    Flicker noise is the sum of first-order Gauss-Markov processes whose correlation times are a
    factor of sqrt(10) apart, each of the variance h-1 ln(sqrt(10)).
    """
    h0, h_1, h_2 = allan
    stream = (np.random.default_rng([seed, kind]) for kind in range(3 + 2 * _processes()))
    white, walk, start = (next(stream) for _ in range(3))
    frequency = _integrated(walk.standard_normal(steps)) * math.pi * math.sqrt(2 * h_2 * STEP_S)
    deviation = math.sqrt(h_1 * math.log(_RATIO))
    for k in range(_processes()):
        keep = math.exp(-STEP_S / (STEP_S * _RATIO**k))
        drive = next(stream).standard_normal(steps) * math.sqrt(1 - keep**2)
        first = start.standard_normal()
        frequency += deviation * lfilter([1.0], [1.0, -keep], drive, zi=[keep * first])[0]
    increments = STEP_S * frequency
    increments += white.standard_normal(steps) * math.sqrt(0.5 * h0 * STEP_S)
    return _integrated(increments)


def _processes() -> int:
    """From the step to the longest correlation time."""
    return round(math.log(_LONGEST_S / STEP_S) / math.log(_RATIO)) + 1


def _integrated(steps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Running sum, 0 at first."""
    return np.concatenate([[0.0], np.cumsum(steps[:-1])])
