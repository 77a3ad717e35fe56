"""B-CNAV1: frames to symbols and back."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from bcnav1_runs import MESSAGE, START, START_S, WEEK, broadcast, ephemeris, run_of

from sdr_spoof.errors import NavigationError
from sdr_spoof.nav import bcnav1_fields, bcnav1_orbit, bcnav1_pages
from sdr_spoof.nav.messages import MESSAGES, message_on
from sdr_spoof.nav.time import GnssTime

VECTORS = Path(__file__).parents[1] / "vectors" / "messages" / "bcnav1.txt"


def received(name: str) -> np.ndarray:
    """Code word that a satellite sent in January 2024."""
    words = dict(line.split() for line in VECTORS.read_text().splitlines())
    return np.array([int(c, 16) >> k & 1 for c in words[name] for k in (3, 2, 1, 0)], np.uint8)


def test_fields_of_a_received_frame_are_those_of_a_medium_orbit() -> None:
    found = bcnav1_fields.SUBFRAME2.read(received("subframe2"))
    assert (found["week"], found["how"], found["sat_type"]) == (941, 125, 3)
    assert found["toe"] == found["toc"] == found["how"] * 3600
    assert found["iode"] == found["iodc"] == 13
    assert abs(found["delta_a"]) < 1000 and found["e"] < 1e-3
    assert math.degrees(found["i0"]) == pytest.approx(55, abs=2)
    assert abs(found["a0"]) < 1e-3 and abs(found["a1"]) < 1e-10


def test_page_of_a_received_frame_tells_leap_seconds_and_ionosphere() -> None:
    now = GnssTime.of_week(941, 450_000, "C")
    bits = received("subframe3")[:264]
    said = bcnav1_pages.read(bits, now)
    utc, model = said.utc[0], said.ionosphere[0]
    assert (utc.leap_s, utc.leap_future_s) == (4, 4)
    assert abs(utc.a0) < 1e-7 and abs(utc.reference - now) < 86_400
    # The sign of alpha 5 is that of its scale; compare BDGIM records of any RINEX 4 file.
    assert model.alpha == (26.625, -3.5, 9.25, 8.375, -9.25, 1.0, 0.125, 0.5, 0.875)
    assert bcnav1_pages.health(bits) == 0


def quanta() -> dict[str, float]:
    """Steps of the fields of subframe 2."""
    return {f.name: abs(f.scale) for f in bcnav1_fields.SUBFRAME2.fields}


def test_content_comes_back_within_the_steps_of_its_fields() -> None:
    content = broadcast()
    symbols = MESSAGE.encode(content, START, 6 * 18.0)
    frames = MESSAGE.decode(run_of(symbols))
    assert [f.page for f in frames] == [1, 4, 1, 2, 1, 3]
    assert all(f.ok and not f.inverted and f.corrected == 0 for f in frames)
    assert [f.transmitted - START for f in frames] == [18.0 * n for n in range(6)]
    assert [f.code_phase_chips for f in frames[:2]] == [71_610.0, 71_610.0 + 1800 * 10_230]
    said = MESSAGE.read(frames)
    (found,), sent = said.ephemerides, content.ephemeris
    steps = quanta()
    for field in fields(found):
        ours, theirs = getattr(sent, field.name), getattr(found, field.name)
        if field.name in steps and isinstance(ours, float):
            assert theirs == pytest.approx(ours, abs=0.51 * steps[field.name]), field.name
    assert found.a == pytest.approx(sent.a, abs=2.0**-10)
    assert (found.toe, found.toc, found.iode, found.iodc) == (sent.toe, sent.toc, 17, 273)
    for signal in ("B1CP", "B1CD", "B2AP"):
        assert found.group_delay_s(signal) == pytest.approx(sent.group_delay_s(signal), abs=6e-11)
    assert said.ionosphere[0].alpha == content.bdgim.alpha
    utc = said.utc[0]
    assert utc.a0 == pytest.approx(1.2e-9, abs=2.0**-36)
    assert (utc.leap_s, utc.leap_week, utc.leap_day, utc.leap_future_s) == (4, 890, 3, 4)
    assert said.offsets[0].other == "G"
    assert said.offsets[0].a0 == pytest.approx(-7.5e-9, abs=2.0**-36)


def test_almanacs_are_the_orbits_coarsely() -> None:
    content = broadcast()
    said = MESSAGE.read(MESSAGE.decode(run_of(MESSAGE.encode(content, START, 6 * 18.0))))
    known = {e.prn: e for e in content.ephemerides}
    assert len(said.almanacs) == 5 and {e.prn for e in said.almanacs} <= set(known)
    for found in said.almanacs:
        sent = known[found.prn]
        assert abs(found.toe - START) <= 2048
        assert found.a == pytest.approx(sent.a, abs=400.0)
        assert found.i0 == pytest.approx(0.3 * math.pi, abs=0.05)
    healthy = {name for name, value in said.health if value == 0}
    assert healthy == {f"C{e.prn}" for e in said.almanacs if e.prn != 38}


def test_almanac_of_an_unhealthy_inclined_satellite() -> None:
    content = broadcast(ephemerides=(ephemeris(38, 42_160_000.0, health=1),))
    said = MESSAGE.read(MESSAGE.decode(run_of(MESSAGE.encode(content, START, 4 * 18.0))))
    assert [(e.prn, round(e.a, -3)) for e in said.almanacs] == [(38, 42_160_000.0)] * 2
    assert dict(said.health) == {"C38": 0x80}


def test_own_health_goes_with_the_ephemeris() -> None:
    content = broadcast(ephemeris=ephemeris(health=1))
    said = MESSAGE.read(MESSAGE.decode(run_of(MESSAGE.encode(content, START, 36.0))))
    assert [e.health for e in said.ephemerides] == [1]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("start_s", [0.0, 5.55, 3595.0, 604_797.0 - START_S])
def test_frames_are_found_wherever_a_recording_starts(start_s: float, sign: float) -> None:
    """Also over the ends of an hour and of a week, with 7 % of the symbols wrong."""
    symbols = MESSAGE.encode(broadcast(), START + start_s, 45.0)
    frames = MESSAGE.decode(run_of(symbols, es_n0_db=0.5, sign=sign))
    assert len(frames) >= 2
    for frame in frames:
        expected = START + start_s + (frame.time_s - 0.25)
        assert abs(frame.transmitted - expected) < 1e-6
        assert frame.transmitted.week_tow("C")[1] % 18 == 0
        assert frame.inverted == (sign < 0)
        assert frame.corrected > 50 or frame.time_s < 0 or frame.time_s > 27


def test_two_thirds_of_a_frame_are_enough_without_noise() -> None:
    symbols = MESSAGE.encode(broadcast(), START, 12.0)
    (frame,) = MESSAGE.decode(run_of(symbols))
    assert (frame.transmitted, frame.corrected) == (START, 0)
    assert MESSAGE.read([frame]).ephemerides
    # The end of one frame and the first of the next one: the end is enough.
    symbols = MESSAGE.encode(broadcast(), START + 6.0, 12.8)
    frames = MESSAGE.decode(run_of(symbols))
    assert frames[0].transmitted == START
    assert frames[0].time_s == pytest.approx(0.25 - 6.0)


def test_a_lost_half_cycle_costs_one_frame() -> None:
    symbols = MESSAGE.encode(broadcast(), START, 72.0).astype(np.float32)
    symbols[2500:] *= -1.0
    frames = MESSAGE.decode(run_of(symbols, es_n0_db=6.0))
    assert [(f.transmitted - START, f.inverted) for f in frames if f.page] == [
        (0.0, False),
        (36.0, True),
        (54.0, True),
    ]


def test_a_start_known_from_the_pilot_is_used() -> None:
    symbols = MESSAGE.encode(broadcast(), START + 4.0, 32.0)
    frames = MESSAGE.decode(run_of(symbols), start=1400 + 1800)
    assert [f.transmitted - START for f in frames] == [0.0, 18.0]
    assert MESSAGE.decode(run_of(symbols), start=1399) == []


def test_weeks_roll_over() -> None:
    later = GnssTime.of_week(8192 + 5, 1000 * 18.0, "C")
    content = broadcast(ephemeris=ephemeris(toe=later, toc=later), ephemerides=())
    (frame,) = MESSAGE.decode(run_of(MESSAGE.encode(content, later, 18.0)), near=later + 1e6)
    assert frame.transmitted == later


def test_a_frame_that_tells_another_time_is_not_ok() -> None:
    first = MESSAGE.encode(broadcast(), START, 18.0)
    second = MESSAGE.encode(broadcast(), START + 7200.0 + 18.0, 18.0)
    frames = MESSAGE.decode(run_of(np.concatenate([first, second])))
    assert [f.ok for f in frames] == [True, False]


def test_noise_and_an_unmodulated_carrier_and_another_satellite_give_nothing() -> None:
    assert MESSAGE.decode(run_of(np.zeros(4000), es_n0_db=0.0)) == []
    assert MESSAGE.decode(run_of(np.ones(4000))) == []
    assert MESSAGE.decode(run_of(np.ones(20))) == []
    symbols = MESSAGE.encode(broadcast(), START, 36.0)
    assert MESSAGE.decode(run_of(symbols, prn=28)) == []


def test_what_the_message_cannot_tell_is_refused() -> None:
    with pytest.raises(NavigationError, match="multiples of 300 s"):
        MESSAGE.encode(broadcast(ephemeris=ephemeris(toe=START + 8.0)), START, 18.0)
    with pytest.raises(NavigationError, match="cannot start at"):
        MESSAGE.encode(broadcast(), START + 0.005, 18.0)
    with pytest.raises(NavigationError, match="does not fit"):
        MESSAGE.encode(broadcast(ephemeris=ephemeris(crs=1e6)), START, 18.0)


def test_issues_that_do_not_go_together_make_no_ephemeris() -> None:
    values = bcnav1_orbit.values(replace(ephemeris(), iodc=18))
    assert bcnav1_orbit.ephemeris(27, values, START, 0) is None
    assert bcnav1_orbit.issues(ephemeris(message="D1", iode=1, iodc=1)) == (0, 0)


def test_geostationary_satellites_send_none() -> None:
    assert MESSAGE.sent_on("B1CD", 27)
    assert not MESSAGE.sent_on("B1CD", 60)
    assert not MESSAGE.sent_on("B1CP", 27)
    assert START.week_tow("C")[0] == WEEK


@pytest.mark.parametrize("seed", range(6))
def test_garbage_gives_nothing_and_raises_nothing(seed: int) -> None:
    random = np.random.default_rng(seed)
    values = random.standard_normal(4000) * 10.0 ** random.integers(-3, 4)
    values[random.integers(0, 4000, 200)] = random.choice([0.0, np.nan, np.inf, -np.inf, 1e30])
    run = replace(run_of(np.zeros(4000)), values=values.astype(np.float32))
    assert MESSAGE.decode(run) == []


def test_broken_symbols_within_a_good_run_do_no_harm() -> None:
    run = run_of(MESSAGE.encode(broadcast(), START, 36.0), es_n0_db=10.0)
    values = run.values.copy()
    values[np.random.default_rng(3).integers(0, values.size, 300)] = np.nan
    frames = MESSAGE.decode(replace(run, values=values))
    assert [f.transmitted - START for f in frames] == [0.0, 18.0]


def test_registered() -> None:
    assert message_on("B1CD", 27) is MESSAGES["CNV1"]
    assert message_on("B1CP", 27) is None
