"""What a receiver makes of the attacks, at the level of its correlators."""

from typing import Any

import numpy as np
import pytest
from attacks import authentic, scenario

from sdr_spoof.correlator_level import simulate
from sdr_spoof.records import SignalTrack, State, TrackLog
from sdr_spoof.scenario import Scenario, builtin_scenario, scenario_names


def track(log: TrackLog, prn: int, signal: str) -> SignalTrack:
    (found,) = [t for t in log.signals if (t.prn, t.signal) == (prn, signal)]
    return found


def phase_cycles(made: Scenario, prn: int, t: SignalTrack) -> np.ndarray:
    """Measured less authentic received phase."""
    true = authentic(made, prn, t.signal).emitter.received_phase_cycles(np.asarray(t.time_s))
    return np.asarray(-t.carrier_phase_cycles - true)


def during(t: SignalTrack, start_s: float, end_s: float) -> np.ndarray:
    return (np.asarray(t.time_s) >= start_s) & (np.asarray(t.time_s) < end_s)


def cn0_dbhz(t: SignalTrack, start_s: float, end_s: float) -> float:
    return float(np.mean(np.asarray(t.cn0_dbhz)[during(t, start_s, end_s)]))


@pytest.mark.parametrize("name", [n for n in scenario_names() if n != "ds7"])
def test_every_shipped_scenario_is_received(name: str) -> None:
    made = builtin_scenario(name)
    if made.sky is not None:
        made = made.sped_up(15)
    log = simulate(made)
    assert {t.prn for t in log.signals} >= {s.prn for s in made.satellites}


def test_a_seamless_takeover_turns_the_phase_by_half_a_cycle_and_keeps_the_power() -> None:
    """TEXBAT ds7, 40 times faster: clean to 2.75 s, held from 3.25 to 3.75 s."""
    made = builtin_scenario("ds7").sped_up(40)
    log = simulate(made)
    for prn, turn in ((19, 0.5), (40, 0.5)):
        for signal, expected in (("B1I", 0.0), ("B1CP", turn)):
            t = track(log, prn, signal)
            phase = phase_cycles(made, prn, t)
            before, held = (float(np.mean(phase[during(t, *s)])) for s in ((2.2, 2.7), (3.3, 3.7)))
            # 50 and 40 epochs of 0.02 cycles each; 0.03 also covers what the loop has left to turn.
            assert held - before == pytest.approx(expected, abs=0.03)
            assert cn0_dbhz(t, 3.3, 3.7) == pytest.approx(cn0_dbhz(t, 2.2, 2.7), abs=1.0)
            assert (np.asarray(t.state)[during(t, 2.2, 3.7)] >= State.SYNCED).all()


INDUCED: dict[str, Any] = {
    "prn": 27,
    "signals": ["B1C"],
    "start_s": 3.0,
    "power_ramp_s": 0.5,
    "eta": 0.5,
}


@pytest.mark.parametrize(
    ("phase", "change_db"), [("aligned", 20 * np.log10(1.5)), ("antipodal", 20 * np.log10(0.5))]
)
def test_a_weak_spoofer_adds_to_the_power_or_takes_from_it(phase: str, change_db: float) -> None:
    made = scenario(INDUCED | {"carrier_phase_cycles": phase}, duration_s=6.0)
    log = simulate(made)
    t = track(log, 27, "B1CP")
    assert cn0_dbhz(t, 4.5, 6) - cn0_dbhz(t, 1.5, 3) == pytest.approx(change_db, abs=0.7)
    other = track(log, 27, "B1I")
    assert cn0_dbhz(other, 4.5, 6) - cn0_dbhz(other, 1.5, 3) == pytest.approx(0.0, abs=0.7)


@pytest.mark.parametrize(("delay_ms", "worst"), [(0.0, 1.9), (5.0, 1.0), (10.0, 0.1)])
def test_late_data_cost_the_sum_where_they_disagree(delay_ms: float, worst: float) -> None:
    """B1I symbols last two epochs of 10 ms; at half of their starts the late one differs.

    So in a quarter of the epochs the spoofer, 0.9 strong and in phase, takes away for
    ``delay_ms`` and adds for the rest.
    """
    data = {"data": "delayed", "data_delay_ms": delay_ms} if delay_ms else {}
    attack = INDUCED | {"signals": ["B1I"], "carrier_phase_cycles": "aligned", "eta": 0.9}
    t = track(simulate(scenario(attack | data, duration_s=8.0)), 27, "B1I")
    expected = 10 * np.log10(0.75 * 1.9**2 + 0.25 * worst**2)
    # 350 epochs, of which 4 standard errors of a binomial are 0.3 dB; 0.1 dB of thermal noise
    assert cn0_dbhz(t, 4.5, 8) - cn0_dbhz(t, 1.5, 3) == pytest.approx(expected, abs=0.4)
