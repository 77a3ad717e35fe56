"""What the table ``[sky]`` of a scenario says, checked."""

from __future__ import annotations

import math
from dataclasses import replace
from datetime import datetime
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import BaseModel, Field, field_validator, model_validator

from sdr_spoof.nav.instants import instant
from sdr_spoof.nav.integrity import Integrity
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.scenario.base import FROZEN
from sdr_spoof.signals import components, signal_spec

from .array import ArrayTable
from .clock import ReceiverClock
from .receiver import AnyReceiver

if TYPE_CHECKING:
    from .trajectory import Trajectory

SYSTEMS = {"C": "BDT", "G": "GPS"}
"""Systems of which there are orbits, and the names of their times."""


class SatelliteOverride(BaseModel):
    """One of ``[[sky.satellite]]``: what is different about one satellite."""

    model_config = FROZEN

    prn: int = Field(description="PRN")
    system: str = Field("C", description="RINEX system letter")
    cn0_dbhz: float | None = Field(None, description="C/N0 of each signal, at any elevation")
    signals: tuple[str, ...] | None = Field(None, description="its signals")
    on_air: bool = Field(True, description="false: it is left out")
    healthy: bool = Field(True, description="false: it sends as ever, and that it is unhealthy")
    udrei: int | None = Field(
        None, ge=0, le=15, description="UDREI that geostationary BDS satellites tell of it (D2)"
    )
    rurai: int | None = Field(None, ge=0, le=15, description="likewise, RURAI")
    correction_m: float | None = Field(
        None, ge=-409.5, le=409.5, description="likewise, equivalent clock correction"
    )

    @property
    def judged(self) -> bool:
        """Whether geostationary satellites tell of it."""
        return (self.udrei, self.rurai, self.correction_m) != (None, None, None)

    @model_validator(mode="after")
    def _of_bds(self) -> Self:
        if self.judged and self.system != "C":
            raise ValueError(
                f"udrei, rurai, correction_m: only BDS satellites are judged in D2, not "
                f"{self.system}{self.prn:02d}; leave them out"
            )
        return self


class SkyTable(BaseModel):
    """Time, place, satellites and propagation: table ``[sky]``."""

    model_config = FROZEN

    start: str = Field(
        description="time of the first sample: a date in UTC (2023-03-12T12:00:00), or week and "
        "seconds of week: 'BDT 897 43204' or 'GPS 2253 43218'"
    )
    receiver: AnyReceiver = Field(description="where the antenna is")
    navigation: str | None = Field(
        None,
        description="RINEX navigation file, path from the folder of the scenario file (default: "
        "one of 2023-03-12, 10 to 14 h, that comes with the package)",
    )
    systems: tuple[Literal["C", "G"], ...] = Field(
        ("C", "G"), min_length=1, description="RINEX system letters"
    )
    signals: tuple[str, ...] = Field(
        ("B1I", "B1C", "L1CA"),
        min_length=1,
        description="signals; each satellite has those that it sends",
    )
    elevation_mask_deg: float = Field(
        5.0, ge=0, lt=90, description="satellites are on the air above it"
    )
    cn0_zenith_dbhz: float = Field(45.0, description="C/N0 of each signal in the zenith")
    cn0_horizon_dbhz: float | None = Field(
        None,
        description="C/N0 at the horizon; in between in proportion to the sine of the elevation "
        "(default: that of the zenith)",
    )
    ionosphere: Literal["none", "klobuchar", "bdgim"] = Field(
        "klobuchar",
        description="delay of codes, advance of carriers: none; klobuchar (for each system in the "
        "form of its own message); bdgim",
    )
    ionosphere_grid: bool = Field(
        False,
        description="geostationary BDS satellites send the grid of the ionosphere (D2), as it is "
        "at the start",
    )
    klobuchar_alpha: tuple[float, float, float, float] | None = Field(
        None, description="instead of those of the navigation file"
    )
    klobuchar_beta: tuple[float, float, float, float] | None = Field(
        None, description="instead of those of the navigation file"
    )
    bdgim_tecu: tuple[float, float, float, float, float, float, float, float, float] | None = Field(
        None, description="parameters of bdgim, instead of those of the navigation file"
    )
    troposphere: Literal["none", "saastamoinen"] = Field(
        "saastamoinen", description="delay of the air, of a standard atmosphere"
    )
    bdt_offset_ns: float = Field(0.0, description="BDT less GPST, beyond the whole seconds")
    messages: bool = Field(
        True, description="false: pseudo-random symbols instead of navigation messages"
    )
    new_issues: bool = Field(
        False,
        description="messages change to the next ephemeris of the navigation file when a satellite "
        "would: BDS at its reference time, each full hour, GPS two hours before it. The satellites "
        "stay on the orbit of one ephemeris, which has no steps",
    )
    clock: ReceiverClock = Field(ReceiverClock.model_validate({}), description="receiver's clock")
    array: ArrayTable | None = Field(None, description="several antennas instead of one")
    satellite: tuple[SatelliteOverride, ...] = Field((), description="what differs")

    @field_validator("start", mode="before")
    @classmethod
    def _as_text(cls, value: Any) -> Any:
        return value.isoformat() if isinstance(value, datetime) else value

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if len(set(self.systems)) < len(self.systems):
            raise ValueError("systems names one twice")
        names = [component for signal in self.signals for component in components(signal)]
        if len(set(names)) < len(names):
            raise ValueError("signals names a signal twice")
        strange = [n for n in names if signal_spec(n).system not in self.systems]
        if strange and {"signals", "systems"} <= self.model_fields_set:
            raise ValueError(f"signals: {strange[0]} belongs to none of the systems")
        if (self.klobuchar_alpha is None) != (self.klobuchar_beta is None):
            raise ValueError("klobuchar_alpha and klobuchar_beta belong together; give both")
        places = [(s.system, s.prn) for s in self.satellite]
        if len(set(places)) < len(places):
            raise ValueError("satellite: one is named twice")
        _ = self.start_time
        return self

    @property
    def start_time(self) -> GnssTime:
        """Time of the first sample, by a right clock."""
        return instant(self.start)

    def override(self, system: str, prn: int) -> SatelliteOverride:
        """What differs for a satellite."""
        found = (s for s in self.satellite if (s.system, s.prn) == (system, prn))
        return next(found, SatelliteOverride(prn=prn, system=system))

    @property
    def integrity(self) -> tuple[Integrity, ...]:
        """How geostationary BDS satellites judge those of which something is said."""
        return tuple(
            Integrity(
                s.prn,
                udrei=s.udrei or 0,
                rurai=s.rurai or 0,
                correction_m=math.nan if s.correction_m is None else s.correction_m,
            )
            for s in self.satellite
            if s.judged
        )

    def trajectory(self, duration_s: float, *, reference: bool = False) -> Trajectory:
        """Motion of the antenna that is recorded, or of an array's reference antenna."""
        moving = self.receiver.trajectory(duration_s)
        if self.array is None:
            return moving
        place = self.array.elements_m[0] if reference else self.array.place_m
        forward, right, down = (a + b for a, b in zip(moving.lever_arm_m, place, strict=True))
        return replace(moving, lever_arm_m=(forward, right, down))
