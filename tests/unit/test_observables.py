"""Observables recover closed-form ranges, with the noise of the loops and no more."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from observed_tracks import LIGHT_M_S, START, Moving, anchor, navigation, observed_log

from sdr_spoof.nav.records import Navigation
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.observables import ObservablesConfig, observe
from sdr_spoof.observables.clock import set_clock
from sdr_spoof.observations import SUBCARRIER
from sdr_spoof.records import SatelliteVerdict, Verdict
from sdr_spoof.signals import signal_spec

SKY = (
    Moving(27, 0.0781234, 5000.0, -1.0),
    Moving(30, 0.0710077, -5000.0, 1.0),
    Moving(9, 0.1251, 10.0, 0.1),
)


def column(observations, prn, signal):
    return next(i for i, s in enumerate(observations.signals) if (s.prn, s.signal) == (prn, signal))


def true_range_m(observations, satellite, signal="B1I"):
    """Pseudorange by the clock that the observations went by, at their sample times."""
    times = observations.sample_time_s
    clock = observations.clock.pieces[0]
    bias_s = (clock.time - START) - clock.sample_s
    own = satellite.group_delay_s.get(signal, 0.0)
    return LIGHT_M_S * (satellite.delay(times) + own + bias_s + clock.rate * times)


@pytest.mark.parametrize("rate_hz", [1, 10, 50])
def test_ranges_are_recovered(rate_hz):
    log, told = observed_log(*SKY), navigation(*SKY)
    seen = observe(log, told, ObservablesConfig(rate_hz=rate_hz))
    assert seen.epochs == pytest.approx(20 * rate_hz, abs=1)
    assert np.array_equal(seen.time_s, np.round(seen.time_s * rate_hz) / rate_hz)
    for satellite in SKY:
        for signal in satellite.signals:
            at = column(seen, satellite.prn, signal)
            error = seen.pseudorange_m[:, at] - true_range_m(seen, satellite)
            valid = np.isfinite(error)
            assert valid.sum() >= seen.epochs - 2
            assert np.abs(error[valid]).max() < 2e-4
            check_carrier(seen, satellite, signal, at)


def check_carrier(seen, satellite, signal, at):
    """Phase goes with the range to 0.1 mm, beginning near it; Doppler is its rate."""
    carrier = signal_spec(signal).carrier_hz
    phase_m = seen.carrier_phase_cycles[:, at] * LIGHT_M_S / carrier
    difference = phase_m - true_range_m(seen, satellite)
    valid = np.isfinite(difference)
    assert np.ptp(difference[valid]) < 1e-4
    assert np.abs(difference[valid]).max() < 0.2
    course = satellite.doppler_hz + satellite.doppler_rate_hz_s * seen.sample_time_s
    doppler = seen.doppler_hz[valid, at] - carrier / 1575.42e6 * course[valid]
    assert np.abs(doppler).max() < 1e-4


def test_clock_is_set_to_70_ms_after_the_nearest():
    seen = observe(observed_log(*SKY), navigation(*SKY))
    nearest = min(np.nanmin(seen.pseudorange_m[0:2], axis=0)) / LIGHT_M_S
    assert nearest == pytest.approx(0.070, abs=1e-4)
    assert seen.reference.fraction == 0.0
    sampled = START + float(seen.sample_time_s[0])
    assert abs(seen.time(0) - sampled) < 0.01


def test_a_corrected_clock_gives_true_ranges():
    log, told = observed_log(*SKY), navigation(*SKY)
    first = observe(log, told)
    clock = first.clock.pieces[0]
    bias_s = clock.at(5.0) - (START + 5.0)
    drift = 2e-6  # say that the sample clock gains this
    corrected = replace(first.clock, pieces=(clock.corrected(5.0, bias_s, drift),))
    seen = observe(log, told, clock=corrected)
    assert corrected.pieces[0].at(5.0) - (START + 5.0) == pytest.approx(0, abs=1e-12)
    at = column(seen, 27, "B1CP")
    times = seen.sample_time_s
    bias = corrected.pieces[0].rate * (times - 5.0)
    expected = LIGHT_M_S * (SKY[0].delay(times) + bias)
    valid = np.isfinite(seen.pseudorange_m[:, at])
    assert np.abs((seen.pseudorange_m[:, at] - expected)[valid]).max() < 1e-3
    phase_m = seen.carrier_phase_cycles[:, at] * LIGHT_M_S / 1575.42e6
    assert np.ptp((phase_m - expected)[valid]) < 1e-3
    rate = (5000.0 - times) - 1575.42e6 * corrected.pieces[0].rate
    assert np.abs((seen.doppler_hz[:, at] - rate)[valid]).max() < 0.02


def test_noise_is_that_of_the_rows():
    """Phase: 0.21 of a row's variance; Doppler: 12 / (n^3 T^2); measured code: as the phase."""
    satellite = Moving(noise=1.0, signals=("B1CP",))
    log = observed_log(satellite, duration_s=100.0)
    config = ObservablesConfig(rate_hz=5, code="measured")
    seen = observe(log, navigation(satellite, duration_s=100.0), config)
    valid = np.isfinite(seen.pseudorange_m[:, 0])
    truth = true_range_m(seen, satellite)
    wavelength = LIGHT_M_S / 1575.42e6
    chip_m = LIGHT_M_S / 1.023e6
    phase = (seen.carrier_phase_cycles[:, 0] - truth / wavelength)[valid]
    code = (seen.pseudorange_m[:, 0] - truth)[valid]
    doppler = (seen.doppler_hz[:, 0] - (5000.0 - seen.sample_time_s))[valid]
    spread = 4 / np.sqrt(2 * phase.size)
    assert np.std(phase) == pytest.approx(0.0064 * np.sqrt(0.2075), rel=spread)
    assert np.std(code) == pytest.approx(0.02 * chip_m * np.sqrt(0.2075), rel=spread)
    slope = 0.0064 / (0.01 * np.sqrt(11 * (11**2 - 1) / 12))
    assert np.std(doppler) == pytest.approx(slope, rel=spread + 0.02)


