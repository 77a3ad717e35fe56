"""What a scenario file says, checked. Times are seconds since the first sample."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any, Self

from pydantic import BaseModel, Field, model_validator

from sdr_spoof.errors import ConfigError
from sdr_spoof.signals import components, signal_spec

from .attack import AnyAttack, Victims
from .base import FROZEN
from .dme_table import DmeTable
from .dme_table import check as check_dme
from .draw import integer, of_attack
from .imu_table import ImuTable
from .recording_plan import RecordingPlan
from .satellite import Satellite
from .sky import SkyTable, sky_of

if TYPE_CHECKING:
    from .draw import Draw
    from .sky import Sky

_TIME = re.compile(r"(?<!_m)_s$")
"""Keys that hold seconds, and not metres per second."""


class Scenario(BaseModel):
    """A whole scenario file."""

    model_config = FROZEN

    title: str = Field("", description="what it shows")
    recording: RecordingPlan
    sky: SkyTable | None = Field(None, description="authentic satellites on their orbits")
    satellite: tuple[Satellite, ...] = Field((), description="authentic satellites")
    attack: tuple[AnyAttack, ...] = Field((), description="attacks, and multipath")
    imu: ImuTable | None = Field(None, description="inertial sensors beside the antenna")
    dme: tuple[DmeTable, ...] = Field((), description="DME stations about the receiver")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        names = [(s.system, s.prn) for s in self.satellites]
        for system, prn in names:
            if names.count((system, prn)) > 1:
                raise ValueError(f"[[satellite]] prn: {system}{prn:02} appears twice")
        for satellite in self.satellites:
            table = "[[satellite]]" if satellite in self.satellite else "[sky]"
            self._check_band(table, satellite, satellite.signals)
        self._check_imu()
        check_dme(self.dme, sky=self.sky is not None)
        for number, attack in enumerate(self.attack):
            try:
                attack.check(self.satellites, self.recording.duration_s)
            except ValueError as error:
                raise ValueError(f"[[attack]] (number {number + 1}) {error}") from error
            for satellite, signals in self.victims(number):
                self._check_band("[[attack]]", satellite, signals)
        return self

    def _check_imu(self) -> None:
        if self.imu is None:
            return
        if self.sky is None:
            raise ValueError("[imu] needs a [sky], whose receiver moves; add one")
        if self.imu.start_s >= self.recording.duration_s:
            raise ValueError(
                f"[imu] start_s {self.imu.start_s:g} is not before the end of the recording at "
                f"{self.recording.duration_s:g} s"
            )

    @property
    def satellites(self) -> tuple[Satellite, ...]:
        """All authentic ones: those of the file, and those of its sky."""
        return self.satellite if self.sky is None else (*self.satellite, *self._sky().satellites)

    def sky_model(self) -> Sky | None:
        """Orbits, antenna and clock of the table ``[sky]``, where there is one."""
        return None if self.sky is None else self._sky()

    def _sky(self) -> Sky:
        assert self.sky is not None
        try:
            return sky_of(self.sky, self.recording.duration_s, self.recording.seed)
        except ValueError as error:
            raise ValueError(f"[sky] {error}") from error

    def antennas(self) -> tuple[Scenario, ...]:
        """One scenario for each antenna that is recorded."""
        sky = self.sky
        if sky is None or sky.array is None or sky.array.antenna is not None:
            return (self,)
        table = sky.array
        skies = [
            sky.model_copy(update={"array": table.model_copy(update={"antenna": k})})
            for k in range(len(table.elements_m))
        ]
        # The IMU is one: its log lies beside the reference's recording.
        imus = [self.imu, *[None] * (len(skies) - 1)]
        return tuple(
            self.model_copy(update={"sky": s, "imu": imu, "dme": () if k else self.dme})
            for k, (s, imu) in enumerate(zip(skies, imus, strict=True))
        )

    @property
    def noise_seed(self) -> int:
        """Seed of the noise: each antenna has its own."""
        seed = self.recording.seed
        array = None if self.sky is None else self.sky.array
        return integer("antenna", seed, array.antenna) if array and array.antenna else seed

    @property
    def line_cycles(self) -> float:
        """What the line of the antenna adds to carrier phases."""
        array = None if self.sky is None else self.sky.array
        return array.delay_cycles if array else 0.0

    def victims(self, number: int) -> Victims:
        """Satellites and signals that the attack of this number imitates."""
        attack = self.attack[number]
        return attack.victims(self.satellites, self.draw(number))

    def draw(self, number: int) -> Draw:
        """Random numbers of the attack of this number."""
        return of_attack(self.recording.seed, number)

    def sped_up(self, factor: float) -> Scenario:
        """The same scenario in a shorter time.

        Every time and duration is divided by the factor, that of the recording included. What is
        no time stays: rates of drags and motions, powers, offsets, carriers. So a drag has its
        speed, and gets less far.

        Raises:
            ConfigError: the factor is not above 0.
        """
        if not (factor > 0 and math.isfinite(factor)):
            raise ConfigError(f"speed-up {factor:g}: must be a number above 0, such as 10")
        return Scenario.model_validate(_times_divided(self.model_dump(), factor))

    def _check_band(self, table: str, satellite: Satellite, signals: tuple[str, ...]) -> None:
        low, high = self.recording.band_hz
        for signal, component in ((s, c) for s in signals for c in components(s)):
            spec = signal_spec(component)
            first = spec.carrier_hz - spec.min_half_bandwidth_hz
            last = spec.carrier_hz + spec.min_half_bandwidth_hz
            if first < low or last > high:
                raise ValueError(
                    f"{table} signals: {signal} of PRN {satellite.prn} needs {first / 1e6:g} "
                    f"to {last / 1e6:g} MHz; the recording samples {low / 1e6:g} to "
                    f"{high / 1e6:g} MHz: raise sample_rate_hz, move lo_hz, or leave {signal} out"
                )


def _times_divided(value: Any, factor: float, key: str = "") -> Any:
    if isinstance(value, dict):
        return {k: _times_divided(v, factor, k) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_times_divided(v, factor, key) for v in value]
    return value / factor if _TIME.search(key) and value is not None else value
