"""What the report keeps of the tests: thin lines, largest values, peaks, states."""

import dataclasses

import numpy as np
import pytest
from simulated_tracks import Attack, Satellite, simulate_log

from sdr_spoof.detectors import DETECTORS, DetectionConfig
from sdr_spoof.fusion import deciding, share_of
from sdr_spoof.records import State
from sdr_spoof.report import words
from sdr_spoof.report.evidence import Evidence, EvidenceBook, broken
from sdr_spoof.report.figures import peaks, style, tracking_bar
from sdr_spoof.report.figures.evidence_panels import evidence_panels
from sdr_spoof.report.figures.quiet import QuietDrawing
from sdr_spoof.verdict import detect, statistics

CONFIG = DetectionConfig(detectors=tuple(DETECTORS))


@pytest.fixture(scope="module")
def log():
    return simulate_log(Satellite(23, attack=Attack(start_s=6.0, drag_hz=2.0)), duration_s=10.0)


@pytest.fixture(scope="module")
def verdict(log):
    return detect(log, CONFIG)


@pytest.fixture(scope="module")
def evidence(log, verdict):
    taken = Evidence()
    for series in statistics(log, CONFIG):
        if series.time_s.size:
            taken.take(series, share_of(CONFIG))
    taken.judge(verdict.satellites[0].alarms)
    return taken


def test_a_cell_is_beyond_one_exactly_where_its_detector_alarmed(evidence, verdict):
    alarmed = {a.detector for a in verdict.satellites[0].alarms}
    assert "phase_difference_rate" in alarmed
    assert {n for n, c in evidence.cells.items() if c.of_threshold > 1.0} == alarmed
    assert {n for n, c in evidence.cells.items() if c.alarm_s is not None} == alarmed


def test_lines_are_those_of_the_series(log, evidence):
    config = share_of(CONFIG)
    (series,) = (s for s in statistics(log, CONFIG) if s.detector == "phase_difference_rate")
    ratio = np.abs(series.value) / series.threshold(config.false_alarm_probability)
    time_s, value = evidence.consistency["phase_difference_rate", None].joined()
    np.testing.assert_allclose(value, ratio)
    np.testing.assert_array_equal(time_s, series.time_s)
    assert set(evidence.quality) == {
        (n, s) for n in ("delta_metric", "ratio_metric") for s in ("B1I", "B1CP")
    }


def test_sections_of_a_track_make_one_difference(log, evidence):
    """Cut in two that overlap, each from a level of its own: the same line but for noise."""
    (series,) = (s for s in statistics(log, CONFIG) if s.detector == "phase_difference_rate")
    half = series.trace.size // 2
    taken = Evidence()
    for part, level in ((slice(0, half + 100), 0.0), (slice(half, None), 7.0)):
        section = dataclasses.replace(
            series,
            trace=series.trace[part] + level,
            trace_time_s=series.trace_time_s[part],
            trace_segment=series.trace_segment[part],
        )
        taken.take(section, share_of(CONFIG))
    time_s, value = taken.difference.joined()
    whole_s, whole = evidence.difference.joined()
    np.testing.assert_array_equal(time_s, whole_s)
    np.testing.assert_allclose(value, whole, atol=1e-9)


def test_lines_break_where_nothing_was_tested(log):
    (series,) = (s for s in statistics(log, CONFIG) if s.detector == "phase_difference_rate")
    kept = np.r_[0:100, 200 : series.time_s.size]
    columns = ("time_s", "value", "sigma", "sigma_thermal", "segment")
    gapped = dataclasses.replace(series, **{n: getattr(series, n)[kept] for n in columns})
    time_s, value = broken(gapped, gapped.value)
    assert np.flatnonzero(np.isnan(value)).tolist() == [100]
    assert (np.diff(time_s) > 0).all()


def test_long_lines_stay_small():
    line = Evidence().difference
    for section in range(3):
        line.add(section * 1e5 + np.arange(1e5), np.zeros(100_000))
    assert line.joined()[0].size < 3 * 1.6 * style.MOST_POINTS


def test_the_table_has_a_place_for_each_detector(evidence):
    book = EvidenceBook(CONFIG)
    book.satellites["C", 23] = evidence
    names = ("power", "phase_difference_rate")
    assert list(book.rows(names, [("C", 7), ("C", 23)])) == [
        (("C", 23), [evidence.cells["power"], evidence.cells["phase_difference_rate"]])
    ]


def test_a_peak_is_that_of_the_taps(log):
    track = log.signals[1]
    found = peaks.peak(track, peaks.Stretch("before", 1.0, 5.0))
    np.testing.assert_allclose(
        found.height / found.height.max(), [-0.5, 0.7, 1, 0.7, -0.5], atol=0.01
    )
    assert (np.diff(found.offset_chips) > 0).all()
    assert peaks.peak(track, peaks.Stretch("after", 11.0, 12.0)) is None


@pytest.mark.parametrize(
    ("onset_s", "last_alarm_s", "duration_s"), [(4, 6, 12), (11.9, 12, 12), (0, 0.1, 5), (3, 3, 9)]
)
def test_stretches_follow_each_other(onset_s, last_alarm_s, duration_s):
    before, during, after = peaks.stretches(onset_s, last_alarm_s, duration_s)
    assert before.start_s <= before.stop_s == during.start_s == onset_s
    assert during.start_s < during.stop_s <= after.start_s < after.stop_s == duration_s


def test_stretches_of_tracking(log):
    track = log.signals[0]
    state = np.full(track.epochs, State.COMBO, dtype=np.uint8)
    state[:100] = State.SYNCED
    state[600:700] = State.LOST
    state[700:] = State.CAPTURED
    track = dataclasses.replace(track, state=state)
    kinds = [kind for kind, _, _ in tracking_bar.stretches(track)]
    assert kinds == [tracking_bar.ALONE, tracking_bar.JOINT, tracking_bar.ISOLATED]
    assert tracking_bar.fell_back(track, 5.0) == track.time_s[600]
    assert tracking_bar.fell_back(track, 6.5) is None
    assert tracking_bar.isolated_s(track) == track.time_s[700]
    assert tracking_bar.isolated_s(log.signals[0]) is None


def test_words_of_a_satellite(verdict):
    satellite = verdict.satellites[0]
    first = min(a.alarm_s for a in deciding(satellite.alarms))
    assert f"alarm raised at {first:.2f} s" in words.alarms_sentence(satellite)
    assert words.action_sentence(satellite).startswith("use B1I alone (B1C (1575.42 MHz) is")
    suspect = dataclasses.replace(satellite, verdict="suspect", alarms=satellite.alarms[:1])
    assert "as a reflection does too" in words.satellite_sentence(suspect)
    untold = dataclasses.replace(satellite, band=None, action="drop the satellite")
    assert "cannot be told" in words.satellite_sentence(untold)
    assert words.action_sentence(untold).startswith("drop the satellite: ")


def test_of_a_satellite_with_hardly_a_test_nothing_is_drawn(log):
    """As of one that was tested for power alone before Ctrl-C."""
    assert QuietDrawing.of(evidence_panels(Evidence(), 10.0), ("B1I",), log.duration_s) is None
