"""Height of the geoid above the ellipsoid."""

from __future__ import annotations

import numpy as np
import pytest

from sdr_spoof.nav.geoid import TABLE, geoid_height_m

TRUE_WITHIN_M = 0.3

# The agency's own check values for EGM2008 (OUTPUT.DAT of its interpolation programs), and two
# places from its calculator, computed from the full expansion.
EGM2008 = [
    (37.0, 241.0, -26.151),
    (37.0, -119.0, -26.151),
    (90.0, 0.0, 14.899),
    (-90.0, 359.983333, -30.150),
    (-90.0, 0.0, -30.150),
    (42.244169, -83.5066427, -34.89),
    (33.276390, -112.282220, -30.86),
]
# The agency's check values for EGM96 (OUTINTPT.DAT of F477), which differs by decimetres.
EGM96 = [
    (38.6281550, 269.7791550, -31.628),
    (-14.6212170, 305.0211140, -2.969),
    (46.8743190, 102.4487290, -43.575),
    (-23.6174460, 133.8747120, 15.871),
    (38.6254730, 359.9995000, 50.066),
    (-0.4667440, 0.0023000, 17.329),
]


@pytest.mark.parametrize(("latitude", "longitude", "published"), EGM2008)
def test_published_values_are_met(latitude, longitude, published):
    assert geoid_height_m(latitude, longitude) == pytest.approx(published, abs=TRUE_WITHIN_M)


@pytest.mark.parametrize(("latitude", "longitude", "published"), EGM96)
def test_older_model_is_near(latitude, longitude, published):
    assert geoid_height_m(latitude, longitude) == pytest.approx(published, abs=1.0)


def test_longitudes_wrap():
    around = geoid_height_m([10.0] * 3, [-0.1, 359.9, 719.9])
    assert np.ptp(around) < 1e-9
    seam = geoid_height_m([10.0] * 3, [359.999, 0.0, 0.001])
    assert np.ptp(seam) < 0.01


def test_poles_have_one_height():
    for pole in (90.0, -90.0):
        assert np.ptp(geoid_height_m(np.full(8, pole), np.linspace(-180, 180, 8))) < 1e-9


def test_lowest_and_highest_are_where_they_should_be():
    latitude, longitude = np.meshgrid(np.arange(-90, 91.0), np.arange(0, 360.0), indexing="ij")
    heights = geoid_height_m(latitude, longitude)
    low, high = (np.unravel_index(k, heights.shape) for k in (heights.argmin(), heights.argmax()))
    assert heights[low] == pytest.approx(-106.9, abs=1.0)  # south of Ceylon
    assert (abs(latitude[low] - 4.7) < 2, abs(longitude[low] - 78.8) < 2) == (True, True)
    assert heights[high] == pytest.approx(85.8, abs=2.0)  # New Guinea
    assert (abs(latitude[high] + 8.4) < 2, abs(longitude[high] - 147.3) < 2) == (True, True)


def test_unknown_places_have_none():
    assert np.isnan(geoid_height_m([np.nan, 1.0], [1.0, np.nan])).all()


def test_table_is_small():
    assert TABLE.stat().st_size < 200_000
