"""A whole sky: satellites on their orbits, an antenna that moves, a clock that drifts."""

from .model import Sky, View, sky_of
from .table import SkyTable
from .track import SkySatellite, Track

__all__ = ["Sky", "SkySatellite", "SkyTable", "Track", "View", "sky_of"]
