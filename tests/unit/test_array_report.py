"""Tracks of three antennas in closed form: motion, direction of arrival, verdict, report."""

import numpy as np
import pytest

from sdr_spoof.aiding.array import arrival
from sdr_spoof.aiding.array.config import ArrayConfig
from sdr_spoof.aiding.array.examine import GRID_S, Vehicle, examine
from sdr_spoof.aiding.array.geometry import triangle
from sdr_spoof.aiding.array.phases import ArrayPhases
from sdr_spoof.aiding.array.simulate import differences, direction, towards
from sdr_spoof.errors import AidingError, OutputError
from sdr_spoof.records import SignalTrack, State, TrackLog
from sdr_spoof.report.array import array_page
from sdr_spoof.report.figures.array_scores import draw_scores
from sdr_spoof.report.page import write_page
from sdr_spoof.scenario.sky.trajectory import rotations
from sdr_spoof.signals import LIGHT_M_S, signal_spec

SIDE_M, SIGMA, LENGTH_S, STEP_S = 0.38, 0.005, 20.0, 0.02
ARRAY = triangle(SIDE_M)
WAVELENGTH = LIGHT_M_S / signal_spec("L1CA").carrier_hz
LINES_M = (0.031, -0.012)
SKY = {"G06": (20.0, 70.0), "G11": (300.0, 50.0), "G17": (150.0, 45.0)}
SPOOFER = np.array([150.0, 40.0, -20.0])
"""North, east, down from where the vehicle begins."""


def vehicle_at(time_s, speed_m_s):
    """Northward, and turning right."""
    place = np.outer(speed_m_s * time_s, [1.0, 0.0, 0.0])
    yaw = 0.03 * time_s
    attitude = np.stack([yaw, 0 * yaw, 0 * yaw], axis=1)
    looks = {k: np.tile(direction(*v), (time_s.size, 1)) for k, v in SKY.items()}
    return Vehicle(time_s, attitude, place, looks.get)


def logs_of(speed_m_s, *, spoofed=(), lines_m=LINES_M, heading_rad=0.0, seed=1):
    """One log an antenna; data hide half cycles, and the whole ones are not known."""
    time_s = np.arange(0.0, LENGTH_S, STEP_S)
    moving = vehicle_at(time_s, speed_m_s)
    turn = rotations(np.add(moving.attitude_rad, [heading_rad, 0.0, 0.0]))
    rng = np.random.default_rng(seed)
    tracks = [[] for _ in range(3)]
    for name in SKY:
        near = towards(SPOOFER, moving.place_m) if name in spoofed else moving.look(name)
        body = np.einsum("eij,ei->ej", turn, near)
        arms = np.vstack([np.zeros(3), ARRAY.baselines_m])
        phase = -body @ arms.T / WAVELENGTH + np.array([0.0, *lines_m]) / WAVELENGTH
        phase += SIGMA * rng.standard_normal(phase.shape) + 0.5 * rng.integers(-9, 9, 3)
        for of, one in zip(tracks, phase.T, strict=True):
            of.append(track_of(int(name[1:]), time_s, one))
    return [TrackLog("rec", 4e6, LENGTH_S, False, tuple(of), ()) for of in tracks]


def track_of(prn, time_s, phase):
    ones, taps = np.ones(time_s.size), np.ones((time_s.size, 5), np.complex64)
    return SignalTrack(
        signal="L1CA",
        prn=prn,
        modulation="Bpsk",
        tap_offsets_s=np.zeros(5),
        prompt_tap=2,
        time_s=time_s,
        integration_s=STEP_S * ones,
        state=np.full(time_s.size, State.SYNCED, np.uint8),
        carrier_phase_cycles=phase,
        doppler_hz=ones,
        code_phase_chips=ones,
        phase_error_cycles=ones,
        code_error_chips=ones,
        cn0_dbhz=ones,
        phase_lock=ones,
        noise_power=ones,
        taps=taps,
        data_prompt=taps[:, 0],
    )


def moving_at(speed_m_s):
    return vehicle_at(GRID_S * np.arange(round(LENGTH_S / GRID_S)), speed_m_s)


def verdicts(findings):
    return {f.satellite: f.verdict for f in findings}


def test_motion_and_arrival_agree_on_who_is_near():
    logs, moving = logs_of(12.0, spoofed=["G11"]), moving_at(12.0)
    by_motion = examine(logs, ARRAY, moving, ArrayConfig(line_sigma_cycles=0.2))
    assert verdicts(by_motion) == {"G06": "clean", "G11": "spoofed", "G17": "clean"}
    assert all(f.arrivals is None for f in by_motion)
    both = examine(logs, ARRAY, moving, lines_m=LINES_M)
    assert verdicts(both) == verdicts(by_motion)
    hit = both[1]
    assert hit.alarm_s < by_motion[1].alarm_s
    assert (hit.arrivals.score > hit.threshold).all()
    assert "did not come from where the satellite is" in hit.reason
    assert both[0].arrivals.time_s.size == 20
    np.testing.assert_allclose(both[0].sigma_cycles, SIGMA, rtol=0.2)


