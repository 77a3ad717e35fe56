"""The combo study: acceptance numbers, capture, multipath, errata, sweeps through the receiver."""

import numpy as np
import pytest

from sdr_spoof.progress import silent
from sdr_spoof.reproduce import combo
from sdr_spoof.reproduce.combo import (
    capture,
    errata,
    multipath,
    phase_jump,
    published,
    receiver,
    receiver_section,
    sweep,
    thresholds,
)
from sdr_spoof.reproduce.combo.tap_loops import B1C, B1I, EPOCH_S, Rays, WindowSlope, follow
from sdr_spoof.reproduce.study import Effort


def test_published_numbers_and_draws_are_met():
    section = thresholds.section(Effort(runs=100), silent)
    assert len(section.numbers) == 85
    assert [n.name for n in section.numbers if not n.met] == []
    values = {n.name: n.value for n in section.numbers}
    assert values["threshold_as_ratio_hz"] == pytest.approx(4.511, abs=1e-3)
    assert values["threshold_printed"] == pytest.approx(18.833, abs=1e-3)
    assert values["threshold_as_dbhz_hz"] == pytest.approx(0.680, abs=1e-3)
    assert values["pd_by_drag_8.0_as_ratio"] == pytest.approx(0.6196, abs=1e-3)
    assert values["pd_by_amplitude_ratio_1.1_as_ratio"] == pytest.approx(0.7782, abs=1e-3)


def test_draws_depend_on_their_seed_alone():
    law = thresholds.law("as_ratio")
    hits = [thresholds.drawn_hits(law, 4.8, 1000, (1, 2)) for _ in range(2)]
    assert hits[0] == hits[1] != thresholds.drawn_hits(law, 4.8, 1000, (1, 3))


def test_end_slopes_follow_the_beat_model():
    drags = np.repeat(capture.DRAGS_HZ, 20)
    _, slopes = capture.simulate(drags, np.full(drags.size, published.ETA), seed=1)
    ends = slopes[-1].reshape(4, 20).mean(axis=1)
    np.testing.assert_allclose(ends, capture.SIMULATED_HZ, atol=0.15)
    assert np.all(ends > 1.5 * 0.6 * np.array(capture.DRAGS_HZ))


@pytest.mark.parametrize("band", [B1C, B1I])
def test_loops_have_the_thermal_slope_noise(band):
    # Study of the combo signal: slopes over 1 s of 10 ms phases, white within the discriminator.
    runs, nothing, rows = 500, np.zeros(500), 100
    slopes = WindowSlope(runs, 2 * rows, rows)
    follow(
        band,
        45.0,
        runs,
        2 * rows,
        lambda _: Rays(nothing, nothing, nothing, nothing),
        3,
        lambda epoch, got: slopes.add(epoch, got.phase_cycles),
    )
    phase_sigma = np.sqrt(1 / (2 * 10**4.5 * EPOCH_S)) / (2 * np.pi)
    expected = phase_sigma * np.sqrt(12 / (rows * (rows**2 - 1))) / EPOCH_S
    assert slopes.slope_hz.std() == pytest.approx(expected, rel=4 / np.sqrt(2 * 2 * runs))


def test_clean_taps_have_their_closed_form_metrics():
    sums = B1C.correlation(B1C.tap_chips)[None, :, None] * np.ones((1, 5, 3))
    delta, ratio = multipath.metrics(sums)
    np.testing.assert_allclose([delta, ratio], 0.0, atol=1e-12)


def test_a_static_echo_does_not_turn_the_difference(monkeypatch):
    monkeypatch.setattr(multipath, "EPOCHS", 500)
    amplitude = np.full(40, 0.5)
    found = multipath.echoes(amplitude, np.zeros(40), 45.0).values["phase difference rate"]
    moving = multipath.echoes(amplitude, np.full(40, 1.3), 45.0).values["phase difference rate"]
    assert found.max() < 0.03
    assert moving.max() > 0.06


def test_errata_name_every_known_error():
    titles = " ".join(e.title for e in errata.errata())
    for word in ("Units", "scaled", "Small-angle", "100 ms", "Decoupling", "axis"):
        assert word in titles
    assert errata.leak_hz() == pytest.approx(38.2, abs=0.1)
    plain, conjugate = errata.decoupling_degrees(20.0, 10.0)
    assert (plain, conjugate) == (pytest.approx(110.0), pytest.approx(10.0))


def test_jump_and_slope_from_samples():
    section = phase_jump.section(Effort(runs=1), silent)
    assert [n.name for n in section.numbers if not n.met] == []


def test_a_slow_drag_is_seen_by_the_receiver():
    point = receiver.Point(45.0, 1.0, published.ETA, receiver.IF)
    (result,) = sweep.measure([point], 1)
    assert (len(result.held), result.lost) == (1, 0)
    for method in range(2):
        (latency,) = result.detected(method)
        assert 0.0 < latency < 0.5
    cells = dict(zip(sweep.columns(), sweep.row(result), strict=True))
    assert cells["Pd, rate (published law)"] == 1.0


def test_seeds_are_those_of_the_point():
    a = receiver.Point(30.0, 1.0, 1.5)
    b = receiver.Point(30.0, 2.0, 1.5)
    assert sweep.seed_of(a, 0) == sweep.seed_of(receiver.Point(30.0, 1.0, 1.5), 0)
    assert len({sweep.seed_of(a, 0), sweep.seed_of(a, 1), sweep.seed_of(b, 0)}) == 3


def test_lowest_held_cn0():
    def result(cn0, held):
        lost = float("nan")
        runs = tuple(receiver.Run(k < held, lost, (False,), (lost,)) for k in range(20))
        return sweep.Result(receiver.Point(cn0, 0.0, 0.0), runs)

    results = [result(20.0, 20), result(26.0, 10), result(28.0, 19), result(30.0, 20)]
    assert receiver_section.lowest_held(results) == 28.0
    assert receiver_section.lowest_held([result(30.0, 5)]) is None


def test_study_is_complete():
    assert combo.STUDY.full_runs == 1000
