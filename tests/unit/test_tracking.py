"""Tracking of synthesised signals: truth, states, and independence of blocks and threads."""

import numpy as np
import pytest
from synthetic import LO_HZ, RATE_HZ, Synthetic, same, seed_of

from sdr_spoof import _core
from sdr_spoof.acquisition import AcquisitionConfig, acquire
from sdr_spoof.errors import ConfigError
from sdr_spoof.records import Acquisition, State
from sdr_spoof.sinks.hdf5 import Result, write_result
from sdr_spoof.sources import open_recording
from sdr_spoof.studies import tracking as study
from sdr_spoof.tracking import TrackingConfig, track


def run_one(signal, prn, *, duration_s=1.5, cn0_dbhz=45.0, config=None, **more):
    """Track one emitter; gives the track and the emitter."""
    spec = _core.signal_spec(signal)
    emitter = _core.Emitter(
        signal, prn, cn0_dbhz, delay_s=0.0712345, doppler_hz=1234.5, data_seed=3, **more
    )
    rate_hz = max(8e6, 1.25 * spec["chip_rate_hz"])
    source = Synthetic([emitter], duration_s, rate_hz=rate_hz, lo_hz=spec["carrier_hz"] - 0.4e6)
    log = track(source, [seed_of(emitter, signal, prn)], config, threads=1)
    return log.signals[0], emitter


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """2.2 s of two satellites in both bands, on disk."""
    plan = study.scenario(45.0, 2.2, prns=(19, 27), sample_rate_hz=RATE_HZ)
    path = tmp_path_factory.mktemp("recording") / "two.bin"
    study.LiveRecording(plan).read_raw(0, plan.recording.sample_count).tofile(path)
    return open_recording(
        path, {"sample_format": "ci8", "sample_rate_hz": RATE_HZ, "lo_hz": LO_HZ}
    ), study.seeds(plan)


@pytest.fixture(scope="module")
def log(recording):
    return track(*recording, threads=1)


@pytest.mark.parametrize(("block_s", "threads"), [(0.001, 1), (0.0073, 2), (1.0, 2)])
def test_blocks_and_threads_do_not_matter(recording, log, block_s, threads):
    other = track(*recording, threads=threads, block_s=block_s)
    assert len(other.signals) == 4
    for a, b in zip((*log.signals, *log.combos), (*other.signals, *other.combos), strict=True):
        same(a, b)


def test_the_result_file_is_the_same_for_rows_in_memory_or_in_a_file(recording, log, tmp_path):
    source, found = recording
    kept = track(source, found, threads=2, block_s=0.0073, rows_in=tmp_path)
    assert list(tmp_path.iterdir()) == []  # the file has no name
    results = []
    for name, case in (("memory", log), ("file", kept)):
        write_result(tmp_path / name, Result("x", source.format, {}, tuple(found), case))
        results.append((tmp_path / name).read_bytes())
    assert results[0] == results[1]


def test_both_sidebands_join_and_agree(log):
    assert [c.prn for c in log.combos] == [19, 27]
    for combo in log.combos:
        joined = combo.state == State.COMBO
        assert joined[-50:].all()
        assert combo.subcarrier_lock[-1] > 0.9
        assert np.diff(combo.time_s) == pytest.approx(0.01, abs=1e-6)
        # Synthesised without delay between the bands; 10 ms code noise is about 10 ns.
        difference_s = combo.code_difference_s[joined]
        assert abs(difference_s.mean()) < 4 * difference_s.std() / np.sqrt(joined.sum() / 10)
        # The scaled difference of the carrier phases stands still (DESIGN trap 1).
        ratio = 1575.42 / 1561.098
        scaled = (combo.phase_upper_cycles - ratio * combo.phase_lower_cycles)[joined]
        rate_hz = np.polyfit(combo.time_s[joined], np.unwrap(scaled, period=0.5), 1)[0]
        assert abs(rate_hz) < 0.05


