"""The fused verdict: every class, the shares of the false alarms, and the words."""

import dataclasses

import numpy as np
import pytest
from simulated_taps import quality_log, quality_track
from simulated_tracks import Attack, Satellite, simulate_log

from sdr_spoof import fusion
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.fusion import Examined, judge, share_of
from sdr_spoof.records import Alarm, TrackLog, Verdict
from sdr_spoof.report import words
from sdr_spoof.verdict import detect, statistics

CONFIG = DetectionConfig(detectors=("phase_difference_rate", "ratio_metric", "power"))


def alarm(detector="phase_difference_rate", band=None, onset_s=10.0, **more):
    values = dict(
        prn=23,
        detector=detector,
        band=band,
        onset_s=onset_s,
        alarm_s=onset_s + 0.5,
        statistic=1.0,
        threshold=0.1,
        unit="Hz",
        log10_p=-12.0,
    )
    return Alarm(**(values | more))


def examined(found=None, detector="phase_difference_rate", signal=None, tested_s=20.0, quantity=""):
    return Examined(
        detector=found.detector if found else detector,
        signal=signal,
        quantity=quantity,
        alarm=found,
        tests=round(tested_s * 100),
        tested_s=tested_s,
        start_s=0.0,
        held_until_s=20.0,
        window_s=1.0,
        notes=(),
    )


def two_bands():
    log = simulate_log(Satellite(23), duration_s=3.0)
    return dataclasses.replace(log, duration_s=20.0)


def judged(*parts, log=None, config=CONFIG):
    return judge(log or two_bands(), "C", 23, parts, config)


QUALITY = [alarm("ratio_metric", "B1I"), alarm("power", "B1CP", quantity="C/N0")]


def test_consistency_alone_is_spoofed():
    verdict = judged(examined(alarm(band="B1CP")))
    assert (verdict.verdict, verdict.onset_s, verdict.band) == ("spoofed", 10.0, "B1CP")
    assert verdict.fallback == "B1I"
    assert verdict.action == "use B1I alone"
    assert verdict.confidence == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("found", QUALITY)
def test_quality_alone_is_a_suspicion(found):
    verdict = judged(examined(), examined(found, signal=found.band))
    assert verdict.verdict == "suspect"
    assert verdict.onset_s == 10.0
    assert verdict.fallback is None
    assert "weight" in verdict.action
    report = Verdict(False, (verdict,), "")
    assert report.suspect
    assert words.headline(report) == "Suspicious signals"


def test_any_number_of_quality_alarms_stays_a_suspicion():
    parts = [examined(a, signal=a.band, quantity=a.quantity) for a in QUALITY]
    assert judged(examined(), *parts).verdict == "suspect"


def test_consistency_decides_the_onset_and_comes_first():
    early = alarm("ratio_metric", "B1CP", onset_s=8.0)
    verdict = judged(examined(early, signal="B1CP"), examined(alarm(band="B1CP")))
    assert verdict.onset_s == 10.0
    assert [a.detector for a in verdict.alarms] == ["phase_difference_rate", "ratio_metric"]
    assert "also: Ratio metric" in verdict.reason


def test_the_first_alarm_of_each_series_stays():
    sections = [examined(alarm(onset_s=5.0)), examined(alarm(onset_s=9.0)), examined()]
    (kept,) = judged(*sections).alarms
    assert kept.onset_s == 5.0


def test_one_series_of_each_signal_and_quantity_counts_by_itself():
    parts = [
        examined(alarm("power", band, quantity=quantity), signal=band, quantity=quantity)
        for band in ("B1I", "B1CP")
        for quantity in ("C/N0", "noise power")
    ]
    assert len(judged(*parts).alarms) == 4


def test_clean_needs_a_test_that_could_have_said_spoofed():
    quality = examined(None, "ratio_metric", "B1I")
    assert judged(examined(), quality).verdict == "clean"
    assert judged(quality).verdict == "not enough support"
    assert judged(examined(tested_s=1.0), quality).verdict == "not enough support"
    alone = CONFIG.model_copy(update={"detectors": ("ratio_metric",)})
    assert judged(quality, config=alone).verdict == "clean"
    assert judged().verdict == "not enough support"


BENT = [alarm("ratio_metric", band, onset_s=10.5) for band in ("B1I", "B1CP")]
JUMP = alarm("phase_difference_glr")


def reflected(*found):
    return judged(*(examined(a, signal=a.band, quantity=a.quantity) for a in found)).verdict


def test_a_reflection_that_comes_or_goes_is_a_suspicion():
    assert reflected(JUMP, *BENT) == "suspect"
    verdict = judged(*(examined(a, signal=a.band) for a in (JUMP, *BENT)))
    assert "a reflection does this too" in verdict.reason
    # It biases the codes too, and may move one carrier more than the other.
    codes = [alarm("code_minus_carrier", band, onset_s=10.5) for band in ("B1I", "B1CP")]
    assert reflected(JUMP, *codes) == "suspect"
    assert reflected(dataclasses.replace(JUMP, band="B1CP"), *BENT, codes[0]) == "suspect"


