"""The study of the combo in short, and its hand-overs by the hundred."""

import numpy as np
import pytest

from sdr_spoof.correlator_level import simulate
from sdr_spoof.isolation import Isolation
from sdr_spoof.records import State
from sdr_spoof.studies import combo as study
from sdr_spoof.studies.tracking import PRNS, emitter_of, phase_sigma, scenario


@pytest.fixture(scope="module")
def noise():
    return {v.quantity: v for v in study.measure_noise(40.0, seeds=1, duration_s=14.0)}


def test_the_main_carrier_has_the_jitter_of_the_formula(noise):
    main = noise["main carrier"]
    wavelength_mm = 2e3 * study.LIGHT_M_S / (1561.098e6 + 1575.42e6)
    expected = wavelength_mm * phase_sigma(10.0, [40.0, 40.0], 0.01)
    # 6 satellites, 10 s, 2 B independent values a second.
    assert main.combo_mm == pytest.approx(expected, rel=4 / np.sqrt(2 * 6 * 10 * 20) + 0.02)
    assert noise["B1CP carrier"].single_mm / main.combo_mm == pytest.approx(np.sqrt(2), rel=0.1)


def test_the_subcarrier_range_is_several_times_less_noisy_than_any_code(noise):
    subcarrier = noise["subcarrier range, 10 ms"].combo_mm
    assert noise["B1CP code, 10 ms"].combo_mm > 4 * subcarrier
    assert noise["B1I code, 10 ms"].combo_mm > 12 * subcarrier


def test_one_code_loop_steadies_the_noisier_code(noise):
    assert noise["B1I code loop"].ratio > 1.6
    assert noise["B1CP code loop"].ratio > 0.9
    # What is measured is the code, whatever steers the replica.
    for code in ("B1I code, 10 ms", "B1CP code, 10 ms"):
        assert noise[code].ratio == pytest.approx(1.0, abs=0.02)


def test_lock_is_held_at_28_dbhz_and_not_at_15():
    held = study.measure_hold(28.0, seeds=1), study.measure_hold(15.0, seeds=1)
    assert [h.held for h in held[0]] == [6] * 6
    assert [h.held for h in held[1]] == [0] * 6
    (lock, *_) = study.thresholds([*held[0], *held[1]])
    assert (lock.single_dbhz, lock.combo_dbhz) == (28.0, 28.0)


@pytest.mark.parametrize("captured", study.PAIR)
def test_hand_overs_leave_no_more_than_thermal_noise(captured):
    """Means of 0.1 s after and before a hand-over, against those at quiet times."""
    events_s = np.arange(6.0, 30.0, 2.0)
    isolations = [Isolation(captured, prn, t, t + 0.5) for prn in PRNS for t in events_s]
    plan = scenario(38.0, 31.0)
    log = simulate(plan, isolations=isolations, seed=4)
    stays = next(s for s in study.PAIR if s != captured)
    steps: dict[str, list[float]] = {"parted": [], "joined": [], "quiet": []}
    for t in (t for t in log.signals if t.signal == stays):
        oscillator = t.carrier_phase_cycles + t.phase_error_cycles
        error = oscillator + emitter_of(plan, t).received_phase_cycles(t.time_s)
        for at_s in events_s:
            # Joined again half a second after the isolation ends.
            times = {"parted": at_s, "joined": at_s + 1.0, "quiet": at_s + 1.5}
            for kind, time_s in times.items():
                at = int(np.searchsorted(t.time_s, time_s + 0.01))
                steps[kind].append(error[at : at + 10].mean() - error[at - 10 : at].mean())
        changes = np.diff(t.state.astype(int))[t.time_s[1:] > 5.0]
        assert np.count_nonzero(changes) == 2 * events_s.size
        assert set(t.state[t.time_s > 5.0]) == {State.SYNCED, State.COMBO}
    quiet = np.std(steps["quiet"])
    standard_error = np.sqrt(1 / len(steps["quiet"]))  # of a ratio of two
    for kind in ("parted", "joined"):
        assert np.std(steps[kind]) < quiet * (1.25 + 4 * standard_error), kind
        assert abs(np.mean(steps[kind])) < 4 * quiet / np.sqrt(len(steps[kind])), kind