def test_joining_makes_no_phase_jump(log):
    for t in log.signals:
        first = int(np.flatnonzero(t.state == State.COMBO)[0])
        phase = t.carrier_phase_cycles[first - 10 : first + 10]
        bend = np.diff(phase, 2)
        assert np.abs(bend).max() < 0.1, (t.signal, t.prn)


@pytest.mark.parametrize(
    ("signal", "prn", "integration_s"),
    [
        ("B1I", 30, 0.010),
        ("B1I", 3, 0.002),  # GEO: D2, symbols of 2 ms, no NH code
        ("B1CP", 30, 0.010),
        ("B1CD", 30, 0.010),
        ("L1CA", 7, 0.010),
        ("L1CA", 131, 0.002),  # SBAS
        ("E5AQ", 1, 0.010),
        ("E5BQ", 36, 0.010),
    ],
)
def test_every_signal_synchronises_and_follows_the_truth(signal, prn, integration_s):
    t, emitter = run_one(signal, prn, duration_s=2.5)
    assert t.state[-1] == State.SYNCED
    assert t.integration_s[-1] == pytest.approx(integration_s)
    rows = (t.state == State.SYNCED) & (t.time_s > t.time_s[t.state == State.SYNCED][0] + 0.3)
    time_s = t.time_s[rows]
    # Carrier: grows as range grows, the pilots' sign known, the others' up to half a cycle.
    error = t.carrier_phase_cycles[rows] + emitter.received_phase_cycles(time_s)
    ambiguity = 1.0 if _core.periods_per_symbol(signal, prn) is None else 0.5
    error -= np.round(error.mean() / ambiguity) * ambiguity
    spec = _core.signal_spec(signal)
    cn0 = 10 ** (4.5 + (np.log10(29 / 33) if signal == "B1CP" else 0.0))
    sigma = np.sqrt(1 / (2 * cn0 * integration_s)) / (2 * np.pi)
    assert error.std() == pytest.approx(sigma, rel=0.25)
    assert abs(error.mean()) < 4 * sigma * np.sqrt(2 / rows.sum())
    # Code: mean within 4 sigma of the loop's own noise, and 0.01 chip for the sampled edges.
    chips = t.code_phase_chips[rows] - emitter.code_phase_chips(time_s)
    chips -= np.round(chips.mean() / spec["code_length"]) * spec["code_length"]
    assert abs(chips.mean()) < 0.03
    assert t.doppler_hz[rows].mean() == pytest.approx(emitter.doppler_hz(time_s).mean(), abs=0.5)
    assert t.cn0_dbhz[-1] == pytest.approx(10 * np.log10(cn0), abs=0.6)


def test_secondary_code_is_wiped_in_step():
    t, _ = run_one("B1CP", 41, duration_s=1.5)
    prompt = t.taps[t.state == State.SYNCED, t.prompt_tap]
    assert prompt.size > 50
    assert (prompt.real > 0).all()


def test_b1i_epochs_keep_within_symbols():
    t, _ = run_one("B1I", 30, duration_s=2.0)
    synced = t.state == State.SYNCED
    amplitude = np.abs(t.taps[synced, t.prompt_tap])
    # Were they to straddle symbols or miss the NH code, half of them would nearly vanish.
    assert amplitude.min() > 0.6 * amplitude.mean()


def test_a_third_signal_of_a_satellite_is_tracked_beside_the_combo():
    emitters = {
        signal: _core.Emitter(signal, 30, 45.0, delay_s=0.0712345, doppler_hz=800.0, data_seed=3)
        for signal in ("B1CD", "B1CP", "B1I")
    }
    found = [seed_of(e, signal, 30) for signal, e in emitters.items()]
    log = track(Synthetic(list(emitters.values()), 2.0), found, threads=2)
    (combo,) = log.combos
    assert (combo.lower, combo.upper) == ("B1I", "B1CP")
    assert combo.state[-1] == State.COMBO
    states = {t.signal: t.state[-1] for t in log.signals}
    assert states == {"B1I": State.COMBO, "B1CP": State.COMBO, "B1CD": State.SYNCED}


