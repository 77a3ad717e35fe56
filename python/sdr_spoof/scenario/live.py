"""A scenario as a recording that is never written: samples are made as they are read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof.errors import SignalError
from sdr_spoof.signals import signal_spec
from sdr_spoof.sources import RecordingFormat

from .front_end import gain_log
from .synthesis import open_synthesizer

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .model import Scenario


class LiveRecording:
    """Stands in for a :class:`~sdr_spoof.sources.Recording` where a file would be in the way."""

    def __init__(self, scenario: Scenario, threads: int | None = None) -> None:
        """Plan the synthesis of a scenario with the given number of threads."""
        plan = scenario.recording
        self.path = Path(scenario.title or "live")
        self.format = RecordingFormat(
            sample_format=plan.sample_format,
            sample_rate_hz=plan.sample_rate_hz,
            lo_hz=plan.lo_hz,
            bandwidth_hz=plan.bandwidth_hz,
        )
        self.sample_count = plan.sample_count
        self.duration_s = plan.duration_s
        self._signals = {s for satellite in scenario.satellites for s in satellite.signals}
        self.gain = gain_log(scenario)
        self._synthesizer = open_synthesizer(scenario, threads)

    def read_raw(self, start: int, count: int) -> NDArray[np.uint8]:
        """Bytes of whole samples, clipped at the end."""
        return self._synthesizer.generate(start, max(0, min(count, self.sample_count - start)))

    def check_signal(self, signal: str) -> None:
        """Raise SignalError if no satellite of the scenario sends the signal."""
        spec = signal_spec(signal)
        if not self._signals & {spec.id, spec.composite}:
            raise SignalError(f"the scenario has no {signal}")

    def signals(self) -> list[str]:
        """Composite and component names that the scenario sends."""
        return sorted(self._signals)
