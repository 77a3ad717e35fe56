"""From observations and increments to places, alarms and a verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.nav.time import GnssTime

    from .judge import AidedVerdict
    from .records import AidedTrack, Monitor


@dataclass(frozen=True)
class Aided:
    """All that aiding found."""

    verdict: AidedVerdict
    measurements: Measurements
    inertial: InertialStates | None
    """The INS by itself."""
    track: AidedTrack | None
    """The filter; None where it could not run."""
    monitors: tuple[Monitor, ...]
    """Statistics of the filter and of rates, with thresholds and alarms."""
    residuals: tuple[Monitor, ...]
    """Rates left over, east, north, up."""
    risk: float
    """Probability that an error exceeds its protection level."""

    @property
    def reference(self) -> GnssTime:
        """What times count from."""
        assert self.measurements.reference is not None
        return self.measurements.reference

    @property
    def span_s(self) -> tuple[float, float]:
        """First and last epoch."""
        times = self.measurements.time_s
        return float(times[0]), float(times[-1])

    @property
    def satellites(self) -> int:
        """How many were measured."""
        return len(self.measurements.satellites)