def test_b1i_joins_the_data_component_where_there_is_no_pilot():
    emitters = {
        signal: _core.Emitter(signal, 30, 48.0, delay_s=0.0712345, doppler_hz=800.0, data_seed=3)
        for signal in ("B1CD", "B1I")
    }
    found = [seed_of(e, signal, 30) for signal, e in emitters.items()]
    config = TrackingConfig(pairs=(("B1I", "B1CD"),))
    log = track(Synthetic(list(emitters.values()), 4.0), found, config, threads=2)
    (combo,) = log.combos
    assert combo.state[-1] == State.COMBO
    assert all((t.state != State.LOST).all() for t in log.signals)


@pytest.mark.parametrize("integration_ms", [1, 2, 4, 5, 20])
def test_the_pilot_synchronises_at_every_integration_time(integration_ms):
    t, _ = run_one("B1CP", 30, config=TrackingConfig(integration_ms=integration_ms))
    assert t.state[-1] == State.SYNCED
    assert t.integration_s[-1] == pytest.approx(integration_ms * 1e-3)


def test_a_loop_half_way_between_two_signals_is_given_up():
    # A spoofer 14 Hz beside a satellite of the same power: a Costas loop settles between them.
    emitters = [
        _core.Emitter("B1CP", 29, 45.0, delay_s=0.0712345, doppler_hz=d) for d in (500.0, 514.0)
    ]
    seed = seed_of(emitters[0], "B1CP", 29, doppler_error_hz=7.0)
    config = TrackingConfig(reacquire=False)
    t = track(Synthetic(emitters, 5.5), [seed], config, threads=2).signals[0]
    assert t.doppler_hz[-1] == pytest.approx(507.0, abs=3.0)
    assert t.state[-1] == State.LOST