def test_a_standing_vehicle_is_judged_by_arrival_alone():
    logs, moving = logs_of(0.0, spoofed=["G11"]), moving_at(0.0)
    without = examine(logs, ARRAY, moving)
    assert set(verdicts(without).values()) == {"not enough support"}
    found = verdicts(examine(logs, ARRAY, moving, lines_m=LINES_M))
    assert found == {"G06": "clean", "G11": "spoofed", "G17": "clean"}


def test_arrival_needs_calibrated_lines_and_a_known_heading():
    moving = moving_at(0.0)
    wrong = examine(logs_of(0.0), ARRAY, moving, lines_m=(0.0, 0.0))
    assert "spoofed" in verdicts(wrong).values()
    told = ArrayConfig(line_sigma_cycles=0.2)
    assert set(verdicts(examine(logs_of(0.0), ARRAY, moving, told, (0, 0))).values()) == {"clean"}
    turned = logs_of(0.0, heading_rad=np.radians(2.5))
    assert "spoofed" in verdicts(examine(turned, ARRAY, moving, lines_m=LINES_M)).values()
    told = ArrayConfig(heading_sigma_deg=2.5)
    assert set(verdicts(examine(turned, ARRAY, moving, told, LINES_M)).values()) == {"clean"}
    with pytest.raises(AidingError, match="1 calibrated lines for an array of 2"):
        examine(turned, ARRAY, moving, lines_m=LINES_M[:1])


def test_a_second_of_arrivals_has_its_law():
    runs, epochs = 4000, 10
    time_s = GRID_S * np.arange(epochs)
    expected = np.tile(direction(70.0, 40.0), (epochs, 1))
    rng = np.random.default_rng(4)
    heading = np.radians(0.5) * rng.standard_normal((runs, 1, 1)) * [1.0, 0.0, 0.0]
    believed = np.zeros((epochs, 3))
    lines = 0.01 * rng.standard_normal((runs, 2))
    unit = np.broadcast_to(expected, (runs, epochs, 3))
    true = np.broadcast_to(believed + heading, unit.shape)
    measured = differences(ARRAY, unit, true, WAVELENGTH, SIGMA, rng, bias_cycles=lines)
    measured = measured + 0.5 * rng.integers(-5, 5, (runs, 1, 2))
    phases = ArrayPhases(
        time_s,
        measured,
        believed,
        np.zeros((epochs, 3)),
        SIGMA,
        WAVELENGTH,
        expected,
        known_cycles=False,
        cycle_step=0.5,
        yaw_sigma_rad=np.radians(0.5),
        bias_sigma_cycles=0.01,
    )
    p = arrival.p_value(arrival.statistic_of_all(ARRAY, phases), ARRAY)
    for level in (0.01, 0.1, 0.5):
        assert abs(np.mean(p < level) - level) < 4 * np.sqrt(level * (1 - level) / runs)


def page_of(speed_m_s, spoofed, lines_m=LINES_M, known=True):
    moving = moving_at(speed_m_s)
    findings = examine(logs_of(speed_m_s, spoofed=spoofed), ARRAY, moving, lines_m=lines_m)
    return array_page(
        findings,
        ARRAY,
        moving,
        ArrayConfig(),
        name="a<b>.sigmf-meta",
        known=known,
        calibrated=lines_m is not None,
        picture=draw_scores(findings),
    )


def test_the_report_says_who(tmp_path):
    page = page_of(12.0, ["G11"])
    path = write_page(tmp_path / "a.html", page, {"array": {"form": "matched"}})
    text = path.read_text(encoding="utf-8")
    assert text.count("data:image/png") == 2
    for expected in ("Spoofing detected", "G11 L1CA does not come", "a&lt;b&gt;", "array.form"):
        assert expected in text
    assert "http" not in text and "one in a million" in text and "leave G11 out" in text
    write_page(tmp_path / "b.html", page, {"array": {"form": "matched"}})
    assert (tmp_path / "b.html").read_bytes() == path.read_bytes()
    with pytest.raises(OutputError, match="--force"):
        write_page(path, page, {})


def test_the_report_says_what_was_not_tested():
    page = page_of(0.0, [], lines_m=None, known=False)
    assert (page.level, page.sentences) == ("unsupported", ())
    assert any("--lines" in note for note in page.notes)
    assert any("20 m of motion" in note for note in page.notes)
    assert any("--nav" in note for note in page.notes)
    clean = page_of(12.0, [])
    assert (clean.level, clean.headline) == ("clean", "No spoofing found")
