"""Figures of the fixes: what they draw, and that they draw it the same way twice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from routes import small_route

from sdr_spoof.report.figures.position import draw_geometry, draw_track, local_m
from sdr_spoof.report.figures.scatter import against_neighbours, scatter_of
from sdr_spoof.report.figures.sky_plot import DOT, LABEL, POINTS_PER_DEG, draw_sky, label_offsets


@pytest.mark.parametrize("draw", [draw_sky, draw_track, draw_geometry])
def test_figures_are_deterministic(draw):
    route = small_route()
    assert draw(route) == draw(route)
    assert draw(route).startswith(b"\x89PNG")


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


def circle(rng, sigma_m, epochs=400, speed_m_s=30.0, turn_m_s2=9.81):
    """Times, places with noise and velocities in a turn."""
    time_s, rate = np.arange(float(epochs)), turn_m_s2 / speed_m_s
    radius_m, angle = speed_m_s / rate, rate * np.arange(epochs)
    up = np.zeros(epochs)
    place = radius_m * np.stack([np.cos(angle), np.sin(angle), up], axis=1)
    velocity = speed_m_s * np.stack([-np.sin(angle), np.cos(angle), up], axis=1)
    return time_s, place + rng.normal(0.0, sigma_m, place.shape), velocity


def test_scatter_in_a_turn_is_that_of_the_fixes():
    """1 g at 30 m/s: the curve itself leaves 0.05 m, noise comes back within 4 standard errors."""
    rng = np.random.default_rng(3)
    still = against_neighbours(*circle(rng, 0.0))
    assert np.nanmax(np.abs(still)) < 0.1
    noisy = against_neighbours(*circle(rng, 1.0))
    assert np.isnan(noisy[[0, -1]]).all()
    values = noisy[1:-1, 2]
    # Neighbours share fixes: correlations -2/3 and 1/6, so 1.94 times fewer values count.
    error = np.sqrt(0.5 * (1.0 + 2.0 * (4 / 9 + 1 / 36)) / values.size)
    assert np.sqrt(np.mean(values**2)) == pytest.approx(1.0, abs=4.0 * error)


def test_scatter_says_of_what():
    route = small_route()
    local = local_m(route)
    assert scatter_of(route, local)[1].startswith("Scatter about the median")
    assert scatter_of(route, 10.0 * local)[1].startswith("Off what neighbours and velocities say")
    assert scatter_of(route, local * np.nan)[1] == "Scatter: no fix"


def test_names_of_satellites_keep_clear():
    """Five beside each other: each name off every dot but its own, and off other names."""
    dots = {f"C{i:02d}": (np.radians(150.0 + 16.0 * i), 30.0 + 4.0 * (i % 2)) for i in range(5)}
    at = {n: POINTS_PER_DEG * r * np.array([np.sin(t), np.cos(t)]) for n, (t, r) in dots.items()}
    half = 0.5 * np.array(LABEL)
    middles = {n: at[n] + offset + half for n, offset in label_offsets(dots).items()}
    for name, middle in middles.items():
        for other in dots.keys() - {name}:
            assert (np.abs(middle - at[other]) >= half + DOT - 1e-9).any()
            assert (np.abs(middle - middles[other]) >= 2 * half - 1e-9).any()
