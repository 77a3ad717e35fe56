"""Laws of samples under H0 that a rule can be calibrated for: mean 0 and variance 1 each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter, lfiltic

from sdr_spoof.errors import ConfigError

Draw = Callable[[np.random.Generator, tuple[int, int], float], NDArray[np.float64]]


@dataclass(frozen=True)
class Law:
    """A law by name, with its one parameter."""

    name: str = "normal"
    parameter: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        if self.name not in LAWS:
            raise ConfigError(f"unknown law '{self.name}'; known laws: {', '.join(LAWS)}")
        low, high = LIMITS[self.name]
        if not low < self.parameter < high:
            raise ConfigError(
                f"law '{self.name}': the parameter is {self.parameter:g}, it must lie between "
                f"{low:g} and {high:g}"
            )

    def draw(self, rng: np.random.Generator, shape: tuple[int, int]) -> NDArray[np.float64]:
        """Rows of samples."""
        return LAWS[self.name](rng, shape, self.parameter)


def _normal(
    rng: np.random.Generator, shape: tuple[int, int], parameter: float
) -> NDArray[np.float64]:
    del parameter
    return rng.standard_normal(shape)


def _ar1(rng: np.random.Generator, shape: tuple[int, int], rho: float) -> NDArray[np.float64]:
    """x_k = rho x_(k-1) + white noise."""
    noise = rng.standard_normal(shape)
    noise[:, 1:] *= (1.0 - rho**2) ** 0.5
    state = lfiltic([1.0], [1.0, -rho], [0.0])[None, :].repeat(shape[0], 0)
    return np.asarray(lfilter([1.0], [1.0, -rho], noise, axis=1, zi=state)[0])


def _ma1(rng: np.random.Generator, shape: tuple[int, int], theta: float) -> NDArray[np.float64]:
    """x_k = e_k + theta e_(k-1); -1 is a difference of white noise."""
    noise = rng.standard_normal((shape[0], shape[1] + 1))
    return np.asarray((noise[:, 1:] + theta * noise[:, :-1]) / np.hypot(1.0, theta))


def _student(
    rng: np.random.Generator, shape: tuple[int, int], freedom: float
) -> NDArray[np.float64]:
    return np.asarray(rng.standard_t(freedom, shape) * ((freedom - 2.0) / freedom) ** 0.5)


LAWS: dict[str, Draw] = {"normal": _normal, "ar1": _ar1, "ma1": _ma1, "student": _student}
"""Every law, by name: white normal noise; autoregressive with a coefficient; a moving average of
two with a coefficient; Student's with degrees of freedom."""
LIMITS = {
    "normal": (-1.0, 1.0),
    "ar1": (-1.0, 1.0),
    "ma1": (-1.0001, 1.0001),
    "student": (2.0, np.inf),
}
NORMAL = Law()
