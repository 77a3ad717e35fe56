"""The correlator level against the IF level, against theory, and against itself."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from sdr_spoof import _core, simulate, track
from sdr_spoof.correlator_level import core_simulator
from sdr_spoof.errors import ConfigError
from sdr_spoof.records import State
from sdr_spoof.scenario import Scenario, transmissions
from sdr_spoof.scenario.live import LiveRecording
from sdr_spoof.studies import tracking as study
from sdr_spoof.tracking import TrackingConfig, core_settings

RATE_HZ = 20.03e6
"""No simple ratio to a chip rate: a code's edges fall everywhere between samples."""
SETTLED_S = 2.0
NOISE_POWER = 2 * 16.0**2


def scenario(duration_s, *, prns=(19, 27), cn0_dbhz=45.0, **recording):
    plan = study.scenario(cn0_dbhz, duration_s, prns=prns, sample_rate_hz=RATE_HZ)
    return edited(plan, recording)


def edited(plan, recording, **tables):
    values = plan.model_dump()
    values["recording"] |= recording
    return Scenario.model_validate(values | tables)


def on_if_level(plan, config=None):
    return track(LiveRecording(plan, 1), study.seeds(plan), config, threads=1)


def settled(signal):
    return (signal.state >= State.SYNCED) & (signal.time_s > SETTLED_S)


def normalised(signal, rate_hz):
    """Taps without symbols, in units of the noise of an epoch, shape (epochs, taps)."""
    taps = signal.taps[settled(signal)].astype(complex)
    sign = np.sign(taps[:, signal.prompt_tap].real)
    length = signal.integration_s[settled(signal)] * rate_hz
    return taps * (sign / np.sqrt(NOISE_POWER * length))[:, None]


def pairs(a, b):
    """The tracks of the same signals."""
    for x in a.signals:
        yield x, next(y for y in b.signals if (y.signal, y.prn) == (x.signal, x.prn))


BANDS = {
    "whole QMBOC": {"sample_rate_hz": 30.03e6, "duration_s": 5.5},
    "filter": {"bandwidth_hz": 18e6},
}


@pytest.fixture(scope="module", params=BANDS.values(), ids=BANDS)
def both(request):
    plan = edited(scenario(6.5), request.param)
    config = TrackingConfig(data_component=True)
    return on_if_level(plan, config), simulate(plan, config)


def test_means_of_the_taps(both):
    for x, y in pairs(*both):
        a, b = (normalised(s, both[0].sample_rate_hz) for s in (x, y))
        # Real and imaginary part have half the variance each, which is 1; two means differ.
        error = np.sqrt(0.5 * 1.1 / len(a) + 0.5 * 1.1 / len(b))
        off = a.mean(axis=0) - b.mean(axis=0)
        assert np.abs(off.real).max() < 4 * error, (x.signal, x.prn)
        assert np.abs(off.imag).max() < 4 * error, (x.signal, x.prn)


def test_covariance_of_the_taps(both):
    for x, y in pairs(*both):
        a, b = (normalised(s, both[0].sample_rate_hz) for s in (x, y))
        error = 1.1 * np.sqrt(1 / len(a) + 1 / len(b))
        off = np.cov(a.T) - np.cov(b.T)
        # |off|^2 is that of a complex number of variance error^2: Rayleigh, not normal.
        assert np.abs(off).max() < 4 * error, (x.signal, x.prn)


def test_jitter_and_noise_power(both):
    for x, y in pairs(*both):
        for column in ("phase_error_cycles", "code_error_chips"):
            a, b = (getattr(s, column)[settled(s)] for s in (x, y))
            error = np.sqrt(0.5 / a.size + 0.5 / b.size)
            assert abs(np.log(a.std() / b.std())) < 4 * error, (x.signal, x.prn, column)
        a, b = (s.noise_power[settled(s)] for s in (x, y))
        # A running mean of 1 ms taps over 2 s, over this stretch.
        error = np.sqrt(2 / (1e3 * (a.size * 0.01 + 2.0)))
        assert abs(np.log(a.mean() / b.mean())) < 4 * error
        a, b = (s.cn0_dbhz[settled(s)] for s in (x, y))
        error_db = 4.34 * np.sqrt(2 * (2 / (a.size * 17.0**2) + error**2))
        assert abs(a.mean() - b.mean()) < 4 * error_db


