"""From tracks to positions, hot start, and the formats that positions are written in."""

from .config import NavigationConfig
from .locate import Located, locate, try_locate

__all__ = ["Located", "NavigationConfig", "locate", "try_locate"]
