"""Loop jitter against the thermal-noise formulas.

With B the noise bandwidth, T the coherent time, c the C/N0 as a ratio and gamma = c T:

- phase (atan discriminator): sigma^2 = B / c (1 + 1 / (2 gamma)) rad^2 (Kaplan and Hegarty,
  Understanding GPS, equation 5.5);
- code (early-minus-late dot prompt, taps at +-d/2): sigma^2 = 2 B (1 - R(d)) / (c K^2)
  (1 + 1 / gamma) chip^2, where R is the code's autocorrelation and K the slope of early minus
  late per chip (for BPSK, R(d) = 1 - d and K = 2: the usual B d / (2 c) (1 + 1 / gamma));
- combo: main carrier and subcarrier are half the sum and half the difference of the sidebands'
  phases, so sigma^2 = B / 4 (1 / c_u + 1 / c_l) with the same correction.

The jitter is that of the oscillators, discriminator removed, about the synthesised truth.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from sdr_spoof import _core
from sdr_spoof.correlator_level import simulate
from sdr_spoof.records import Acquisition, State
from sdr_spoof.scenario import Scenario, transmissions
from sdr_spoof.scenario.live import LiveRecording
from sdr_spoof.signals import signal_spec
from sdr_spoof.tracking import TrackingConfig, track

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.progress import Progress
    from sdr_spoof.records import ComboTrack, SignalTrack, TrackLog

    Floats = NDArray[np.float64]

CN0_DBHZ = (30.0, 35.0, 40.0, 45.0)
PRNS = (19, 22, 27, 36, 40, 45)
SETTLED_S = 3.0
"""Rows before this, or before the state is reached, do not count."""


@dataclass(frozen=True)
class Jitter:
    """Measured and expected jitter of one loop."""

    loop: str
    """For example ``B1I phase`` or ``combo main``."""
    unit: str
    cn0_dbhz: float
    bandwidth_hz: float
    measured: float
    expected: float
    standard_error: float
    """Relative, of the measured value, from 2 B t independent samples."""

    @property
    def ratio(self) -> float:
        """Measured over expected."""
        return self.measured / self.expected


def scenario(
    cn0_dbhz: float,
    duration_s: float,
    *,
    prns: Sequence[int] = PRNS,
    sample_rate_hz: float = 40e6,
) -> Scenario:
    """B1I and the B1C pilot of several satellites, each component at the given C/N0.

    At 40 Msps the whole QMBOC pilot is in the band, at 20 Msps its BOC(1,1) part.
    """
    return Scenario.model_validate(
        {
            "title": f"{cn0_dbhz} dB-Hz",
            "recording": {
                "duration_s": duration_s,
                "sample_rate_hz": sample_rate_hz,
                "lo_hz": 1568.259e6,
                "sample_format": "ci8",
                "seed": 77 + round(10 * cn0_dbhz),
            },
            "satellite": [
                {
                    "prn": prn,
                    "signals": ["B1I", "B1CP"],
                    "cn0_dbhz": cn0_dbhz,
                    "range_rate_m_s": 617.0 - 217.3 * k,
                    "range_acceleration_m_s2": 0.03 * k,
                    "delay_ms": 71.3 + 3.217 * k,
                }
                for k, prn in enumerate(prns)
            ],
        }
    )


def seeds(plan: Scenario) -> list[Acquisition]:
    """What a good acquisition of the scenario's first sample would be, errors included."""
    found = []
    for t in transmissions(plan):
        spec = signal_spec(t.signal)
        phase = float(t.emitter.code_phase_chips(np.zeros(1))[0])
        doppler = float(t.emitter.doppler_hz(np.zeros(1))[0]) + 4.0
        delay = (-phase % spec.code_length + 0.02) / spec.chip_rate_hz
        found.append(Acquisition(t.signal, t.prn, True, 0, doppler, delay, 0.0, 0.0, 0.0, 0.0))
    return found