def test_what_no_reflection_does_is_spoofing():
    late = dataclasses.replace(BENT[1], onset_s=15.0, alarm_s=15.5)
    asymmetric = alarm("delta_metric", "B1CP", onset_s=10.5)  # the code loop is shared
    for found in (
        [JUMP],
        [JUMP, BENT[0]],  # one band's peak alone
        [JUMP, BENT[0], late],
        [JUMP, BENT[0], asymmetric],
        [JUMP, alarm(), *BENT],  # the difference turns
        [JUMP, *BENT, alarm("power", "B1I", quantity="C/N0")],
    ):
        assert reflected(*found) == "spoofed"


def test_an_unnamed_band_means_drop_the_satellite():
    verdict = judged(examined(alarm()))
    assert (verdict.verdict, verdict.band, verdict.fallback) == ("spoofed", None, None)
    assert verdict.action == "drop the satellite"
    assert "cannot be told" in words.action_sentence(verdict)


def test_a_satellite_with_one_signal_has_nothing_to_fall_back_to():
    log = quality_log(quality_track(duration_s=3.0))
    verdict = judged(examined(alarm(band="B1I"), signal="B1I"), log=log)
    assert (verdict.band, verdict.fallback) == ("B1I", None)
    assert verdict.action == "drop the satellite"


def test_support_is_missing_only_where_nothing_of_a_detector_could_be_tested():
    idle = examined(detector="power", signal="B1I", tested_s=0.0, quantity="noise floor")
    busy = examined(detector="power", signal="B1I", quantity="C/N0")
    assert judged(examined(), idle).reason.endswith("too little support for: Power")
    assert "too little" not in judged(examined(), busy, idle).reason


def test_the_confidence_counts_the_tests_made():
    weak = alarm(log10_p=-6.0)
    short = judged(examined(weak, signal=None, tested_s=10.0)).confidence
    long = judged(examined(weak, signal=None, tested_s=1e5)).confidence
    assert short == pytest.approx(1 - 1e-5)
    assert long == pytest.approx(0.9)


def test_the_share_of_each_detector():
    config = DetectionConfig(false_alarm_probability=1e-3, detectors=("power", "ratio_metric"))
    assert share_of(config).false_alarm_probability == pytest.approx(5e-4)
    assert share_of(config).false_alarms_per_hour == pytest.approx(5e-4)
    one = DetectionConfig(detectors=("phase_difference_rate",))
    assert share_of(one) == one


def test_the_satellite_keeps_the_stated_rate_of_false_alarms():
    # All quality tests of a two-band satellite: 600 alarms an hour in all, for ten minutes.
    config = DetectionConfig(
        detectors=("delta_metric", "ratio_metric", "ratio_metric_variance", "power"),
        false_alarms_per_hour=600.0,
        quality_window_s=0.2,
        quality_reference_s=2.0,
        power_window_s=0.2,
        power_reference_s=2.0,
        power_wander_db=0.0,
        settle_s=0.0,
        quality_settle_s=0.0,
    )
    found, expected = 0, 50.0
    for seed in (8, 9):
        tracks = [
            quality_track(duration_s=300.0, seed=seed),
            quality_track(signal="B1CP", modulation="Boc11", duration_s=300.0, seed=seed),
        ]
        at = [
            series.time_s[np.abs(series.value) > series.threshold(1e-6)]
            for series in statistics(quality_log(*tracks), config)
        ]
        found += 1 + np.count_nonzero(np.diff(np.sort(np.concatenate(at))) > 0.2)
    assert 0.3 * 2 * expected < found < 2 * expected + 4 * np.sqrt(2 * expected)


def test_all_detectors_on_simulated_satellites():
    attacked = Satellite(23, attack=Attack(start_s=12.0, drag_hz=2.0))
    slipped = Satellite(25, slips={9.0: ("B1I", 0.5), 15.0: ("B1CP", 1.0)})
    log = simulate_log(attacked, Satellite(24), slipped, single=[(Satellite(40), "B1CP")])
    verdict = detect(log, DetectionConfig())
    by_prn = {s.prn: s for s in verdict.satellites}
    spoofed = by_prn[23]
    assert (spoofed.verdict, spoofed.band, spoofed.fallback) == ("spoofed", "B1CP", "B1I")
    assert spoofed.onset_s == pytest.approx(12.0, abs=0.05)
    assert by_prn[24].verdict == by_prn[25].verdict == "clean"
    assert words.ordered(verdict)[0].prn == 23


def test_multipath_in_one_band_is_suspect_not_spoofed():
    # The carriers' law is kept out: a ray in phase moves the shape, not the carrier.
    time = (np.arange(2000) + 0.5) * 0.01
    log = simulate_log(Satellite(23))
    ray = (np.where(time > 12.0, 0.6, 0.0), 0.3, 0.0)
    bent = quality_track(duration_s=20.0, rays=[ray])
    bent = dataclasses.replace(bent, state=log.signals[0].state)
    log = dataclasses.replace(log, signals=(bent, log.signals[1]))
    (satellite,) = detect(log, DetectionConfig()).satellites
    assert satellite.verdict == "suspect"
    assert satellite.onset_s == pytest.approx(12.0, abs=0.1)
    assert not any(fusion.evidence_of(a.detector) == "consistency" for a in satellite.alarms)


def test_an_empty_log_has_no_satellites():
    empty = TrackLog("none", 1e6, 0.0, False, (), ())
    verdict = detect(empty, DetectionConfig())
    assert not verdict.spoofed
    assert not verdict.suspect
