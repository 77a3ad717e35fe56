"""What ionosphere and troposphere add to the ranges of a sky."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np

from sdr_spoof.nav.atmosphere import gpst_s, ionosphere_m, troposphere_m
from sdr_spoof.nav.broadcast import Bdgim, Klobuchar
from sdr_spoof.nav.geodesy import ecef_to_geodetic
from sdr_spoof.nav.integrity import IGPS, GridPoint, place_deg
from sdr_spoof.signals import signal_spec

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.broadcast import Ionosphere
    from sdr_spoof.nav.records import Navigation
    from sdr_spoof.nav.time import GnssTime

    from .ranges import Geometry
    from .table import SkyTable

REFERENCE_HZ = 1575.42e6
"""Carrier at which ionospheric delays are kept; those of others are as 1/f^2."""


@dataclass(frozen=True)
class Delays:
    """Along one satellite's way, at N times."""

    ionosphere_m: NDArray[np.float64]
    """Of a code at :data:`REFERENCE_HZ`."""
    troposphere_m: NDArray[np.float64]


@dataclass(frozen=True)
class Propagation:
    """Models and their parameters."""

    model: str
    """none, klobuchar or bdgim."""
    klobuchars: tuple[Klobuchar, ...]
    """Of different systems; each sends its own."""
    bdgim: Bdgim | None
    troposphere: bool

    @classmethod
    def of(cls, table: SkyTable, navigation: Navigation) -> Self:
        """From the table, and what the navigation file has where the table says nothing.

        Raises:
            ValueError: a model is wanted of which there are no parameters.
        """
        none = table.ionosphere == "none"
        found = [i for i in navigation.ionosphere if isinstance(i, Klobuchar) and not none]
        if table.klobuchar_alpha and table.klobuchar_beta:
            found = [Klobuchar(table.klobuchar_alpha, table.klobuchar_beta, "G")]
        found_bdgim = (i for i in navigation.ionosphere if isinstance(i, Bdgim) and not none)
        bdgim = next(found_bdgim, None)
        if table.bdgim_tecu:
            bdgim = Bdgim(table.bdgim_tecu)
        if table.ionosphere == "klobuchar" and not found:
            raise ValueError(
                "ionosphere: the navigation file has no parameters of klobuchar; give "
                "klobuchar_alpha and klobuchar_beta"
            )
        if table.ionosphere == "bdgim" and bdgim is None:
            raise ValueError(
                "ionosphere: the navigation file has no parameters of bdgim; give bdgim_tecu"
            )
        return cls(table.ionosphere, tuple(found), bdgim, troposphere=table.troposphere != "none")

    def klobuchar(self, system: str) -> Klobuchar | None:
        """What a system's message says; another system's numbers where its own are not known."""
        own = (k for k in self.klobuchars if k.system == system)
        known = next(own, next(iter(self.klobuchars), None))
        return None if known is None else replace(known, system=system)

    def delays(
        self,
        system: str,
        start: GnssTime,
        time_s: NDArray[np.float64],
        antenna_m: NDArray[np.float64],
        way: Geometry,
    ) -> Delays:
        """Delays of one satellite's signals at times of system time since the start."""
        place = ecef_to_geodetic(antenna_m)
        look = np.degrees(np.stack([way.azimuth_rad, way.elevation_rad], axis=-1))
        instants = gpst_s(start, time_s)
        none = np.zeros_like(time_s)
        model = self._model(system)
        return Delays(
            none if model is None else ionosphere_m(model, place, look, instants, REFERENCE_HZ),
            troposphere_m(place, look, instants) if self.troposphere else none,
        )

    def grid(self, time: GnssTime) -> tuple[GridPoint, ...]:
        """Vertical delays of B1I over the points that D2 tells of; none without a model."""
        model = self._model("C")
        if model is None:
            return ()
        numbers = range(1, IGPS + 1)
        places = np.array([(*place_deg(igp), 0.0) for igp in numbers])
        up = np.tile([0.0, 90.0], (IGPS, 1))
        instants = gpst_s(time, np.zeros(IGPS))
        delays = ionosphere_m(model, places, up, instants, signal_spec("B1I").carrier_hz)
        return tuple(GridPoint(igp, d, 0) for igp, d in zip(numbers, delays.tolist(), strict=True))

    def _model(self, system: str) -> Ionosphere | None:
        if self.model == "klobuchar":
            return self.klobuchar(system)
        return self.bdgim if self.model == "bdgim" else None
