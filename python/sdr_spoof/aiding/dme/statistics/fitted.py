"""The published detection quantity: the fitted pseudorange difference of each satellite.

Delta_j = (G (G' W' W G)^-1 G' W' W y)_j (equation 13 of the INS/DME publication), normalised. It is
what least squares explains by an error of position and clocks. Hence it contains the receiver's
clock error, which must be known or taken off before; what cannot be such an error (the parity) is
thrown away; and a spoofed satellite moves the position and with it the fitted values of healthy
ones. DME does not change it: against pseudoranges of metres its hundreds of metres weigh nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .statistic import Statistic, normalised

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.aiding.dme.geometry import Geometry


def weights(geometry: Geometry) -> NDArray[np.float64]:
    """Rows of the hat matrix, (n, m)."""
    return normalised(geometry.hat()[: geometry.satellites], geometry)


STATISTIC = Statistic(
    "fitted",
    "Fitted difference",
    "whether GNSS sees an error of the inertial position and the clock",
    "a captured INS; which satellite is spoofed; it takes a jump of the receiver's clock for an "
    "attack",
    weights,
    by_satellite=True,
)
