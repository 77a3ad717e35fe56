"""LNAV, D1 and D2 both ways: every quantity comes back within its quantum."""

from dataclasses import replace

import numpy as np
import pytest
from nav_air import KLOBUCHAR, NOON, air, content, navigation, signal_of

from sdr_spoof.errors import NavigationError
from sdr_spoof.nav import d1, d2, keplerian, lnav
from sdr_spoof.nav.beidou_satellites import GEO
from sdr_spoof.nav.bits import number_of
from sdr_spoof.nav.broadcast import Broadcast, TimeOffset
from sdr_spoof.nav.messages import MESSAGES, message_on
from sdr_spoof.nav.plausible import objection
from sdr_spoof.nav.records import SymbolRun
from sdr_spoof.nav.time import GnssTime

SETS = {
    "D1": (d1.CLOCK, d1.ORBIT_2, d1.ORBIT_3),
    "D2": (d2.BASIC,),
    "LNAV": (lnav.CLOCK, lnav.ORBIT_2, lnav.ORBIT_3),
}
WHOLE = {"D1": 2160.5, "D2": 1080.5, "LNAV": 750.5}
"""Length of all pages, s."""


def _quanta(message):
    fields = (f for part in SETS[message] for f in part.fields)
    return {f.name: f.scale for f in fields}


def _read(message, prn, start, duration_s, data=None, near=None):
    encoder = MESSAGES[message]
    symbols = encoder.encode(data or content(prn, message, start), start, duration_s)
    k = np.arange(symbols.size)
    run = SymbolRun(
        signal_of(message), prn, k * 1.0, k * encoder.symbol_s, symbols * 1.0, encoder.symbol_s
    )
    frames = encoder.decode(run, near)
    return frames, encoder.read(frames)


@pytest.mark.parametrize("message", ["D1", "D2", "LNAV"])
def test_every_ephemeris_of_the_file_comes_back(message) -> None:
    known = {e.prn: e for e in navigation().ephemerides if e.message == message}
    assert len(known) == {"D1": 37, "D2": 7, "LNAV": 32}[message]
    quanta = _quanta(message)
    for prn, e in sorted(known.items()):
        start = e.toe + -600.0
        start = GnssTime(start.seconds - start.seconds % 30 + (14 if e.system == "C" else 0))
        start = start + (e.toe.seconds % 30) * 0.0
        _, contents = _read(message, prn, start, 32.0, Broadcast(e))
        (back,) = contents.ephemerides
        sent, got = keplerian.values(e), keplerian.values(back)
        for name in sent:
            if name in quanta and name not in ("sqrt_a",):
                assert got[name] == pytest.approx(sent[name], abs=0.51 * quanta[name]), name
        assert got["sqrt_a"] == pytest.approx(sent["sqrt_a"], abs=0.51 * quanta["sqrt_a"])
        assert (back.toe, back.toc) == (e.toe, e.toc)
        assert (back.iode, back.iodc, back.health) == (e.iode, e.iodc, e.health)
        assert (back.system, back.prn, back.message) == (e.system, e.prn, message)
        for signal, delay in e.group_delays_s:
            assert back.group_delay_s(signal) == pytest.approx(delay, abs=0.51e-10 + 2.0**-32)
        # What was decoded is sent again without any change.
        again = MESSAGES[message].encode(Broadcast(back), start, 32.0)
        assert (again == MESSAGES[message].encode(Broadcast(e), start, 32.0)).all()


@pytest.mark.parametrize(("message", "prn"), [("D1", 27), ("D2", 3), ("LNAV", 12)])
def test_all_pages(message, prn) -> None:
    encoder = MESSAGES[message]
    system = encoder.system
    data = content(prn, message)
    start_of_week = GnssTime.of_week(NOON.week_tow("C")[0], 0, "C")
    offset = TimeOffset("C", "G", 12.3e-9, -4e-10, start_of_week)
    if system == "C":
        data = replace(data, offsets=(offset,), health=(("C27", 0x40),))
    frames, contents = _read(message, prn, NOON, WHOLE[message], data)
    assert all(f.ok and f.week_known for f in frames[:-1])
    (model,) = contents.ionosphere
    assert model.system == system
    assert model.alpha == pytest.approx(KLOBUCHAR[system].alpha, abs=3e-8 * 2)
    assert model.alpha[0] == pytest.approx(1.1e-8, abs=2.0**-31)
    assert model.beta == pytest.approx(KLOBUCHAR[system].beta, abs=2.0**15)
    (utc,) = contents.utc
    assert utc.leap_s == data.utc.leap_s
    assert utc.leap_week == data.utc.leap_week
    assert utc.a0 + utc.a1 * (NOON - utc.reference) == pytest.approx(
        data.utc.a0 + data.utc.a1 * (NOON - data.utc.reference), abs=2.0**-30
    )
    known = {e.prn for e in data.ephemerides if e.system == system}
    assert {a.prn for a in contents.almanacs} == known
    health = dict(contents.health)
    if system == "C":
        (back,) = contents.offsets
        assert (back.other, back.a0) == ("G", pytest.approx(12.3e-9, abs=0.5e-10))
        assert health["C27"] == 0x40
        assert len(health) == 63
        assert all((health[f"C{p:02d}"] == 0x1FF) == (p not in known) for p in range(1, 64))
    else:
        assert health == {f"G{p:02d}": content(p, "LNAV").ephemeris.health for p in range(1, 33)}