def test_loop_code_is_without_the_discriminator():
    satellite = Moving(noise=1.0, signals=("B1CP",))
    seen = observe(observed_log(satellite), navigation(satellite))
    error = seen.pseudorange_m[:, 0] - true_range_m(seen, satellite)
    assert np.nanmax(np.abs(error)) < 1e-3


def test_smoothing_averages_the_code():
    satellite = Moving(noise=1.0, signals=("B1CP",))
    log = observed_log(satellite, duration_s=60.0)
    told = navigation(satellite, duration_s=60.0)
    seen = observe(log, told, ObservablesConfig(smoothing_s=5.0))
    error = (seen.pseudorange_m[:, 0] - true_range_m(seen, satellite))[10:]
    expected = 0.02 * LIGHT_M_S / 1.023e6 * np.sqrt(0.01 / (2 * 5.0))
    assert np.nanstd(error) < 2 * expected
    assert abs(np.nanmean(error)) < 4 * expected / np.sqrt(50 / 10)


def test_another_signal_tells_the_time():
    satellite = Moving()
    told = Navigation(anchors=(anchor(satellite, "B1I"),))
    seen = observe(observed_log(satellite), told)
    at = column(seen, 27, "B1CP")
    error = seen.pseudorange_m[:, at] - true_range_m(seen, satellite)
    assert np.nanmax(np.abs(error)) < 1e-3


def test_no_transmit_time_no_observations():
    seen = observe(observed_log(*SKY), Navigation())
    assert seen.epochs == 0 and seen.signals == ()
    assert seen.pseudorange_m.shape == (0, 0)
    assert "transmit time" in seen.notes[0]


def test_contradicting_anchors_are_not_used():
    satellite = Moving(signals=("B1I",))
    anchors = (anchor(satellite, "B1I"), anchor(satellite, "B1I", late_s=0.02))
    assert observe(observed_log(satellite), Navigation(anchors=anchors)).signals == ()


def test_anchors_hold_where_they_say():
    satellite = Moving(signals=("B1I",))
    anchors = (
        anchor(satellite, "B1I", until_s=8.0),
        anchor(satellite, "B1I", from_s=12.0, late_s=0.02),
    )
    seen = observe(observed_log(satellite), Navigation(anchors=anchors))
    error = seen.pseudorange_m[:, 0] - true_range_m(seen, satellite)
    between = (seen.sample_time_s > 8.0) & (seen.sample_time_s < 12.0)
    assert np.isnan(error[between]).all()
    late = seen.sample_time_s >= 12.0
    assert np.abs(error[~between & ~late]).max() < 1e-3
    assert np.abs(error[late] + LIGHT_M_S * 0.02).max() < 1e-3
    assert seen.lock_lost[late.argmax(), 0]