def test_the_data_component(both):
    for x, y in pairs(*both):
        for s in (x, y):
            length = 0.01 * both[0].sample_rate_hz
            data = s.data_prompt[settled(s)] / np.sqrt(NOISE_POWER * length)
            if s.signal == "B1I":
                assert not s.data_prompt.any()
            else:  # none is sent: noise alone
                assert abs(np.var(data) - 1) < 4 * np.sqrt(1 / data.size) + 0.05


def test_jitter_is_thermal():
    for cn0_dbhz in (35.0, 45.0):
        plan = study.scenario(cn0_dbhz, 60.0, prns=(19, 27), sample_rate_hz=40e6)
        for jitter in study.measure(plan, cn0_dbhz, level="correlator"):
            # The formulas are of the first order in B T.
            assert abs(jitter.ratio - 1) < 4 * jitter.standard_error + 0.05, jitter


def same(a, b):
    for field in fields(a):
        x, y = getattr(a, field.name), getattr(b, field.name)
        if isinstance(x, np.ndarray):
            assert x.tobytes() == y.tobytes(), field.name
        else:
            assert x == y, field.name


def test_threads_do_not_matter_and_seeds_do():
    plan = scenario(3.0)
    one, two = simulate(plan, threads=1), simulate(plan, threads=2)
    for a, b in zip((*one.signals, *one.combos), (*two.signals, *two.combos), strict=True):
        same(a, b)
    other = simulate(plan, seed=1234)
    again = simulate(edited(plan, {"seed": 1234}))
    for a, b, c in zip(one.signals, other.signals, again.signals, strict=True):
        same(b, c)
        assert a.taps[0, 0] != b.taps[0, 0]
    # No two signals have the same noise.
    assert np.unique([s.taps[5, s.prompt_tap] for s in one.signals]).size == 4


def test_satellites_do_not_depend_on_each_other_but_for_their_noise():
    """A track's random numbers are its own: only the level of noise knows of the neighbours."""
    alone = simulate(scenario(1.0, prns=(19,), cn0_dbhz=40.0))
    together = simulate(scenario(1.0, prns=(19, 27), cn0_dbhz=40.0))
    for x, y in pairs(alone, together):
        ratio = x.taps[:20, -1] / y.taps[:20, -1]  # the noise tap, before loops differ
        assert np.abs(ratio - 1).max() < 0.2


def test_steps_do_not_matter():
    plan = scenario(2.5)
    count = plan.recording.sample_count

    def rows(ends):
        simulator = core_simulator(plan, TrackingConfig(), 1)
        taken = []
        for end in ends:
            simulator.advance(end)
            taken.append(simulator.take_signals())
        return [
            np.concatenate([piece[k]["carrier_phase_cycles"] for piece in taken]) for k in range(4)
        ]

    whole = rows([count])
    odd = rows([1, 12_345, 12_346, 20_030_001, 33_333_333, count])
    for a, b in zip(whole, odd, strict=True):
        assert a.size > 100
        assert a.tobytes() == b.tobytes()


def attacked(duration_s=9.0):
    """B1C captured with a coherent drag of 0.57 m/s: 3 Hz."""
    values = scenario(duration_s, prns=(19,)).model_dump()
    values["attack"] = [
        {
            "prn": 19,
            "signals": ["B1CP"],
            "start_s": 3.0,
            "power_start_db": -20.0,
            "power_db": 6.0,
            "power_ramp_s": 1.0,
            "drag_start_s": 4.5,
            "drag_rate_m_s": -0.571,
            "drag_ramp_s": 1.0,
            "carrier_phase_cycles": 0.0,
        }
    ]
    return Scenario.model_validate(values)


