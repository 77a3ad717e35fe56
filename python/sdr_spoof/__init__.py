"""A software-defined GNSS receiver that can tell when it is being lied to.

The whole way, from a recording to a verdict::

    import sdr_spoof

    recording = sdr_spoof.open_recording("recording.sigmf-meta")
    config = sdr_spoof.load_config()
    found = sdr_spoof.acquire(recording, config.acquisition)
    log = sdr_spoof.track(recording, found, config.tracking)
    verdict = sdr_spoof.detect(log, config.detection)

``process`` does this and writes the result file and the report. Mistakes raise subclasses of
``SdrSpoofError``. Names are imported from their modules when first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .acquisition import AcquisitionConfig, acquire
    from .config import Config, load_config
    from .correlator_level import simulate
    from .detectors import DetectionConfig
    from .errors import ConfigError, OutputError, RecordingError, SdrSpoofError, SignalError
    from .info import inspect
    from .isolation import Isolation
    from .pipeline import process
    from .records import Acquisition, ComboTrack, SignalTrack, State, TrackLog, Verdict
    from .report import write_report
    from .scenario import find_scenario, load_scenario, synthesize
    from .signals import signal_ids, signal_spec
    from .sinks.hdf5 import Result, read_result, write_result
    from .sources import Recording, RecordingFormat, open_recording
    from .tracking import TrackingConfig, track
    from .verdict import detect

__all__ = [
    "Acquisition",
    "AcquisitionConfig",
    "ComboTrack",
    "Config",
    "ConfigError",
    "DetectionConfig",
    "Isolation",
    "OutputError",
    "Recording",
    "RecordingError",
    "RecordingFormat",
    "Result",
    "SdrSpoofError",
    "SignalError",
    "SignalTrack",
    "State",
    "TrackLog",
    "TrackingConfig",
    "Verdict",
    "acquire",
    "detect",
    "find_scenario",
    "inspect",
    "load_config",
    "load_scenario",
    "open_recording",
    "process",
    "read_result",
    "signal_ids",
    "signal_spec",
    "simulate",
    "synthesize",
    "track",
    "write_report",
    "write_result",
]

_HOMES = {
    "acquisition": ("AcquisitionConfig", "acquire"),
    "config": ("Config", "load_config"),
    "correlator_level": ("simulate",),
    "detectors": ("DetectionConfig",),
    "errors": ("ConfigError", "OutputError", "RecordingError", "SdrSpoofError", "SignalError"),
    "info": ("inspect",),
    "isolation": ("Isolation",),
    "pipeline": ("process",),
    "records": ("Acquisition", "ComboTrack", "SignalTrack", "State", "TrackLog", "Verdict"),
    "report": ("write_report",),
    "scenario": ("find_scenario", "load_scenario", "synthesize"),
    "signals": ("signal_ids", "signal_spec"),
    "sinks.hdf5": ("Result", "read_result", "write_result"),
    "sources": ("Recording", "RecordingFormat", "open_recording"),
    "tracking": ("TrackingConfig", "track"),
    "verdict": ("detect",),
}
_MODULE_OF = {name: module for module, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f".{_MODULE_OF[name]}", __name__), name)
