"""What is measured: satellites, sample rates, recordings and the engine's channels.

W1 is 12 satellites with B1I and the B1C pilot received as BOC(1,1). W2 is the same with the whole
QMBOC pilot and the prompt of the data component, which only fast recordings hold.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof.scenario import Scenario, synthesize
from sdr_spoof.signals import components, signal_spec
from sdr_spoof.sources import open_recording

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from sdr_spoof.progress import Progress
    from sdr_spoof.sources import Recording

Channel = tuple[str, int, str, bool, float, float]
"""Of the engine: signal, PRN, modulation, data component too, Doppler in Hz, first sample."""
PRNS = (19, 21, 23, 25, 27, 29, 32, 34, 36, 38, 40, 42)
DOPPLER_HZ = 4000.0
"""Of the fastest satellites, either way, at 1575.42 MHz, and of the engine's channels."""
_CN0_DBHZ = 45.0
_TAPS_AT_HZ = 120e6
"""At this rate taps are 8 samples apart, elsewhere as far apart in time."""
_RELATIVE_COST = {"Bpsk": 1.0, "Boc11": 1.0, "Qmboc": 4.0}
_FRONT_END_COST = 12.0
"""Of a band at 120 Msps, in channels of B1I."""


@dataclass(frozen=True)
class Rate:
    """Samples that a recording may have."""

    sample_rate_hz: float
    sample_format: str
    lo_hz: float
    signals: tuple[str, ...]
    """That it holds, as scenarios name them."""
    workloads: tuple[str, ...]


RATES = {
    5: Rate(5e6, "ci8", 1561.098e6, ("B1I",), ("W1",)),
    25: Rate(25e6, "ci8", 1568.259e6, ("B1I", "B1C"), ("W1",)),
    60: Rate(60e6, "ri8", 1553.259e6, ("B1I", "B1C"), ("W1", "W2")),
    120: Rate(120e6, "ri8", 1538.259e6, ("B1I", "B1C"), ("W1", "W2")),
}
"""By Msps: the rates that can be measured."""


def scenario(rate: Rate, duration_s: float, signals: Sequence[str] | None = None) -> Scenario:
    """The satellites, at a sample rate."""
    return Scenario.model_validate(
        {
            "title": f"{len(PRNS)} satellites",
            "recording": {
                "duration_s": duration_s,
                "sample_rate_hz": rate.sample_rate_hz,
                "lo_hz": rate.lo_hz,
                "sample_format": rate.sample_format,
            },
            "satellite": [
                {
                    "prn": prn,
                    "signals": list(signals or rate.signals),
                    "cn0_dbhz": _CN0_DBHZ,
                    "doppler_hz": _doppler_hz(k, len(PRNS)),
                    "delay_ms": 70.0 + 3.217 * k,
                }
                for k, prn in enumerate(PRNS)
            ],
        }
    )


def recording(
    rate: Rate, duration_s: float, folder: Path, progress: Progress | None = None
) -> Recording:
    """The recording of a scenario, made anew where the folder does not hold it.

    Raises:
        OutputError: no room for it.
    """
    plan = scenario(rate, duration_s)
    path = folder / f"bench_{rate.sample_rate_hz / 1e6:g}Msps_{duration_s:g}s.sigmf-meta"
    if path.exists():
        kept = open_recording(path)
        if kept.sample_count == plan.recording.sample_count:
            return kept
    return open_recording(synthesize(plan, path, force=True, progress=progress))


def tracked(rate: Rate) -> list[str]:
    """Signals that are tracked, of those that a recording holds: data components are not."""
    sent = [c for name in rate.signals for c in components(name)]
    return [s for s in sent if s != "B1CD"]


def channels(workload: str, rate: Rate) -> list[Channel]:
    """Channels of the engine, ordered by band."""
    made: list[Channel] = []
    for signal in tracked(rate):
        whole = workload == "W2" and signal == "B1CP"
        modulation = "Qmboc" if whole else "Bpsk" if signal == "B1I" else "Boc11"
        made += alike(rate, signal, modulation, PRNS, data=whole)
    return made


def b1i(rate: Rate, count: int) -> list[Channel]:
    """B1I channels of the first satellites."""
    return alike(rate, "B1I", "Bpsk", signal_spec("B1I").prns[:count])


def alike(
    rate: Rate, signal: str, modulation: str, prns: Sequence[int], *, data: bool = False
) -> list[Channel]:
    """A channel of one kind for each PRN, with other Doppler and delay."""
    first = [5e-3 * k / len(prns) * rate.sample_rate_hz for k in range(len(prns))]
    return [
        (signal, prn, modulation, data, _doppler_hz(k, len(prns)), first[k])
        for k, prn in enumerate(prns)
    ]


def taps(rate: Rate) -> list[int]:
    """Offsets of five taps about the prompt, in samples."""
    step = max(1, round(8 * rate.sample_rate_hz / _TAPS_AT_HZ))
    return [k * step for k in (-2, -1, 0, 1, 2)]


def shared_out(channels: Sequence[Channel], threads: int, rate: Rate) -> list[list[Channel]]:
    """Channels of each thread: neighbours stay together, so that few threads mix both bands."""
    front_end = _FRONT_END_COST * rate.sample_rate_hz / _TAPS_AT_HZ
    limit = front_end
    while len(groups := _filled(channels, limit, front_end)) > threads:
        limit += 0.5
    return groups


def _filled(channels: Sequence[Channel], limit: float, front_end: float) -> list[list[Channel]]:
    """Groups that cost no more than a limit, or are a single channel."""
    groups: list[list[Channel]] = []
    for channel in channels:
        if not groups or _cost([*groups[-1], channel], front_end) > limit:
            groups.append([])
        groups[-1].append(channel)
    return groups


def _cost(channels: Sequence[Channel], front_end: float) -> float:
    bands = {signal_spec(c[0]).carrier_hz for c in channels}
    return front_end * len(bands) + sum(_RELATIVE_COST[c[2]] for c in channels)


def _doppler_hz(k: int, count: int) -> float:
    return DOPPLER_HZ * (2 * k / max(1, count - 1) - 1)
