"""A sea by chance, and how a ship moves on it.

The spectrum is that of Bretschneider (ITTC 1978; Fossen 2011, Handbook of Marine Craft
Hydrodynamics and Motion Control, section 8.2), with the significant wave heights of WMO code table
3700 (middles) and the modal periods of the open North Atlantic (Lee, Bales 1984). All waves run in
one direction. Heave follows the surface, roll and pitch its slope, each as a damped oscillator;
what a ship meets depends on where it is, so that headings and speeds change what it feels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .manoeuvres import Way

SEAS = (
    (0.0, 6.0),
    (0.05, 6.0),
    (0.3, 6.9),
    (0.88, 7.5),
    (1.88, 8.8),
    (3.25, 9.7),
    (5.0, 12.4),
    (7.5, 15.0),
)
"""Significant wave height in m and modal period in s, by sea state."""
_GRAVITY_M_S2 = 9.80665
_RANGE = (0.5, 4.0)
"""Frequencies, against the modal one."""
_WAVES = 32


@dataclass(frozen=True)
class Hull:
    """Oscillators of a ship: natural periods in s, and dampings against the critical one.

    Waves shorter than the hull hold up one part of it while another sinks: it feels their mean over
    its length, in rolling over its beam.
    """

    length_m: float = 60.0
    beam_m: float = 12.0
    heave_s: float = 7.0
    roll_s: float = 12.0
    pitch_s: float = 7.0
    heave_damping: float = 0.5
    roll_damping: float = 0.12
    pitch_damping: float = 0.5


@dataclass(frozen=True)
class Sea:
    """W waves."""

    rate_rad_s: NDArray[np.float64]
    amplitude_m: NDArray[np.float64]
    phase_rad: NDArray[np.float64]
    towards_rad: float
    """Direction in which they run, from north to east."""

    @classmethod
    def drawn(cls, state: int, towards_rad: float, rng: np.random.Generator) -> Sea:
        """Waves at frequencies that have no common period."""
        height, period = SEAS[state]
        modal = math.tau / period
        edges = modal * np.geomspace(*_RANGE, _WAVES + 1)
        rate = rng.uniform(edges[:-1], edges[1:])
        energy = bretschneider(height, period, rate) * np.diff(edges)
        return cls(rate, np.sqrt(2 * energy), rng.uniform(0, math.tau, _WAVES), towards_rad)

    def moves(self, ship: Way, hull: Hull) -> tuple[NDArray[np.float64], ...]:
        """Heave in m, pitch and roll in rad of a ship on its way, (N,) each."""
        number = self.rate_rad_s**2 / _GRAVITY_M_S2
        north, east = math.cos(self.towards_rad), math.sin(self.towards_rad)
        ahead_m = ship.north_m * north + ship.east_m * east
        angle = np.stack([ahead_m, -ship.time_s], axis=-1) @ np.stack([number, self.rate_rad_s])
        angle += self.phase_rad
        answers = self._answers(hull, number)
        moved = np.cos(angle) @ answers.real - np.sin(angle) @ answers.imag
        heave, along, across = moved.T
        bearing = self.towards_rad - ship.heading_rad
        return heave, along * np.cos(bearing), -across * np.sin(bearing)

    def _answers(self, hull: Hull, number: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Of heave, and of the slope in pitching and in rolling, to each wave, (W, 3)."""
        ends, sides = (np.exp(-((number * m) ** 2) / 24) for m in (hull.length_m, hull.beam_m))
        # The slope is the derivative along the way of the waves: a quarter of a cycle ahead.
        slope = 1j * self.amplitude_m * number
        rate = self.rate_rad_s
        parts = [
            self.amplitude_m * ends * oscillator(rate, hull.heave_s, hull.heave_damping),
            slope * ends * oscillator(rate, hull.pitch_s, hull.pitch_damping),
            slope * sides * oscillator(rate, hull.roll_s, hull.roll_damping),
        ]
        return np.stack(parts, axis=-1)


def bretschneider(
    height_m: float, period_s: float, rate_rad_s: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Spectrum of the surface in m^2 s; its integral is (significant height / 4)^2."""
    ratio = (math.tau / period_s / rate_rad_s) ** 4
    return np.asarray(5 / 16 * height_m**2 * ratio / rate_rad_s * np.exp(-1.25 * ratio))


def oscillator(
    rate_rad_s: NDArray[np.float64], period_s: float, damping: float
) -> NDArray[np.complex128]:
    """Answer to waves whose phase falls with time."""
    ratio = rate_rad_s * period_s / math.tau
    return np.asarray(1 / (1 - ratio**2 - 2j * damping * ratio))
