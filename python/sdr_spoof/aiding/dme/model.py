"""Many runs of what INS, GNSS and DME say of each other, by the linear measurement model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .feedback import Feedback

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .geometry import Geometry
    from .spoofing import Spoofing


@dataclass(frozen=True)
class Runs:
    """R runs of N epochs."""

    time_s: NDArray[np.float64]
    """Since the first epoch, (N,)."""
    differences_m: NDArray[np.float64]
    """Predicted less measured, satellites and then stations, (R, N, m)."""
    error_m: NDArray[np.float64]
    """Error of the inertial position, east, north, up, (R, N, 3)."""


def simulate(
    geometry: Geometry,
    epochs: int,
    runs: int,
    random: np.random.Generator,
    *,
    spoofing: Spoofing | None = None,
    feedback: Feedback | None = None,
    drift_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0),
    clock_m: tuple[float, float] = (0.0, 0.0),
    interval_s: float = 1.0,
) -> Runs:
    """Runs with white noise.

    Args:
        geometry: satellites and stations; it stands still.
        epochs: N.
        runs: R.
        random: of the noise.
        spoofing: what is added to pseudoranges.
        feedback: how GNSS corrects the INS.
        drift_m_s: of the INS by itself.
        clock_m: c dt of the GNSS receiver, and of DME.
        interval_s: between epochs.
    """
    time_s = np.arange(epochs, dtype=np.float64) * interval_s
    n = geometry.satellites
    feedback = feedback or Feedback()
    course = np.zeros((1, epochs, len(geometry.sigma_m)))
    course[..., :n] -= clock_m[0]
    course[..., n:] -= clock_m[1]
    if spoofing is not None:
        course[..., :n] -= spoofing(time_s, geometry)
    noise = random.standard_normal((runs, epochs, len(geometry.sigma_m)))
    alone = np.asarray(course + noise * geometry.sigma_m)
    fed = alone if feedback.noisy else course
    error = _drawn(fed, geometry, feedback, np.array(drift_m_s), interval_s)
    differences = np.asarray(alone + error @ geometry.design[:, :3].T)
    return Runs(time_s, differences, np.broadcast_to(error, (runs, epochs, 3)))


def _drawn(
    y: NDArray[np.float64],
    geometry: Geometry,
    feedback: Feedback,
    drift_m_s: NDArray[np.float64],
    interval_s: float,
) -> NDArray[np.float64]:
    """Error of the inertial position from what GNSS has corrected it by, (R, N, 3); R may be 1."""
    runs, epochs, n = y.shape[0], y.shape[1], geometry.satellites
    error = np.zeros((runs, epochs, 3))
    if feedback.kind == "none":
        error += (interval_s * np.arange(epochs))[:, None] * drift_m_s
        return error
    position, velocity = feedback.gains(geometry, interval_s)
    design = geometry.design[:n, :3]
    speed = np.zeros((runs, 3))
    for k in range(1, epochs):
        seen = y[:, k - 1, :n] + error[:, k - 1] @ design.T
        speed = speed - seen @ velocity.T
        moved = speed + drift_m_s * interval_s - seen @ position.T
        error[:, k] = error[:, k - 1] + moved
    return error