def run(
    output: Path,
    *,
    duration_s: float = 30.0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Measure every loop at every C/N0; write tracking_jitter.{json,csv,png}.

    Args:
        output: folder to write to.
        duration_s: signal tracked at each C/N0, by six satellites.
        threads: worker threads; the numbers do not depend on it.
        progress: called with (done, total).

    Returns:
        What tracking_jitter.json holds.
    """
    rows: list[Jitter] = []
    for k, cn0_dbhz in enumerate(CN0_DBHZ):
        rows += measure(scenario(cn0_dbhz, duration_s), cn0_dbhz, threads=threads)
        if progress:
            progress(k + 1, len(CN0_DBHZ))
    table = [{**asdict(r), "ratio": r.ratio} for r in rows]
    result = {"duration_s": duration_s, "satellites": len(PRNS), "jitter": table}
    output.mkdir(parents=True, exist_ok=True)
    (output / "tracking_jitter.json").write_text(json.dumps(result, indent=1) + "\n")
    with (output / "tracking_jitter.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    from .tracking_figure import draw  # noqa: PLC0415 - matplotlib is slow to import

    draw(output / "tracking_jitter.png", rows)
    return result


def measure(
    plan: Scenario,
    cn0_dbhz: float,
    *,
    config: TrackingConfig | None = None,
    threads: int | None = None,
    level: Literal["if", "correlator"] = "if",
) -> list[Jitter]:
    """Jitter of the single-sideband loops and of the combo loops in a :func:`scenario`."""
    config = config or TrackingConfig()
    logs = []
    for combo in (False, True):
        settings = config.model_copy(update={"combo": combo, "reacquire": False})
        if level == "correlator":
            logs.append(simulate(plan, settings, threads=threads or 1))
        else:
            recording = LiveRecording(plan, threads)
            logs.append(track(recording, seeds(plan), settings, threads=threads))
    return [*_single(plan, logs[0], config, cn0_dbhz), *_combo(plan, logs[1], config, cn0_dbhz)]


def _single(
    plan: Scenario, log: TrackLog, config: TrackingConfig, cn0_dbhz: float
) -> Iterator[Jitter]:
    for signal in ("B1I", "B1CP"):
        tracks = [t for t in log.signals if t.signal == signal]
        kept = [kept_rows(t, State.SYNCED) for t in tracks]
        interval = config.integration_ms * 1e-3
        phase = [phase_error(plan, t, k) for t, k in zip(tracks, kept, strict=True)]
        code = [code_error(plan, t, k) for t, k in zip(tracks, kept, strict=True)]
        received_dbhz = cn0_dbhz + 10 * np.log10(received_share(tracks[0]))
        expected = phase_sigma(config.pll_bandwidth_hz, [received_dbhz], interval)
        pll, dll = config.pll_bandwidth_hz, config.dll_bandwidth_hz
        yield _jitter(f"{signal} phase", "cycle", cn0_dbhz, pll, phase, expected, interval)
        expected = code_sigma(tracks[0], dll, received_dbhz, interval)
        yield _jitter(f"{signal} code", "chip", cn0_dbhz, dll, code, expected, interval)


def _combo(
    plan: Scenario, log: TrackLog, config: TrackingConfig, cn0_dbhz: float
) -> Iterator[Jitter]:
    main, sub = [], []
    pair = [next(t for t in log.signals if t.signal == s) for s in ("B1I", "B1CP")]
    received_dbhz = [cn0_dbhz + 10 * float(np.log10(received_share(t))) for t in pair]
    interval = config.integration_ms * 1e-3
    for combo in log.combos:
        lower, upper = (
            next(t for t in log.signals if (t.signal, t.prn) == (name, combo.prn))
            for name in (combo.lower, combo.upper)
        )
        keep_lower, keep_upper = kept_rows(lower, State.COMBO), kept_rows(upper, State.COMBO)
        rows = min(keep_lower.sum(), keep_upper.sum())
        low = phase_error(plan, lower, keep_lower)[-rows:]
        up = phase_error(plan, upper, keep_upper)[-rows:]
        main.append((up + low) / 2)
        sub.append((up - low) / 2)
    for name, errors, bandwidth in (
        ("combo main", main, config.main_bandwidth_hz),
        ("combo subcarrier", sub, config.subcarrier_bandwidth_hz),
    ):
        expected = phase_sigma(bandwidth, received_dbhz, interval)
        yield _jitter(name, "cycle", cn0_dbhz, bandwidth, errors, expected, interval)


def received_share(track: SignalTrack) -> float:
    """Share of the signal's power that the replica takes: BOC(1,1) has 29/33 of QMBOC's."""
    sent = signal_spec(track.signal).modulation
    return 29 / 33 if (sent, track.modulation) == ("Qmboc", "Boc11") else 1.0


def phase_sigma(bandwidth_hz: float, cn0_dbhz: Sequence[float], interval_s: float) -> float:
    """Thermal phase jitter in cycles of the mean phase of one or more signals."""
    cn0 = 10 ** (np.asarray(cn0_dbhz) / 10)
    variance = bandwidth_hz / cn0 * (1 + 1 / (2 * cn0 * interval_s))
    return float(np.sqrt(variance.sum()) / cn0.size / (2 * np.pi))


def code_sigma(
    track: SignalTrack, bandwidth_hz: float, cn0_dbhz: float, interval_s: float
) -> float:
    """Thermal code jitter in chips, for the taps and modulation that the track used."""
    spec = signal_spec(track.signal)
    half = float(track.tap_offsets_s[track.prompt_tap + 1]) * spec.chip_rate_hz
    correlation, slope = _core.early_late(track.modulation, half)
    cn0 = 10 ** (cn0_dbhz / 10)
    squaring = 1 + 1 / (cn0 * interval_s)
    return float(np.sqrt(2 * bandwidth_hz * (1 - correlation) / (cn0 * slope**2) * squaring))


def kept_rows(track: SignalTrack | ComboTrack, state: State) -> NDArray[np.bool_]:
    """Rows of the state's last unbroken stretch, settled."""
    wrong = np.flatnonzero(track.state != state)
    start = track.time_s[wrong[-1]] if wrong.size else 0.0
    return np.asarray(track.time_s > max(SETTLED_S, start + 1.0))


def emitter_of(plan: Scenario, track: SignalTrack) -> _core.Emitter:
    """What a scenario sends on a track's signal."""
    return next(
        t.emitter for t in transmissions(plan) if (t.signal, t.prn) == (track.signal, track.prn)
    )


def phase_error(plan: Scenario, track: SignalTrack, keep: NDArray[np.bool_]) -> Floats:
    """Oscillator minus true phase in cycles, half cycles removed."""
    truth = -emitter_of(plan, track).received_phase_cycles(track.time_s[keep])
    error = track.carrier_phase_cycles[keep] + track.phase_error_cycles[keep] - truth
    return np.asarray(error - np.round(2 * np.mean(error)) / 2)


def code_error(plan: Scenario, track: SignalTrack, keep: NDArray[np.bool_]) -> Floats:
    """Replica minus true code phase in chips, whole code periods removed."""
    truth = emitter_of(plan, track).code_phase_chips(track.time_s[keep])
    error = track.code_phase_chips[keep] - track.code_error_chips[keep] - truth
    length = signal_spec(track.signal).code_length
    return np.asarray(error - np.round(np.mean(error) / length) * length)


def _jitter(
    loop: str,
    unit: str,
    cn0_dbhz: float,
    bandwidth_hz: float,
    errors: Sequence[Floats],
    expected: float,
    interval_s: float,
) -> Jitter:
    """Pools the satellites' errors, each about its own mean."""
    errors = [e for e in errors if e.size]
    rows = sum(e.size for e in errors)
    measured = float(np.sqrt(sum(np.sum((e - e.mean()) ** 2) for e in errors) / rows))
    independent = max(1.0, 2 * bandwidth_hz * rows * interval_s)
    return Jitter(
        loop, unit, cn0_dbhz, bandwidth_hz, measured, expected, float(1 / np.sqrt(2 * independent))
    )
