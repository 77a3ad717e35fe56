"""Integrity and grid in D2: places, values, round trips, and what is made of them."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from nav_air import NOON, VECTORS, content, noisy_run
from observed_sky import EXACT, START, Sky
from observed_sky import navigation as orbits
from skies import satellite, sky

from sdr_spoof import pvt, simulate
from sdr_spoof.config import load_config
from sdr_spoof.errors import NavigationError
from sdr_spoof.fixes import Cause
from sdr_spoof.nav import d2_integrity
from sdr_spoof.nav.atmosphere import gpst_s, ionosphere_m
from sdr_spoof.nav.beidou_framing import NUMBER, SOW
from sdr_spoof.nav.bits import bits_of
from sdr_spoof.nav.broadcast import Contents
from sdr_spoof.nav.integrity import GridPoint, Integrity, place_deg
from sdr_spoof.nav.messages import MESSAGES
from sdr_spoof.nav.records import Frame, Navigation
from sdr_spoof.nav.store import Store
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.positioning import locate
from sdr_spoof.positioning.summary import sentences, summarise
from sdr_spoof.signals import signal_spec
from sdr_spoof.sinks.hdf5 import Result, read_result, write_result
from sdr_spoof.sources import RecordingFormat

D2 = MESSAGES["D2"]
MORNING = VECTORS / "brd4_2023071_04h_08h.rnx"
FRAME = GnssTime.of_week(897, 43_200.0, "C")
JUDGED = (
    *(Integrity(prn, prn % 14, (3 * prn) % 15, 0.1 * (prn - 9)) for prn in range(1, 19)),
    Integrity(31, 9, 6, -2.0),
    Integrity(63, 14, 15),
)


def frames(integrity=(), grid=(), seconds=36.0, start=FRAME):
    """Decoded frames of C03 that sends them."""
    said = replace(content(3, "D2", NOON), integrity=tuple(integrity), grid=tuple(grid))
    symbols = D2.encode(said, start, seconds + 1.0)
    return D2.decode(noisy_run(symbols, "D2", 3, 60.0), start)


def plain(found):
    """Judgements without their times, by satellite."""
    return {i.prn: (i.udrei, i.rurai, i.correction_m) for i in found}


def set_bits(bits, places, value):
    """Write a number into bits, counted from 1."""
    for n, place in enumerate(reversed(places)):
        bits[place - 1] = value >> n & 1


def test_the_places_are_those_of_the_icd():
    """Page 1 bit by bit, with values that another decoder's test has for the same fields."""
    whole = frames(JUDGED, seconds=18.0)
    second, third, fourth = (next(f for f in whole if f.number == n) for n in (2, 3, 4))
    first = [f for f in whole if f.transmitted == second.transmitted]
    assert first == [second]
    bits = {n: np.zeros(300, np.uint8) for n in (2, 3, 4)}
    two = bits[2]
    set_bits(two, [44, 45, 46, 47], 1)  # page
    set_bits(two, [50, 51, 52, *range(61, 76)], (1 << 18) - 1)  # C01 to C18
    set_bits(two, [172, 181, 182, 183], 7)  # UDREI of C01
    set_bits(two, [276, 277, 278, 279], 5)
    set_bits(two, [*range(280, 293)], -12 & 0x1FFF)
    three = bits[3]
    set_bits(three, [44, 45, 46, 47], 2)
    set_bits(three, [*range(48, 53), *range(61, 69)], 30)
    set_bits(three, [69, 70, 71, 72], 3)
    set_bits(three, [*range(73, 83), *range(91, 94)], -40 & 0x1FFF)
    four = bits[4]
    set_bits(four, [169, 170], 3)
    set_bits(four, [171], 1)  # C31
    set_bits(four, [220, 221, 222, 223], 9)
    set_bits(four, [252, 253, 254, 255], 6)
    set_bits(four, [*range(256, 263), *range(271, 277)], -20 & 0x1FFF)
    page = [
        replace(f, bits=bits[f.number], page=1 if f.number == 2 else 0)
        for f in (second, third, fourth)
    ]
    found = plain(D2.read(page).integrity)
    assert found == {
        1: (7, 5, pytest.approx(-1.2)),
        2: (0, 2, pytest.approx(3.0)),
        3: (0, 3, pytest.approx(-4.0)),
        31: (9, 6, pytest.approx(-2.0)),
    }


