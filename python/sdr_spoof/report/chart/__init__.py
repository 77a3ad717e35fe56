"""Line charts as SVG, for the report: a picture of eight satellites' tests takes milliseconds.

A :class:`Panel` gathers marks in units of the data; a :class:`Grid` of panels finds limits, ticks
and margins; :func:`drawing` puts grids below each other. The same input gives the same text.
"""

from .grid import Grid
from .panel import Axis, Panel
from .picture import Drawing, Entry, drawing

__all__ = ["Axis", "Drawing", "Entry", "Grid", "Panel", "drawing"]
