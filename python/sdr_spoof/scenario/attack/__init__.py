"""Kinds of attack, and what nature does that looks like one. One file and one line for each."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Discriminator, Tag

from .asynchronous import Asynchronous
from .base import Attack, Emission, Target, Victims
from .induced import InducedAttack
from .meaconing import Meaconing
from .multipath import Multipath, Ray
from .position import Position


def _kind(value: Any) -> str:
    """Kind of a table, or of an attack; ``induced`` where the file names none."""
    if isinstance(value, dict):
        return str(value.get("kind", "induced"))
    return str(getattr(value, "kind", "induced"))


AnyAttack = Annotated[
    Annotated[InducedAttack, Tag("induced")]
    | Annotated[Meaconing, Tag("meaconing")]
    | Annotated[Asynchronous, Tag("asynchronous")]
    | Annotated[Multipath, Tag("multipath")]
    | Annotated[Position, Tag("position")],
    Discriminator(_kind),
]
"""An element of ``[[attack]]``, told by its ``kind``."""

__all__ = [
    "AnyAttack",
    "Asynchronous",
    "Attack",
    "Emission",
    "InducedAttack",
    "Meaconing",
    "Multipath",
    "Position",
    "Ray",
    "Target",
    "Victims",
]
