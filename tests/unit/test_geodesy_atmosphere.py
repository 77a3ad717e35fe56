"""Geodesy and delays of the atmosphere as Python has them; the figures are tested in the core."""

from __future__ import annotations

import numpy as np
import pytest

from sdr_spoof.nav.atmosphere import ionosphere_m, troposphere_m
from sdr_spoof.nav.broadcast import Bdgim, Klobuchar
from sdr_spoof.nav.geodesy import azimuth_elevation, ecef_to_geodetic, enu, geodetic_to_ecef
from sdr_spoof.nav.time import GnssTime

L1_HZ = 1575.42e6
B1I_HZ = 1561.098e6
NOON = GnssTime.of_week(2253, 12 * 3600.0)


def test_geodetic_there_and_back() -> None:
    places = np.array(
        [[[0.0, 0.0, 0.0], [45.0, -120.0, 2e7]], [[-90.0, 0.0, 5.0], [30.1, 179.9, -9.0]]]
    )
    back = ecef_to_geodetic(geodetic_to_ecef(places))
    assert back.shape == places.shape
    assert np.abs(back - places).max() < 1e-6


def test_both_ellipsoids_are_the_published_ones() -> None:
    """Semi-minor axes: NIMA TR8350.2 6356752.3142 m; CGCS2000 (GB 22021) 6356752.3141 m."""
    pole = [90.0, 0.0, 0.0]
    assert geodetic_to_ecef(pole)[2] == pytest.approx(6_356_752.3142, abs=1e-4)
    assert geodetic_to_ecef(pole, "CGCS2000")[2] == pytest.approx(6_356_752.3141, abs=1e-4)


def test_directions_and_local_coordinates() -> None:
    origin = geodetic_to_ecef([40.0, 116.0, 50.0])
    north = geodetic_to_ecef([40.001, 116.0, 50.0])
    east = geodetic_to_ecef([40.0, 116.001, 50.0])
    look = azimuth_elevation(origin, [north, east, geodetic_to_ecef([40.0, 116.0, 1e6])])
    assert np.abs((look[:2] - [[0.0, 0.0], [90.0, 0.0]] + 180.0) % 360.0 - 180.0).max() < 1e-2
    assert look[2, 1] == pytest.approx(90.0, abs=1e-4)
    local = enu([north, east], origin)
    assert local[0, 1] == pytest.approx(111.03, abs=0.05)
    assert local[1, 0] == pytest.approx(85.39, abs=0.05)


@pytest.mark.parametrize(
    ("model", "carrier_hz", "zenith_m"),
    [
        (Klobuchar((1e-8, 0.0, 0.0, 0.0), (1e5, 0.0, 0.0, 0.0), "G"), L1_HZ, 15e-9 * 299_792_458.0),
        (
            Klobuchar((1e-8, 0.0, 0.0, 0.0), (1e5, 0.0, 0.0, 0.0), "C"),
            B1I_HZ,
            15e-9 * 299_792_458.0,
        ),
        (None, L1_HZ, 0.0),
    ],
)
def test_ionosphere_at_its_daily_peak(
    model: Klobuchar | None, carrier_hz: float, zenith_m: float
) -> None:
    """Local time 14 h at longitude 30 degrees when it is noon in Greenwich."""
    delay = ionosphere_m(model, [20.0, 30.0, 0.0], [[0.0, 90.0], [0.0, 20.0]], NOON, carrier_hz)
    assert delay[0] == pytest.approx(zenith_m, rel=2e-3)
    assert delay[1] == 0.0 if model is None else 1.8 < delay[1] / delay[0] < 2.4


def test_bdgim_is_of_a_sensible_size() -> None:
    """TECU at the zenith times 0.162 m at L1."""
    model = Bdgim((20.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    delay = ionosphere_m(model, [20.0, 30.0, 0.0], [[0.0, 90.0]], NOON, L1_HZ)
    assert 2.0 < delay[0] < 10.0


def test_troposphere_at_the_zenith_and_low() -> None:
    delay = troposphere_m([45.0, 0.0, 0.0], [[0.0, 90.0], [0.0, 5.0]], NOON)
    assert delay[0] == pytest.approx(2.42, abs=0.05)
    assert 9.5 < delay[1] / delay[0] < 10.5
