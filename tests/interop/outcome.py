"""What a peer made of our files, or we of its."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sdr_spoof.nav.geodesy import enu, geodetic_to_ecef

Place = tuple[float, float, float]
"""Latitude and longitude in degrees, height in m."""


class PeerMissingError(Exception):
    """The peer is not on this machine; the message says how it gets there."""


@dataclass(frozen=True)
class Outcome:
    """One comparison."""

    peer: str
    """Name and version."""
    test: str
    passed: bool
    figures: str
    """What was measured, in words."""


@dataclass(frozen=True)
class Errors:
    """Positions against the truth, m."""

    count: int
    mean: tuple[float, float, float]
    """East, north, up."""
    horizontal_rms: float
    rms: float
    largest: float

    @classmethod
    def of(cls, places: list[Place], truth: Place) -> Errors:
        """Of places found; none are infinitely off."""
        if not places:
            return cls(0, (np.inf,) * 3, np.inf, np.inf, np.inf)
        off = enu(geodetic_to_ecef(places), geodetic_to_ecef(truth))
        square = (off**2).sum(axis=1)
        east, north, up = off.mean(axis=0).tolist()
        flat = float(np.sqrt((off[:, :2] ** 2).sum(axis=1).mean()))
        return cls(
            len(places),
            (east, north, up),
            flat,
            float(np.sqrt(square.mean())),
            float(np.sqrt(square.max())),
        )

    def __str__(self) -> str:
        if not self.count:
            return "no fix"
        east, north, up = self.mean
        return (
            f"{self.count} fixes, mean {east:+.2f} m east {north:+.2f} north {up:+.2f} up, "
            f"rms {self.horizontal_rms:.2f} m horizontal {self.rms:.2f} in all, "
            f"largest {self.largest:.2f}"
        )
