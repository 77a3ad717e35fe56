"""Height of the geoid (mean sea level) above the WGS-84 ellipsoid, by a coarse table of EGM2008.

Source: Pavlis, Holmes, Kenyon and Factor, "The development and evaluation of the Earth
Gravitational Model 2008", J. Geophys. Res. 117 (2012) B04406; every twelfth value of the grid of
2.5 minutes of the US National Geospatial-Intelligence Agency (tide-free), rounded to 0.1 m.
Between its nodes the table is 0.22 m (rms) off that grid, 0.9 m at the 99th percentile, 6.7 m at
most (a steep mountain coast): see docs/validation.md.
"""

from __future__ import annotations

import lzma
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

TABLE = Path(__file__).parent / "data" / "egm2008-30min.xz"
"""Differences of differences (rows, then columns), 16 bits, of values in decimetres."""
PER_DEGREE = 2
ROWS, COLUMNS = 180 * PER_DEGREE + 1, 360 * PER_DEGREE
UNIT_M = 0.1


def geoid_height_m(latitude_deg: ArrayLike, longitude_deg: ArrayLike) -> NDArray[np.float64]:
    """Geoid above ellipsoid in m, bilinear between nodes; take it off a height above the ellipsoid.

    Arguments have one shape, latitudes within 90 degrees, any longitudes; NaN gives NaN.
    """
    latitude, longitude = np.broadcast_arrays(
        np.asarray(latitude_deg, np.float64), np.asarray(longitude_deg, np.float64)
    )
    known = np.isfinite(latitude) & np.isfinite(longitude)
    south = np.where(known, 90.0 - latitude, 0.0) * PER_DEGREE
    east = np.where(known, longitude % 360.0, 0.0) * PER_DEGREE
    row = np.minimum(south.astype(np.intp), ROWS - 2)
    column = np.minimum(east.astype(np.intp), COLUMNS - 1)
    down, right = south - row, east - column
    heights, beside = _heights(), (column + 1) % COLUMNS
    upper = heights[row, column] * (1 - right) + heights[row, beside] * right
    lower = heights[row + 1, column] * (1 - right) + heights[row + 1, beside] * right
    return np.where(known, upper * (1 - down) + lower * down, np.nan)


@cache
def _heights() -> NDArray[np.float64]:
    """In m, from the north pole southwards and from 0 degrees eastwards (ROWS, COLUMNS)."""
    steps = np.frombuffer(lzma.decompress(TABLE.read_bytes()), "<i2").reshape(ROWS, COLUMNS)
    return steps.astype(np.int64).cumsum(axis=0).cumsum(axis=1) * UNIT_M
