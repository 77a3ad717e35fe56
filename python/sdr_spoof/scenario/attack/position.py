"""A false position: counterfeit signals as they would be received somewhere else.

Each counterfeit has the range that its satellite would have from the false place: it begins where
the authentic one is, gains power, and moves away as its direction asks for.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from sdr_spoof.scenario.base import SPEED_OF_LIGHT, NonNegative, Phase
from sdr_spoof.scenario.knots import Knots
from sdr_spoof.scenario.sky import SkySatellite
from sdr_spoof.scenario.sky.earth import enu_axes
from sdr_spoof.scenario.sky.receiver import AnyReceiver

from .base import Attack, Emission, Target, check_end

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.scenario.draw import Draw
    from sdr_spoof.scenario.satellite import Satellite
    from sdr_spoof.scenario.sky import Sky, Track, View

Vector = tuple[float, float, float]
_PHASES = {"aligned": 0.0, "antipodal": 0.5}


class Position(Attack):
    """A false trajectory, or a false time, for all satellites of a sky or for some.

    From ``start_s`` counterfeits are aligned with the authentic signals; their power ramps to
    ``power_db``. From ``drag_start_s`` the place moves away from the antenna's at
    ``velocity_enu_m_s`` and the time at ``clock_rate_ppb``, both growing for ``drag_ramp_s``; or
    the place is that of ``trajectory`` all the time.
    """

    role: ClassVar[str] = "spoof"

    kind: Literal["position"] = Field("position", description="kind of attack")
    system: str | None = Field(
        None, description="RINEX system letter (default: all systems, or C where prns are given)"
    )
    start_s: NonNegative = Field(description="on the air from here")
    end_s: NonNegative | None = Field(None, description="off the air from here (default: the end)")
    power_start_db: float = Field(-20.0, description="power against the authentic, at first")
    power_db: float | None = Field(
        None, description="power against the authentic, after the ramp (default 3.5)"
    )
    eta: float | None = Field(
        None, gt=0, description="instead of power_db: amplitude over the authentic one"
    )
    power_ramp_s: NonNegative = Field(2.0, description="length of the power ramp")
    drag_start_s: NonNegative | None = Field(None, description="start of the drag (default: none)")
    velocity_enu_m_s: Vector = Field(
        (0.0, 0.0, 0.0), description="final velocity east, north, up against the antenna"
    )
    clock_rate_ppb: float = Field(
        0.0, description="final drift of the time in ns/s; positive: signals come later and later"
    )
    drag_ramp_s: NonNegative = Field(1.0, description="time for the drag to grow from zero")
    drag_end_s: NonNegative | None = Field(
        None, description="the drag falls to zero from here, for drag_ramp_s (default: never)"
    )
    trajectory: AnyReceiver | None = Field(
        None, description="instead of a velocity: the false trajectory, as [sky.receiver]"
    )
    transmitters_enu_m: tuple[Vector, ...] = Field(
        (),
        description="transmit antennas, east, north, up from the receiver's first place; "
        "satellites take turns. It matters to an array, which hears counterfeits from there "
        "(default: from the directions of their satellites)",
    )
    carrier: Literal["coherent", "frequency-locked"] = Field(
        "coherent",
        description="coherent: the carrier moves with the code; frequency-locked: the code alone",
    )
    carrier_phase_cycles: Phase | Literal["aligned", "antipodal"] = Field(
        "random",
        description="carrier phase against the authentic at first: a number, aligned (0), "
        "antipodal (0.5) or random for each signal",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_end(self.start_s, self.end_s)
        if self.power_db is not None and self.eta is not None:
            raise ValueError("power_db and eta say the same; give one of them")
        moves = any(self.velocity_enu_m_s) or self.clock_rate_ppb
        if self.trajectory is not None and any(self.velocity_enu_m_s):
            raise ValueError("trajectory and velocity_enu_m_s say the same; give one of them")
        if self.drag_start_s is None:
            if moves or self.drag_end_s is not None:
                raise ValueError(
                    "velocity_enu_m_s, clock_rate_ppb and drag_end_s need drag_start_s"
                )
            if self.trajectory is None:
                raise ValueError("a false position needs drag_start_s and a rate, or a trajectory")
        elif not moves:
            raise ValueError("drag_start_s needs velocity_enu_m_s or clock_rate_ppb")
        elif self.drag_start_s < self.start_s:
            raise ValueError(
                f"drag_start_s {self.drag_start_s:g} is before start_s {self.start_s:g}"
            )
        elif self.drag_end_s is not None and self.drag_end_s < self._full_s:
            raise ValueError(
                f"drag_end_s {self.drag_end_s:g} is before the drag is full at {self._full_s:g} s"
            )
        return self

    @property
    def final_power_db(self) -> float:
        """Power after the ramp, from ``power_db`` or ``eta``."""
        if self.eta is not None:
            return 20 * math.log10(self.eta)
        return 3.5 if self.power_db is None else self.power_db

    def check(self, satellites: Sequence[Satellite], duration_s: float) -> None:
        """Only satellites on orbits can be seen from elsewhere."""
        super().check(satellites, duration_s)
        for satellite, _ in self._chosen(satellites):
            if not isinstance(satellite, SkySatellite):
                raise ValueError(
                    f"prns: {satellite.system}{satellite.prn:02} is no satellite of a [sky], so "
                    "that its range from another place is not known; use kind = 'induced' for it"
                )
        if self.trajectory is not None:
            self.trajectory.trajectory(duration_s)

    def starts(self) -> dict[str, float]:
        """Times of its coming on the air and of the drag."""
        drag = {} if self.drag_start_s is None else {"drag_start_s": self.drag_start_s}
        return {"start_s": self.start_s} | drag

    def emissions(self, target: Target, draw: Draw) -> list[Emission]:
        """The component as it would be received at the false place."""
        satellite, spec = target.satellite, target.spec
        assert isinstance(satellite, SkySatellite)
        phase = self.carrier_phase_cycles
        if phase == "random":
            phase = draw("phase", satellite.system, satellite.prn, target.signal)
        ramp_end_s = self.start_s + self.power_ramp_s
        track = satellite.track
        false = self.view(track)
        coherent = self.carrier == "coherent"
        return [
            Emission(
                start_s=self.start_s,
                end_s=self.end_s,
                power_db=[(self.start_s, self.power_start_db), (ramp_end_s, self.final_power_db)],
                phase_cycles=_PHASES[phase] if isinstance(phase, str) else phase,
                code_offset_m=[] if coherent else _offset_m(track, false),
                motion=track.motion(spec, false if coherent else None),
            )
        ]

    def timeline(self, satellite: Satellite, signals: tuple[str, ...]) -> dict[str, Any]:
        """Times, and how far the range is off at the end of the recording."""
        del signals
        assert isinstance(satellite, SkySatellite)
        offset_m = _offset_m(satellite.track, self.view(satellite.track))
        return {
            "start_s": self.start_s,
            "power_ramp_start_s": self.start_s,
            "power_ramp_end_s": self.start_s + self.power_ramp_s,
            "capture_s": self._capture_s,
            "drag_start_s": self.drag_start_s,
            "drag_full_s": None if self.drag_start_s is None else self._full_s,
            "drag_end_s": self.drag_end_s,
            "end_s": self.end_s,
            "power_db": self.final_power_db,
            "velocity_enu_m_s": list(self.velocity_enu_m_s),
            "clock_rate_ppb": self.clock_rate_ppb,
            "carrier": self.carrier,
            "range_offset_end_m": offset_m[-1][1],
        }

    def place_m(self, sky: Sky) -> NDArray[np.float64]:
        """Earth-fixed false place at the knots of a sky, (N, 3)."""
        if self.trajectory is not None:
            return self.trajectory.trajectory(sky.duration_s).position_m(sky.system_s)
        aimed_m = sky.reference_m if self.transmitters_enu_m else sky.antenna_m
        axes = enu_axes(aimed_m)
        velocity = np.einsum("nkx,k->nx", axes, np.array(self.velocity_enu_m_s))
        return np.asarray(aimed_m + velocity * self._dragged_s(sky.time_s)[:, None])

    def view(self, track: Track) -> View:
        """A satellite as it is seen from the false place at the false time."""
        late_s = self.late_s(track.sky.time_s) + self._near_s(track)
        return track.sky.view(track.ephemeris, self.place_m(track.sky), late_s)

    def _near_s(self, track: Track) -> NDArray[np.float64] | float:
        """How much later the antenna hears the transmitter than the array's reference does."""
        sky = track.sky
        if not self.transmitters_enu_m or sky.antenna_m is sky.reference_m:
            return 0.0
        turn = [e.prn for e in sky.ephemerides].index(track.ephemeris.prn)
        enu = np.array(self.transmitters_enu_m[turn % len(self.transmitters_enu_m)])
        first = int(np.argmin(np.abs(sky.time_s)))
        place = sky.reference_m[first] + enu @ enu_axes(sky.reference_m[first : first + 1])[0]
        there, here = (
            np.linalg.norm(place - at, axis=1) for at in (sky.antenna_m, sky.reference_m)
        )
        return np.asarray((there - here) / SPEED_OF_LIGHT)

    def late_s(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """By how much all counterfeits come later than the false place asks for."""
        return np.asarray(1e-9 * self.clock_rate_ppb * self._dragged_s(time_s))

    def _means(self, satellite: Satellite) -> bool:
        """Those of a sky, unless named."""
        return super()._means(satellite) and (
            bool(self.prns) or isinstance(satellite, SkySatellite)
        )

    @property
    def _full_s(self) -> float:
        return (self.drag_start_s or 0.0) + self.drag_ramp_s

    @property
    def _capture_s(self) -> float | None:
        first, last = self.power_start_db, self.final_power_db
        if last <= 0:
            return None
        return self.start_s + (self.power_ramp_s * max(0.0, -first) / (last - min(first, 0.0)))

    def _dragged_s(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Integral of the share of the drag's final rate."""
        if self.drag_start_s is None:
            return np.zeros_like(time_s)
        total = _since(time_s, self.drag_start_s, self.drag_ramp_s)
        if self.drag_end_s is not None:
            total = total - _since(time_s, self.drag_end_s, self.drag_ramp_s)
        return total


def _since(time_s: NDArray[np.float64], start_s: float, ramp_s: float) -> NDArray[np.float64]:
    """Integral of a rate that grows from 0 to 1 in ``ramp_s``."""
    into = np.maximum(time_s - start_s, 0.0)
    if not ramp_s:
        return into
    return np.where(into < ramp_s, into**2 / (2 * ramp_s), into - 0.5 * ramp_s)


def _offset_m(track: Track, false: View) -> Knots:
    """Range of the false view less the authentic one."""
    offset = false.range_m - track.view.range_m
    return list(zip(track.sky.time_s.tolist(), offset.tolist(), strict=True))
