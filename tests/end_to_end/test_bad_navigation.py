"""``sdr-spoof fix`` on what is wrong: no traceback, and no wrong fix without a flag.

Orbits, time and place come from outside, since the recording lies between two subframes: it begins
in the middle of a frame and holds no message.
"""

from __future__ import annotations

import json
import os
import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from commands import failing

from sdr_spoof import simulate
from sdr_spoof.cli import main
from sdr_spoof.cli.fix import NO_FIX
from sdr_spoof.fixes import Status
from sdr_spoof.nav.ephemeris import Ephemeris
from sdr_spoof.nav.geodesy import enu, geodetic_to_ecef
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.rinex_nav_write import format_navigation
from sdr_spoof.records import Verdict
from sdr_spoof.scenario import load_scenario
from sdr_spoof.sinks.hdf5 import Result, read_result, write_result
from sdr_spoof.sources import RecordingFormat

BROADCAST = Path(simulate.__code__.co_filename).parent / "scenario/data/brdc-2023-03-12.rnx"
TIME, PLACE = "2023-03-12T12:00:03", "31.2,121.5,30"
RATE_HZ, CUT_AT_S = 2.6e6, 1.2
DAY_S = 86_400.0
SKY = f"""
title = "between two subframes"
[recording]
duration_s = 2.4
sample_rate_hz = {RATE_HZ}
lo_hz = 1561.098e6
sample_format = "ci8"
seed = 3
[sky]
start = "{TIME}"
systems = ["C"]
signals = ["B1I"]
elevation_mask_deg = 25.0
[sky.receiver]
kind = "static"
latitude_deg = 31.2
longitude_deg = 121.5
height_m = 30.0
"""


@dataclass(frozen=True)
class Told:
    """What a run of the command said."""

    errors_m: np.ndarray
    """Of each fix that is not called suspect."""
    fixes: int
    suspect: int
    unchecked: int
    notes: str
    satellites: tuple[str, ...]


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("bad")
    (folder / "sky.toml").write_text(SKY)
    return folder


@pytest.fixture(scope="module")
def tracks(folder) -> Path:
    """A result file of the recording, its loops run at correlator level."""
    return result_file(folder / "tracks.h5", folder / "sky.toml")


def result_file(path: Path, scenario: Path, prns: tuple[int, ...] | None = None) -> Path:
    log = simulate(load_scenario(scenario))
    if prns is not None:
        log = replace(log, signals=tuple(t for t in log.signals if t.prn in prns))
    form = RecordingFormat(sample_format="ci8", sample_rate_hz=RATE_HZ, lo_hz=1561.098e6)
    quiet = Verdict(False, (), "")
    write_result(path, Result("rec.sigmf-data", form, {}, log=log, verdict=quiet))
    return path


@pytest.fixture(scope="module")
def samples(folder) -> Path:
    assert main(["synth", str(folder / "sky.toml"), "-o", str(folder / "rec")]) == 0
    return folder / "rec.sigmf-meta"


@pytest.fixture
def fix(tmp_path, capsys):
    def run(
        path: Path,
        *more: str,
        nav: Path | None = BROADCAST,
        time: str | None = TIME,
        place: str | None = PLACE,
    ) -> Told:
        given = {"--nav": nav, "--time": time, "--place": place}
        flags = [word for flag, v in given.items() if v is not None for word in (flag, str(v))]
        words = ["fix", str(path), *flags, *more, "--rate", "10", "--json", "--format", "hdf5"]
        capsys.readouterr()
        code = main([*words, "-o", str(tmp_path / "out"), "--force"])
        said = capsys.readouterr()
        position = json.loads(said.out)["position"]
        assert code == (0 if position["fixes"] else NO_FIX)
        assert ("No position: " in said.err) == (code == NO_FIX)
        fixes = read_result(tmp_path / "out/fixes.h5").fixes
        assert fixes is not None
        good = fixes.fixed & (fixes.status != Status.SUSPECT)
        return Told(
            np.linalg.norm(enu(fixes.position_m[good], geodetic_to_ecef((31.2, 121.5, 30))), axis=1)
            if good.any()
            else np.zeros(0),
            position["fixes"],
            position["suspect"],
            position["unchecked"],
            "\n".join(position["notes"]),
            tuple(position["satellites"]),
        )

    return run


