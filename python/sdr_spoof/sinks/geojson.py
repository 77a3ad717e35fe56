"""The track as GeoJSON (RFC 7946): lines coloured by alarm (simplestyle), a point for each fix."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from sdr_spoof.route import ALARM_COLOURS, Alarm, Quality

from .atomic import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from sdr_spoof.route import Route


def write_geojson(path: Path, route: Route, *, force: bool = False) -> None:
    """Write the track; heights are above the WGS-84 ellipsoid.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written.
    """
    lines = [_line(route, alarm, epochs) for alarm, epochs in route.stretches()]
    points = [_point(route, i) for i, fixed in enumerate(route.fixed) if fixed]
    content = {"type": "FeatureCollection", "features": [x for x in lines if x] + points}
    write_bytes(path, json.dumps(content, allow_nan=False).encode(), force=force)


def _line(route: Route, alarm: Alarm, epochs: list[int]) -> dict[str, Any] | None:
    if len(epochs) < 2:
        return None
    return {
        "type": "Feature",
        "geometry": {"type": "LineString", "coordinates": [_place(route, i) for i in epochs]},
        "properties": {
            "alarm": alarm.name.lower(),
            "stroke": ALARM_COLOURS[alarm],
            "stroke-width": 3,
            "from": _utc(route, epochs[0]),
            "until": _utc(route, epochs[-1]),
        },
    }


def _point(route: Route, epoch: int) -> dict[str, Any]:
    alarm = Alarm(route.alarm[epoch])
    return {
        "type": "Feature",
        "geometry": {"type": "Point", "coordinates": _place(route, epoch)},
        "properties": {
            "time": _utc(route, epoch),
            "alarm": alarm.name.lower(),
            "marker-color": ALARM_COLOURS[alarm],
            "quality": Quality(route.quality[epoch]).name.lower(),
            "hdop": round(float(route.dop[epoch, 1]), 2),
            "satellites": route.used(epoch),
        },
    }


def _place(route: Route, epoch: int) -> list[float]:
    """Longitude, latitude to 0.1 mm, height."""
    return [
        round(float(route.longitude_deg[epoch]), 9),
        round(float(route.latitude_deg[epoch]), 9),
        round(float(route.height_m[epoch]), 4),
    ]


def _utc(route: Route, epoch: int) -> str:
    return route.times[epoch].utc().isoformat(timespec="milliseconds").replace("+00:00", "Z")
