"""FFT search of a recording for satellites: what is there, with Doppler, code delay and C/N0.

Each signal is searched over all its PRNs, the whole code period and the whole Doppler range.
Where both signals of a BeiDou satellite are in the recording, B1I (1 ms code, cheap) is searched
blind and B1C only near the Doppler of the satellites found, but over the whole code period: a
spoofed B1C need not line up with B1I.
"""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field

from . import _core
from .errors import RecordingError, SignalError
from .signal_search import Plan, SignalSearch

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .records import Acquisition
    from .sources.source import Source

    Progress = Callable[[float, float], None]

HANDOVER = {"B1CP": "B1I", "B1CD": "B1I"}
"""Signal to the one that is searched in its stead first, where the recording holds both."""

NOT_BY_DEFAULT = ("B1CD",)
"""Searched only on demand: the pilot, on the same carrier, is 4.8 dB stronger."""


class AcquisitionConfig(BaseModel):
    """Settings of the FFT search."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    pfa: float = Field(
        default=1e-5,
        gt=0,
        lt=0.5,
        description="false-alarm probability of the search for one PRN, over its whole grid of "
        "code delay and Doppler; a recording has one such search per signal and PRN",
    )
    doppler_max_hz: float = Field(
        default=5000.0,
        gt=0,
        le=100e3,
        description="largest Doppler searched, receiver offset included",
    )
    blocks_short: int = Field(
        default=20,
        ge=1,
        le=1000,
        description="non-coherent sums of one code period for codes of 1 ms (B1I, L1CA, E5AQ, "
        "E5BQ)",
    )
    blocks_long: int = Field(
        default=5,
        ge=1,
        le=1000,
        description="non-coherent sums of one code period for codes of 10 ms (B1C)",
    )
    handover: bool = Field(
        default=True,
        description="search B1C only near the Doppler of satellites found on B1I, where the "
        "recording holds both; false searches both blind",
    )
    handover_doppler_hz: float = Field(
        default=250.0, gt=0, description="half width of the Doppler range searched after a handover"
    )
    second_peak_every_s: float = Field(
        default=10.0,
        ge=0,
        description="how often a second signal of each tracked satellite is searched for; 0: never",
    )
    second_peak_pfa: float = Field(
        default=1e-7,
        gt=0,
        lt=0.5,
        description="false-alarm probability of one such search",
    )
    second_peak_apart_chips: float = Field(
        default=10.0,
        ge=2.0,
        description="a second peak nearer than this to the tracked one may be a reflection",
    )


def acquire(
    recording: Source,
    config: AcquisitionConfig,
    *,
    signals: Sequence[str] | None = None,
    prns: Sequence[int] | None = None,
    start_sample: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> list[Acquisition]:
    """Search a recording for satellites.

    Args:
        recording: where to read; only the samples searched are read.
        config: settings.
        signals: registry names; default: all that fit and that one of ``prns`` sends, but not
            ``NOT_BY_DEFAULT``.
        prns: satellites; default: all that transmit the signal.
        start_sample: where the search starts.
        threads: default: one per processor. The result does not depend on it.
        progress: called with (done, total).

    Returns:
        One record per search, in the order of signals and PRNs; see ``detected``. PRNs that a
        handover left out are missing. C/N0 is that of the whole component (B1CP: all of QMBOC).

    Raises:
        SignalError: unknown signal, one that the recording cannot hold, or no PRN to search.
        RecordingError: ``start_sample`` negative, too short after it, or silent.
    """
    if start_sample < 0:
        raise RecordingError(f"start_sample is {start_sample}; the first sample of a file is 0")
    plans = [
        _plan(recording, config, signal, prns, start_sample)
        for signal in _ordered(recording, signals, prns)
    ]
    total = float(sum(len(p.prns) for p in plans))
    found: dict[str, list[Acquisition]] = {}
    done = 0.0
    for plan in plans:
        ranges = _doppler_ranges(plan, config, found)
        report = _offset(progress, done, total, len(plan.prns) / max(len(ranges), 1))
        found[plan.signal] = []
        if ranges:
            search = SignalSearch(
                recording, plan, ranges, config.pfa, start_sample, threads or _processors()
            )
            found[plan.signal] = search.run(report)
        done += len(plan.prns)
    if progress is not None:
        progress(total, total)
    return [a for plan in plans for a in found[plan.signal]]


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _ordered(
    recording: Source, signals: Sequence[str] | None, prns: Sequence[int] | None
) -> list[str]:
    """Signals to search, each after the one that hands over to it."""
    if signals is None:
        signals = [s for s in recording.signals() if s not in NOT_BY_DEFAULT]
        # Of several signals, leave out those that none of the satellites asked for transmits.
        sent = [s for s in signals if not prns or {*prns} & {*_core.signal_spec(s)["prns"]}]
        signals = sent or signals
        if not signals:
            raise SignalError(
                "the recording holds no known signal; check its lo_hz and sample_rate_hz"
            )
    known = _core.signal_ids()
    for signal in signals:
        if signal not in known:
            raise SignalError(f"unknown signal '{signal}'; known signals: {', '.join(known)}")
        recording.check_signal(signal)
    return sorted(dict.fromkeys(signals), key=lambda s: s in HANDOVER)


def _plan(
    recording: Source,
    config: AcquisitionConfig,
    signal: str,
    prns: Sequence[int] | None,
    start_sample: int,
) -> Plan:
    spec = _core.signal_spec(signal)
    wanted = None if prns is None else set(prns)
    chosen = tuple(p for p in spec["prns"] if wanted is None or p in wanted)
    if not chosen:
        names = ", ".join(map(str, sorted(wanted or ())))
        raise SignalError(
            f"{signal}: none of the PRNs asked for ({names}) transmits it; it is sent by PRN "
            f"{spec['prns'][0]} to {spec['prns'][-1]}"
        )
    period_s = spec["code_length"] / spec["chip_rate_hz"]
    blocks = config.blocks_short if period_s < 5e-3 else config.blocks_long
    rate = recording.format.sample_rate_hz
    held = math.floor((recording.sample_count - start_sample) / rate / period_s + 1e-6) - 1
    if held < 1:
        raise RecordingError(
            f"too short: {signal} needs {2e3 * period_s:g} ms after sample {start_sample}, the "
            f"recording ends at sample {recording.sample_count} ({rate / 1e6:g} Msps)"
        )
    return Plan(signal, chosen, min(blocks, held), 0.5 / period_s, period_s, spec["carrier_hz"])


def _doppler_ranges(
    plan: Plan, config: AcquisitionConfig, found: dict[str, list[Acquisition]]
) -> dict[int, tuple[int, int]]:
    """Doppler bins of each PRN to search, both ends included."""
    first = HANDOVER.get(plan.signal)
    if not config.handover or first not in found:
        reach = math.ceil(config.doppler_max_hz / plan.bin_hz)
        return dict.fromkeys(plan.prns, (-reach, reach))
    scale = plan.carrier_hz / _core.signal_spec(first)["carrier_hz"]
    reach = math.ceil(config.handover_doppler_hz / plan.bin_hz)
    middle = {a.prn: round(a.doppler_hz * scale / plan.bin_hz) for a in found[first] if a.detected}
    return {p: (middle[p] - reach, middle[p] + reach) for p in plan.prns if p in middle}


def search_plan(
    recording: Source,
    config: AcquisitionConfig,
    signal: str,
    prns: Sequence[int],
    start_sample: int,
) -> tuple[Plan, dict[int, tuple[int, int]]]:
    """Blind search for some satellites: the plan, and the Doppler bins of each PRN.

    Raises RecordingError if the recording ends too soon after ``start_sample``.
    """
    plan = _plan(recording, config, signal, prns, start_sample)
    return plan, _doppler_ranges(plan, config, {})


def _offset(
    progress: Progress | None, done: float, total: float, weight: float
) -> Callable[[int], None]:
    def report(count: int) -> None:
        if progress is not None:
            progress(done + weight * count, total)

    return report
