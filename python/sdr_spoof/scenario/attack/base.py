"""What every kind of attack tells the rest: whom it is against, and what it puts on the air."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import BaseModel, Field, model_validator

from sdr_spoof import _core
from sdr_spoof.scenario.base import FROZEN, NonNegative
from sdr_spoof.scenario.satellite import Satellite, check_signals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.scenario.draw import Draw
    from sdr_spoof.scenario.knots import Knots
    from sdr_spoof.scenario.motion import Motion
    from sdr_spoof.signals import SignalSpec


@dataclass(frozen=True)
class Target:
    """A signal component of a satellite, from which that of an attack is derived."""

    satellite: Satellite
    signal: str
    """As the scenario names it, e.g. ``B1C``."""
    spec: SignalSpec
    """The component, e.g. ``B1CP``."""

    @property
    def has_data(self) -> bool:
        """False for a pilot."""
        return _core.periods_per_symbol(self.spec.id, self.satellite.prn) is not None


@dataclass(frozen=True)
class Emission:
    """What is on the air, as it differs from the target's own component."""

    start_s: float = 0.0
    end_s: float | None = None
    """None: the end of the recording."""
    power_db: Knots = field(default_factory=list)
    code_offset_m: Knots = field(default_factory=list)
    carrier_offset_hz: Knots = field(default_factory=list)
    phase_cycles: float = 0.0
    """At 0 s, before the carrier offset."""
    data_delay_s: float = 0.0
    data_error_rate: float = 0.0
    motion: Motion | None = None
    """Instead of the target's own."""


Victims = list[tuple[Satellite, tuple[str, ...]]]
"""Satellites and those of their signals that an attack imitates."""


class Attack(BaseModel):
    """Base of all kinds. A kind adds ``kind``, its keys, ``emissions`` and ``timeline``."""

    model_config = FROZEN

    kind: str = Field(description="kind of attack")
    role: ClassVar[str]
    """Of its emitters, in the truth."""
    hostile: ClassVar[bool] = True
    """False for what nature does."""

    prns: tuple[int, ...] = Field((), description="satellites; prn = N does for one (default: all)")
    system: str | None = Field(
        None, description="RINEX system letter (default: all systems, or C where prns are given)"
    )
    signals: tuple[str, ...] = Field((), description="signals (default: all of each satellite)")

    @model_validator(mode="before")
    @classmethod
    def _one_prn(cls, values: Any) -> Any:
        if not isinstance(values, dict) or "prn" not in values:
            return values
        if "prns" in values:
            raise ValueError("prn and prns say the same; give one of them")
        prn = values["prn"]
        return {k: v for k, v in values.items() if k != "prn"} | {"prns": (prn,)}

    @model_validator(mode="after")
    def _satellites_send_it(self) -> Self:
        if len(set(self.prns)) < len(self.prns):
            raise ValueError("prns names a satellite twice")
        for prn in self.prns:
            check_signals(self.system or "C", prn, self.signals)
        return self

    def victims(self, satellites: Sequence[Satellite], draw: Draw) -> Victims:
        """Satellites and signals that it imitates.

        Args:
            satellites: the authentic ones of the scenario.
            draw: random numbers of this attack.
        """
        del draw
        return self._chosen(satellites)

    def check(self, satellites: Sequence[Satellite], duration_s: float) -> None:
        """Raise ValueError, naming the key, if it does not fit the scenario."""
        sent = {(s.system, s.prn, n) for s in satellites for n in s.signals}
        for prn in self.prns:
            system = self.system or "C"
            missing = [n for n in self.signals if (system, prn, n) not in sent]
            if missing or (system, prn) not in {(s.system, s.prn) for s in satellites}:
                signals = f" with {', '.join(missing)}" if missing else ""
                raise ValueError(
                    f"prns: no [[satellite]] {system}{prn:02}{signals} for this "
                    "attack; add it or correct prn and signals"
                )
        if not self._chosen(satellites):
            raise ValueError(
                "prns: no satellite of the scenario is meant; correct system, prns and signals"
            )
        self.check_starts(duration_s)

    def check_starts(self, duration_s: float) -> None:
        """Raise ValueError if something comes on the air after the end of the recording."""
        for key, time_s in self.starts().items():
            if time_s >= duration_s:
                raise ValueError(
                    f"{key}: {time_s:g} is after the end of the recording at "
                    f"{duration_s:g} s; make it earlier or duration_s longer"
                )

    def starts(self) -> dict[str, float]:
        """Keys of the times at which something of it comes on the air, with their values."""
        raise NotImplementedError

    def emissions(self, target: Target, draw: Draw) -> list[Emission]:
        """What it puts on the air for one component."""
        raise NotImplementedError

    def timeline(self, satellite: Satellite, signals: tuple[str, ...]) -> dict[str, Any]:
        """Times and sizes for the truth, of one satellite."""
        raise NotImplementedError

    def _chosen(self, satellites: Sequence[Satellite]) -> Victims:
        meant = (s for s in satellites if self._means(s))
        named = ((s, tuple(n for n in self.signals or s.signals if n in s.signals)) for s in meant)
        return [(satellite, signals) for satellite, signals in named if signals]

    def _means(self, satellite: Satellite) -> bool:
        if not self.prns:
            return self.system in (None, satellite.system)
        return satellite.prn in self.prns and satellite.system == (self.system or "C")


class OnAir(Attack):
    """Base of those that come on the air once, and may go."""

    start_s: NonNegative = Field(description="on the air from here")
    end_s: NonNegative | None = Field(None, description="off the air from here (default: the end)")

    @model_validator(mode="after")
    def _ends_after_its_start(self) -> Self:
        check_end(self.start_s, self.end_s)
        return self

    def starts(self) -> dict[str, float]:
        """Time of its coming on the air."""
        return {"start_s": self.start_s}


def check_end(start_s: float, end_s: float | None) -> None:
    """Raise ValueError if an end is not after its start."""
    if end_s is not None and end_s <= start_s:
        raise ValueError(f"end_s {end_s:g} must be after start_s {start_s:g}")
