"""Which band was captured: right on attacks in either band, silent on what the receiver does."""

import dataclasses

import numpy as np
import pytest
from simulated_tracks import F_LOWER_HZ, F_UPPER_HZ, Attack, Satellite, simulate_log
from test_fusion import alarm

from sdr_spoof.attribution import BOTH, MISSED, WRONG, attribute
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.detectors.band_attribution import common_clock, disturbed_band
from sdr_spoof.verdict import detect

CONFIG = DetectionConfig()
BOTH_BANDS = ("B1CP", "B1I")
OTHERS = [Satellite(prn, doppler_hz=d) for prn, d in ((24, -900.0), (25, 1700.0), (26, 300.0))]


def attributed(*alarms):
    return attribute(BOTH_BANDS, alarms, 10.0, CONFIG)


def moved(log, seconds):
    """The log with every carrier moved by the same change of range, in s at each time."""

    def signal(track):
        carrier = F_LOWER_HZ if track.signal == "B1I" else F_UPPER_HZ
        phase = track.carrier_phase_cycles + carrier * seconds(track.time_s)
        chip_rate = 2.046e6 if track.signal == "B1I" else 1.023e6
        code = track.code_phase_chips - chip_rate * seconds(track.time_s)
        return dataclasses.replace(track, carrier_phase_cycles=phase, code_phase_chips=code)

    def combo(track):
        change = seconds(track.time_s)
        return dataclasses.replace(
            track,
            phase_lower_cycles=track.phase_lower_cycles + F_LOWER_HZ * change,
            phase_upper_cycles=track.phase_upper_cycles + F_UPPER_HZ * change,
        )

    return dataclasses.replace(
        log,
        signals=tuple(signal(t) for t in log.signals),
        combos=tuple(combo(t) for t in log.combos),
    )


@pytest.mark.parametrize("band", BOTH_BANDS)
def test_carriers_alone_name_a_band(band):
    found = attributed(alarm(band=band))
    assert found.signal == band
    several = BOTH * MISSED["carriers"]
    assert found.confidence == pytest.approx((1 - WRONG["carriers"]) / (1 + several))


def test_one_weak_hint_is_not_enough_but_two_are():
    shape, power = alarm("ratio_metric", "B1I"), alarm("power", "B1I")
    assert attributed(shape).signal is None
    assert attributed(shape).confidence == pytest.approx(0.9 / (1 + BOTH * MISSED["shape"]))
    assert attributed(power).signal is None
    both = attributed(shape, power)
    assert both.signal == "B1I"
    several = BOTH * MISSED["shape"] * MISSED["power"]
    assert both.confidence == pytest.approx(0.72 / (0.72 + 0.02 + several))


def test_several_tests_of_the_same_taps_count_once():
    one = attributed(alarm("ratio_metric", "B1I"))
    two = attributed(alarm("ratio_metric", "B1I"), alarm("delta_metric", "B1I"))
    assert one == two


def both_bands(detector):
    return [alarm(detector, band) for band in BOTH_BANDS]


def test_one_kind_of_evidence_in_both_bands_does_not_refute_a_carrier():
    power = both_bands("power")
    assert attributed(*power).signal is None
    assert attributed(alarm(band="B1CP"), *power).signal == "B1CP"


def test_several_kinds_in_both_bands_say_that_both_were_captured():
    several = [*both_bands("power"), *both_bands("ratio_metric")]
    found = attributed(*several)
    assert (found.signal, found.both) == (None, True)
    assert "power: B1C and B1I" in found.evidence
    # One code that has left its carrier, or one carrier its course, names none against that.
    assert attributed(alarm("code_minus_carrier", "B1CP"), *several).both
    carrier = attributed(alarm(band="B1I"), *both_bands("code_minus_carrier"), *several)
    assert (carrier.signal, carrier.both) == (None, True)


def test_symmetry_that_is_lost_in_both_bands_says_nothing():
    # One code loop steers both.
    alone = attributed(alarm(band="B1CP"))
    assert attributed(alarm(band="B1CP"), *both_bands("delta_metric")) == alone


