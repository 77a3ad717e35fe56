"""Fields of navigation messages, declared once and used to write and to read.

Bits are numbered from 1, as the ICDs do. A value may be split over several places, its most
significant bits first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import NavigationError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

SEMICIRCLE = 3.1415926535898
"""Radians in a semicircle as the ICDs have it (IS-GPS-200, table 20-IV)."""

PAGE_BITS = 300
"""Bits of a subframe of LNAV, D1, D2."""


@dataclass(frozen=True)
class Field:
    """A number in a message."""

    name: str
    at: tuple[tuple[int, int], ...]
    """(first bit, number of bits) of each part."""
    scale: float = 1.0
    """Value of the least significant bit."""
    signed: bool = False
    """Two's complement."""

    @property
    def width(self) -> int:
        """Bits in all."""
        return sum(count for _, count in self.at)

    def integer(self, value: float) -> int:
        """What is sent for a value.

        Raises:
            NavigationError: if it does not fit.
        """
        number = round(value / self.scale) if math.isfinite(value) else None
        low = -(1 << (self.width - 1)) if self.signed else 0
        if number is None or not low <= number < low + (1 << self.width):
            raise NavigationError(
                f"{self.name} is {value:g}, which does not fit its {self.width} bits of "
                f"{self.scale:g} each; check the ephemeris it comes from"
            )
        return number

    def write(self, bits: NDArray[np.uint8], value: float) -> None:
        """Put a value into the bits of a message."""
        number, shift = self.integer(value), self.width
        for first, count in self.at:
            shift -= count
            part = (number >> shift) & ((1 << count) - 1)
            bits[first - 1 : first - 1 + count] = bits_of(part, count)

    def raw(self, bits: NDArray[np.uint8]) -> int:
        """Integer in the bits of a message."""
        number = 0
        for first, count in self.at:
            number = number << count | number_of(bits[first - 1 : first - 1 + count])
        if self.signed and number >> (self.width - 1):
            number -= 1 << self.width
        return number

    def read(self, bits: NDArray[np.uint8]) -> float:
        """Value in the bits of a message."""
        return self.raw(bits) * self.scale


@dataclass(frozen=True)
class Layout:
    """The fields of one kind of page."""

    fields: tuple[Field, ...]

    def write(self, bits: NDArray[np.uint8], values: Mapping[str, float]) -> None:
        """Put values into the bits of a message; there must be one for each field."""
        for field in self.fields:
            field.write(bits, values[field.name])

    def places(self, length: int) -> NDArray[np.bool_]:
        """Which of so many bits are those of a field."""
        found = np.zeros(length, dtype=np.bool_)
        for first, count in (at for field in self.fields for at in field.at):
            found[first - 1 : first - 1 + count] = True
        return found

    def read(self, bits: NDArray[np.uint8]) -> dict[str, float]:
        """Values of all fields."""
        return {field.name: field.read(bits) for field in self.fields}


def layout(*fields: tuple[str, str] | tuple[str, str, float], signed: str = "") -> Layout:
    """Build a layout from (name, places, scale): ``("toc", "74-82 91-98", 8)``.

    A place may begin with a page, ``3:101-112``, where a value goes over several pages; these are
    then read and written as one piece. ``signed`` names those in two's complement, separated by
    blanks.
    """
    names = signed.split()
    built = []
    for name, places, *scale in fields:
        at = tuple(_place(p) for p in places.split())
        built.append(Field(name, at, scale[0] if scale else 1.0, name in names))
    return Layout(tuple(built))


def _place(text: str) -> tuple[int, int]:
    page, _, place = text.rpartition(":")
    first, _, last = place.partition("-")
    before = (int(page or 1) - 1) * PAGE_BITS
    return before + int(first), int(last or first) - int(first) + 1


def wrapped(angle: float, quantum: float) -> float:
    """Angle in [-pi, pi) as ICDs have pi, after rounding to a quantum."""
    turn = 2 * SEMICIRCLE
    inside = (angle + SEMICIRCLE) % turn - SEMICIRCLE
    return inside if inside < SEMICIRCLE - 0.5 * quantum else -SEMICIRCLE


def bits_of(number: int, count: int) -> NDArray[np.uint8]:
    """Bits of a number that is not negative, most significant first."""
    return np.array([number >> k & 1 for k in range(count - 1, -1, -1)], dtype=np.uint8)


def number_of(bits: NDArray[np.uint8]) -> int:
    """Number that bits are, most significant first."""
    number = 0
    for bit in bits.tolist():
        number = number << 1 | bit
    return number
