"""What the benchmark is asked for, and the jobs that follow."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.errors import ConfigError
from sdr_spoof.signals import signal_spec

from .jobs import SEARCHES, STAGES, Job
from .machine import thread_counts
from .workloads import RATES, channels, tracked

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_SEARCHED_S = 0.3
"""Recording for acquisition where there is no longer one."""
_SYNTHESISED_S = 0.2
_SLOPE_AT = 24
"""Channels about which the cost of one more is measured."""


@dataclass(frozen=True)
class Settings:
    """What to measure."""

    msps: tuple[int, ...] = tuple(RATES)
    """Sample rates."""
    stages: tuple[str, ...] = tuple(STAGES)
    threads: tuple[int, ...] = ()
    """None: 1, 2, 4 ... and one per core."""
    level: str | None = None
    """Vector instructions; None: the best, and W1 with the portable ones too."""
    repeats: int = 5
    """Timed runs of each job; one more, not timed, goes before them."""
    recording_s: float = 4.0
    """Length of the receiver's recordings."""
    engine_s: float = 0.5
    """Signal in one run of the engine."""
    folder: Path | None = None
    """Where to keep recordings for the next time; None: a temporary folder."""

    def __post_init__(self) -> None:
        """Check the choices.

        Raises:
            ConfigError: an unknown rate, stage or level.
        """
        known: dict[str, list[object]] = {
            "rate": [*RATES],
            "stage": [*STAGES],
            "level": [*_core.simd_levels()],
        }
        chosen = {"rate": self.msps, "stage": self.stages, "level": (self.level,)}
        for name, values in chosen.items():
            for value in values:
                if value is not None and value not in known[name]:
                    choices = ", ".join(map(str, known[name]))
                    raise ConfigError(f"{name} {value} cannot be measured here; choose {choices}")


def jobs(settings: Settings) -> Iterator[Job]:
    """Everything to time, stage by stage."""
    for stage in settings.stages:
        for job in _PLANS[stage](settings):
            for threads in settings.threads or thread_counts():
                if stage != "channel" or threads == 1:
                    yield replace(job, threads=threads)


def _loaded(stage: str, settings: Settings, signal_s: float) -> Iterator[Job]:
    """Each workload at each rate; the fastest also with portable instructions."""
    level = _level(settings)
    for msps in settings.msps:
        rate = RATES[msps]
        for workload in rate.workloads:
            count = len(channels(workload, rate))
            job = Job(stage, workload, msps, level, 1, count, signal_s)
            yield job
            slow = settings.level is None and level != "portable"
            if slow and workload == "W1" and msps == max(settings.msps):
                yield replace(job, level="portable")


def _receiver(settings: Settings) -> Iterator[Job]:
    return _loaded("receiver", settings, settings.recording_s)


def _engine(settings: Settings) -> Iterator[Job]:
    return _loaded("engine", settings, settings.engine_s)


def _channel(settings: Settings) -> Iterator[Job]:
    msps = max(settings.msps)
    yield Job("channel", "B1I", msps, _level(settings), 1, _SLOPE_AT, settings.engine_s)


def _acquisition(settings: Settings) -> Iterator[Job]:
    msps = max(settings.msps)
    length_s = settings.recording_s if "receiver" in settings.stages else _SEARCHED_S
    for workload, signals in SEARCHES.items():
        if set(signals) <= set(tracked(RATES[msps])):
            count = len(signal_spec(signals[0]).prns)
            yield Job("acquisition", workload, msps, _level(settings), 1, count, length_s)


def _synthesis(settings: Settings) -> Iterator[Job]:
    msps = max(settings.msps)
    emitters = len(channels("W1", RATES[msps]))
    workload = f"{emitters} emitters"
    yield Job("synthesis", workload, msps, _level(settings), 1, emitters, _SYNTHESISED_S)


_PLANS = {
    "receiver": _receiver,
    "engine": _engine,
    "channel": _channel,
    "acquisition": _acquisition,
    "synthesis": _synthesis,
}


def _level(settings: Settings) -> str:
    return settings.level or _core.simd_level()