@pytest.mark.parametrize(("message", "prn"), [("D1", 27), ("D2", 3), ("LNAV", 12)])
def test_almanacs_are_the_orbits(message, prn) -> None:
    _, contents = _read(message, prn, NOON, WHOLE[message])
    for almanac in contents.almanacs:
        e = content(almanac.prn, message, almanac.transmitted).ephemeris
        assert almanac.a == pytest.approx(e.a, rel=3e-6)
        assert almanac.i0 == pytest.approx(e.i0, abs=2e-5)
        # Argument of latitude in an Earth-fixed frame at the almanac's time of reference.
        motion = np.sqrt(3.986004418e14 / e.a**3) + e.delta_n
        later = almanac.toe - e.toe
        turned = almanac.omega + almanac.m0 - (e.omega + e.m0 + motion * later)
        assert np.cos(turned) > 1 - 1e-8


@pytest.mark.parametrize("prn", range(1, 64))
def test_all_beidou_satellites_send_one_message(prn) -> None:
    message = message_on("B1I", prn)
    assert message is not None
    assert message.name == ("D2" if prn in GEO else "D1")
    e = replace(content(3 if prn in GEO else 27, message.name).ephemeris, prn=prn)
    frames, contents = _read(message.name, prn, NOON, 36.5, Broadcast(e))
    assert {f.prn for f in frames} == {prn}
    assert contents.ephemerides[0].prn == prn


def test_no_other_message_is_claimed() -> None:
    assert message_on("L1CA", 12).name == "LNAV"
    assert message_on("L1CA", 120) is None
    assert message_on("B1CP", 27) is None
    assert message_on("B1I", 64) is None


def test_a_subframe_of_d1_as_the_icd_draws_it() -> None:
    data = content(27)
    start = GnssTime.of_week(897, 43_200, "C")
    symbols = MESSAGES["D1"].encode(data, start, 6.0)
    bits = (symbols < 0).astype(np.uint8)
    assert number_of(bits[:11]) == 0b11100010010
    assert number_of(bits[15:18]) == 1  # FraID
    sow = number_of(bits[18:26])
    # The second word is interleaved: its 22 information bits are at even, then odd places.
    word = np.concatenate([bits[30:52:2], bits[31:53:2]])
    assert sow << 12 | number_of(word[:12]) == 43_200
    assert word[12] == data.ephemeris.health
    assert number_of(word[13:18]) == data.ephemeris.iodc


def test_a_subframe_of_lnav_as_the_icd_draws_it() -> None:
    start = GnssTime.of_week(2253, 43_200)
    bits = (MESSAGES["LNAV"].encode(content(12, "LNAV"), start, 6.0) < 0).astype(np.uint8)
    assert number_of(bits[:8]) == 0b10001011
    hand_over = bits[30:60] ^ np.append(np.full(24, bits[29]), np.zeros(6, np.uint8))
    assert number_of(hand_over[:17]) == 43_206 // 6
    assert number_of(hand_over[19:22]) == 1
    assert hand_over[28:].tolist() == [0, 0]
    third = bits[60:90] ^ np.append(np.full(24, bits[59]), np.zeros(6, np.uint8))
    assert number_of(third[:10]) == 2253 % 1024


