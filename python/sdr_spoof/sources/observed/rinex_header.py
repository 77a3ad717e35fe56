"""Header of RINEX observation files.

Source: RINEX 3.05 (IGS/RTCM-SC104, 2020), table A2; RINEX 4.00, the same lines.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import ObservationError
from sdr_spoof.signals import signal_ids, signal_spec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

LABEL = 60
"""Column at which a line's label begins."""
TYPES = "SYS / # / OBS TYPES"
SCALE = "SYS / SCALE FACTOR"
SYSTEM_TIMES = ("GPS", "GAL", "QZS", "BDT", "GLO", "IRN")
CODES_A_LINE = 13
_B1I_UNTIL = 3.025
"""RINEX 3.02 calls the band of B1I 1, later versions 2 (table A15 of 3.05)."""
KINDS = "CLDS"
"""Pseudorange, carrier phase, Doppler, strength."""


def wrong(name: str, number: int, what: str) -> ObservationError:
    """The error of a line, counted from 1."""
    return ObservationError(f"{name}, line {number}: {what}")


def finite(text: str) -> float:
    """Read a number in Fortran's F format.

    Raises:
        ValueError: it is none.
    """
    if "_" in text:
        raise ValueError(text)
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return value


@dataclass
class Header:
    """What the header says; further lines may come in between epochs."""

    version: float
    name: str
    """Of the file, for messages."""
    types: dict[str, list[str]] = field(default_factory=dict)
    """Codes of each system, in the order of the columns."""
    scale: dict[tuple[str, str], float] = field(default_factory=dict)
    """What values of a system's code are to be divided by."""
    time_system: str = "GPS"
    position_m: NDArray[np.float64] | None = None
    decibels: bool = True
    """Whether strengths are in dB-Hz."""
    _open: tuple[str, int] | None = None
    """System whose list of codes goes on, and its length."""
    _columns: dict[str, dict[str, dict[str, int]]] = field(default_factory=dict)
    """Of systems that were asked for."""

    def take(self, line: str, number: int) -> None:
        """Read a line of the header.

        Raises:
            ObservationError: it makes no sense.
        """
        label = line[LABEL:].strip()
        try:
            if label == TYPES:
                self._types(line)
            elif label == SCALE:
                self._scale(line)
            elif label == "TIME OF FIRST OBS":
                self._time_system(line)
            elif label == "APPROX POSITION XYZ":
                place = np.array([finite(line[at : at + 14]) for at in (0, 14, 28)])
                self.position_m = place if place.any() else None
            elif label == "SIGNAL STRENGTH UNIT":
                self.decibels = line[:20].strip().upper() in ("DBHZ", "")
        except (ValueError, KeyError) as error:
            if isinstance(error, ObservationError):
                raise
            raise wrong(self.name, number, f"'{label}' cannot be read: {error}") from error

    def columns(self, system: str) -> dict[str, dict[str, int]]:
        """Of the signals of the registry, the column of each kind of observation."""
        if system not in self._columns:
            self._columns[system] = self._found(system)
        return self._columns[system]

    def _found(self, system: str) -> dict[str, dict[str, int]]:
        codes = self.types.get(system, [])
        found: dict[str, dict[str, int]] = {}
        for signal in signal_ids():
            spec = signal_spec(signal)
            if spec.system != system:
                continue
            names = [spec.rinex]
            if spec.rinex == "2I" and self.version < _B1I_UNTIL:
                names = ["1I"]
            if spec.rinex == "1P":
                names.append("1X")
            used = next((n for n in names if f"C{n}" in codes), None)
            if used:
                found[signal] = {k: codes.index(k + used) for k in KINDS if k + used in codes}
        return found

    def _types(self, line: str) -> None:
        system = line[0].strip()
        self._columns.clear()
        if system:
            count = int(line[3:6])
            if not 0 < count < 1000:
                raise ValueError(f"{count} observation types")
            self.types[system], self._open = [], (system, count)
        if self._open is None:
            raise ValueError("a list of codes goes on that has not begun")
        system, count = self._open
        codes = line[7:LABEL].split()[: count - len(self.types[system])]
        if any(len(code) != 3 for code in codes):
            raise ValueError(f"'{line[7:LABEL].strip()}' are no observation codes")
        self.types[system] += codes
        self._open = (system, count)

    def _scale(self, line: str) -> None:
        factor, count = int(line[2:6]), line[8:10].strip()
        if factor not in (1, 10, 100, 1000):
            raise ValueError(f"factor {factor} is not 1, 10, 100 or 1000")
        codes = line[10:LABEL].split() if count and int(count) else self.types.get(line[0], [])
        self.scale.update({(line[0], code): float(factor) for code in codes})

    def _time_system(self, line: str) -> None:
        name = line[48:51].strip().upper()
        if name and name not in SYSTEM_TIMES:
            raise ValueError(f"time system '{name}' is none of {', '.join(SYSTEM_TIMES)}")
        self.time_system = name or "GPS"

    def check(self, end: int) -> None:
        """Refuse lists of codes that are shorter than they say.

        Raises:
            ObservationError: one is, or there is none.
        """
        if self._open is not None and len(self.types[self._open[0]]) != self._open[1]:
            system, count = self._open
            raise wrong(
                self.name,
                end,
                f"system {system} has {len(self.types[system])} observation types, the header "
                f"says {count}; it is damaged, fetch the file again",
            )
        if not self.types:
            raise wrong(self.name, end, f"the header has no '{TYPES}'; fetch the file again")


def read_header(lines: Sequence[str], name: str) -> tuple[Header, int]:
    """Header and the number of its lines.

    Raises:
        ObservationError: the lines do not begin as an observation file of version 3 or 4.
    """
    header = Header(_version(lines[0] if lines else "", name), name)
    for at, line in enumerate(lines):
        label = line[LABEL:].strip()
        if label == TYPES and line[:1].strip() and header.types:
            header.check(at + 1)
        if label == "END OF HEADER":
            header.check(at + 1)
            return header, at + 1
        header.take(line, at + 1)
    raise wrong(name, len(lines), "the file ends within its header; it is cut off, fetch it again")


def _version(line: str, name: str) -> float:
    label = line[LABEL:].strip()
    if label.startswith("CRINEX VERS"):
        raise wrong(name, 1, "is compressed after Hatanaka; expand it with CRX2RNX first")
    if not label.startswith("RINEX VERSION"):
        raise wrong(
            name, 1, "does not begin with 'RINEX VERSION / TYPE'; give a RINEX observation file"
        )
    try:
        version = finite(line[:9])
    except ValueError:
        version = 0.0
    if line[20:21].upper() != "O" or not 3.0 <= version < 5.0:
        raise wrong(
            name,
            1,
            f"is RINEX {line[:9].strip()} of type '{line[20:21]}'; give an observation file ('O') "
            "of version 3 or 4",
        )
    return version
