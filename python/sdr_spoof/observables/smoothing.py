"""Code smoothed by the carrier: the mean of code minus carrier, added to the carrier.

R. Hatch, The synergism of GPS code and carrier measurements, 1982, with a memory that grows to a
time constant and is exponential then. The ionosphere delays the code and advances the carrier: the
smoothed code lags by twice its rate times the time constant.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .runs import Run


def smoothed(run: Run, time_constant_s: float) -> Run:
    """The run with its code (oscillator plus discriminator) smoothed; anew after each slip."""
    carrier_s = -run.phase_cycles / run.spec.carrier_hz
    difference_s = run.code_s + run.code_error_s - carrier_s
    keep = np.exp(-run.integration_s / time_constant_s)
    starts = [0, *np.flatnonzero(run.slipped[1:] & ~run.slipped[:-1]) + 1, run.time_s.size]
    means = [_mean(difference_s[a:b], keep) for a, b in pairwise(starts)]
    return replace(run, code_s=carrier_s + np.concatenate(means))


def _mean(values: NDArray[np.float64], keep: float) -> NDArray[np.float64]:
    """Mean of all values up to each, weighted by ``keep`` to the power of their age."""
    from scipy.signal import lfilter  # noqa: PLC0415 - slow to import, rarely needed

    start = values[0]
    total = lfilter([1.0], [1.0, -keep], values - start)
    weight = lfilter([1.0], [1.0, -keep], np.ones_like(values))
    return np.asarray(start + total / weight)
