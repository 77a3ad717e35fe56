"""From simulated tracks of a whole sky to positions: cold, hot, and where there is none."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof import simulate
from sdr_spoof.config import Config, load_config
from sdr_spoof.detectors.noise_floor import QUANTITY as NOISE_OF_THE_BAND
from sdr_spoof.fixes import Cause, Status
from sdr_spoof.nav.beidou_satellites import GEO
from sdr_spoof.nav.frames import decode
from sdr_spoof.nav.geodesy import enu, geodetic_to_ecef
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.rinex_nav_write import format_navigation
from sdr_spoof.positioning import locate, try_locate
from sdr_spoof.positioning.summary import sentences, summarise
from sdr_spoof.records import Alarm as Alarm_
from sdr_spoof.records import SatelliteVerdict, Verdict
from sdr_spoof.route import Alarm, Quality
from sdr_spoof.scenario import load_scenario, synthesize
from sdr_spoof.sources import open_recording

PLACE = (31.2, 121.5, 30.0)
START = datetime(2023, 3, 12, 12, 0, tzinfo=UTC)
BROADCAST = Path(simulate.__code__.co_filename).parent / "scenario/data/brdc-2023-03-12.rnx"
SKY = """
title = "positioning"
[recording]
duration_s = {duration}
sample_rate_hz = {rate}
lo_hz = {lo}
sample_format = "ci8"
seed = 7
[sky]
start = "2023-03-12T12:00:00"
systems = ["C"]
signals = [{signals}]
elevation_mask_deg = 25.0
ionosphere = "none"
troposphere = "none"
[sky.receiver]
kind = "static"
latitude_deg = 31.2
longitude_deg = 121.5
height_m = 30.0
"""
PLAIN = {"pvt.ionosphere": "none", "pvt.troposphere": "none"}
HOT = PLAIN | {
    "navigation.files": str(BROADCAST),
    "navigation.time": "2023-03-12T12:00:00",
    "navigation.place": "31.5,121.0,0",
}


def sky_log(folder, duration, signals='"B1I"', rate=10e6, lo=1561.098e6, more=""):
    path = folder / "sky.toml"
    path.write_text(SKY.format(duration=duration, signals=signals, rate=rate, lo=lo) + more)
    return simulate(load_scenario(path))


@pytest.fixture(scope="module")
def cold_log(tmp_path_factory):
    return sky_log(tmp_path_factory.mktemp("cold"), 36.0)


@pytest.fixture(scope="module")
def cold(cold_log):
    return locate(cold_log, load_config(flags=PLAIN))


@pytest.fixture(scope="module")
def short_log(tmp_path_factory):
    """No subframe of D1 begins in it; without the satellites that send D2, whose are 0.6 s."""
    log = sky_log(tmp_path_factory.mktemp("short"), 2.05)
    return replace(log, signals=tuple(t for t in log.signals if t.prn not in GEO))


def errors_m(found):
    fixes = found.fixes
    return enu(fixes.position_m[fixes.fixed], geodetic_to_ecef(PLACE))


def test_cold_start(cold):
    """All messages received: positions, velocity and time, epochs at whole seconds of GPST."""
    error = errors_m(cold)
    assert len(error) >= 33
    assert np.sqrt((error[:, :2] ** 2).sum(axis=1).mean()) < 0.8
    assert np.abs(error.mean(axis=0)).max() < 1.0
    assert np.nanmax(np.abs(cold.route.velocity_enu_m_s)) < 0.1
    sampled = [(t - cold.observations.time(i)) for i, t in enumerate(cold.route.times)]
    assert np.abs(sampled).max() < 20e-9
    utc = cold.route.times[0].utc()
    since_s = (utc - START).total_seconds()
    assert since_s == pytest.approx(cold.route.sample_time_s[0], abs=1e-5)


def test_summary(cold):
    summary = summarise(cold)
    assert summary.fixes == summary.epochs == len(cold.route.times)
    assert summary.latitude_deg == pytest.approx(31.2, abs=1e-5)
    assert "° N, " in next(sentences(summary))
    assert summary.left_out == () and len(summary.satellites) > 6


def test_spoofed_satellites_are_left_out_and_named(cold_log):
    verdict = Verdict(True, (SatelliteVerdict(27, "spoofed", (), "", onset_s=10.0),), "")
    found = locate(cold_log, load_config(flags=PLAIN), verdict)
    view = next(s for s in found.route.satellites if s.name == "C27")
    late = found.route.sample_time_s >= 10.0
    assert view.used[~late].any() and not view.used[late].any()
    assert (found.route.alarm == np.where(late, Alarm.SPOOFED, Alarm.NONE)).all()
    assert summarise(found).left_out == ("C27",)


def test_fixes_on_suspects_are_suspect(cold_log):
    """Where one satellite is spoofed, another under suspicion is hardly innocent."""
    told = (
        SatelliteVerdict(27, "spoofed", (), "", onset_s=20.0),
        SatelliteVerdict(29, "suspect", (), "", onset_s=10.0),
    )
    config = load_config(flags=PLAIN | {"pvt.suspects": "use"})
    found = locate(cold_log, config, Verdict(True, told, ""))
    late = found.route.sample_time_s >= 20.0
    assert (found.route.quality == np.where(late, Quality.SUSPECT, Quality.FIX)).all()
    assert summarise(found).suspect == late.sum()


def test_suspects_are_left_out_where_others_are_spoofed(cold_log):
    """From the onset of the first spoofed satellite on, while there is a fix without them."""
    own = Alarm_(29, "ratio_metric", None, 10.0, 11.0, 9.0, 5.0, "")
    shared = replace(own, prn=32, detector="power", quantity=NOISE_OF_THE_BAND)
    told = (
        SatelliteVerdict(27, "spoofed", (), "", onset_s=20.0),
        SatelliteVerdict(29, "suspect", (own,), "", onset_s=10.0),
        SatelliteVerdict(32, "suspect", (shared,), "", onset_s=10.0),
    )
    for setting, left_out in (("leave-out", {27, 29}), ("use", {27})):
        config = load_config(flags=PLAIN | {"pvt.suspects": setting})
        fixes = locate(cold_log, config, Verdict(True, told, "")).fixes
        late = fixes.time_s - fixes.time_s[0] > 20.5
        prns = np.array([s.prn for s in fixes.signals])
        out = set(prns[~fixes.used[late].any(axis=0)].tolist())
        assert fixes.fixed.all() and out == left_out
        assert fixes.used[~late][5:15].all()
        causes = {e.satellite: e.cause for e in fixes.excluded}
        assert (causes.get("C29") == Cause.SUSPECT) == (setting == "leave-out")


def test_suspects_are_used_and_flagged_where_too_few_are_left(cold_log):
    prns = sorted({t.prn for t in cold_log.signals})
    told = [SatelliteVerdict(prn, "suspect", (), "", onset_s=10.0) for prn in prns[1:]]
    told.append(SatelliteVerdict(prns[0], "spoofed", (), "", onset_s=20.0))
    found = locate(cold_log, load_config(flags=PLAIN), Verdict(True, tuple(told), ""))
    assert found.fixes.fixed.all()
    late = found.route.sample_time_s >= 20.0
    assert (found.route.quality == np.where(late, Quality.SUSPECT, Quality.FIX)).all()


def test_a_synthesised_sky_tells_when_it_began(tmp_path):
    path = tmp_path / "sky.toml"
    path.write_text(SKY.format(duration=0.01, signals='"B1I"', rate=10e6, lo=1561.098e6))
    meta = synthesize(load_scenario(path), tmp_path / "rec")
    assert open_recording(meta).start == START


def test_hot_start_of_a_short_recording(short_log):
    """Two seconds hold no message: orbits, time and place from elsewhere give a fix."""
    found = locate(short_log, load_config(flags=HOT))
    error = errors_m(found)
    assert len(error) >= 1
    assert np.hypot(*error[:, :2].T).max() < 3.0


@pytest.mark.parametrize("late_s", [-40.0, 3.7])
def test_hot_start_with_a_coarse_time(short_log, late_s):
    """The time given is off; the snapshot finds it, and the fixes' clock the rest."""
    time = (START + timedelta(seconds=late_s)).isoformat()
    found = locate(short_log, load_config(flags=HOT | {"navigation.time": time}))
    error = errors_m(found)
    assert len(error) >= 1 and np.hypot(*error[:, :2].T).max() < 3.0
    since_s = (found.route.times[0].utc() - START).total_seconds()
    assert since_s == pytest.approx(found.route.sample_time_s[0], abs=1e-5)


