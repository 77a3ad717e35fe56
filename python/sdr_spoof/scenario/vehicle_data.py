"""What a perfect INS would say of the body that carries an array of antennas."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .model import Scenario

COLUMNS = ("time_s", "x_m", "y_m", "z_m", "yaw_deg", "pitch_deg", "roll_deg")


def moves_array(scenario: Scenario) -> bool:
    """Whether the scenario records an array's reference antenna."""
    return (
        scenario.sky is not None
        and scenario.sky.array is not None
        and not scenario.sky.array.antenna
    )


def vehicle_csv(scenario: Scenario) -> str:
    """Earth-fixed place of the reference antenna and the body's attitude, by receiver time."""
    sky = scenario.sky_model()
    assert sky is not None
    inside = (sky.time_s >= 0) & (sky.time_s <= sky.duration_s + 1e-9)
    rows = np.flatnonzero(inside)
    attitude = np.degrees(sky.trajectory.attitude_rad(sky.system_s[rows]))
    table = np.column_stack([sky.time_s[rows], sky.reference_m[rows], attitude])
    text = io.StringIO()
    np.savetxt(
        text, table, "%.9g,%.4f,%.4f,%.4f,%.6f,%.6f,%.6f", header=",".join(COLUMNS), comments=""
    )
    return text.getvalue()
