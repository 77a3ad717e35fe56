"""What a file of observations holds, and what a format must provide."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.nav.broadcast import Contents
    from sdr_spoof.observations import Observations
    from sdr_spoof.records import Verdict


@dataclass(frozen=True)
class Observed:
    """Observations, and what else the file knows."""

    observations: Observations
    navigation: Contents | None = None
    """Orbits that were received with them."""
    verdict: Verdict | None = None
    """What the detectors said."""
    position_m: NDArray[np.float64] | None = None
    """Approximate position (3,), ECEF."""
    notes: tuple[str, ...] = ()
    """What was left out, a sentence each."""


@dataclass(frozen=True)
class ObservedReader:
    """One format: a line in the registry of ``sources/observed/__init__.py``."""

    name: str
    matches: Callable[[Path], bool]
    read: Callable[[Path], Observed]