def nav_file(path: Path, change, satellites: tuple[int, ...] | None = None) -> Path:
    """The broadcast file with the ephemerides of some satellites changed, all by default."""
    whole = read_navigation(BROADCAST)
    changed = (
        change(e) if satellites is None or (e.system == "C" and e.prn in satellites) else e
        for e in whole.ephemerides
    )
    made = replace(whole, ephemerides=tuple(e for e in changed if e is not None))
    path.write_text(format_navigation(made, "4.00"))
    return path


def displaced(e: Ephemeris) -> Ephemeris:
    """5 km along its orbit."""
    return replace(e, m0=e.m0 + 5e3 / e.a)


def later(e: Ephemeris, days: float) -> Ephemeris:
    s = days * DAY_S
    return replace(e, toe=e.toe + s, toc=e.toc + s, transmitted=e.transmitted + s)


def test_a_recording_that_begins_in_a_frame(fix, tracks):
    told = fix(tracks)
    assert told.fixes >= 20 and told.suspect <= 2
    assert told.errors_m.max() < 15.0
    assert "time from a snapshot" in told.notes


def test_one_false_orbit_is_left_out_and_named(fix, tracks, tmp_path):
    told = fix(tracks, nav=nav_file(tmp_path / "a.rnx", displaced, (27,)))
    assert told.errors_m.size >= 15 and told.errors_m.max() < 20.0
    assert "excluded by RAIM: C27" in told.notes


@pytest.mark.parametrize("satellites", [(27, 30), None])
def test_several_false_orbits_give_no_fix(fix, tracks, tmp_path, satellites):
    told = fix(tracks, nav=nav_file(tmp_path / "a.rnx", displaced, satellites))
    assert told.fixes == told.suspect
    assert "contradicts itself; time, place or navigation file may be farther off" in told.notes


@pytest.mark.parametrize("days", [-1.0, -7.0, -0.25, -7.0 * 1024, 1.0])
def test_a_file_of_another_day(fix, tracks, tmp_path, days):
    """A week, or a rollover of GPS's ten bits, earlier: the same time of week, another sky."""
    told = fix(tracks, nav=nav_file(tmp_path / "a.rnx", lambda e: later(e, days)))
    assert told.fixes == 0
    assert "stale ephemeris: C" in told.notes


def test_old_orbits_with_a_new_date(fix, tracks, tmp_path):
    """Orbits of two hours before, said to be of now."""
    told = fix(tracks, nav=nav_file(tmp_path / "a.rnx", lambda e: later(e, 1 / 12)))
    assert told.fixes == told.suspect
    assert "farther off than said" in told.notes


def turned(e: Ephemeris) -> Ephemeris:
    """About the Earth's axis, by 94 km at this latitude."""
    return replace(e, omega0=e.omega0 + 0.0172)


def test_a_sky_turned_as_a_whole_is_never_called_checked(fix, tracks, tmp_path):
    """Nothing in the recording contradicts it but the place given, if that is known well enough."""
    file = nav_file(tmp_path / "a.rnx", turned)
    told = fix(tracks, nav=file)
    assert told.errors_m.min() > 90e3
    assert told.unchecked + told.suspect == told.fixes > 0
    assert "no message confirms time and orbits" in told.notes
    assert "km from the place given, which may be 100 km off" in told.notes
    told = fix(tracks, "--pvt-place-uncertainty-m", "50e3", nav=file)
    assert told.fixes == told.suspect
    assert "farther off than said" in told.notes


def test_unhealthy_satellites(fix, tracks, tmp_path):
    told = fix(tracks, nav=nav_file(tmp_path / "a.rnx", lambda e: replace(e, health=1), (27,)))
    assert told.fixes and "C27" not in told.satellites
    assert "unhealthy: C27" in told.notes
    told = fix(tracks, nav=nav_file(tmp_path / "b.rnx", lambda e: replace(e, health=1)))
    assert told.fixes == 0 and "unhealthy: C" in told.notes


@pytest.mark.parametrize(
    "time", ["2023-03-12T13:00:03", "2023-03-12T11:00:03", "2023-03-19T12:00:03"]
)
def test_wrong_time(fix, tracks, time):
    told = fix(tracks, time=time)
    assert told.fixes == told.suspect
    assert "farther off than said" in told.notes


