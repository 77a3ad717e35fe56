"""Two sidebands as one signal: observables, hand-over, and pairs of any two signals."""

import numpy as np
import pytest
from synthetic import Synthetic, same, seed_of

from sdr_spoof import _core
from sdr_spoof.correlator_level import simulate
from sdr_spoof.errors import ConfigError
from sdr_spoof.isolation import Isolation
from sdr_spoof.records import State
from sdr_spoof.scenario import Scenario, transmissions
from sdr_spoof.signals import coherent_pairs, signal_spec
from sdr_spoof.tracking import TrackingConfig, track

LIGHT_M_S = 299_792_458.0
DELAY_S = 0.0712345
STEP_M = LIGHT_M_S / 14.322e6 / 2
"""The lower sideband's sign is unknown: half a wavelength of the difference frequency."""


def emitter(signal, *, delay_s=DELAY_S, cn0_dbhz=45.0, **more):
    """Carrier and code of one delay, which falls by half a microsecond a second."""
    carrier_hz = signal_spec(signal).carrier_hz
    return _core.Emitter(
        signal,
        30,
        cn0_dbhz,
        delay_s=delay_s,
        doppler_hz=0.5e-6 * carrier_hz,
        phase_cycles=-carrier_hz * DELAY_S % 1,
        data_seed=3,
        **more,
    )


def tracked(emitters, duration_s, config=None, *, threads=2, block_s=None, isolations=()):
    """Track the emitters of one satellite, by signal; gives the log."""
    found = [seed_of(e, signal, 30) for signal, e in emitters.items()]
    source = Synthetic(list(emitters.values()), duration_s)
    return track(source, found, config, threads=threads, block_s=block_s, isolations=isolations)


@pytest.fixture(scope="module")
def pair():
    return {"B1I": emitter("B1I"), "B1CP": emitter("B1CP")}


@pytest.fixture(scope="module")
def log(pair):
    """Joined at about 1.3 s, B1C marked as captured at 1.8 s, trusted again at 2.3 s."""
    return tracked(pair, 3.2, isolations=[Isolation("B1CP", 30, 1.8, 2.3)])


def test_the_subcarrier_range_is_the_truth_and_several_times_less_noisy_than_the_code(pair, log):
    (combo,) = log.combos
    rows = np.isfinite(combo.subcarrier_range_m)
    assert rows[-1]
    time_s = combo.time_s[rows]
    chips = pair["B1CP"].code_phase_chips(time_s)
    truth_m = LIGHT_M_S * (time_s - chips / 1.023e6)
    error_m = combo.subcarrier_range_m[rows] - truth_m
    period_m = LIGHT_M_S * 0.01
    error_m -= np.round(error_m.mean() / period_m) * period_m
    # Thermal: two phases of an epoch each.
    cn0 = 10**4.5 * np.array([1.0, 29 / 33])
    sigma_m = 2 * STEP_M * np.sqrt(np.sum(1 / (2 * cn0 * 0.01))) / (2 * np.pi)
    assert error_m.std() == pytest.approx(sigma_m, rel=4 / np.sqrt(2 * rows.sum()) + 0.02)
    assert abs(error_m.mean()) < 4 * sigma_m / np.sqrt(rows.sum()) + 0.01
    code_m = LIGHT_M_S * (combo.code_delay_upper_s[rows] - (time_s - chips / 1.023e6))
    assert code_m.std() > 4 * error_m.std()


def test_it_is_given_only_once_the_code_is_good_enough(log):
    (combo,) = log.combos
    known = np.isfinite(combo.subcarrier_range_m)
    first = int(np.argmax(known))
    assert 0 < first < 30
    assert known[first:].all()


def test_main_and_subcarrier_phase_are_half_the_sum_and_the_difference(log):
    (combo,) = log.combos
    upper = combo.main_phase_cycles + combo.subcarrier_phase_cycles
    lower = combo.main_phase_cycles - combo.subcarrier_phase_cycles
    assert upper == pytest.approx(combo.phase_upper_cycles, abs=1e-9)
    assert lower == pytest.approx(combo.phase_lower_cycles, abs=1e-9)
    difference_s = combo.code_delay_upper_s - combo.code_delay_lower_s
    whole = np.round((difference_s - combo.code_difference_s) / 1e-3)
    assert difference_s - 1e-3 * whole == pytest.approx(combo.code_difference_s, abs=1e-12)


