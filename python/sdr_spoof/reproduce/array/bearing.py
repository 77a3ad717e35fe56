"""Figures 3 to 5 and the claim on coverage: baseline, direction of motion, place of the spoofer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.array.simulate import direction, towards
from sdr_spoof.reproduce.study import Number, Picture, Section, Table, near

from . import published
from .figures import draw_bearings, draw_maps, draw_roc

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Effort

    Floats = NDArray[np.float64]

SEED = 20_170_005
BEARINGS = np.arange(360.0)
REACH_M = 2000.0
MOTION_M = 200.0
PLACES = 40_000
"""Places of the spoofer for each share of a region; 4 standard errors are below 0.008."""
SIDES = (1.0, 2.0, 3.0, 4.0)
PD_OF_SIDE = (0.069, 0.399, 0.843, 0.989)


def section(effort: Effort, stages: Stages) -> Section:
    """Everything that follows from the noncentrality alone."""
    del effort
    with stages("Directions and regions"):
        sides = published.noncentrality(direction(80.0, 50.0), direction(82.0, 51.0), 1.0)
        per_side = [float(published.detected(sides * side**2)) for side in SIDES]
        headings = {d: _by_heading(d) for d in (50.0, 100.0, 200.0)}
        spoofers = {r: _by_bearing(r) for r in (500.0, 1000.0, 2000.0, 4000.0)}
        regions = _regions()
    return Section(
        "Figures 3 to 5: baseline, directions and coverage",
        text=(
            "The law of equation 17 gives these figures without draws. The claim that 200 m of "
            "motion are enough for 95 % of the places within 2 km is not reproduced: the mean "
            "detection probability in the half ball is near to it, but the share of places at "
            "which 95 % are reached is smaller, and on the ground smaller still. The blind spot is "
            "the line of motion, and a vehicle that turns has none.",
        ),
        tables=[_region_table(regions)],
        pictures=[
            Picture(
                "figure3",
                "ROC by baseline",
                draw_roc([(f"b = {s:g} wavelengths", float(sides * s**2)) for s in SIDES], {}),
                "A direction that moves from (80, 50) to (82, 51) degrees.",
            ),
            Picture(
                "figure4",
                "Direction of motion",
                draw_bearings(
                    BEARINGS,
                    {f"{d:g} m of motion": pd for d, pd in headings.items()},
                    "direction of motion from north (degrees)",
                ),
                "Spoofer at 1000 m, azimuth and elevation 45 degrees.",
            ),
            Picture(
                "figure5",
                "Bearing of the spoofer",
                draw_bearings(
                    BEARINGS,
                    {f"spoofer at {r:g} m": pd for r, pd in spoofers.items()},
                    "bearing of the spoofer from north (degrees)",
                ),
                "200 m of motion towards azimuth and elevation 45 degrees; spoofers on the ground.",
            ),
            Picture(
                "coverage",
                "Where a spoofer on the ground is seen",
                draw_maps(
                    {f"{d:g} m to the north": _map(d) for d in (100.0, 200.0, 777.0)}, REACH_M
                ),
                "Published test, Pfa 1 %; the white line is a detection probability of 0.95.",
            ),
        ],
        numbers=_numbers(float(sides), per_side, headings, regions),
    )


def _seen(source_m: Floats, moved_m: Floats) -> Floats:
    """Detection probability of spoofers (..., 3) after a motion (3,)."""
    unit = towards(source_m, np.stack([np.zeros(3), moved_m]))
    return published.detected(published.noncentrality(unit[..., 0, :], unit[..., 1, :]))


def _by_heading(moved_m: float) -> Floats:
    """For every direction of a level motion (360,)."""
    source = 1000.0 * direction(45.0, 45.0)
    return np.array([float(_seen(source, moved_m * direction(b, 0.0))) for b in BEARINGS])


def _by_bearing(range_m: float) -> Floats:
    """For spoofers on the ground all around (360,)."""
    sources = range_m * direction(BEARINGS, 0.0)
    return _seen(sources, MOTION_M * direction(45.0, 45.0))


def _half_ball(rng: np.random.Generator) -> Floats:
    """Places spread evenly over the half ball above, (N, 3)."""
    height = rng.random(PLACES)
    turn = rng.uniform(0, 2 * np.pi, PLACES)
    level = np.sqrt(1 - height**2)
    unit = np.stack([level * np.cos(turn), level * np.sin(turn), -height], axis=-1)
    return np.asarray(REACH_M * rng.random((PLACES, 1)) ** (1 / 3) * unit)


def _disc(rng: np.random.Generator) -> Floats:
    """Places spread evenly over the ground, (N, 3)."""
    turn = rng.uniform(0, 2 * np.pi, PLACES)
    unit = np.stack([np.cos(turn), np.sin(turn), np.zeros(PLACES)], axis=-1)
    return np.asarray(REACH_M * np.sqrt(rng.random((PLACES, 1))) * unit)


def _regions() -> dict[str, tuple[float, float, float]]:
    """Mean Pd, share of places with Pd >= 0.95, and motion for which that share is 0.95."""
    rng = np.random.default_rng(SEED)
    found = {}
    for name, places in (("half ball", _half_ball(rng)), ("ground", _disc(rng))):
        pd = _seen(places, MOTION_M * direction(0.0, 0.0))
        found[name] = (float(pd.mean()), float(np.mean(pd >= 0.95)), _motion_for(places))
    return found


def _motion_for(places: Floats, share: float = 0.95) -> float:
    """Least level motion after which a share of the places has a Pd of 0.95."""
    low, high = MOTION_M, 2000.0
    for _ in range(16):
        middle = 0.5 * (low + high)
        pd = _seen(places, middle * direction(0.0, 0.0))
        low, high = (middle, high) if np.mean(pd >= 0.95) < share else (low, middle)
    return high


def _map(moved_m: float) -> Floats:
    axis = np.linspace(-REACH_M, REACH_M, 160)  # an even number: none at the vehicle itself
    east, north = np.meshgrid(axis, axis)
    ground = np.stack([north, east, np.zeros_like(north)], axis=-1)
    return _seen(ground, moved_m * direction(0.0, 0.0))


def _region_table(regions: dict[str, tuple[float, float, float]]) -> Table:
    return Table(
        "coverage",
        "Spoofers within 2 km, 200 m of level motion",
        ("region", "mean Pd", "share with Pd >= 0.95", "motion for 95 % of the region (m)"),
        [(name, *values) for name, values in regions.items()],
        "Published: 200 m cover 95 % of the region.",
    )


def _numbers(
    side: float,
    per_side: list[float],
    headings: dict[float, Floats],
    regions: dict[str, tuple[float, float, float]],
) -> list[Number]:
    numbers = [
        near("figure3_lambda", "noncentrality of Figure 3 over b squared", side, 1.6855, 5e-4)
    ]
    for b, pd, reference in zip(SIDES, per_side, PD_OF_SIDE, strict=True):
        numbers.append(near(f"figure3_b{b:g}", f"Pd at b = {b:g}", pd, reference, 1e-3))
    for moved, low, high in ((50.0, 0.318, 0.982), (100.0, 0.946, 1.000)):
        curve, at = headings[moved], f"over headings after {moved:g} m"
        numbers += [
            near(f"figure4_{moved:g}_min", f"least Pd {at}", float(curve.min()), low, 1e-3),
            near(f"figure4_{moved:g}_max", f"greatest Pd {at}", float(curve.max()), high, 1e-3),
        ]
    best = float(BEARINGS[np.argmax(headings[50.0])])
    numbers.append(
        near("figure4_best", "heading of the greatest Pd after 50 m", best, 132, 1, "deg")
    )
    references = {"half ball": (0.939, 0.881, 354), "ground": (0.878, 0.803, 777)}
    for name, values in regions.items():
        mean, share, motion_m = references[name]
        key = name.replace(" ", "_")
        numbers += [
            near(f"{key}_mean", f"mean Pd, {name}", values[0], mean, 0.005),
            near(f"{key}_share", f"share with Pd >= 0.95, {name}", values[1], share, 0.008),
            near(f"{key}_motion", f"motion for 95 %, {name}", values[2], motion_m, 25, "m"),
        ]
    return numbers
