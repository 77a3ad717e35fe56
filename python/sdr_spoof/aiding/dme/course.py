"""How far the fix of GNSS is from the INS, over time, with and without some satellites."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import NDArray

    from .observed import Differences


def fix_course(
    found: Differences, epochs: NDArray[np.int64], left_out: Collection[int] = ()
) -> NDArray[np.float64]:
    """Least squares of each epoch: east, north, up from the INS's place, (K, 3).

    Args:
        found: differences of all epochs.
        epochs: some of them, (K,).
        left_out: columns of satellites that are not used.

    NaN where the satellites give no position.
    """
    course = np.full((epochs.size, 3), np.nan)
    for k, epoch in enumerate(epochs.tolist()):
        known = found.known(epoch)
        used = known[(known < found.count) & ~np.isin(known, list(left_out))]
        try:
            fix = found.geometry(epoch, used).estimator()[:3]
        except AidingError:
            continue
        # A difference is predicted less measured: the fix is where the INS's error is taken off.
        course[k] = -fix @ found.differences_m[epoch, used]
    return course
