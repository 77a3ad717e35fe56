"""What can be made of the differences between INS, GNSS and DME: linear statistics.

A statistic is one file and one line in :data:`STATISTICS`: weights by which the differences of an
epoch become channels of unit variance, which are independent from epoch to epoch as the noise is.
"""

from __future__ import annotations

from sdr_spoof.errors import ConfigError

from . import difference, dme_difference, fitted, parity, parity_by_satellite
from .statistic import Statistic

__all__ = ["STATISTICS", "Statistic", "find"]

STATISTICS: dict[str, Statistic] = {
    s.name: s
    for s in (
        fitted.STATISTIC,
        difference.STATISTIC,
        difference.CLOCK_FREE,
        parity.STATISTIC,
        parity_by_satellite.STATISTIC,
        dme_difference.STATISTIC,
    )
}
"""Every statistic, by name."""


def find(name: str) -> Statistic:
    """The statistic of that name; raises ConfigError that lists the known ones."""
    if name not in STATISTICS:
        raise ConfigError(f"unknown statistic '{name}'; known statistics: {', '.join(STATISTICS)}")
    return STATISTICS[name]
