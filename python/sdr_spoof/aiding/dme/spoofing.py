"""What a spoofer adds to the pseudoranges of some satellites, as a function of time.

Each kind is a function of times since the first epoch (N,) and the geometry that gives (N, n).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .geometry import Geometry

Spoofing = Callable[["NDArray[np.float64]", "Geometry"], "NDArray[np.float64]"]


def step(satellites: Sequence[int], size_m: float, onset_s: float) -> Spoofing:
    """Later by a constant from the onset on."""
    return _times(satellites, lambda since: np.where(since >= 0.0, size_m, 0.0), onset_s)


def ramp(satellites: Sequence[int], rate_m_s: float, onset_s: float) -> Spoofing:
    """Later by a growing amount."""
    return _times(satellites, lambda since: rate_m_s * np.maximum(since, 0.0), onset_s)


def clock_only(size_m: float, rate_m_s: float, onset_s: float) -> Spoofing:
    """All satellites alike: the receiver's clock is moved, its position is not."""

    def added(time_s: NDArray[np.float64], geometry: Geometry) -> NDArray[np.float64]:
        since = time_s - onset_s
        course = np.where(since >= 0.0, size_m + rate_m_s * since, 0.0)
        return np.asarray(np.repeat(course[:, None], geometry.satellites, axis=1))

    return added


def coherent(
    direction: ArrayLike, rate_m_s: float, onset_s: float, size_m: float = 0.0
) -> Spoofing:
    """All satellites as from a false trajectory: a step and a drag along east, north, up."""
    along = np.asarray(direction, dtype=np.float64)
    along = along / np.linalg.norm(along)

    def added(time_s: NDArray[np.float64], geometry: Geometry) -> NDArray[np.float64]:
        since = time_s - onset_s
        moved = np.where(since >= 0.0, size_m + rate_m_s * since, 0.0)
        # A receiver that is moved by d measures G d more, clock aside.
        return np.asarray(moved[:, None] * (geometry.design[: geometry.satellites, :3] @ along))

    return added


def _times(
    satellites: Sequence[int],
    course: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    onset_s: float,
) -> Spoofing:
    def added(time_s: NDArray[np.float64], geometry: Geometry) -> NDArray[np.float64]:
        of = np.zeros(geometry.satellites)
        of[list(satellites)] = 1.0
        return np.asarray(course(time_s - onset_s)[:, None] * of)

    return added
