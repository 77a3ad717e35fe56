"""From tracks to positions, hot start, and the formats that positions are written in.

Names are imported from their modules when first used: the configuration needs no messages.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .config import NavigationConfig
    from .located import Located, locate, try_locate

__all__ = ["Located", "NavigationConfig", "locate", "try_locate"]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in __all__:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    home = "config" if name == "NavigationConfig" else "located"
    return getattr(import_module(f".{home}", __name__), name)
