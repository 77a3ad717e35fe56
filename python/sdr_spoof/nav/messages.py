"""The navigation messages, by their names in RINEX 4."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .bcnav1 import BCnav1Message
from .d1 import D1Message
from .d2 import D2Message
from .lnav import LnavMessage

if TYPE_CHECKING:
    from .records import Message

MESSAGES: dict[str, Message] = {
    m.name: m for m in (LnavMessage(), D1Message(), D2Message(), BCnav1Message())
}
"""One entry each. A message is a class with the functions of :class:`records.Message`."""


def message_on(signal: str, prn: int) -> Message | None:
    """Message that a satellite sends on a registry signal; None where it sends none we know."""
    return next((m for m in MESSAGES.values() if m.sent_on(signal, prn)), None)