def test_half_a_second(short_log):
    """No whole second lies in it: it says so, and more epochs a second give fixes."""
    log = replace(
        short_log, signals=tuple(t.between(1.1, 1.7) for t in short_log.signals), duration_s=1.7
    )
    found = locate(log, load_config(flags=HOT))
    assert found.fixes.epochs == 0
    assert any("1 Hz" in note for note in found.notes)
    found = locate(log, load_config(flags=HOT | {"observables.rate_hz": "10"}))
    error = errors_m(found)
    assert len(error) >= 4 and np.hypot(*error[:, :2].T).max() < 5.0


def test_time_from_the_recording(short_log):
    flags = {k: v for k, v in HOT.items() if k != "navigation.time"}
    found = locate(short_log, load_config(flags=flags), start=START)
    assert found.fixes.fixed.any()


@pytest.mark.parametrize("left_out", ["navigation.files", "navigation.time", "navigation.place"])
def test_short_recordings_say_what_they_lack(short_log, left_out):
    flags = {k: v for k, v in HOT.items() if k != left_out}
    found = locate(short_log, load_config(flags=flags))
    assert not found.fixes.fixed.any()
    words = {"files": "navigation file", "time": "time", "place": "place"}
    assert words[left_out.split(".")[1]] in " ".join(found.notes)
    assert "No position" in next(sentences(summarise(found)))


