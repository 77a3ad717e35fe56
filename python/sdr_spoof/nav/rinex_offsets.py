"""Offsets between system times in RINEX navigation files: UTC, and one system to another."""

from __future__ import annotations

from dataclasses import dataclass

from .broadcast import Contents, TimeOffset, UtcParameters
from .rinex_lines import MalformedError, epoch, numbers
from .time import WEEK_S, GnssTime
from .weeks import nearest

SYSTEMS = {"GP": "G", "BD": "C", "GA": "E", "GL": "R"}
BDT_LEAP_S, BDT_WEEK = 14, 1356
"""GPST minus BDT, and the week of GPS at which BDS began to count; GPS counts days from 1."""


@dataclass(frozen=True)
class Leap:
    """Leap seconds as a header tells them."""

    now_s: int
    future_s: int
    week: int
    day: int
    system: str
    """G: since 1980; C: since 2006."""

    def of(self, system: str) -> Leap:
        """The same in a system's own time, weeks and days."""
        if system == self.system:
            return self
        sign = -1 if system == "C" else 1
        shift = sign * BDT_LEAP_S
        week = max(0, self.week + sign * BDT_WEEK)
        now, future = self.now_s + shift, self.future_s + shift
        return Leap(now, future, week, self.day + sign, system)


def parameters(
    code: str,
    polynomial: tuple[float, float, float],
    reference: GnssTime,
    transmitted: GnssTime | None,
    leap: Leap | None,
) -> Contents:
    """Parameters of a code such as GPUT or BDGP; nothing for systems that are not used."""
    system, other = SYSTEMS.get(code[:2]), code[2:4]
    a0, a1, a2 = polynomial
    if system not in ("G", "C"):
        return Contents()
    if other != "UT":
        name = SYSTEMS.get(other)
        offset = TimeOffset(system, name or "", a0, a1, reference, a2, transmitted)
        return Contents(offsets=(offset,) if name else ())
    if leap is None:
        raise MalformedError(f"{code} needs the leap seconds, which the header does not tell")
    own = leap.of(system)
    utc = UtcParameters(
        system, a0, a1, reference, own.now_s, own.week, own.day, own.future_s, a2, transmitted
    )
    return Contents(utc=(utc,))


def offset_contents(lines: list[str], system: str, leap: Leap | None) -> Contents:
    """Contents of a STO record of RINEX 4."""
    if len(lines) < 2:
        raise MalformedError(f"STO has {len(lines)} lines, must have 2")
    reference = epoch(lines[0][4:23], system)
    code = lines[0][24:28]
    sent, a0, a1, a2 = numbers(lines[1], 4, 4)
    transmitted = nearest(system, sent % WEEK_S, reference)
    return parameters(code, (a0, a1, a2), reference, transmitted, leap)
