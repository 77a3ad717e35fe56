"""The attacks of the study, each for 400 s."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sdr_spoof.aiding.simulated import (
    accelerated_drag,
    clock_drag,
    hover,
    position_step,
    range_pull,
    velocity_drag,
)

from .simulation import ATTACK_S, NAMES

if TYPE_CHECKING:
    from sdr_spoof.aiding.simulated import Attack

THREE = (NAMES[1], NAMES[4], NAMES[9])
"""Satellites of attacks on three channels: among the best seen of seven triples tried."""


@dataclass(frozen=True)
class Named:
    """An attack of the list."""

    name: str
    title: str
    attack: Attack
    quick: bool = False
    floor: bool = False
    """Below what can be seen with certainty."""


def _towards(size: float) -> tuple[float, float, float]:
    """A horizontal vector of that length."""
    return 0.6 * size, 0.8 * size, 0.0


def _drag(size: float, **other: Any) -> Attack:
    return velocity_drag(_towards(size), *ATTACK_S, **other)


def _accelerated(size: float) -> Attack:
    return accelerated_drag(_towards(size), *ATTACK_S)


def _pull(rate: float, acceleration: float, **other: Any) -> Attack:
    pull = (0.0, rate, acceleration)
    return range_pull(pull, *ATTACK_S, satellites=THREE, **other)


LIST = (
    Named("all_0.2", "all, 0.2 m/s", _drag(0.2), quick=True),
    Named("all_0.5", "all, 0.5 m/s", _drag(0.5)),
    Named("all_1", "all, 1 m/s", _drag(1.0)),
    Named("all_2", "all, 2 m/s", _drag(2.0)),
    Named("all_0.02_s2", "all, 0.02 m/s²", _accelerated(0.02)),
    Named("all_0.005_s2", "all, 0.005 m/s²", _accelerated(0.005), quick=True),
    Named("all_0.002_s2", "all, 0.002 m/s²", _accelerated(0.002), floor=True),
    Named("all_0.001_s2", "all, 0.001 m/s²", _accelerated(0.001), floor=True),
    Named("three_0.2", "three, 0.2 m/s", _pull(0.2, 0.0)),
    Named("three_0.5", "three, 0.5 m/s", _pull(0.5, 0.0), quick=True),
    Named("three_0.005_s2", "three, 0.005 m/s²", _pull(0.0, 0.005), quick=True),
    Named("three_0.002_s2", "three, 0.002 m/s²", _pull(0.0, 0.002)),
    Named("code_1", "all, codes only, 1 m/s", _drag(1.0, code_only=True)),
    Named("three_code_1", "three, codes only, 1 m/s", _pull(1.0, 0.0, code_only=True)),
    Named("clock_1", "clock, 1 m/s", clock_drag(1.0, *ATTACK_S)),
    Named("hover", "hover: the fix stands still", hover(*ATTACK_S)),
    Named(
        "jump_10_db",
        "jump of 100 m with +10 dB",
        position_step(_towards(100.0), *ATTACK_S, rise_db=10.0),
    ),
)
"""In the order of the table."""