@pytest.mark.parametrize("message", ["D1", "D2", "LNAV"])
def test_symbols_do_not_depend_on_where_encoding_starts(message) -> None:
    prn = {"D1": 27, "D2": 3, "LNAV": 12}[message]
    encoder, data = MESSAGES[message], content(prn, message)
    whole = encoder.encode(data, NOON, 40.0)
    assert whole.dtype == np.int8
    assert whole.size == round(40.0 / encoder.symbol_s)
    assert set(np.unique(whole)) == {-1, 1}
    part = encoder.encode(data, NOON + 12.34, 20.0)
    first = round(12.34 / encoder.symbol_s)
    assert (part == whole[first : first + part.size]).all()
    with pytest.raises(NavigationError, match="whole multiple"):
        encoder.encode(data, NOON + 0.0011, 1.0)


@pytest.mark.parametrize(
    ("message", "prn", "week", "near_week"),
    [
        ("D1", 27, 8191, 8191),
        ("D1", 27, 8192, 8191),
        ("D2", 3, 8191, 8192),
        ("LNAV", 12, 1023, 1024),
        ("LNAV", 12, 2047, 2048),
        ("LNAV", 12, 3071, 3072),
    ],
)
def test_weeks_roll_over(message, prn, week, near_week) -> None:
    system = MESSAGES[message].system
    start = GnssTime.of_week(week, 604_800 - 45, system)
    near = GnssTime.of_week(near_week, 7000, system)
    old = content(prn, message).ephemeris
    toe = GnssTime.of_week(week + 1, 0, system)
    e = replace(old, toe=toe, toc=toe, transmitted=start)
    frames, contents = _read(message, prn, start, 90.6, Broadcast(e), near)
    assert [f.transmitted - start - f.time_s for f in frames] == pytest.approx(
        [0.0] * len(frames), abs=1e-9
    )
    assert {f.transmitted.week_tow(system)[0] for f in frames} == {week, week + 1}
    assert {x.toe for x in contents.ephemerides} == {toe}


def test_without_a_date_the_era_is_ours() -> None:
    for week, system, message, prn in ((2253, "G", "LNAV", 12), (897, "C", "D1", 27)):
        start = GnssTime.of_week(week, 100_000 - 100_000 % 30, system)
        frames, _ = _read(message, prn, start, 12.5)
        assert frames[0].transmitted == start


@pytest.mark.parametrize("value", [{"e": 1.2}, {"crs": 5e4}, {"a0": float("nan")}, {"iode": 77}])
def test_what_does_not_fit_is_told(value) -> None:
    data = content(27)
    with pytest.raises(NavigationError, match="does not fit"):
        MESSAGES["D1"].encode(replace(data, ephemeris=replace(data.ephemeris, **value)), NOON, 30.0)


def test_unhealthy_satellites_say_so() -> None:
    for message, prn in (("D1", 27), ("D2", 3), ("LNAV", 12)):
        data = content(prn, message)
        sick = replace(data, ephemeris=replace(data.ephemeris, health=1))
        _, contents = _read(message, prn, NOON, 36.5, sick)
        assert contents.ephemerides[0].health == 1


@pytest.mark.parametrize("message", ["D1", "D2", "LNAV"])
def test_whatever_bits_say_nothing_is_raised(message) -> None:
    prn = {"D1": 27, "D2": 3, "LNAV": 12}[message]
    encoder = MESSAGES[message]
    frames, _ = _read(message, prn, NOON, 33.0, near=NOON)
    rng = np.random.default_rng(12)
    garbled = []
    for n in range(400):
        bits = rng.integers(0, 2, 300).astype(np.uint8)
        if n % 4 == 0:
            bits[:] = n // 4 % 2
        page = int(rng.integers(0, 128))
        number = int(rng.integers(1, 6))
        frame = replace(frames[n % 5], bits=bits, number=number, page=page, ok=True)
        garbled.append(replace(frame, transmitted=NOON + 0.6 * n))
    contents = encoder.read(garbled)
    for e in contents.ephemerides:
        assert objection(e) is None or isinstance(objection(e), str)


def test_frames_of_different_hours_are_not_mixed() -> None:
    hour = GnssTime.of_week(897, 12 * 3600, "C")
    old, new = content(27, at=hour), content(27, at=hour + 3600.0)
    encoder = MESSAGES["D1"]
    symbols = np.concatenate(
        [encoder.encode(old, hour + -18.0, 18.0), encoder.encode(new, hour, 40.0)]
    )
    run = replace(air("D1", 27, NOON, 58.0), values=symbols.astype(np.float32))
    contents = encoder.read(encoder.decode(run))
    assert [e.toe for e in contents.ephemerides] == [new.ephemeris.toe]
