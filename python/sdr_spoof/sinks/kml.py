"""The track as KML 2.2 (OGC 07-147r2): lines coloured by alarm, laid on the ground.

Altitudes are above the geoid, as KML has them, by the table of :mod:`sdr_spoof.nav.geoid`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree

from sdr_spoof.nav.geoid import geoid_height_m
from sdr_spoof.route import ALARM_COLOURS, Alarm

from .atomic import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from sdr_spoof.route import Route

NAMESPACE = "http://www.opengis.net/kml/2.2"


def write_kml(path: Path, route: Route, *, name: str = "sdr-spoof", force: bool = False) -> None:
    """Write the track.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written.
    """
    root = ElementTree.Element("kml", xmlns=NAMESPACE)
    document = _add(root, "Document")
    _add(document, "name", name)
    for alarm, colour in ALARM_COLOURS.items():
        style = _add(document, "Style", id=alarm.name.lower())
        line = _add(style, "LineStyle")
        _add(line, "color", _abgr(colour))
        _add(line, "width", "3")
    for alarm, epochs in route.stretches():
        _placemark(document, route, alarm, epochs)
    ElementTree.indent(root)
    write_bytes(path, ElementTree.tostring(root, "utf-8", xml_declaration=True), force=force)


def _placemark(
    document: ElementTree.Element, route: Route, alarm: Alarm, epochs: list[int]
) -> None:
    mark = _add(document, "Placemark")
    _add(mark, "name", f"alarm: {alarm.name.lower()}")
    span = _add(mark, "TimeSpan")
    for tag, epoch in (("begin", epochs[0]), ("end", epochs[-1])):
        time = route.times[epoch].utc().isoformat(timespec="milliseconds")
        _add(span, tag, time.replace("+00:00", "Z"))
    _add(mark, "styleUrl", f"#{alarm.name.lower()}")
    altitude = route.height_m - geoid_height_m(route.latitude_deg, route.longitude_deg)
    places = [
        f"{route.longitude_deg[i]:.9f},{route.latitude_deg[i]:.9f},{altitude[i]:.4f}"
        for i in epochs
    ]
    shape = _add(mark, "LineString" if len(epochs) > 1 else "Point")
    _add(shape, "coordinates", " ".join(places))


def _add(
    parent: ElementTree.Element, tag: str, text: str | None = None, **attributes: str
) -> ElementTree.Element:
    element = ElementTree.SubElement(parent, tag, attributes)
    element.text = text
    return element


def _abgr(colour: str) -> str:
    """KML's order of bytes: opacity, blue, green, red."""
    red, green, blue = colour[1:3], colour[3:5], colour[5:7]
    return f"ff{blue}{green}{red}"
