"""What a sequential rule is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar

import numpy as np

from sdr_spoof.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from sdr_spoof.decision.record import Decision, Refusal
    from sdr_spoof.detectors.config import DetectionConfig
    from sdr_spoof.detectors.series import StatisticSeries

Parameters = TypeVar("Parameters")


@dataclass(frozen=True)
class Change:
    """What the samples would look like under the changes that a rule looks for.

    Calibration draws from it, so that rare alarms are common, and weighs by the likelihood.
    """

    shifts: tuple[float, ...] = ()
    """Shifts of the mean, in standard deviations, each to both sides."""
    scale: float = 1.0
    """Standard deviation of samples whose mean has shifted."""
    energy: bool = False
    """Whether samples whose density has gained the factor z^2 belong to it too, as likely as all
    shifts together."""
    from_start: bool = False
    """Whether the change is there from the first sample, or may begin at any."""
    template: tuple[float, ...] = ()
    """Weights of a statistic that is a weighted sum of its last samples, oldest first, squares
    summing to 1: what is added, times a size, are these weights themselves."""
    sizes: tuple[float, ...] = ()
    """Of the template, in standard deviations of the statistic."""


@dataclass(frozen=True)
class SequentialRule(Generic[Parameters]):
    """A registered rule: a statistic that grows with the evidence, and its parameters."""

    name: str
    title: str
    tests: str
    """What it accumulates, in words for the report."""
    path: Callable[[NDArray[np.float64], Parameters], NDArray[np.float64]]
    """Samples in standard deviations, (..., N), to the statistic after each, (..., N). A sample
    that is missing (NaN) is skipped, and its place in the path is NaN."""
    parameters: Parameters
    change: Callable[[Parameters], Change]
    scale: Literal["log-likelihood", "deviate", "squares"] = "log-likelihood"
    """What the statistic is: a log-likelihood ratio, the size of a normal deviate, or a sum of
    squares."""
    forgets: bool = True
    """Whether its law under H0 settles; else it depends on the time since the start."""
    configured: Callable[[Parameters, DetectionConfig], Parameters] = field(
        default=lambda parameters, _: parameters
    )
    """Its parameters with what the configuration says."""
    decide: Callable[[StatisticSeries, DetectionConfig], Decision | Refusal | None] | None = None
    """A decision on a series of its own, where the rule is not for independent samples."""

    def with_(self, **changes: Any) -> SequentialRule[Parameters]:
        """The rule with other parameters; raises ConfigError where it has none of that name."""
        try:
            return replace(self, parameters=replace(self.parameters, **changes))  # type: ignore[type-var]
        except TypeError as error:
            raise ConfigError(f"rule '{self.name}': {error}") from error

    def run(self, z: ArrayLike) -> NDArray[np.float64]:
        """The path over the last axis of samples of any shape, at least one axis."""
        return self.path(np.atleast_1d(np.asarray(z, dtype=np.float64)), self.parameters)


def by_rows(
    kernel: Callable[[NDArray[np.float64]], NDArray[np.float64]], z: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Hand samples of any shape to a kernel of rows."""
    if z.size == 0:
        return np.zeros(z.shape)
    rows = np.ascontiguousarray(z, dtype=np.float64).reshape(-1, z.shape[-1])
    return kernel(rows).reshape(z.shape)


def checked(rule: str, **limits: tuple[float, float]) -> None:
    """Raise ConfigError for a parameter below its least value: name to (value, least)."""
    for name, (value, least) in limits.items():
        if not value >= least:
            raise ConfigError(f"rule '{rule}': {name} is {value:g}, it must be at least {least:g}")


def first_alarm(path: NDArray[np.float64], threshold: float) -> NDArray[np.int64]:
    """Row of the first statistic above the threshold, shape (...,); N where there is none."""
    above = path > threshold
    return np.asarray(np.where(above.any(-1), above.argmax(-1), path.shape[-1]))


def latched(path: NDArray[np.float64], threshold: float) -> NDArray[np.bool_]:
    """Whether the alarm stands after each sample: once raised, it stays."""
    return np.logical_or.accumulate(path > threshold, axis=-1)
