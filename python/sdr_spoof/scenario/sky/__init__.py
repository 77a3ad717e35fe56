"""A whole sky: satellites on their orbits, an antenna that moves, a clock that drifts."""

from .model import Sky, SkySatellite, Track, View, sky_of
from .table import SkyTable

__all__ = ["Sky", "SkySatellite", "SkyTable", "Track", "View", "sky_of"]
