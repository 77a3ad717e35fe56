"""What several statistics share: changes, errors of the INS, series in east, north and up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from sdr_spoof.detectors.series import StatisticSeries

from . import budget, growth
from .changes import Changes, States, at_epochs, changes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.rate_config import RateConfig
    from sdr_spoof.aiding.records import InertialStates, Measurements

    Floats = NDArray[np.float64]

DIRECTIONS = ("east", "north", "up")
ALL_SATELLITES = ("", 0)
"""System and PRN of a series that no single satellite is behind."""


@dataclass(frozen=True)
class Prepared:
    """Measurements and INS, compared."""

    changes: Changes
    ins: States
    steps: growth.Steps
    covariance: Floats
    """Of the free INS, (E, 15, 15)."""


def prepare(measurements: Measurements, states: InertialStates, config: RateConfig) -> Prepared:
    """Compare, and let the errors of the INS grow by their model.

    Raises:
        NavigationError: INS and measurements do not overlap.
        ConfigError: there is no such grade of IMU.
    """
    ins = at_epochs(measurements, states)
    steps = growth.steps(ins, measurements.time_s, budget.of(config))
    return Prepared(changes(measurements, states, config), ins, steps, growth.covariances(steps))


def local(axes: Floats, covariance: Floats) -> Floats:
    """A covariance in the axes given, (E, 3, 3)."""
    return np.asarray(axes @ covariance @ np.swapaxes(axes, -1, -2))


def in_direction(
    name: str,
    number: int,
    rows: NDArray[np.bool_],
    values: tuple[Floats, Floats, Floats],
    found: Changes,
    *,
    window_s: float,
    trace: Floats,
    units: tuple[str, str],
    pfa: float,
    notes: tuple[str, ...] = (),
) -> StatisticSeries:
    """Series of one direction: value, sigma and noise (E,) where ``rows`` is true."""
    value, sigma, noise = values
    return StatisticSeries(
        detector=name,
        system=ALL_SATELLITES[0],
        prn=ALL_SATELLITES[1],
        unit=units[0],
        time_s=found.time_s[rows],
        value=value[rows],
        sigma=sigma[rows],
        sigma_thermal=noise[rows],
        segment=found.segment[rows],
        window_s=window_s,
        trace_time_s=found.time_s,
        trace=trace,
        trace_unit=units[1],
        trace_segment=found.segment,
        notes=notes,
        quantity=DIRECTIONS[number],
        share=1.0 / len(DIRECTIONS),
        threshold_sigmas=float(norm.isf(pfa / len(DIRECTIONS) / 2)),
    )


def too_old(
    supported: NDArray[np.bool_], possible: NDArray[np.bool_], found: Changes
) -> str | None:
    """In words, where the INS has become too old for the power that is required."""
    refused = possible & ~supported
    if not refused.any():
        return None
    first = int(np.argmax(refused))
    return (
        f"{int(refused.sum())} of {int(possible.sum())} epochs not judged: from "
        f"{found.age_s[first]:.0f} s after alignment the drift of the INS hides the drag to be "
        "found; align it anew, or use rate_local or rate_drag"
    )
