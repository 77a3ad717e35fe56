"""Random choices of a scenario: a pure function of names, the same on every machine."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

Draw = Callable[..., float]
"""Uniform in [0, 1) for each set of names."""


def uniform(*names: object) -> float:
    """A number in [0, 1)."""
    return integer(*names) / 2**63


def integer(*names: object) -> int:
    """63 bits."""
    digest = hashlib.blake2b(repr(names).encode(), digest_size=8).digest()
    return int.from_bytes(digest, "little") >> 1


def of_attack(seed: int, number: int) -> Draw:
    """The draws of one attack of a scenario, by its place in the file."""
    prefix = ("attack", seed, number) if number else ("attack", seed)
    return lambda *names: uniform(*prefix, *names)