def test_few_satellites_give_no_fix(cold_log):
    few = replace(cold_log, signals=cold_log.signals[:3])
    found = locate(few, load_config(flags=PLAIN))
    assert not found.fixes.fixed.any()
    assert any("too few satellites" in note for note in found.notes)


def test_an_empty_log(cold_log):
    empty = replace(cold_log, signals=())
    found = locate(empty, load_config(flags=PLAIN))
    assert found.fixes.epochs == 0
    assert list(sentences(summarise(found)))


def test_positioning_can_be_switched_off(cold_log):
    config = load_config(flags={"navigation.position": "false"})
    assert try_locate(cold_log, config)[0] is None


def test_a_missing_navigation_file_is_told(cold_log, tmp_path):
    config = load_config(flags={"navigation.files": str(tmp_path / "none.rnx")})
    located, why = try_locate(cold_log, config)
    assert located is None and "none.rnx" in why


def test_same_fixes_twice(cold, cold_log):
    again = locate(cold_log, load_config(flags=PLAIN))
    assert np.array_equal(again.fixes.position_m, cold.fixes.position_m, equal_nan=True)


def test_a_gap_in_the_recording(cold_log):
    """Samples are missing: what follows has other counters, and no wrong position comes of it."""

    def cut(track):
        rows = (track.time_s < 20.0) | (track.time_s > 20.5)
        late = track.time_s > 20.25
        moved = replace(track, code_phase_chips=track.code_phase_chips - 777.0 * late)
        return moved.between(0.0, 20.0) if not rows.all() else moved

    log = replace(cold_log, signals=tuple(cut(t) for t in cold_log.signals))
    found = locate(log, load_config(flags=PLAIN))
    if found.fixes.fixed.any():
        assert np.abs(errors_m(found)).max() < 20.0


def test_a_satellite_that_says_it_is_unhealthy_is_left_out(tmp_path):
    """From the scenario's key through its message to the fix: D1 and D2."""
    table = "[[sky.satellite]]\nprn = {}\nhealthy = false\n"
    found = locate(
        sky_log(tmp_path, 36.0, more=table.format(30) + table.format(3)),
        load_config(flags=PLAIN | {"navigation.files": str(BROADCAST)}),
    )
    used = {s.name for s in found.route.satellites if s.used[found.route.sample_time_s > 34].any()}
    assert "C30" not in used and "C27" in used
    assert any(note.startswith("unhealthy: ") and "C30" in note for note in found.notes)
    sent = {e.prn: e.health for e in decode(sky_log(tmp_path, 34.0)).ephemerides}
    assert not any(sent.values())
    assert np.abs(errors_m(found)).max() < 20.0


def test_wrong_time_gives_no_wrong_fix(short_log):
    """A day off: ephemerides are stale, and the fix is refused."""
    late = (START + timedelta(days=1)).isoformat()
    found = locate(short_log, load_config(flags=HOT | {"navigation.time": late}))
    assert not (found.fixes.status == Status.FIX).any()
    assert found.notes


def test_a_file_that_contradicts_the_messages_is_told(cold_log, tmp_path):
    """Messages are sent later and are used; which of the two is forged is not known."""
    told = read_navigation(BROADCAST)
    false = tuple(replace(e, m0=e.m0 + 2e-4) if e.prn == 27 else e for e in told.ephemerides)
    file = tmp_path / "false.rnx"
    file.write_text(format_navigation(replace(told, ephemerides=false), "4.00"))
    found = locate(cold_log, load_config(flags=PLAIN | {"navigation.files": str(file)}))
    (note,) = [n for n in found.notes if "contradict" in n]
    assert "C27 D1" in note and note.endswith("differs in m0")


def test_defaults_locate(cold_log):
    assert locate(cold_log, Config()).fixes.fixed.any()