def test_an_induced_attack_captures_the_loop_as_on_if_level():
    plan = attacked()
    logs = on_if_level(plan), simulate(plan)
    spoofer = next(t.emitter for t in transmissions(plan) if t.role != "authentic")
    for log in logs:
        upper = next(s for s in log.signals if s.signal == "B1CP")
        late = upper.time_s > 8.0
        assert (upper.state[late] >= State.SYNCED).all()
        truth_hz = spoofer.doppler_hz(upper.time_s[late])
        assert abs((upper.doppler_hz[late] - truth_hz).mean()) < 0.2
    seen, made = (beat(log) for log in logs)
    # 3 Hz of drag; the authentic signal, 6 dB weaker, makes it beat.
    assert seen["slope_hz"] == pytest.approx(-3.0, abs=0.1)
    assert made["slope_hz"] == pytest.approx(seen["slope_hz"], abs=0.02)
    for name in ("phase_cycles", "amplitude", "amplitude_beat", "doppler_hz"):
        # Deterministic but for noise of one or two per cent.
        assert made[name] == pytest.approx(seen[name], rel=0.08), name


def beat(log):
    """What two signals 3 Hz apart make of the tracks."""
    combo, upper = log.combos[0], next(s for s in log.signals if s.signal == "B1CP")
    rows, late = combo.time_s > 7.0, upper.time_s > 7.0
    difference = (combo.phase_upper_cycles - 1575.42 / 1561.098 * combo.phase_lower_cycles)[rows]
    line = np.polyfit(combo.time_s[rows], difference, 1)
    amplitude = np.abs(upper.taps[late, upper.prompt_tap])
    return {
        "slope_hz": line[0],
        "phase_cycles": np.std(difference - np.polyval(line, combo.time_s[rows])),
        "amplitude": amplitude.mean(),
        "amplitude_beat": amplitude.std(),
        "doppler_hz": upper.doppler_hz[late].std(),
    }


def emitter_simulator(emitters, duration_s, seed=3, **setting):
    plan = scenario(duration_s)
    signals = dict.fromkeys((e.signal, e.prn) for e in emitters)
    return _core.Simulator(
        RATE_HZ,
        plan.recording.lo_hz,
        core_settings(TrackingConfig(), LiveRecording(plan, 1).format),
        emitters,
        list(signals),
        noise_power=1.0,
        seed=seed,
        **setting,
    )


@pytest.mark.parametrize("reacquire", [True, False])
def test_a_lost_signal_is_found_again(reacquire):
    motion = {"delay_s": 0.07, "doppler_hz": 1000.0, "data_seed": 5}
    first = _core.Emitter("B1I", 19, 45.0, end_s=2.0, **motion)
    second = _core.Emitter("B1I", 19, 45.0, start_s=4.5, **motion)
    simulator = emitter_simulator([first, second], 8.0, reacquire=reacquire)
    simulator.advance(round(8 * RATE_HZ))
    track = simulator.take_signals()[0]
    time_s, state = track["time_s"], track["state"]
    assert (state[(time_s > 1.0) & (time_s < 2.0)] == State.SYNCED).all()
    assert not ((time_s > 3.0) & (time_s < 5.0)).any()  # lost: no rows
    back = time_s > 6.5
    assert back.any() == reacquire
    assert (state[back] == State.SYNCED).all()
    if reacquire:
        assert np.abs(track["doppler_hz"][back] - 1000.0).max() < 5.0