def sent_by_c01():
    """Frames of 14 July 2021, from midnight BDT on (tests/vectors/navigation/README.md)."""
    found = []
    with (VECTORS / "subframes.csv").open() as file:
        rows = [r for r in csv.DictReader(file) if r["message"] == "D2"]
    for row in rows:
        bits = np.concatenate([bits_of(int(word, 16), 30) for word in row["words"].split()])
        sow, number = SOW.raw(bits), NUMBER.raw(bits)
        page = D2.page(sow // 3 * 5 + number - 1, bits)
        sent = GnssTime.of_week(810, float(sow), "C") + 0.6 * (number - 1)
        found.append(Frame("C", 1, "B1I", "D2", number, sent, bits, 0.0, 0.0, 0.6, page))
    return sorted(found, key=lambda f: f.transmitted)


def test_what_a_satellite_sent():
    """Marks, and what is said: 16 satellites have slots, just the other two slots are empty."""
    frames_ = sent_by_c01()
    read = D2.read(frames_)
    assert [i.prn for i in read.integrity] == [*range(1, 7), *range(8, 14), 16, 23, 24, 25]
    steps = [6, 13, -3, 1, 3, 8, 10, 1, 6, 9, 8, -12, -4, -18, -21, -17]
    assert [round(i.correction_m / 0.1) for i in read.integrity] == steps
    assert [i.rurai for i in read.integrity] == [1, 3, 0, 0, 0, 1, 2, 0, 0, 1, 1, 2, 0, 4, 4, 3]
    assert {i.udrei for i in read.integrity} == {0}
    second = next(f for f in frames_ if f.number == 2)
    assert [f.raw(second.bits) for f in d2_integrity.UDREI[16:]] == [14, 14]
    assert all(i.usable for i in read.integrity)


def test_the_grid_that_a_satellite_sent():
    """The morning's ionosphere over China: thicker in the south."""
    grid = D2.read(sent_by_c01()).grid
    delays = {p.place_deg: p.delay_m for p in grid}
    assert len(delays) == len(grid) == 115
    assert (min(delays.values()), max(delays.values())) == (0.75, 2.75)
    assert delays[22.5, 125.0] == 2.75
    south, north = (
        np.mean([d for (latitude, _), d in delays.items() if low <= latitude < low + 15])
        for low in (7.5, 37.5)
    )
    assert south > north + 0.3


def test_all_satellites_come_back():
    found = plain(D2.read(frames(JUDGED)).integrity)
    assert set(found) == {i.prn for i in JUDGED}
    for one in JUDGED:
        assert found[one.prn][:2] == (one.udrei, one.rurai)
        assert found[one.prn][2] == pytest.approx(one.correction_m, abs=1e-9, nan_ok=True)


def test_indices_mean_metres():
    told = Integrity(1, 7, 9)
    assert (told.udre_m, told.rura_m, told.usable) == (8.0, 6.0, True)
    assert math.isnan(Integrity(1, 14, 0).udre_m)
    assert math.isinf(Integrity(1, 0, 15).rura_m)
    assert [Integrity(1, u, r).usable for u, r in ((14, 14), (15, 0), (0, 15))] == [
        True,
        False,
        False,
    ]
    assert GridPoint(1, 2.0, 5).give_m == 1.8


def test_grid_points_lie_where_the_icd_has_them():
    assert [place_deg(n) for n in (1, 10, 11, 160, 161, 170, 320)] == [
        (10.0, 70.0),
        (55.0, 70.0),
        (10.0, 75.0),
        (55.0, 145.0),
        (7.5, 70.0),
        (52.5, 70.0),
        (52.5, 145.0),
    ]


def test_the_grid_comes_back():
    grid = [GridPoint(n, 0.125 * (n % 500), n % 16) for n in (*range(1, 161), 161, 320)]
    start = GnssTime.of_week(897, 43_200.0 - 43_200 % 360, "C")
    read = D2.read(frames(grid=grid, seconds=222.0, start=start)).grid
    found = {p.igp: (p.delay_m, p.givei) for p in read}
    assert found == {p.igp: (p.delay_m, p.givei) for p in grid}
    assert D2.read(frames(seconds=42.0, start=start)).grid == ()


def test_a_sky_sends_the_grid_of_its_ionosphere():
    """Overhead, where the model of the message gives the same delay."""
    made = sky(
        recording={"duration_s": 40.0}, signals=["B1I"], systems=["C"], ionosphere="klobuchar",
        start="2023-03-12T06:00:00", ionosphere_grid=True, navigation=str(MORNING),
        klobuchar_alpha=(2e-8, 1e-8, -1e-7, 0.0), klobuchar_beta=(1e5, 1e5, -1e5, 0.0),
    )  # fmt: skip
    track = satellite(made, "C", 3).track
    symbols = track.symbols(signal_spec("B1I"))
    found = D2.read(D2.decode(noisy_run(symbols, "D2", 3, 60.0), track.sky.start)).grid
    assert len(found) >= 13
    place = np.array([(*p.place_deg, 0.0) for p in found])
    up = np.tile([0.0, 90.0], (len(found), 1))
    instants = gpst_s(track.sky.start, np.zeros(len(found)))
    model = track.sky.propagation.klobuchar("C")
    expected = ionosphere_m(model, place, up, instants, signal_spec("B1I").carrier_hz)
    assert np.abs(expected - [p.delay_m for p in found]).max() <= 0.0625 + 1e-9
    assert np.ptp(expected) > 0.2


def test_a_point_that_is_not_monitored_is_told_as_such():
    bits = np.zeros(300, np.uint8)
    set_bits(bits, [51, 52, *range(61, 68)], 16)  # 2 m
    set_bits(bits, [68, 69, 70, 71], 5)
    set_bits(bits, [*range(72, 81)], 510)
    first, second, *_ = d2_integrity.read_grid(bits, 1, FRAME).grid
    assert (first.igp, first.delay_m, first.givei) == (1, 2.0, 5)
    assert second.igp == 2
    assert math.isnan(second.delay_m)


def test_without_judgements_the_message_is_as_ever():
    for frame in frames(seconds=18.0):
        if frame.number in (3, 4):
            assert not frame.bits[60:].any()
    assert D2.read(frames(seconds=18.0)).integrity == ()


def test_changes_are_told_once_and_in_order():
    good, bad = Integrity(6, 2, 3, 0.5), Integrity(6, 15, 3, 0.5)
    later = FRAME + 18.0
    told = [*frames([good], seconds=18.0), *frames([bad], start=later, seconds=18.0)]
    told += frames([good], start=later + 18.0, seconds=18.0)
    read = D2.read(told).integrity
    assert [i.usable for i in read] == [True, False, True]


def test_what_the_satellite_itself_found_wrong_is_not_read():
    def wrong(frame):
        bits = frame.bits.copy()
        set_bits(bits, [48, 49], 0b10)
        return replace(frame, bits=bits) if frame.number == 2 else frame

    assert D2.read([wrong(f) for f in frames(JUDGED)]).integrity == ()


def test_only_bds_satellites_are_judged():
    with pytest.raises(ValueError, match="only BDS"):
        sky(satellite=[{"prn": 5, "system": "G", "udrei": 3}])


def test_too_many_satellites_are_an_error():
    with pytest.raises(NavigationError, match="name fewer"):
        d2_integrity.slots([Integrity(prn, 0, 0) for prn in range(1, 20)])


def test_an_unusable_satellite_is_treated_as_an_unhealthy_one():
    observations = Sky("C", epochs=120, interval_s=1.0).observe()
    prn = next(s.prn for s in observations.signals if s.prn > 20)
    change = START + 60.0
    judged = Contents(
        integrity=(
            Integrity(prn, 2, 3, transmitted=START + -10.0),
            Integrity(prn, 15, 3, transmitted=change),
        )
    )
    known = Store(orbits(), judged)
    assert known.select("C", prn, START).healthy
    assert not known.select("C", prn, change + 30.0).healthy
    merged = Navigation(ephemerides=orbits().ephemerides, integrity=judged.integrity)
    fixes = pvt.solve(observations, merged, EXACT)
    column = next(n for n, s in enumerate(fixes.signals) if s.prn == prn)
    assert fixes.cause[0, column] == Cause.USED
    assert fixes.cause[-1, column] == Cause.UNHEALTHY


def test_from_a_sky_to_the_fix(tmp_path: Path):
    """C27 is unusable by what the geostationary satellites send."""
    made = sky(
        recording={"duration_s": 40.0, "sample_rate_hz": 10e6, "lo_hz": 1561.098e6},
        signals=["B1I"], systems=["C"], elevation_mask_deg=45.0,
        satellite=[{"prn": 27, "udrei": 15}, {"prn": 30, "udrei": 1, "correction_m": 1.5}],
    )  # fmt: skip
    log = simulate(made)
    found = locate(log, load_config(flags={"pvt.ionosphere": "none", "pvt.troposphere": "none"}))
    summary = summarise(found)
    assert "C27" not in summary.satellites
    assert "C30" in summary.satellites
    told = {j.satellite: j for j in summary.integrity}
    assert (told["C27"].usable, told["C27"].udre_m) == (False, None)
    assert (told["C30"].usable, told["C30"].udre_m, told["C30"].rura_m) == (True, 1.5, 0.75)
    assert told["C30"].correction_m == pytest.approx(1.5)
    assert any("C27" in text and "integrity" in text for text in sentences(summary))
    form = RecordingFormat(sample_format="ci8", sample_rate_hz=10e6, lo_hz=1561.098e6)
    write_result(tmp_path / "x.h5", Result("x", form, {}, navigation=found.navigation))
    again = read_result(tmp_path / "x.h5").navigation
    assert str(plain(again.integrity)) == str(plain(found.navigation.integrity))