def test_contradictions_lower_the_confidence():
    found = attributed(alarm(band="B1CP"), alarm("ratio_metric", "B1I"), alarm("power", "B1I"))
    assert found.signal == "B1CP"
    assert 0.95 < found.confidence < 1 - WRONG["carriers"]


def test_what_happened_long_before_is_another_event():
    assert attributed(alarm("power", "B1I", onset_s=-5.0)).confidence is None


@pytest.mark.parametrize("band", BOTH_BANDS)
@pytest.mark.parametrize("drag_hz", [0.5, -3.0])
@pytest.mark.parametrize("phase_cycles", [0.0, 0.3])
def test_the_captured_band_is_named(band, drag_hz, phase_cycles):
    attack = Attack(band=band, start_s=8.0, drag_hz=drag_hz, phase_cycles=phase_cycles)
    for seed in range(5):
        log = simulate_log(Satellite(23, attack=attack), duration_s=12.0, seed=seed)
        (satellite,) = detect(log, CONFIG).satellites
        assert satellite.band == band
        assert satellite.fallback == BOTH_BANDS[1 - BOTH_BANDS.index(band)]


RECEIVER = {
    "clock jump": lambda t: 3e-9 * (t > 8.0),
    "frequency step": lambda t: 2e-9 * np.maximum(t - 8.0, 0.0),
    "jerk": lambda t: 4e-8 * np.maximum(t - 8.0, 0.0) ** 3,
    "wander": lambda t: 2e-10 * np.sin(2 * np.pi * 1.3 * t),
}


@pytest.mark.parametrize("what", RECEIVER)
@pytest.mark.parametrize("alone", [True, False])
def test_the_receiver_never_names_a_band(what, alone):
    for seed in range(10):
        satellites = [Satellite(23)] if alone else [Satellite(23), *OTHERS]
        log = moved(simulate_log(*satellites, duration_s=10.0, seed=seed), RECEIVER[what])
        clock = common_clock(log, ("C", 23), 8.0, 9.0, CONFIG)
        assert (clock is None) == alone
        combo = log.combos[0].between(6.0, 9.0)
        # Asked outright, as if something had alarmed there.
        assert disturbed_band(combo, 8.0, 9.0, CONFIG, clock) is None


@pytest.mark.parametrize("what", RECEIVER)
def test_the_receiver_alone_raises_no_alarm(what):
    satellites = [Satellite(23), *OTHERS]
    verdict = detect(moved(simulate_log(*satellites), RECEIVER[what]), CONFIG)
    assert {s.verdict for s in verdict.satellites} == {"clean"}


@pytest.mark.parametrize("band", BOTH_BANDS)
def test_the_other_satellites_explain_the_clock(band):
    # A poor oscillator moves both bands further than the attack moves one.
    attack = Attack(band=band, start_s=8.0, drag_hz=0.5)
    log = simulate_log(Satellite(23, attack=attack), *OTHERS, duration_s=12.0)
    log = moved(log, lambda t: 2e-8 * np.maximum(t - 8.0, 0.0) ** 3)
    alone = dataclasses.replace(log, signals=log.signals[:2], combos=log.combos[:1])
    assert detect(alone, CONFIG).satellites[0].band is None
    by_prn = {s.prn: s for s in detect(log, CONFIG).satellites}
    assert (by_prn[23].verdict, by_prn[23].band) == ("spoofed", band)
    assert all(by_prn[s.prn].verdict == "clean" for s in OTHERS)


def test_one_attacked_neighbour_does_not_spoil_the_clock():
    attack = Attack(start_s=8.0, drag_hz=5.0)
    log = simulate_log(Satellite(23), Satellite(27, attack=attack), *OTHERS, duration_s=10.0)
    clock = common_clock(log, ("C", 23), 8.0, 9.0, CONFIG)
    assert np.max(np.abs(clock(np.linspace(8.0, 9.0, 50)))) * F_UPPER_HZ < 0.1