@pytest.mark.parametrize("place", ["40.2,121.5,30", "-31.2,-58.5,30"])
def test_wrong_place(fix, tracks, place):
    """1000 km off, and the other side of the Earth."""
    told = fix(tracks, place=place)
    assert told.fixes == told.suspect
    assert "farther off than said" in told.notes


@pytest.mark.parametrize(("missing", "word"), [("nav", "file"), ("time", "time"), ("place", "pl")])
def test_what_is_lacking_is_told(fix, tracks, missing, word):
    told = fix(tracks, **{missing: None})
    assert told.fixes == 0
    assert "no message was received in full; a fix needs" in told.notes and word in told.notes


def test_malformed_and_missing_records(fix, tracks, tmp_path):
    """Lines lost, numbers that are none: those records are left out, with their lines."""
    lines, rng = BROADCAST.read_text().split("\n"), np.random.default_rng(1)
    kept = [x for i, x in enumerate(lines) if i < 20 or rng.random() > 0.01]
    wrong = [
        x if i < 20 or rng.random() > 0.01 else f"{x[:30]}x*{x[32:]}" for i, x in enumerate(kept)
    ]
    file = tmp_path / "a.rnx"
    file.write_text("\n".join(wrong))
    told = fix(tracks, nav=file)
    assert told.fixes and told.errors_m.max() < 20.0
    assert "record left out" in told.notes and "line" in told.notes
    file.write_text("\n".join(lines)[: len("\n".join(lines)) // 2])
    told = fix(tracks, nav=file)
    assert (told.errors_m < 50.0).all()
    assert "no ephemeris" in told.notes or "too few satellites" in told.notes


@pytest.mark.parametrize("content", [b"", b"hello\nworld\n", bytes(range(256)) * 20])
def test_no_navigation_file(tracks, tmp_path, capsys, content):
    file = tmp_path / "a.rnx"
    file.write_bytes(content)
    code, message = failing(capsys, "fix", tracks, "-o", tmp_path / "out", "--nav", file)
    assert code == 1 and "a.rnx does not begin with 'RINEX VERSION / TYPE'" in message
    assert not (tmp_path / "out").exists()


def test_too_few_and_no_satellites(fix, folder):
    for prns in ((7, 8, 10), ()):
        name = f"few{len(prns)}.h5"
        told = fix(result_file(folder / name, folder / "sky.toml", prns))
        assert told.fixes == 0
        assert ("too few satellites: 3" if prns else "no signal was tracked") in told.notes


@pytest.mark.parametrize("missing_s", [0.003, 0.020, 0.7])
def test_dropped_samples(fix, samples, tmp_path, missing_s):
    """Whole code periods, whole symbols and more: a fix is right, or called suspect."""
    path = cut(samples, tmp_path, CUT_AT_S, missing_s)
    told = fix(path, "--prns", "7,8,10,13,20,27,29,30")
    assert (told.errors_m < 50.0).all()
    assert told.errors_m.size or "farther off than said, or samples" in told.notes


@pytest.mark.parametrize("left_s", [1.0, 0.05])
def test_a_truncated_recording(fix, samples, tmp_path, left_s):
    path = cut(samples, tmp_path, left_s, 100.0)
    told = fix(path, "--prns", "7,8,10,13,20,27,29,30")
    assert (told.errors_m < 50.0).all()
    assert told.fixes or "no signal was tracked long enough for a snapshot" in told.notes


def cut(samples: Path, folder: Path, at_s: float, missing_s: float) -> Path:
    """The recording without some of its samples."""
    whole = np.fromfile(samples.with_suffix(".sigmf-data"), np.int8)
    first, stop = (2 * round(s * RATE_HZ) for s in (at_s, at_s + missing_s))
    np.concatenate([whole[:first], whole[stop:]]).tofile(folder / "cut.sigmf-data")
    shutil.copy(samples, folder / "cut.sigmf-meta")
    return folder / "cut.sigmf-meta"


def test_half_a_sample_at_the_end(samples, tmp_path, capsys):
    path = cut(samples, tmp_path, 1.0, 100.0)
    os.truncate(path.with_suffix(".sigmf-data"), 2 * round(RATE_HZ) - 1)
    _, message = failing(capsys, "fix", path, "-o", tmp_path / "out")
    assert "not a whole number of ci8 samples" in message