def test_a_strong_spoofer_far_off_in_code_is_noise():
    """Betz 2001: a C/N0 of c adds c times the spectral separation, 2/3 of a chip for BPSK."""
    power_hz = 10**6.0
    quiet = _core.Emitter("B1I", 19, 45.0, delay_s=0.07, data_seed=5)
    loud = _core.Emitter("B1I", 19, 60.0, delay_s=0.0704, data_seed=6)
    elsewhere = _core.Emitter("B1I", 20, 60.0, delay_s=0.0704, data_seed=6)
    for other in (loud, elsewhere):
        both = emitter_simulator([quiet, other], 4.0)
        # Started on the strongest, which is the other one if it is of the same satellite.
        alone = emitter_simulator([quiet], 4.0)
        noise = []
        for simulator in (both, alone):
            simulator.advance(round(4 * RATE_HZ))
            noise.append(simulator.take_signals()[0]["noise_power"][-1])
        expected = 1 + 2 / 3 / 2.046e6 * (power_hz if other is elsewhere else 10**4.5)
        assert noise[0] / noise[1] == pytest.approx(expected, rel=4 * np.sqrt(2 / 2000))


def overpowered(rate_hz, prns):
    """Four satellites, and counterfeit ones of others 10 dB stronger from 1.2 s on."""
    plan = study.scenario(45.0, 3.2, prns=(19, 27, 32, 40), sample_rate_hz=rate_hz)
    attack = {"kind": "asynchronous", "prns": prns, "signals": ["B1I", "B1C"], "start_s": 1.2}
    return edited(plan, {}, attack=[attack])


def changes_db(log):
    """C/N0 and noise power after against before, of each track, in dB."""
    found = {}
    for s in log.signals:
        before, after = (s.time_s > 0.6) & (s.time_s < 1.2), s.time_s > 2.0
        noise_db = 10 * np.log10(s.noise_power)
        rise = [x[after].mean() - x[before].mean() for x in (s.cn0_dbhz, noise_db)]
        found.setdefault(s.signal, []).append(rise)
    return {signal: np.array(rows) for signal, rows in found.items()}


@pytest.mark.parametrize("rate_hz", [RATE_HZ, 30.03e6], ids=["boc11", "qmboc"])
def test_overpowered_signals_raise_the_noise_as_on_if_level(rate_hz):
    plan = overpowered(rate_hz, [21, 22, 23, 24])
    starts = [a for a in study.seeds(plan) if a.prn in (19, 27, 32, 40)]
    seen = changes_db(track(LiveRecording(plan, 1), starts, threads=1))
    made = simulate(plan)
    of_mine = tuple(s for s in made.signals if s.prn in (19, 27, 32, 40))
    made = changes_db(replace(made, signals=of_mine))
    for signal in ("B1I", "B1CP"):
        x, y = seen[signal], made[signal]
        # How codes meet at one Doppler and delay is chance too, in samples.
        error = np.sqrt((x.var(axis=0, ddof=1) + y.var(axis=0, ddof=1)) / len(x))
        assert (np.abs(x.mean(axis=0) - y.mean(axis=0)) < 4 * error).all(), signal
        assert (error < 0.25).all()
        # Four of 55 dB-Hz make 1.4 dB in the end; the noise's memory of 2 s has not forgotten yet.
        assert 0.5 < y[:, 1].mean() < 2.0
        assert -2.0 < y[:, 0].mean() < -0.2


def test_a_counterfeit_satellite_off_the_air_costs_nothing_and_changes_nothing():
    plan = scenario(1.0)
    late = {"kind": "asynchronous", "prns": [21], "signals": ["B1I"], "start_s": 0.99}
    quiet, with_late = simulate(plan), simulate(edited(plan, {}, attack=[late]))
    for x, y in pairs(quiet, with_late):
        rows = x.time_s < 0.95
        assert x.taps[rows].tobytes() == y.taps[: rows.size][rows].tobytes()


def test_settings_out_of_range():
    with pytest.raises(ConfigError, match="integration_ms"):
        simulate(scenario(1.0), TrackingConfig(integration_ms=3))
