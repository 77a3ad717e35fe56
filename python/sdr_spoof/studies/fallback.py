"""The sideband that is left after an alarm, against the truth.

One band is captured and dragged; the receiver finds it, isolates it at the alarm, and goes on with
the other sideband alone (:mod:`sdr_spoof.isolation`). Measured from one second after the alarm to
the end: the root mean square of that sideband's carrier and code error *about the truth*, so that a
bias counts, against the thermal noise of its single-sideband loops (:mod:`.tracking`).
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.correlator_level import simulate
from sdr_spoof.errors import SdrSpoofError
from sdr_spoof.fusion import evidence_of
from sdr_spoof.isolation import Isolation
from sdr_spoof.scenario import Scenario
from sdr_spoof.scenario.base import SPEED_OF_LIGHT
from sdr_spoof.signals import signal_spec
from sdr_spoof.tracking import TrackingConfig
from sdr_spoof.verdict import detect

from .tracking import code_error, code_sigma, phase_error, phase_sigma, received_share

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.progress import Progress
    from sdr_spoof.records import SatelliteVerdict, SignalTrack

    Floats = NDArray[np.float64]

CN0_DBHZ = (35.0, 45.0)
CARRIERS = ("coherent", "frequency-locked")
PAIRS = (("B1C", "B1CP", "B1I"), ("B1I", "B1I", "B1CP"))
"""Signal that is captured, its tracked component, and the sideband that is left."""
PRN = 27
DURATION_S = 90.0
DRAG_S = 40.0
SETTLED_S = 1.0
"""After the alarm, while the loops go from joint to single tracking."""


@dataclass(frozen=True)
class Fallback:
    """All runs of one attack."""

    captured: str
    carrier: str
    cn0_dbhz: float
    runs: int
    fell_back: int
    """Runs in which the verdict named the captured band, so that the other was kept."""
    alarm_s: float
    """Median time from the start of the drag to the alarm."""
    phase_cycles: float
    """RMS error of the carrier about the truth, after the alarm."""
    phase_expected_cycles: float
    code_m: float
    code_expected_m: float
    largest_second_cycles: float
    """Largest mean error of the carrier over a second: a slip would show."""


def scenario(captured: str, carrier: str, cn0_dbhz: float) -> Scenario:
    """A capture in phase and a drag of 1.2 m/s of one band; a second satellite is left alone."""
    satellites = [
        {"prn": PRN, "range_rate_m_s": 96.1, "range_acceleration_m_s2": 0.1, "delay_ms": 74.263},
        {"prn": 19, "range_rate_m_s": -412.7, "delay_ms": 77.419},
    ]
    signals = {"signals": ["B1I", "B1CP"], "cn0_dbhz": cn0_dbhz}
    attack = {
        "prn": PRN,
        "signals": ["B1CP" if captured == "B1C" else captured],
        "start_s": DRAG_S - 5.0,
        "eta": 2.0,
        "drag_start_s": DRAG_S,
        "drag_rate_m_s": 1.2,
        "carrier": carrier,
        "carrier_phase_cycles": "aligned",
    }
    recording = {
        "duration_s": DURATION_S,
        "sample_rate_hz": 25e6,
        "lo_hz": 1568.259e6,
        "sample_format": "ci8",
    }
    values = {
        "recording": recording,
        "satellite": [s | signals for s in satellites],
        "attack": [attack],
    }
    return Scenario.model_validate(values)


def measure(captured: tuple[str, str, str], carrier: str, cn0_dbhz: float, runs: int) -> Fallback:
    """Run one attack several times; see :class:`Fallback`.

    Raises:
        SdrSpoofError: no run fell back, so that there is nothing to measure.
    """
    plan = scenario(captured[0], carrier, cn0_dbhz)
    found = [f for seed in range(runs) if (f := _isolated(plan, captured, seed)) is not None]
    if not found:
        raise SdrSpoofError(f"no alarm named {captured[0]} at {cn0_dbhz:g} dB-Hz, {carrier}")
    kept = [(t, t.time_s > at_s + SETTLED_S) for t, at_s in found]
    phase = [phase_error(plan, t, rows) for t, rows in kept]
    code = [code_error(plan, t, rows) for t, rows in kept]
    track, config = found[0][0], TrackingConfig()
    interval_s = config.integration_ms * 1e-3
    received_dbhz = cn0_dbhz + 10.0 * float(np.log10(received_share(track)))
    chip_m = SPEED_OF_LIGHT / signal_spec(track.signal).chip_rate_hz
    code_expected = code_sigma(track, config.dll_bandwidth_hz, received_dbhz, interval_s)
    return Fallback(
        captured=captured[0],
        carrier=carrier,
        cn0_dbhz=cn0_dbhz,
        runs=runs,
        fell_back=len(found),
        alarm_s=float(np.median([at_s for _, at_s in found])) - DRAG_S,
        phase_cycles=_rms(phase),
        phase_expected_cycles=phase_sigma(config.pll_bandwidth_hz, [received_dbhz], interval_s),
        code_m=_rms(code) * chip_m,
        code_expected_m=code_expected * chip_m,
        largest_second_cycles=max(_largest_mean(e, round(1.0 / interval_s)) for e in phase),
    )


def _isolated(
    plan: Scenario, captured: tuple[str, str, str], seed: int
) -> tuple[SignalTrack, float] | None:
    """The sideband that is left, isolated from the alarm on, and the alarm's time."""
    _, component, left = captured
    found = next(s for s in detect(simulate(plan, seed=seed)).satellites if s.prn == PRN)
    if found.fallback != left:
        return None
    at_s = _alarm_s(found)
    log = simulate(plan, isolations=[Isolation(component, PRN, at_s)], seed=seed)
    (track,) = (t for t in log.signals if (t.signal, t.prn) == (left, PRN))
    return track, at_s


def run(output: Path, *, runs: int = 20, progress: Progress | None = None) -> dict[str, Any]:
    """Measure every attack; write fallback.{json,csv}."""
    cases = [(p, carrier, c) for p in PAIRS for carrier in CARRIERS for c in CN0_DBHZ]
    table = []
    for done, case in enumerate(cases):
        table.append(asdict(measure(*case, runs)))
        if progress:
            progress(done + 1, len(cases))
    output.mkdir(parents=True, exist_ok=True)
    with (output / "fallback.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    result = {"fallback": table}
    (output / "fallback.json").write_text(json.dumps(result, indent=1) + "\n")
    return result


def _alarm_s(found: SatelliteVerdict) -> float:
    """The first alarm that decided the verdict."""
    return min(a.alarm_s for a in found.alarms if evidence_of(a.detector) == "consistency")


def _rms(errors: list[Floats]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def _largest_mean(errors: Floats, rows: int) -> float:
    """Largest mean over so many rows."""
    whole = errors[: errors.size // rows * rows].reshape(-1, rows)
    return float(np.abs(whole.mean(axis=1)).max())