def test_half_cycles_are_told_by_the_message():
    satellite = Moving(inverted=("B1I",))
    log, told = observed_log(satellite), navigation(satellite)
    seen = observe(log, told)
    blind = observe(log, replace(told, frames=()))
    at, pilot = column(seen, 27, "B1I"), column(seen, 27, "B1CP")
    assert blind.half_cycle[:, at].all() and not seen.half_cycle[:, at].any()
    assert not blind.half_cycle[:, pilot].any()
    turn = seen.carrier_phase_cycles[:, at] - blind.carrier_phase_cycles[:, at]
    assert np.nanmax(np.abs(np.abs(turn - np.round(turn)) - 0.5)) < 1e-6


def test_a_turned_sign_breaks_the_phase():
    satellite = Moving(signals=("B1I",))
    told = navigation(satellite)
    turned = tuple(replace(f, inverted=f.time_s > 7.0) for f in told.frames)
    seen = observe(observed_log(satellite), replace(told, frames=turned))
    assert np.count_nonzero(seen.lock_lost[:, 0]) == 2


def slipped_log(satellite, row):
    log = observed_log(satellite)
    (track,) = log.signals
    phase, error = track.carrier_phase_cycles.copy(), track.phase_error_cycles.copy()
    phase[row:] += 0.5
    error[row : row + 3] = 0.24
    moved = replace(track, carrier_phase_cycles=phase, phase_error_cycles=error)
    return replace(log, signals=(moved,))


def test_a_slip_is_told_and_not_measured():
    satellite = Moving(signals=("B1I",))
    log = slipped_log(satellite, 1000)
    seen = observe(log, navigation(satellite), ObservablesConfig(rate_hz=10))
    slip_s = float(log.signals[0].time_s[1000])
    near = np.abs(seen.sample_time_s - slip_s) < 0.02
    assert np.isnan(seen.carrier_phase_cycles[near, 0]).all()
    lost = seen.sample_time_s[seen.lock_lost[:, 0]]
    assert lost.size == 2 and slip_s < lost[1] < slip_s + 0.2


def test_a_loop_that_lags_is_no_slip():
    """The discriminator shows 0.15 cycles for a while, and the measured phase goes on smoothly."""
    satellite = Moving(signals=("B1I",), noise=1.0)
    log = observed_log(satellite)
    (track,) = log.signals
    error = track.phase_error_cycles.copy()
    error[1000:1020] += 0.15
    lagging = replace(log, signals=(replace(track, phase_error_cycles=error),))
    seen = observe(lagging, navigation(satellite), ObservablesConfig(rate_hz=10))
    assert np.count_nonzero(seen.lock_lost) == 1
    assert np.isfinite(seen.carrier_phase_cycles).all()


def test_a_gap_breaks_the_run():
    satellite = Moving(lost=((9.6, 10.4),))
    seen = observe(observed_log(satellite), navigation(satellite))
    for at in range(2):
        error = seen.pseudorange_m[:, at] - true_range_m(seen, satellite)
        gone = np.flatnonzero(~np.isfinite(error))
        assert gone.size == 1
        assert seen.lock_lost[gone[0] + 1, at]
        assert np.nanmax(np.abs(error)) < 1e-3


def test_missing_samples_that_the_code_loop_still_follows():
    """0.2 chips are missing: the discriminator shows it until the replica is there."""
    satellite = Moving(signals=("B1I",), noise=1.0)
    log = observed_log(satellite)
    (track,) = log.signals
    since = track.time_s - 10.0
    lag = np.where(since >= 0, 0.2 * np.exp(-np.maximum(since, 0) / 0.25), 0.0)
    jumped = replace(
        track,
        code_phase_chips=track.code_phase_chips + 0.2 * (since >= 0),
        code_error_chips=track.code_error_chips + lag,
    )
    seen = observe(
        replace(log, signals=(jumped,)), navigation(satellite), ObservablesConfig(rate_hz=10)
    )
    moved_m = 0.2 * LIGHT_M_S / 2.046e6
    error = seen.pseudorange_m[:, 0] - true_range_m(seen, satellite)
    late = seen.sample_time_s > 10.0
    assert np.nanmax(np.abs(error[~late])) < 0.01
    # What is given is nearer to the truth after the jump than a tenth of the discriminator's noise.
    assert np.nanmax(np.abs(error[late] + moved_m)) < 6
    assert np.isnan(error[late][:2]).all()


