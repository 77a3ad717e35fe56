"""Figures of the fixes: what they draw, and that they draw it the same way twice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from routes import small_route

from sdr_spoof.report.figures.position import draw_geometry, draw_track, local_m
from sdr_spoof.report.figures.sky_plot import draw_sky


@pytest.mark.parametrize("draw", [draw_sky, draw_track, draw_geometry])
def test_figures_are_deterministic(draw):
    route = small_route()
    assert draw(route) == draw(route)
    assert draw(route).startswith("data:image/png;base64,")


@pytest.mark.parametrize("draw", [draw_sky, draw_track, draw_geometry])
def test_figures_without_fixes_or_satellites(draw):
    assert draw(small_route(epochs=2))
    assert draw(replace(small_route(), satellites=()))


@pytest.mark.parametrize("latitude_deg", [-89.0, -33.0, 0.0, 60.0])
def test_local_axes_are_in_metres(latitude_deg):
    """Against the chord between two places on the ellipsoid, 0.001 degrees apart."""
    route = small_route(epochs=4)
    steps = np.array([0.0, 0.0, 1e-3, 0.0])
    place = {"latitude_deg": latitude_deg + steps, "longitude_deg": 179.9999 + 0 * steps}
    north = local_m(replace(route, **place, height_m=0 * steps + 100.0))
    assert np.ptp(north[:, 1]) == pytest.approx(_chord(place, 0, 2), abs=2e-3)
    place = {"latitude_deg": latitude_deg + 0 * steps, "longitude_deg": 179.9999 + steps}
    place["longitude_deg"][2] -= 360.0
    east = local_m(replace(route, **place, height_m=0 * steps + 100.0))
    assert np.ptp(east[:, 0]) == pytest.approx(_chord(place, 0, 2), abs=2e-3)


def _chord(place, i, j):
    ecef = []
    for k in (i, j):
        lat, lon = np.radians(place["latitude_deg"][k]), np.radians(place["longitude_deg"][k])
        squared = 2 / 298.257223563 - 298.257223563**-2
        normal = 6_378_137.0 / np.sqrt(1 - squared * np.sin(lat) ** 2)
        flat = (normal + 100.0) * np.cos(lat)
        up = (normal * (1 - squared) + 100.0) * np.sin(lat)
        ecef.append(np.array([flat * np.cos(lon), flat * np.sin(lon), up]))
    return np.linalg.norm(ecef[1] - ecef[0])
