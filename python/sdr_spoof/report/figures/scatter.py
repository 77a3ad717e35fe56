"""Scatter of fixes: at rest about their median; in motion against what their neighbours say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.route import Route

STATIC_M = 20.0
"""A track that keeps within this is drawn as that of a receiver at rest."""
FURTHEST_S = 2.5
"""Between the neighbours of a fix: at 30 m/s and 1 g the curve is then off by 0.1 m at most."""


def scatter_of(route: Route, local_m: NDArray[np.float64]) -> tuple[NDArray[np.float64], str]:
    """Scatter of each fix in m, (E, 3), NaN where it is not known; and a title that says of what.

    ``local_m`` are the positions about their median, (E, 3).
    """
    known = local_m[np.isfinite(local_m).all(axis=1), :2]
    if not len(known):
        return local_m, "Scatter: no fix"
    if np.ptp(known, axis=0).max() < STATIC_M:
        return local_m, f"Scatter about the median: {_rms(local_m)}"
    scatter = against_neighbours(route.sample_time_s, local_m, route.velocity_enu_m_s)
    return scatter, f"Off what neighbours and velocities say: {_rms(scatter)}"


def against_neighbours(
    time_s: NDArray[np.float64], place_m: NDArray[np.float64], velocity_m_s: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Each place less the cubic through its two neighbours with their velocities (Hermite's).

    Scaled to the scatter of one place: neighbours are as noisy as it is, velocities less.
    """
    scatter = np.full(place_m.shape, np.nan)
    span = time_s[2:] - time_s[:-2]
    u = ((time_s[1:-1] - time_s[:-2]) / span)[:, None]
    first, last = (1.0 + 2.0 * u) * (1.0 - u) ** 2, u * u * (3.0 - 2.0 * u)
    bend = u * (1.0 - u) ** 2 * velocity_m_s[:-2] - u * u * (1.0 - u) * velocity_m_s[2:]
    expected = first * place_m[:-2] + last * place_m[2:] + span[:, None] * bend
    off = (place_m[1:-1] - expected) / np.sqrt(1.0 + first**2 + last**2)
    scatter[1:-1] = np.where(span[:, None] <= FURTHEST_S, off, np.nan)
    return scatter


def _rms(values: NDArray[np.float64]) -> str:
    flat = values[np.isfinite(values).all(axis=1), :2]
    return f"{np.sqrt((flat**2).sum(axis=1).mean()):.2g} m RMS" if len(flat) else "too few fixes"
