"""What satellites and DME stations see of an error of the inertial position.

Of each, what the inertial position predicts less what is measured is, to first order,

    y = G x + noise - spoofing,    x = (east, north, up, -c dt of GNSS, -c dt of DME),

where the first three are the error of the inertial position (equation 10 of the INS/DME
publication) and a row of G holds the unit vector from the satellite or station to the receiver and
a one for its clock.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix

from .stations import sigma_m, slant_ranges_m

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .stations import Station

WORST_CONDITION = 1e4
"""Of the normalised design: beyond, the geometry is degenerate."""


@dataclass(frozen=True)
class Geometry:
    """n satellites and d stations at one epoch: m = n + d rows."""

    design: NDArray[np.float64]
    """G, (m, 5); (m, 4) without stations."""
    sigma_m: NDArray[np.float64]
    """Noise of each row, (m,)."""
    satellites: int

    @classmethod
    def of(
        cls,
        satellites: ArrayLike,
        sigma_gnss_m: ArrayLike,
        stations: ArrayLike | None = None,
        sigma_dme_m: ArrayLike = (),
    ) -> Geometry:
        """From unit vectors to satellites (n, 3) and stations (d, 3), east, north, up."""
        to = np.asarray(satellites, dtype=np.float64).reshape(-1, 3)
        dme = np.asarray(() if stations is None else stations, dtype=np.float64).reshape(-1, 3)
        n, d = len(to), len(dme)
        design = np.zeros((n + d, 5 if d else 4))
        design[:n, :3], design[:n, 3] = -to, 1.0
        if d:
            design[n:, :3], design[n:, 4] = -dme, 1.0
        sigma = np.concatenate(
            [
                np.broadcast_to(np.asarray(s, float), k)
                for s, k in ((sigma_gnss_m, n), (sigma_dme_m, d))
            ]
        )
        return cls(design, sigma, n)

    @classmethod
    def at(
        cls,
        place_m: NDArray[np.float64],
        satellites_m: NDArray[np.float64],
        sigma_gnss_m: ArrayLike,
        stations: tuple[Station, ...] = (),
    ) -> Geometry:
        """From Earth-fixed places: receiver (3,), satellites (n, 3) as of a sky, stations.

        Satellites with NaN are left out; DME has the noise of ICAO Annex 10.
        """
        latitude, longitude, _ = ecef_to_geodetic(place_m)
        axes = enu_matrix(latitude, longitude)
        there = satellites_m[np.isfinite(satellites_m).all(axis=1)]
        if not stations:
            return cls.of(_unit((there - place_m) @ axes.T), sigma_gnss_m)
        dme = np.stack([s.position_m for s in stations])
        noise = sigma_m(slant_ranges_m(stations, place_m))
        to = [_unit((towards - place_m) @ axes.T) for towards in (there, dme)]
        return cls.of(to[0], sigma_gnss_m, to[1], noise)

    @property
    def stations(self) -> int:
        """How many."""
        return len(self.design) - self.satellites

    def without_stations(self) -> Geometry:
        """Satellites alone."""
        return Geometry(
            self.design[: self.satellites, :4], self.sigma_m[: self.satellites], self.satellites
        )

    def without(self, satellites: tuple[int, ...]) -> Geometry:
        """All but some of the satellites."""
        keep = np.setdiff1d(np.arange(len(self.sigma_m)), satellites)
        left = self.satellites - len(set(satellites))
        return Geometry(self.design[keep], self.sigma_m[keep], left)

    def normalised(self) -> NDArray[np.float64]:
        """W G, (m, 5): equation 11."""
        return self.design / self.sigma_m[:, None]

    def estimator(self) -> NDArray[np.float64]:
        """Weighted least squares: x from y, (5, m).

        Raises:
            AidingError: too few rows, or a geometry that leaves x undetermined.
        """
        self.check()
        return np.asarray(np.linalg.pinv(self.normalised()) / self.sigma_m)

    def hat(self) -> NDArray[np.float64]:
        """Fitted values from y, (m, m): equation 13."""
        return np.asarray(self.design @ self.estimator())

    def check(self) -> None:
        """Refuse what cannot be solved.

        Raises:
            AidingError: too few rows, or a geometry that leaves x undetermined.
        """
        rows, unknowns = self.design.shape
        if rows < unknowns:
            with_dme = f" and {self.stations} DME stations" if self.stations else ""
            raise AidingError(
                f"{self.satellites} satellites{with_dme} cannot determine {unknowns} unknowns; "
                "more are needed"
            )
        # Columns of equal size, so that metres and clocks, GNSS and DME compare.
        scaled = self.normalised()
        size = np.linalg.norm(scaled, axis=0)
        if np.any(size == 0.0) or np.linalg.cond(scaled / size) > WORST_CONDITION:
            raise AidingError(
                "satellites and DME stations lie such that a position cannot be determined; "
                "others are needed"
            )


def directions(azimuth_elevation_deg: ArrayLike) -> NDArray[np.float64]:
    """Unit vectors east, north, up (..., 3) of azimuths and elevations in degrees (..., 2)."""
    azimuth, elevation = np.moveaxis(np.radians(np.asarray(azimuth_elevation_deg, float)), -1, 0)
    level = np.cos(elevation)
    up = np.sin(elevation)
    return np.stack([level * np.sin(azimuth), level * np.cos(azimuth), up], axis=-1)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def pdop(geometry: Geometry) -> float:
    """Position dilution of precision of the satellites alone."""
    design = geometry.without_stations().design
    return float(np.sqrt(np.trace(np.linalg.inv(design.T @ design)[:3, :3])))
