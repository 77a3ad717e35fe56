"""The best of what is known of a satellite at a time, whatever it came from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from ..signals import satellite_name
from .broadcast import Bdgim, Klobuchar, UtcParameters

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .broadcast import Contents
    from .ephemeris import Ephemeris
    from .integrity import Integrity
    from .time import GnssTime

Sent = TypeVar("Sent", Klobuchar, Bdgim, UtcParameters)
SAME_TOE_S = 1.0
COMPARED = (
    "a0", "a1", "a", "e", "m0", "delta_n", "omega0", "i0", "omega", "omega_dot", "i_dot",
    "cuc", "cus", "crc", "crs", "cic", "cis",
)  # fmt: skip
RELATIVE = 1e-6
"""Ephemerides of one issue agree to this where they differ by rounding in files only."""


@dataclass(frozen=True)
class Selected:
    """An ephemeris, and what speaks against its use."""

    ephemeris: Ephemeris
    stale: bool
    """The time is further from its reference than its fit interval."""
    healthy: bool
    age_s: float
    """Time since its reference; negative before it."""


class Store:
    """Ephemerides, ionosphere and UTC of several sources, such as a file and a recording."""

    def __init__(self, *sources: Contents) -> None:
        """Later sources take precedence where two say different things at the same time."""
        self.ephemerides = tuple(e for s in sources for e in s.ephemerides)
        self.ionosphere = tuple(i for s in sources for i in s.ionosphere)
        self.utc_parameters = tuple(u for s in sources for u in s.utc)
        self._of: dict[tuple[str, int], list[Ephemeris]] = {}
        for e in self.ephemerides:
            self._of.setdefault((e.system, e.prn), []).append(e)
        health = {name: value for s in sources for name, value in s.health}
        self._unhealthy = {name for name, value in health.items() if value}
        self._judged: dict[tuple[str, int], list[Integrity]] = {}
        for one in (i for s in sources for i in s.integrity or ()):
            self._judged.setdefault((one.system, one.prn), []).append(one)

    def satellites(self) -> list[tuple[str, int]]:
        """Satellites with an ephemeris: (system, PRN), sorted."""
        return sorted(self._of)

    def select(
        self, system: str, prn: int, time: GnssTime, messages: Iterable[str] | None = None
    ) -> Selected | None:
        """Ephemeris whose reference is closest to a time, of several such the one sent last.

        ``messages`` are those wanted, all by default. None if there is none at all.
        """
        wanted = None if messages is None else frozenset(messages)
        known = [
            e for e in self._of.get((system, prn), []) if wanted is None or e.message in wanted
        ]
        if not known:
            return None
        best = known[0]
        for e in known[1:]:
            closer = abs(best.toe - time) - abs(e.toe - time)
            same = abs(closer) < SAME_TOE_S
            if (not same and closer > 0) or (same and e.transmitted >= best.transmitted):
                best = e
        age = time - best.toe
        return Selected(
            ephemeris=best,
            stale=abs(age) > best.fit_interval_s,
            healthy=self._healthy(known, best, time),
            age_s=age,
        )

    def _healthy(self, known: list[Ephemeris], best: Ephemeris, time: GnssTime) -> bool:
        """By the last ephemeris sent until then, the one chosen, the health pages, and how
        geostationary satellites judged it last."""
        sent = [e for e in known if not time < e.transmitted]
        last = max(sent, key=lambda e: e.transmitted) if sent else best
        name = satellite_name(best.system, best.prn)
        told = best.health == 0 and last.health == 0 and name not in self._unhealthy
        return told and self._usable(best.system, best.prn, time)

    def _usable(self, system: str, prn: int, time: GnssTime) -> bool:
        """By the last judgement sent until then; before the first, by that."""
        judged = self._judged.get((system, prn), [])
        dated = [i for i in judged if i.transmitted is not None]
        sent = [i for i in dated if i.transmitted is not None and not time < i.transmitted]
        last = max(sent, key=_sent) if sent else min(dated, key=_sent, default=None)
        return last is None or last.usable

    def all_at(
        self, time: GnssTime, messages: Iterable[str] | None = None
    ) -> dict[tuple[str, int], Selected]:
        """The best of every satellite that has one, by (system, PRN)."""
        wanted = None if messages is None else tuple(messages)
        found = {s: self.select(*s, time, wanted) for s in self.satellites()}
        return {s: selected for s, selected in found.items() if selected is not None}

    def klobuchar(self, system: str, time: GnssTime) -> Klobuchar | None:
        """Eight-parameter model of a system that was sent closest to a time."""
        models = [i for i in self.ionosphere if isinstance(i, Klobuchar) and i.system == system]
        return _closest(models, time)

    def bdgim(self, time: GnssTime) -> Bdgim | None:
        """Nine-parameter model that was sent closest to a time."""
        return _closest([i for i in self.ionosphere if isinstance(i, Bdgim)], time)

    def utc(self, system: str, time: GnssTime) -> UtcParameters | None:
        """Parameters of a system's UTC that were sent closest to a time."""
        return _closest([u for u in self.utc_parameters if u.system == system], time)


def _sent(one: Integrity) -> GnssTime:
    assert one.transmitted is not None
    return one.transmitted


def _closest(items: list[Sent], time: GnssTime) -> Sent | None:
    """The one sent closest to a time, those without a time last; the later of equals."""

    def distance(item: Sent) -> float:
        return math.inf if item.transmitted is None else abs(item.transmitted - time)

    return min(reversed(items), key=distance, default=None)


def conflicts(a: Contents, b: Contents) -> list[str]:
    """Ephemerides of one issue that differ, such as a forged one from that of a file."""
    known = {_issue(e): e for e in a.ephemerides}
    found = []
    for e in b.ephemerides:
        other = known.get(_issue(e))
        if other is None:
            continue
        names = [n for n in COMPARED if not _same(getattr(e, n), getattr(other, n))]
        if names:
            name = satellite_name(e.system, e.prn)
            found.append(f"{name} {e.message} issue {e.iode} differs in {', '.join(names)}")
    return found


def _issue(e: Ephemeris) -> tuple[str, int, str, int, int]:
    return e.system, e.prn, e.message, e.toe.seconds, e.iode


def _same(x: float, y: float) -> bool:
    return math.isclose(x, y, rel_tol=RELATIVE, abs_tol=1e-15)