def test_a_captured_sideband_parts_the_pair_until_it_is_trusted_again(log):
    (combo,) = log.combos
    marked = (combo.time_s > 1.82) & (combo.time_s < 2.28)
    joined = (combo.time_s > 1.6) & (combo.time_s < 1.79)
    assert (combo.state[joined] == State.COMBO).all()
    assert (combo.state[marked] == State.CAPTURED).all()
    assert combo.state[-1] == State.COMBO
    for t, state in zip(log.signals, (State.SYNCED, State.CAPTURED), strict=True):
        assert t.state[np.searchsorted(t.time_s, 2.0)] == state, t.signal
        assert t.state[-1] == State.COMBO
        # Not an epoch is lost on the way.
        late = t.time_s[t.time_s > 1.3]
        assert np.diff(late) == pytest.approx(0.01, abs=1e-6)


@pytest.mark.parametrize("signal", ["B1I", "B1CP"])
def test_no_hand_over_makes_the_phase_jump(pair, log, signal):
    """Joined, parted and joined again: the loop's phase goes on within its thermal noise."""
    t = next(t for t in log.signals if t.signal == signal)
    replica = t.carrier_phase_cycles + t.phase_error_cycles
    error = replica + pair[signal].received_phase_cycles(t.time_s)
    settled = (t.state == State.COMBO) & (t.time_s > t.time_s[t.state == State.COMBO][0] + 0.2)
    sigma = error[settled].std()
    assert sigma < 0.006  # 10 Hz at 45 dB-Hz: 0.003 cycle
    changes = np.flatnonzero(np.diff(t.state.astype(int)))
    changes = changes[np.argmax(t.state[changes + 1] == State.COMBO) :]
    assert len(changes) == (3 if signal == "B1I" else 4)
    for at in changes:
        before, after = error[at - 14 : at + 1], error[at + 1 : at + 16]
        # Means of 0.15 s, which a loop of 10 Hz makes of about 3 independent values.
        assert abs(after.mean() - before.mean()) < 4 * 0.003 * np.sqrt(2 / 3)
        assert np.abs(error[at - 14 : at + 16] - before.mean()).max() < 5 * 0.003


def test_isolation_does_not_depend_on_blocks_and_threads(pair, log):
    other = tracked(
        pair,
        3.2,
        threads=1,
        block_s=0.0073,
        isolations=[Isolation("B1CP", 30, 1.8, 2.3)],
    )
    for a, b in zip((*log.signals, *log.combos), (*other.signals, *other.combos), strict=True):
        same(a, b)


def test_what_is_not_tracked_cannot_be_isolated(pair):
    for isolation in (Isolation("B1CP", 31, 0.0), Isolation("L1CA", 30, 0.0)):
        with pytest.raises(ConfigError, match="not tracked"):
            tracked(pair, 0.01, isolations=[isolation])


def test_one_sideband_goes_on_alone_and_the_other_comes_back():
    silence = [(0.0, 0.0), (1.6, 0.0), (1.6001, -90.0), (2.2, -90.0), (2.2001, 0.0), (9.0, 0.0)]
    pair = {"B1I": emitter("B1I"), "B1CP": emitter("B1CP", power_db=silence)}
    log = tracked(pair, 4.3)
    lower, upper = log.signals
    assert State.LOST in upper.state
    assert (lower.state[lower.time_s > 0.6] >= State.SYNCED).all()
    (combo,) = log.combos
    assert State.COMBO in combo.state[combo.time_s < 1.6]
    assert combo.state[-1] == State.COMBO
    # The sideband that stays: no jump while it is left alone, and none when it is joined again.
    time_s = lower.time_s[lower.time_s > 1.3]
    error = lower.carrier_phase_cycles[-time_s.size :] + pair["B1I"].received_phase_cycles(time_s)
    error -= np.round(2 * error.mean()) / 2
    assert np.abs(error).max() < 5 * 0.0064  # an epoch's noise at 45 dB-Hz
    # A new phase of the upper one: the ambiguity is resolved anew, to the same range.
    range_m = combo.subcarrier_range_m
    chips = pair["B1I"].code_phase_chips(combo.time_s)
    error_m = range_m - LIGHT_M_S * (combo.time_s - chips / 2.046e6)
    error_m = (error_m + 0.5e-3 * LIGHT_M_S) % (1e-3 * LIGHT_M_S) - 0.5e-3 * LIGHT_M_S
    ends = error_m[(combo.time_s < 1.6) & np.isfinite(range_m)], error_m[-20:]
    assert ends[0].mean() == pytest.approx(ends[1].mean(), abs=0.2)


