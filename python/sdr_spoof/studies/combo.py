"""What tracking two bands as one signal buys where there is no attack.

At correlator level, B1I and the B1C pilot at the same C/N0, each run once with the bands on their
own and once as a combo, on the same signals and the same noise:

- jitter: standard deviation of the oscillators about the truth, as a range;
- ranges: noise of an epoch of the codes and of the subcarrier range, and of the code replicas;
- hold: the share of runs that go on for 20 s after the C/N0 has fallen to a value, without a loss
  and without a slip. The receiver's own limit (``cn0_min_dbhz``) is set low, so that it is the
  loops that end a run.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof import _core
from sdr_spoof.correlator_level import simulate
from sdr_spoof.records import ComboTrack, SignalTrack, State, TrackLog
from sdr_spoof.row_store import RowStore
from sdr_spoof.scenario import transmissions
from sdr_spoof.signals import signal_spec
from sdr_spoof.sources import RecordingFormat
from sdr_spoof.tracking import TrackingConfig, core_settings

from .tracking import PRNS, code_error, emitter_of, kept_rows, phase_error, scenario

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.progress import Progress
    from sdr_spoof.scenario import Scenario

    Floats = NDArray[np.float64]

PAIR = ("B1I", "B1CP")
LIGHT_M_S = 299_792_458.0
CN0_DBHZ = (30.0, 35.0, 40.0, 45.0)
WEAK_DBHZ = tuple(np.arange(18.0, 28.5, 0.5).tolist())
FADE_S = 4.0
"""From here on the C/N0 falls from 45 dB-Hz."""
FALL_S = 4.0
"""Length of the fall."""
HOLD_S = 20.0
HELD = 0.95
"""Share of runs that makes a lock threshold."""
SLIP_CYCLES = 0.25


@dataclass(frozen=True)
class Value:
    """A standard deviation, single and as a combo."""

    quantity: str
    cn0_dbhz: float
    single_mm: float
    combo_mm: float

    @property
    def ratio(self) -> float:
        """Single over combo."""
        return self.single_mm / self.combo_mm


@dataclass(frozen=True)
class Hold:
    """Runs that held at a C/N0."""

    bands: str
    combo: bool
    cn0_dbhz: float
    runs: int
    held: int


def run(
    output: Path, *, seeds: int = 20, threads: int | None = None, progress: Progress | None = None
) -> dict[str, Any]:
    """Measure all three; write combo.{json,png}, combo_noise.csv and combo_hold.csv.

    Args:
        output: folder to write to.
        seeds: scenarios of six satellites for each C/N0, of 30 s for noise, of 25 s for holding.
        threads: worker threads; the numbers do not depend on it.
        progress: called with (done, total).

    Returns:
        What combo.json holds.
    """
    total, noise, hold = len(CN0_DBHZ) + len(WEAK_DBHZ), [], []
    for k, cn0_dbhz in enumerate(CN0_DBHZ):
        noise += measure_noise(cn0_dbhz, seeds=seeds, threads=threads or 1)
        if progress:
            progress(k + 1, total)
    for k, cn0_dbhz in enumerate(WEAK_DBHZ):
        hold += measure_hold(cn0_dbhz, seeds=seeds, threads=threads or 1)
        if progress:
            progress(len(CN0_DBHZ) + k + 1, total)
    tables = {
        "noise": [{**asdict(v), "ratio": v.ratio} for v in noise],
        "threshold": [asdict(t) for t in thresholds(hold)],
        "hold": [asdict(h) for h in hold],
    }
    output.mkdir(parents=True, exist_ok=True)
    for name in ("noise", "hold"):
        _write_csv(output / f"combo_{name}.csv", tables[name])
    from .combo_figure import draw  # noqa: PLC0415 - matplotlib is slow to import

    draw(output / "combo.png", noise, hold)
    result = {"satellites": len(PRNS), "seeds": seeds, **tables}
    (output / "combo.json").write_text(json.dumps(result, indent=1) + "\n")
    return result


def _write_csv(path: Path, table: list[dict[str, Any]]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)


def measure_noise(
    cn0_dbhz: float, *, seeds: int, duration_s: float = 30.0, threads: int = 1
) -> list[Value]:
    """Jitter and range noise at a C/N0, single and as a combo."""
    errors: dict[tuple[str, bool], list[Floats]] = {}
    for seed in range(seeds):
        plan = scenario(cn0_dbhz, duration_s)
        for combo in (False, True):
            config = TrackingConfig(combo=combo, reacquire=False)
            log = simulate(plan, config, seed=1000 + seed, threads=threads)
            for name, values in _errors(plan, log, combo=combo):
                errors.setdefault((name, combo), []).append(values)
    sigma = {
        key: 1e3 * float(np.sqrt(np.mean(np.concatenate(values) ** 2)))
        for key, values in errors.items()
    }
    names = dict.fromkeys(name for name, _ in sigma)
    return [Value(n, cn0_dbhz, sigma[n, False], sigma[n, True]) for n in names]


def _errors(plan: Scenario, log: TrackLog, *, combo: bool) -> Iterator[tuple[str, Floats]]:
    """Errors in metres, each about its mean, of every satellite."""
    state = State.COMBO if combo else State.SYNCED
    for track in log.combos:
        pair = [_track(log, name, track.prn) for name in (track.lower, track.upper)]
        kept = [kept_rows(t, state) for t in pair]
        rows = min(int(k.sum()) for k in kept)
        if not rows:
            continue
        carrier_hz = [signal_spec(t.signal).carrier_hz for t in pair]
        phase = [phase_error(plan, t, k)[-rows:] for t, k in zip(pair, kept, strict=True)]
        for t, f_hz, error in zip(pair, carrier_hz, phase, strict=True):
            yield f"{t.signal} carrier", _centred(error * LIGHT_M_S / f_hz)
        yield "main carrier", _centred((phase[0] + phase[1]) * LIGHT_M_S / sum(carrier_hz))
        for t, k in zip(pair, kept, strict=True):
            chip_m = LIGHT_M_S / signal_spec(t.signal).chip_rate_hz
            replica = code_error(plan, t, k)
            yield f"{t.signal} code loop", _centred(replica * chip_m)
            measured = replica + t.code_error_chips[k]
            yield f"{t.signal} code, 10 ms", _centred(measured * chip_m)
        known = kept_rows(track, state) & np.isfinite(track.subcarrier_range_m)
        delay_s = track.time_s[known] - _truth_s(plan, pair[1], track.time_s[known])
        error = track.subcarrier_range_m[known] - LIGHT_M_S * delay_s
        yield "subcarrier range, 10 ms", _centred(error)


def _track(log: TrackLog, signal: str, prn: int) -> SignalTrack:
    return next(t for t in log.signals if (t.signal, t.prn) == (signal, prn))


def _truth_s(plan: Scenario, track: SignalTrack, time_s: Floats) -> Floats:
    """Time of the received code, in seconds of the satellite."""
    chips = emitter_of(plan, track).code_phase_chips(time_s)
    return np.asarray(chips / signal_spec(track.signal).chip_rate_hz)


def _centred(error: Floats) -> Floats:
    return np.asarray(error - error.mean())


def measure_hold(cn0_dbhz: float, *, seeds: int, threads: int = 1) -> list[Hold]:
    """Share of runs that hold at a C/N0."""
    found = []
    for combo in (False, True):
        held = [h for seed in range(seeds) for h in _held(cn0_dbhz, combo, seed, threads)]
        one_by_one = np.array(held)
        for name, which in ((PAIR[0], [0]), (PAIR[1], [1]), ("both", [0, 1])):
            good = int(one_by_one[:, which].all(axis=1).sum())
            found.append(Hold(name, combo, cn0_dbhz, len(held), good))
    return found


def _held(cn0_dbhz: float, combo: bool, seed: int, threads: int) -> list[tuple[bool, ...]]:
    """Of each satellite, whether each of its bands held."""
    plan = scenario(45.0, FADE_S + FALL_S + HOLD_S)
    emitters = [_fading(t.emitter, cn0_dbhz) for t in transmissions(plan)]
    log = _simulate(plan, emitters, TrackingConfig(combo=combo, cn0_min_dbhz=10.0), seed, threads)
    good = {(t.signal, t.prn): _good(t, emitter_of(plan, t)) for t in log.signals}
    return [tuple(good[signal, prn] for signal in PAIR) for prn in PRNS]


def _good(track: SignalTrack, emitter: _core.Emitter) -> bool:
    """Whether the track was never lost, and ends on the cycle on which it entered the fade."""
    if (track.state == State.LOST).any():
        return False
    oscillator = track.carrier_phase_cycles + track.phase_error_cycles
    error = oscillator + emitter.received_phase_cycles(track.time_s)
    before = error[(track.time_s > FADE_S - 1.0) & (track.time_s < FADE_S)].mean()
    after = error[track.time_s > FADE_S + FALL_S + HOLD_S - 1.0].mean()
    return bool(abs(after - before) < SLIP_CYCLES)


def _fading(emitter: _core.Emitter, cn0_dbhz: float) -> _core.Emitter:
    """The same emitter at 45 dB-Hz, and from the fade on at less."""
    zero = np.zeros(1)
    spec = signal_spec(emitter.signal)
    chips = float(emitter.code_phase_chips(zero)[0])
    doppler_hz = emitter.doppler_hz(np.array([0.0, 1.0]))
    fall_db = 45.0 - cn0_dbhz
    return _core.Emitter(
        emitter.signal,
        emitter.prn,
        45.0,
        delay_s=-chips / spec.chip_rate_hz,
        phase_cycles=float(emitter.received_phase_cycles(zero)[0]),
        doppler_hz=float(doppler_hz[0]),
        doppler_rate_hz_s=float(doppler_hz[1] - doppler_hz[0]),
        data_seed=emitter.prn,
        power_db=[(0.0, 0.0), (FADE_S, 0.0), (FADE_S + FALL_S, -fall_db), (1e3, -fall_db)],
    )


def _simulate(
    plan: Scenario,
    emitters: Sequence[_core.Emitter],
    config: TrackingConfig,
    seed: int,
    threads: int,
) -> TrackLog:
    """Track emitters that no scenario describes."""
    recording = plan.recording
    form = RecordingFormat(
        sample_format=recording.sample_format,
        sample_rate_hz=recording.sample_rate_hz,
        lo_hz=recording.lo_hz,
    )
    simulator = _core.Simulator(
        recording.sample_rate_hz,
        recording.lo_hz,
        core_settings(config, form),
        emitters,
        [(e.signal, e.prn) for e in emitters],
        noise_power=2 * recording.rms_lsb**2,
        seed=seed,
        reacquire=False,
        threads=threads,
    )
    simulator.advance(recording.sample_count)
    rows = RowStore()
    rows.append(SignalTrack, simulator.take_signals())
    rows.append(ComboTrack, simulator.take_combos())
    signals, combos = rows.tracks(SignalTrack), rows.tracks(ComboTrack)
    duration_s = recording.duration_s
    return TrackLog("fade", recording.sample_rate_hz, duration_s, False, signals, combos)


@dataclass(frozen=True)
class Threshold:
    """Lowest C/N0 down to which enough runs hold."""

    bands: str
    single_dbhz: float
    combo_dbhz: float


def thresholds(hold: Sequence[Hold]) -> list[Threshold]:
    """Lock thresholds; NaN where not even the highest C/N0 is enough."""
    names = dict.fromkeys(h.bands for h in hold)
    return [
        Threshold(n, _threshold(hold, n, combo=False), _threshold(hold, n, combo=True))
        for n in names
    ]


def _threshold(hold: Sequence[Hold], bands: str, *, combo: bool) -> float:
    points = [h for h in hold if h.bands == bands and h.combo == combo]
    lowest = float("nan")
    for h in sorted(points, key=lambda h: -h.cn0_dbhz):
        if h.held < HELD * h.runs:
            break
        lowest = h.cn0_dbhz
    return lowest
