"""Position, velocity and time from observations and navigation data; the arithmetic is in the core.

:func:`solve` takes whole recordings, :func:`snapshot` a single instant whose time and place are
known coarsely.
"""

from .config import PvtConfig
from .snapshot import CodePhase, code_phases, snapshot, timed_snapshot
from .solution import solve

__all__ = ["CodePhase", "PvtConfig", "code_phases", "snapshot", "solve", "timed_snapshot"]
