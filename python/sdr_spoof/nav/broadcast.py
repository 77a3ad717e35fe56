"""What satellites broadcast beside their own orbit and clock, whichever message it came in."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .ephemeris import Ephemeris
    from .integrity import GridPoint, Integrity
    from .time import GnssTime


@dataclass(frozen=True)
class Klobuchar:
    """Eight-parameter ionosphere: IS-GPS-200, 20.3.3.5.2.5; BDS-SIS-ICD-B1I-3.0, 5.2.4.7."""

    alpha: tuple[float, float, float, float]
    """s, s/semicircle, s/semicircle^2, s/semicircle^3."""
    beta: tuple[float, float, float, float]
    """The same units."""
    system: str
    """Whose model: G for GPS's form (geomagnetic latitude, at L1), C for that of BDS (geographic
    latitude, at B1I)."""
    transmitted: GnssTime | None = None

    @classmethod
    def of(cls, values: Iterable[float], system: str, transmitted: GnssTime) -> Self:
        """From alpha0 to alpha3 and beta0 to beta3, as messages and files have them."""
        a0, a1, a2, a3, b0, b1, b2, b3 = values
        return cls((a0, a1, a2, a3), (b0, b1, b2, b3), system, transmitted)

    @property
    def blank(self) -> bool:
        """Whether all are 0: a message whose sender knew none, with the 5 ns of the night left."""
        return not any((*self.alpha, *self.beta))

    def fields(self) -> dict[str, float]:
        """By the names that messages have for them: alpha0 to beta3."""
        names = (f"{kind}{n}" for kind in ("alpha", "beta") for n in range(4))
        return dict(zip(names, (*self.alpha, *self.beta), strict=True))


@dataclass(frozen=True)
class Bdgim:
    """Nine-parameter ionosphere: BDS-SIS-ICD-B1C-1.0, 7.8."""

    alpha: tuple[float, float, float, float, float, float, float, float, float]
    """TECU."""
    system: str = "C"
    transmitted: GnssTime | None = None

    @property
    def blank(self) -> bool:
        """Whether all are 0, as where the sender knew none."""
        return not any(self.alpha)


Ionosphere = Klobuchar | Bdgim


@dataclass(frozen=True)
class UtcParameters:
    """A system's time against its realisation of UTC: system time - UTC =
    ``leap_s + a0 + a1 (t - reference) + a2 (t - reference)^2``.

    Sources: IS-GPS-200 20.3.3.5.2.4, BDS-SIS-ICD-B1I-3.0 5.2.4.17 (its reference is the start of
    the week of transmission), BDS-SIS-ICD-B1C-1.0 7.12.
    """

    system: str
    a0: float
    a1: float
    reference: GnssTime
    leap_s: int
    """Leap seconds of this system's time: for GPS 18 in 2023, for BDS 4."""
    leap_week: int
    """Week of the system at the end of whose day ``leap_day`` the new count holds; not rolled over.
    """
    leap_day: int
    """As the message counts days: GPS 1 to 7, BDS 0 to 6."""
    leap_future_s: int
    a2: float = 0.0
    transmitted: GnssTime | None = None


@dataclass(frozen=True)
class TimeOffset:
    """One system's time against another's: ``system - other = a0 + a1 (t - reference) + ...``,
    whole seconds left out.

    Sources: BDS-SIS-ICD-B1I-3.0 5.2.4.18 to 20 (reference: start of the week), B1C-1.0 7.13.
    """

    system: str
    other: str
    """RINEX system letter: G, R, E."""
    a0: float
    a1: float
    reference: GnssTime
    a2: float = 0.0
    transmitted: GnssTime | None = None


@dataclass(frozen=True)
class Contents:
    """What frames say, put together."""

    ephemerides: tuple[Ephemeris, ...] = ()
    ionosphere: tuple[Ionosphere, ...] = ()
    utc: tuple[UtcParameters, ...] = ()
    offsets: tuple[TimeOffset, ...] = ()
    health: tuple[tuple[str, int], ...] = ()
    """Satellite by RINEX name and what almanac or health pages say of it, 0 = healthy."""
    almanacs: tuple[Ephemeris, ...] = ()
    """Coarse orbits; quantities that an almanac lacks are 0."""
    integrity: tuple[Integrity, ...] = ()
    """How satellites were judged, in order of time where one satellite tells."""
    grid: tuple[GridPoint, ...] = ()
    """Vertical delays of the ionosphere."""

    def distinct(self) -> Self:
        """Leave out what is a repetition of something sent before."""
        return replace(
            self,
            ephemerides=_distinct(self.ephemerides),
            ionosphere=_distinct(self.ionosphere),
            utc=_distinct(self.utc),
            offsets=_distinct(self.offsets),
            health=tuple(dict(self.health).items()),
            almanacs=_distinct(self.almanacs),
            grid=_distinct(self.grid),
        )

    def __add__(self, other: Self) -> Self:
        """Both, one after the other."""
        return replace(
            self,
            ephemerides=self.ephemerides + other.ephemerides,
            ionosphere=self.ionosphere + other.ionosphere,
            utc=self.utc + other.utc,
            offsets=self.offsets + other.offsets,
            health=self.health + other.health,
            almanacs=self.almanacs + other.almanacs,
            integrity=self.integrity + other.integrity,
            grid=self.grid + other.grid,
        )


def _distinct(items: tuple[Any, ...]) -> tuple[Any, ...]:
    """First of each that differ in more than the time of transmission."""
    first: dict[Any, Any] = {}
    for item in items:
        first.setdefault(replace(item, transmitted=None), item)
    return tuple(first.values())


@dataclass(frozen=True)
class Broadcast:
    """All that one satellite needs to fill its message; what is None is sent as zeros."""

    ephemeris: Ephemeris
    """Its own."""
    ephemerides: tuple[Ephemeris, ...] = ()
    """Of all satellites, for the almanacs."""
    klobuchar: Klobuchar | None = None
    bdgim: Bdgim | None = None
    utc: UtcParameters | None = None
    """In the time of the message's system."""
    offsets: tuple[TimeOffset, ...] = ()
    health: tuple[tuple[str, int], ...] = field(default=())
    """Satellites that are not healthy, by RINEX name, beyond what ``ephemerides`` say."""
    integrity: tuple[Integrity, ...] = ()
    """Judgements that geostationary BDS satellites send."""
    grid: tuple[GridPoint, ...] = ()
    """Points of the ionosphere's grid that they send; others are not available."""
