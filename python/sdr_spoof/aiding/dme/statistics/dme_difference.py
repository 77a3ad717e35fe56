"""DME against the INS, one station against the first: the only thing that a spoofer does not touch.

y_1 - y_i of the stations, in which the DME's own clock drops out. It moves by (d_1 - d_i) e with
the error e of the inertial position, d the unit vectors from the stations. Hence it sees a captured
INS even where all satellites follow one false trajectory, along (d_1 - d_i) and not across; with
stations in line it sees nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError

from .statistic import Statistic, normalised

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.dme.geometry import Geometry

LEAST_APART = 0.2
"""Length of d_1 - d_i below which stations are in line: an angle of 11 degrees."""


def weights(geometry: Geometry) -> NDArray[np.float64]:
    """One row for every station but the first, (d - 1, m)."""
    n, d = geometry.satellites, geometry.stations
    if d < 2:
        raise AidingError(f"{d} DME stations cannot be compared with each other; two are needed")
    apart = np.linalg.norm(geometry.design[n, :3] - geometry.design[n + 1 :, :3], axis=1)
    if not np.any(apart > LEAST_APART):
        raise AidingError(
            "the DME stations lie in line with the receiver: their difference does not see its "
            "position; stations in other directions are needed"
        )
    rows = np.zeros((d - 1, n + d))
    rows[:, n] = 1.0
    rows[np.arange(d - 1), n + 1 + np.arange(d - 1)] = -1.0
    return normalised(rows[apart > LEAST_APART], geometry)


STATISTIC = Statistic(
    "dme-difference",
    "DME difference",
    "whether the DME ranges are what the inertial position predicts",
    "displacements across the difference of the directions to the stations; those well below the "
    "noise of DME, some hundred metres; an INS that is not captured",
    weights,
    by_satellite=False,
)
