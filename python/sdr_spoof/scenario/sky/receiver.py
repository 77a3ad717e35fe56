"""Kinds of receiver trajectory: table ``[sky.receiver]``. One class and one line for each."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, model_validator

from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.scenario.base import FROZEN, NonNegative

from . import earth, trajectory_files
from .receiver_base import Latitude, Longitude, Placed, Receiver, Vector
from .route import GRAVITY_M_S2, Point, route
from .ship import Ship
from .trajectory import Curve, OnPlane, Trajectory, along, through
from .uav import Uav
from .vehicle import Vehicle

_LOOK_S = 0.02
"""Spacing at which a way is asked for its direction."""


class Static(Placed):
    """A receiver that stands still."""

    kind: Literal["static"] = Field("static", description="kind of trajectory")

    def trajectory(self, duration_s: float) -> Trajectory:
        """One place."""
        del duration_s
        place = geodetic_to_ecef(self.origin)
        return Trajectory(
            lambda time_s: np.broadcast_to(place, (np.size(time_s), 3)),
            lever_arm_m=self.lever_arm_m,
        )


class Circle(Placed):
    """A receiver that goes round a place."""

    kind: Literal["circle"] = Field("circle", description="kind of trajectory")
    radius_m: float = Field(gt=0, description="radius")
    speed_m_s: float = Field(gt=0, description="speed")
    bearing_deg: float = Field(0.0, description="where it is at 0 s, from the middle")
    clockwise: bool = Field(True, description="seen from above")

    def trajectory(self, duration_s: float) -> Trajectory:
        """A circle at one height."""
        del duration_s
        rate = self.speed_m_s / self.radius_m * (1 if self.clockwise else -1)

        def enu_m(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
            bearing = math.radians(self.bearing_deg) + rate * time_s
            east, north = self.radius_m * np.sin(bearing), self.radius_m * np.cos(bearing)
            return np.stack([east, north, np.zeros_like(east)], axis=-1)

        return Trajectory(OnPlane(self.origin, enu_m), lever_arm_m=self.lever_arm_m)


class Waypoint(BaseModel):
    """One of ``[[sky.receiver.waypoint]]``."""

    model_config = FROZEN

    east_m: float | None = Field(None, description="from the place of the trajectory")
    north_m: float | None = Field(None, description="from the place of the trajectory")
    latitude_deg: Latitude | None = Field(None, description="instead of north_m")
    longitude_deg: Longitude | None = Field(None, description="instead of east_m")
    up_m: float = Field(0.0, description="above the height of the trajectory")
    speed_m_s: NonNegative = Field(description="speed there; it changes evenly on the way")

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        plane = (self.east_m is not None, self.north_m is not None)
        globe = (self.longitude_deg is not None, self.latitude_deg is not None)
        if sorted([plane, globe]) != [(False, False), (True, True)]:
            raise ValueError("give east_m and north_m, or latitude_deg and longitude_deg")
        return self

    def place(self, origin: NDArray[np.float64]) -> Vector:
        """East, north, up of a place."""
        if self.east_m is not None and self.north_m is not None:
            return self.east_m, self.north_m, self.up_m
        place = np.array([[self.latitude_deg or 0.0, self.longitude_deg or 0.0, origin[2]]])
        east, north, _ = earth.to_plane(origin, place)[0]
        return float(east), float(north), self.up_m


class Waypoints(Placed):
    """A receiver that drives through points, with round turns."""

    kind: Literal["waypoints"] = Field("waypoints", description="kind of trajectory")
    waypoint: tuple[Waypoint, ...] = Field(min_length=2, description="where it passes; at 0 s")
    turn_g: float = Field(0.3, gt=0, description="acceleration across in turns, 9.80665 m/s^2")

    def trajectory(self, duration_s: float) -> Trajectory:
        """Straight legs and arcs."""
        points = [Point(w.place(self.origin), w.speed_m_s) for w in self.waypoint]
        way = route(points, self.turn_g * GRAVITY_M_S2, duration_s)
        looks = along(way, np.arange(-1.0, duration_s + 1.0, _LOOK_S))
        return Trajectory(OnPlane(self.origin, way), looks, self.lever_arm_m)


class FromFile(Receiver):
    """A receiver that moves as a file says, a cubic spline through its rows."""

    kind: Literal["csv", "nmea"] = Field(description="kind of trajectory")
    file: str = Field(description="path, from the folder of the scenario file")

    def trajectory(self, duration_s: float) -> Trajectory:
        """Through the file's points."""
        read = trajectory_files.read_csv if self.kind == "csv" else trajectory_files.read_nmea
        track = read(Path(self.file))
        if track.time_s[0] > 1e-9 or track.time_s[-1] < duration_s - 1e-9:
            raise ValueError(
                f"file: {self.file} goes from {track.time_s[0]:g} to {track.time_s[-1]:g} s, the "
                f"recording from 0 to {duration_s:g} s; give a longer one or shorten duration_s"
            )
        turned: Curve | None = None
        if track.attitude_rad is not None:
            turned = through(track.time_s, np.unwrap(track.attitude_rad, axis=0))
        body = through(track.time_s, track.position_m)
        return Trajectory(body, turned, self.lever_arm_m)


class CsvFile(FromFile):
    """Columns by name: see :func:`.trajectory_files.read_csv`."""

    kind: Literal["csv"] = Field("csv", description="kind of trajectory")


class NmeaFile(FromFile):
    """GGA sentences."""

    kind: Literal["nmea"] = Field("nmea", description="kind of trajectory")


AnyReceiver = Annotated[
    Static | Circle | Waypoints | Vehicle | Uav | Ship | CsvFile | NmeaFile,
    Field(discriminator="kind"),
]
"""``[sky.receiver]``, told by its ``kind``."""