def test_the_code_difference_of_a_pair_is_measured_without_bias():
    """30 ns between the codes, as of 40 TECU beyond what the carriers tell."""
    pair = {"B1I": emitter("B1I", delay_s=DELAY_S + 30e-9), "B1CP": emitter("B1CP")}
    config = TrackingConfig(code_bias_bandwidth_hz=0.5)
    (combo,) = tracked(pair, 4.0, config).combos
    rows = combo.state == State.COMBO
    difference_s = combo.code_difference_s[rows]
    # B1I: 0.0211 chip of 489 ns an epoch; edges of 50 ns samples cost up to 2 ns.
    sigma_s = 10.5e-9 / np.sqrt(rows.sum())
    assert difference_s.mean() == pytest.approx(-30e-9, abs=4 * sigma_s + 2e-9)


def test_two_signals_on_one_carrier_have_no_subcarrier():
    pair = {s: emitter(s, cn0_dbhz=48.0) for s in ("B1CD", "B1CP")}
    config = TrackingConfig(pairs=(("B1CD", "B1CP"),), subcarrier_bandwidth_hz=1.0)
    log = tracked(pair, 3.0, config)
    (combo,) = log.combos
    assert (combo.lower, combo.upper) == ("B1CD", "B1CP")
    joined = combo.state == State.COMBO
    assert joined[-50:].all()
    assert np.isnan(combo.subcarrier_range_m).all()
    assert combo.subcarrier_lock[-1] > 0.8
    for name in ("main_phase_cycles", "subcarrier_phase_cycles", "code_difference_s"):
        assert np.isfinite(getattr(combo, name)).all(), name
    # One oscillator for both.
    lower, upper = (t.doppler_hz[t.state == State.COMBO][5:] for t in log.signals)
    rows = min(lower.size, upper.size)
    assert np.array_equal(lower[:rows], upper[:rows])
    for t in log.signals:
        truth = pair[t.signal].received_phase_cycles(t.time_s[-50:])
        error = t.carrier_phase_cycles[-50:] + truth
        error -= np.round(2 * error.mean()) / 2
        assert abs(error.mean()) < 4 * 0.006 / np.sqrt(50) + 0.003


def test_pairs_are_a_matter_of_configuration(pair):
    assert ("B1I", "B1CP") in coherent_pairs()
    assert TrackingConfig(pairs=["B1I+B1CD"]).pairs == (("B1I", "B1CD"),)
    assert tracked(pair, 0.1, TrackingConfig(pairs=())).combos == ()
    # The order in which a pair is named does not matter.
    (combo,) = tracked(pair, 0.1, TrackingConfig(pairs=(("B1CP", "B1I"),))).combos
    assert (combo.lower, combo.upper) == ("B1I", "B1CP")


@pytest.mark.parametrize(
    ("names", "message"),
    [(("B1I", "B1I"), "no pair"), (("B1I", "L1CA"), "no pair"), (("B1I", "X9"), "X9")],
)
def test_what_is_no_pair_is_refused(pair, names, message):
    with pytest.raises(ConfigError, match=message):
        tracked(pair, 0.1, TrackingConfig(pairs=(names,)))


def test_two_pilots_of_another_system_are_a_pair_like_any_other():
    """Galileo E5a-Q and E5b-Q, both signs known: the ambiguity is a whole 9.77 m."""
    plan = Scenario.model_validate(
        {
            "recording": {
                "duration_s": 6.0,
                "sample_rate_hz": 60e6,
                "lo_hz": 1191.795e6,
                "sample_format": "ci8",
            },
            "satellite": [
                {"prn": 11, "system": "E", "signals": ["E5AQ", "E5BQ"], "range_rate_m_s": -433.0}
            ],
        }
    )
    (combo,) = simulate(plan).combos
    assert (combo.lower, combo.upper) == ("E5AQ", "E5BQ")
    assert (combo.state[-300:] == State.COMBO).all()
    emitter = next(t.emitter for t in transmissions(plan) if t.signal == "E5BQ")
    rows = np.isfinite(combo.subcarrier_range_m)
    assert rows[-300:].all()
    time_s = combo.time_s[rows]
    period_m = 1e-3 * LIGHT_M_S
    truth_m = LIGHT_M_S * (time_s - emitter.code_phase_chips(time_s) / 10.23e6)
    error_m = (combo.subcarrier_range_m[rows] - truth_m + period_m / 2) % period_m - period_m / 2
    sigma_m = LIGHT_M_S / 30.69e6 * np.sqrt(2 / (2 * 10**4.5 * 0.01)) / (2 * np.pi)
    assert error_m.std() == pytest.approx(sigma_m, rel=4 / np.sqrt(2 * rows.sum()) + 0.02)
    assert abs(error_m.mean()) < 4 * sigma_m / np.sqrt(rows.sum()) + 0.01
