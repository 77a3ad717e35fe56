"""DME stations about the receiver: table ``[[dme]]`` of a scenario, and what is measured of them.

``<recording>.dme.csv`` holds slant ranges from the body, at whole multiples of an interval of
system time since the sky's start, with the noise of ICAO Annex 10 and the clock error of the
interrogator. A spoofer of GNSS does not touch them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pydantic import BaseModel, Field

from sdr_spoof.aiding.dme.files import dme_text
from sdr_spoof.aiding.dme.records import DmeLog
from sdr_spoof.aiding.dme.stations import Station, sigma_m, slant_ranges_m

from .base import FROZEN, NonNegative
from .sky.receiver_base import Latitude, Longitude

if TYPE_CHECKING:
    from .model import Scenario

_STREAM = 0x444D45
"""Of the noise: no other part of a scenario draws from it."""


class DmeTable(BaseModel):
    """One of ``[[dme]]``."""

    model_config = FROZEN

    name: str = Field(min_length=1, pattern=r"^[^,#\s]+$", description="name of the station")
    latitude_deg: Latitude = Field(description="latitude")
    longitude_deg: Longitude = Field(description="longitude")
    height_m: float = Field(0.0, description="height above the ellipsoid")
    interval_s: float = Field(1.0, gt=0.0, description="time between its ranges")
    bias_m: float = Field(0.0, description="error of the interrogator's clock, as a range")
    noise: NonNegative = Field(1.0, description="noise as a multiple of Annex 10's; 0 for none")

    @property
    def station(self) -> Station:
        """Where it is."""
        return Station(self.name, self.latitude_deg, self.longitude_deg, self.height_m)


def check(tables: tuple[DmeTable, ...], *, sky: bool) -> None:
    """Refuse what makes no sense.

    Raises:
        ValueError: the message names the key.
    """
    names = [t.name for t in tables]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"[[dme]] name: '{name}' appears twice; give each station its own")
    if tables and not sky:
        raise ValueError("[[dme]] needs a [sky], whose receiver moves; add one")


def dme_of(scenario: Scenario, *, duration_s: float | None = None) -> DmeLog | None:
    """Ranges of a scenario with stations; None without.

    Args:
        scenario: what happens.
        duration_s: of the recording, if it is shorter than planned.
    """
    sky = scenario.sky_model()
    if not scenario.dme or sky is None:
        return None
    length_s = scenario.recording.duration_s if duration_s is None else duration_s
    stations = tuple(t.station for t in scenario.dme)
    times, which, ranges = [], [], []
    for number, table in enumerate(scenario.dme):
        count = int(np.floor(length_s / table.interval_s + 1e-9)) + 1
        time_s = table.interval_s * np.arange(count, dtype=np.float64)
        true = slant_ranges_m(stations[number : number + 1], sky.trajectory.body(time_s))[:, 0]
        random = np.random.default_rng((scenario.recording.seed, _STREAM, number))
        noise = table.noise * sigma_m(true) * random.standard_normal(count)
        times.append(time_s)
        which.append(np.full(count, number))
        ranges.append(true + table.bias_m + noise)
    time_s = np.concatenate(times)
    order = np.argsort(time_s, kind="stable")
    station, range_m = np.concatenate(which)[order], np.concatenate(ranges)[order]
    return DmeLog(sky.start, stations, time_s[order], station, range_m)


def dme_csv(scenario: Scenario, duration_s: float) -> str | None:
    """The file beside the recording; None without stations."""
    log = dme_of(scenario, duration_s=duration_s)
    return None if log is None else dme_text(log)
