"""Campaign files and runs that cost nothing, for the tests of campaigns.

Workers are other processes: what they run must be importable by name.
"""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np

from sdr_spoof.campaign.points import Point
from sdr_spoof.campaign.run import Row

SPEC = """
[campaign]
title = "Drag"
runs = 6
seed = 5

[scenario.recording]
duration_s = 8.0
sample_rate_hz = 20e6
lo_hz = 1568.259e6
sample_format = "ci8"

[[scenario.satellite]]
prn = 27

[[scenario.satellite]]
prn = 19

[[scenario.attack]]
prn = 27
signals = ["B1C"]
start_s = 1.0
drag_start_s = 4.0

[[sweep]]
key = "scenario.attack.0.drag_rate_m_s"
values = [0.5, 1.0]

[[sweep]]
key = "scenario.satellite.*.cn0_dbhz"
linspace = [35, 45, 3]
"""


def spec_file(folder: Path, text: str = SPEC) -> Path:
    path = folder / "drag.toml"
    path.write_text(text)
    return path


def dice(point: Point, seed: int) -> Row:
    """An alarm on C27 with a probability that grows with the drag, never one on C19."""
    rng = np.random.default_rng(seed)
    rate = point.scenario.attack[0].drag_rate_m_s
    alarmed = bool(rng.random() < rate)
    return {
        "C27.verdict": "spoofed" if alarmed else "clean",
        "C27.attack": "induced",
        "C27.hostile": True,
        "C27.attack_start_s": 1.0,
        "C27.drag_start_s": 4.0,
        "C27.phase_difference_rate.alarmed": alarmed,
        "C27.phase_difference_rate.alarm_s": 4.0 + rng.random() if alarmed else None,
        "C27.phase_difference_rate.score": np.float64(rng.normal(1.0, 1.0) ** 2 + alarmed),
        "C19.verdict": "clean",
        "C19.attack": "",
        "C19.hostile": False,
        "C19.phase_difference_rate.alarmed": False,
        "C19.phase_difference_rate.score": float(rng.random()),
    }


def slow_dice(point: Point, seed: int) -> Row:
    """The same, 50 ms later."""
    time.sleep(0.05)
    return dice(point, seed)


def failing_dice(point: Point, seed: int) -> Row:
    """Fails at 40 dB-Hz."""
    if point.scenario.satellite[0].cn0_dbhz == 40.0:
        raise ValueError("no luck\nat all")
    return dice(point, seed)


def deadly_dice(point: Point, seed: int) -> Row:
    """Ends its process at one of the points."""
    if point.index == 1:
        os._exit(9)
    return dice(point, seed)
