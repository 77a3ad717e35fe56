"""How GNSS corrects the inertial reference, and a spoofer with it: models of a feedback.

Each epoch the error that GNSS sees in the inertial position is fed back in part. A spoofed GNSS so
draws the reference after it: the INS is captured, with a time constant.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from sdr_spoof.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .geometry import Geometry

Kind = Literal["none", "loose", "tight", "velocity"]


@dataclass(frozen=True)
class Feedback:
    """A model of the feedback.

    ``none``: the INS goes its own way. ``loose``: the fix by least squares corrects the position,
    first order. ``tight``: the pseudoranges do, each as far as it tells the position, so that well
    seen directions follow sooner than badly seen ones; the same time constant on average.
    ``velocity``: the fix corrects position and velocity, second order and critically damped: a drag
    at constant speed leaves no lag.
    """

    kind: Kind = "none"
    time_s: float = 10.0
    """Time constant."""
    noisy: bool = True
    """Whether the noise of the pseudoranges is fed back too: it colours the differences. Without,
    the INS is as quiet as one that is corrected by long means."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        if self.kind not in ("none", "loose", "tight", "velocity") or not self.time_s > 0.0:
            raise ConfigError(
                f"feedback '{self.kind}' with {self.time_s:g} s: known are none, loose, tight and "
                "velocity, with a time constant above 0 s"
            )

    def gains(
        self, geometry: Geometry, interval_s: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Corrections of position and velocity (per epoch) from the rows of GNSS, (3, n) each."""
        gnss = geometry.without_stations()
        keep = float(np.exp(-interval_s / self.time_s))
        nothing = np.zeros((3, gnss.satellites))
        if self.kind == "none":
            return nothing, nothing
        if self.kind == "tight":
            return _tight(gnss, 1.0 - keep), nothing
        fix = gnss.estimator()[:3]
        if self.kind == "loose":
            return (1.0 - keep) * fix, nothing
        return (1.0 - keep**2) * fix, (1.0 - keep) ** 2 * fix


def _tight(gnss: Geometry, wanted: float) -> NDArray[np.float64]:
    """Kalman's gain with a prior as large as gives the wanted correction on average."""
    # The clock is eliminated by taking the mean of all rows off.
    rows = len(gnss.design)
    centre = np.eye(rows) - 1.0 / rows
    seen = centre @ gnss.design[:, :3] / gnss.sigma_m[:, None]
    low, high = 1e-6, 1e6
    for _ in range(80):
        prior = np.sqrt(low * high)
        gain = np.linalg.solve(seen.T @ seen + np.eye(3) / prior**2, seen.T)
        low, high = (low, prior) if np.trace(gain @ seen) / 3.0 > wanted else (prior, high)
    return np.asarray(gain @ centre / gnss.sigma_m)