def test_dropped_seconds_set_the_clock_anew():
    """Two seconds of samples are missing: all tracks break, the counters begin anew."""
    before = Moving(27, lost=((10.0, 99.0),))
    after = replace(before, prn=28, lost=((0.0, 10.5),))
    log = observed_log(before, after)
    late = [anchor(after, s, late_s=2.0) for s in after.signals]
    anchors = (*navigation(before).anchors, *late)
    seen = observe(log, Navigation(anchors=anchors))
    assert len(seen.clock.pieces) == 2
    assert np.nanmax(seen.pseudorange_m) < LIGHT_M_S * 0.1
    assert np.all(np.diff(seen.time_s) > 0)
    assert np.diff(seen.time_s).max() == pytest.approx(3.0)


def test_a_time_that_cannot_be_is_left_out():
    sky = (*SKY, Moving(11, 0.09))
    anchors = [a for a in navigation(*sky).anchors if a.prn != 11]
    wrong = [anchor(sky[3], s, late_s=-6.0) for s in sky[3].signals]
    seen = observe(observed_log(*sky), Navigation(anchors=(*anchors, *wrong)))
    assert "C11" not in seen.satellites
    assert any("C11" in note for note in seen.notes)


def test_spoofed_satellites_are_flagged_from_onset_on():
    satellites = (
        SatelliteVerdict(27, "spoofed", (), "", onset_s=8.0, fallback="B1CP"),
        SatelliteVerdict(30, "suspect", (), "", onset_s=2.0),
    )
    verdict = Verdict(True, satellites, "")
    log, told = observed_log(*SKY), navigation(*SKY)
    seen = observe(log, told, verdict=verdict)
    late = seen.sample_time_s >= 8.0
    for signal in ("B1I", "B1CP"):
        assert np.array_equal(seen.spoofed[:, column(seen, 27, signal)], late)
        assert not seen.spoofed[:, column(seen, 30, signal)].any()
    trusting = observe(log, told, ObservablesConfig(trust_fallback=True), verdict)
    assert not trusting.spoofed[:, column(trusting, 27, "B1CP")].any()


@pytest.mark.parametrize("known", [True, False])
def test_subcarrier_range(known):
    """The beat's range is that of the code; without B1I's sign, up to half a step."""
    satellite = Moving(inverted=("B1I",))
    log, told = observed_log(satellite, combos=True), navigation(satellite)
    if not known:
        told = replace(told, frames=())
    seen = observe(log, told)
    at = column(seen, 27, SUBCARRIER)
    error = seen.pseudorange_m[:, at] - true_range_m(seen, satellite)
    assert seen.half_cycle[:, at].all() != known
    half_step_m = LIGHT_M_S / (1575.42e6 - 1561.098e6) / 2
    steps = error / half_step_m
    assert np.nanmax(np.abs(steps - np.round(steps))) < 1e-3
    if known:
        assert np.nanmax(np.abs(error)) < 1e-3
    assert np.isnan(seen.carrier_phase_cycles[:, at]).all()


def test_epochs_are_those_of_gpst():
    seen = observe(observed_log(*SKY), navigation(*SKY), ObservablesConfig(rate_hz=10))
    assert isinstance(seen.reference, GnssTime)
    assert seen.interval_s == pytest.approx(0.1)
    assert np.allclose(np.diff(seen.time_s), 0.1)


@pytest.mark.parametrize("times_s", [(5.0, 5.3), (5.0, 5.01, 5.3, 5.32)])
def test_a_clock_is_set_where_half_of_the_satellites_tell_another_time(times_s):
    """As after samples that are missing before the first frame of some."""
    spans = [
        SimpleNamespace(from_s=1.0, until_s=9.0, origin=GnssTime(1000), ahead_s=lambda _, t=t: t)
        for t in times_s
    ]
    (piece,) = set_clock(spans).pieces
    delays_s = [(piece.time - GnssTime(1000)) - piece.sample_s - t for t in times_s]
    assert sum(0.0 < d < 0.25 for d in delays_s) == len(times_s) // 2