def test_silence_is_a_loss():
    emitter = _core.Emitter("B1CP", 29, 45.0, delay_s=0.0712345, doppler_hz=500.0)

    class Silent(Synthetic):
        def read_raw(self, start, count):
            raw = super().read_raw(start, count).copy()
            at = start + np.arange(raw.size // 2)
            raw.reshape(-1, 2)[at > 1.2 * RATE_HZ] = 0
            return raw

    t = track(Silent([emitter], 2.02), [seed_of(emitter, "B1CP", 29)], threads=1).signals[0]
    assert t.state[-1] == State.LOST
    assert 1.2 < t.time_s[-1] < 1.7


def test_silence_from_the_start_is_no_signal():
    class Silent(Synthetic):
        def read_raw(self, start, count):
            return np.zeros_like(super().read_raw(start, count))

    emitter = _core.Emitter("B1CP", 29, 45.0, delay_s=0.0712345, doppler_hz=500.0)
    t = track(Silent([emitter], 2.5), [seed_of(emitter, "B1CP", 29)], threads=1).signals[0]
    assert t.state[-1] == State.LOST
    assert np.isfinite(t.code_phase_chips).all()
    assert (np.diff(t.time_s) > 0).all()


@pytest.mark.parametrize("doppler_hz", [np.nan, 1e12])
def test_seeds_that_cannot_be_are_refused(doppler_hz, recording):
    source, (first, *_) = recording
    wrong = Acquisition(**{**first.__dict__, "doppler_hz": doppler_hz})
    with pytest.raises(ConfigError, match="cannot be"):
        track(source, [wrong])


def test_a_lost_signal_is_found_again():
    silence = [(0.0, 0.0), (1.2, 0.0), (1.2001, -90.0), (1.9, -90.0), (1.9001, 0.0), (9.0, 0.0)]
    t, emitter = run_one("B1CP", 33, duration_s=3.4, power_db=silence)
    assert State.LOST in t.state
    lost_s = float(t.time_s[t.state == State.LOST][0])
    assert 1.2 < lost_s < 1.9
    assert t.state[-1] == State.SYNCED
    late = t.time_s > 3.0
    error = t.carrier_phase_cycles[late] + emitter.received_phase_cycles(t.time_s[late])
    assert np.abs(error - np.round(error.mean())).max() < 0.1


def test_a_search_with_too_little_signal_left_ends_nothing():
    gone = [(0.0, 0.0), (1.2, 0.0), (1.2001, -90.0), (9.0, -90.0)]
    t, _ = run_one("B1CP", 33, duration_s=2.005, power_db=gone)
    assert t.state[-1] == State.LOST


def test_without_reacquisition_a_lost_signal_stays_lost():
    silence = [(0.0, 0.0), (0.8, 0.0), (0.8001, -90.0), (1.1, -90.0), (1.1001, 0.0), (9.0, 0.0)]
    config = TrackingConfig(reacquire=False, cn0_min_dbhz=30.0)
    t, _ = run_one("B1I", 33, duration_s=2.2, power_db=silence, config=config)
    assert t.state[-1] == State.LOST


@pytest.mark.parametrize("side", [-0.5, 0.5])
def test_side_peaks_of_boc_are_left(side):
    emitter = _core.Emitter("B1CP", 29, 45.0, delay_s=0.0712345, doppler_hz=500.0)
    seed = seed_of(emitter, "B1CP", 29)
    wrong = Acquisition(**{**seed.__dict__, "code_delay_s": seed.code_delay_s + side / 1.023e6})
    log = track(Synthetic([emitter], 2.0), [wrong], threads=1)
    t = log.signals[0]
    assert t.state[-1] == State.SYNCED
    chips = t.code_phase_chips[-20:] - emitter.code_phase_chips(t.time_s[-20:])
    chips -= np.round(chips / 10230) * 10230
    # The early-late unit started at the wrong peak, and the whole-chip count is kept.
    assert np.abs(chips - np.round(chips)).max() < 0.2
    early, prompt, late = (np.abs(t.taps[-20:, k]).mean() for k in (0, 2, 4))
    assert prompt > 1.5 * max(early, late)


@pytest.mark.parametrize("cn0_dbhz", [30.0, 45.0])
def test_jitter_follows_the_thermal_noise_formulas(cn0_dbhz):
    """Within 4 standard errors and 8 %; the full study is ``sdr-spoof validate tracking``."""
    plan = study.scenario(cn0_dbhz, 9.0, prns=(19, 27, 36), sample_rate_hz=RATE_HZ)
    for row in study.measure(plan, cn0_dbhz, threads=2):
        assert row.ratio == pytest.approx(1.0, abs=0.08 + 4 * row.standard_error), row


def test_the_correlator_starts_anywhere(recording):
    source, _ = recording
    start = round(0.7 * RATE_HZ) // 8 * 8
    found = acquire(
        source, AcquisitionConfig(), signals=["B1I"], prns=[19], start_sample=start, threads=2
    )
    log = track(source, found, threads=1)
    t = log.signals[0]
    assert 0.7 < t.time_s[0] < 0.71
    assert t.state[-1] == State.SYNCED
    assert log.duration_s == pytest.approx(1.5)


def test_acquisitions_of_different_samples_are_refused(recording):
    source, (first, second, *_) = recording
    moved = Acquisition(**{**second.__dict__, "sample_index": 80})
    with pytest.raises(ConfigError, match="different samples"):
        track(source, [first, moved])


@pytest.mark.parametrize(
    "values",
    [
        {"integration_ms": 3},
        {"integration_ms": 100},
        {"pll_bandwidth_hz": 40.0},
        {"dll_bandwidth_hz": 1e3},
    ],
)
def test_impossible_settings_are_named(recording, values):
    with pytest.raises(ConfigError, match=next(iter(values))):
        track(*recording, TrackingConfig(**values))


def test_nothing_to_track_is_an_empty_log(recording):
    source, _ = recording
    log = track(source, [])
    assert log.signals == ()
    assert log.duration_s == pytest.approx(2.2)
    assert not log.partial
