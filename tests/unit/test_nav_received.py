"""Subframes that satellites sent, and what another decoder says of them."""

import csv
from dataclasses import replace

import numpy as np
import pytest
from nav_air import VECTORS, signal_of

from sdr_spoof.nav import bch15, beidou_pages, d1, d2, lnav, lnav_pages, lnav_words
from sdr_spoof.nav.beidou_framing import NUMBER, SOW
from sdr_spoof.nav.bits import bits_of
from sdr_spoof.nav.broadcast import Broadcast
from sdr_spoof.nav.messages import MESSAGES
from sdr_spoof.nav.records import SymbolRun
from sdr_spoof.nav.time import GnssTime


def _subframes(message, satellite=None):
    with (VECTORS / "subframes.csv").open() as file:
        rows = [r for r in csv.DictReader(file) if r["message"] == message]
    bits = [
        np.concatenate([bits_of(int(word, 16), 30) for word in row["words"].split()])
        for row in rows
        if satellite is None or row["satellite"] == satellite
    ]
    return np.array(bits, dtype=np.uint8)


def _run(message, prn, bits):
    encoder = MESSAGES[message]
    symbols = encoder.to_symbols(bits.copy()).reshape(-1)
    k = np.arange(symbols.size)
    values = symbols.astype(np.float32)
    return SymbolRun(
        signal_of(message), prn, 1.0 * k, k * encoder.symbol_s, values, encoder.symbol_s
    )


@pytest.mark.parametrize(("message", "count"), [("D1", 28), ("D2", 148), ("LNAV", 8)])
def test_parity_is_that_of_the_satellites(message, count) -> None:
    bits = _subframes(message)
    assert len(bits) == count
    again = bits.copy()
    (lnav_words if message == "LNAV" else bch15).encode(again)
    assert (again == bits).all()


def test_time_and_pages_of_d1_go_together() -> None:
    for bits in _subframes("D1"):
        index = MESSAGES["D1"].index(SOW.raw(bits), NUMBER.raw(bits))
        assert index is not None
        if index % 5 >= 3:
            assert beidou_pages.PAGE.raw(bits) == index // 5 % d1.PAGES + 1


def test_time_and_pages_of_d2_go_together() -> None:
    bits = _subframes("D2")
    fields = {1: (d2.BASIC_PAGE, 10), 2: (d2.INTEGRITY_PAGE, 6), 5: (beidou_pages.PAGE, 120)}
    seen = set()
    for row in bits:
        sow, number = SOW.raw(row), NUMBER.raw(row)
        assert MESSAGES["D2"].index(sow, number) == sow // 3 * 5 + number - 1
        if number in fields:
            field, pages = fields[number]
            assert field.raw(row) == sow // 3 % pages + 1
            seen.add((number, field.raw(row)))
    assert len(seen) == 10 + 6 + 120


def _assert_orbit(e, expected):
    for name, value in expected.items():
        got = np.sqrt(e.a) if name == "sqrt_a" else getattr(e, name)
        # Published with nine digits or more.
        assert got == pytest.approx(value, rel=2e-8), name


def test_d1_ephemeris() -> None:
    bits = _subframes("D1")
    first = [b for b in bits if NUMBER.raw(b) <= 3]
    order = np.array([*first, bits[3]])
    start = GnssTime.of_week(810, 345_600, "C")
    contents = MESSAGES["D1"].read(MESSAGES["D1"].decode(_run("D1", 6, order)))
    (e,) = contents.ephemerides
    assert (e.toe, e.toc, e.transmitted) == (start, start, start)
    assert (e.iode, e.iodc, e.health, e.accuracy_m) == (1, 0, 0, 2.0)
    assert dict(e.group_delays_s) == pytest.approx({"B1I": 8.2e-9, "B2I": -1.9e-9})
    _assert_orbit(
        e,
        {
            "cus": 2.102460712194442749e-05,
            "cuc": -4.5062042772769927979e-06,
            "crc": -4.04640625e02,
            "crs": -1.43203125e02,
            "cic": 7.91624188e-08,
            "cis": -3.39932740e-08,
            "m0": -8.5672685685526606125e-02,
            "delta_n": 1.20183578e-09,
            "e": 1.1284291860647499561e-02,
            "a": 4.2170134522822760046e07,
            "omega0": -1.9160860634641034839,
            "i0": 9.450732988963341796e-01,
            "omega": -2.1772769963262814663,
            "omega_dot": -1.78078846e-09,
            "i_dot": 4.37518224e-10,
            "a0": 6.2543887179344892502e-04,
            "a1": 4.82804907e-11,
            "a2": 0.0,
        },
    )
    (model,) = contents.ionosphere
    assert model.alpha == pytest.approx((6.519258e-09, 2.0**-25, -10 * 2.0**-25, 14 * 2.0**-25))
    assert model.beta == (112_640, 180_224, -524_288, 458_752)
    # Sent again it is the same, bit by bit.
    again = MESSAGES["D1"].encode(Broadcast(e, klobuchar=model), start, 18.0)
    assert (again == MESSAGES["D1"].to_symbols(np.array(first)).reshape(-1)).all()


def test_d2_ephemeris_and_pages() -> None:
    message = MESSAGES["D2"]
    received = _subframes("D2")
    (any_frame,) = message.decode(_run("D2", 1, received[:1]))
    frames = []
    for bits in received:
        index = message.index(SOW.raw(bits), NUMBER.raw(bits))
        sent = message.start(810, index)
        page, number = message.page(index, bits), NUMBER.raw(bits)
        frames.append(
            replace(any_frame, transmitted=sent, page=page, number=number, bits=bits, ok=True)
        )
    contents = message.read(sorted(frames, key=lambda f: f.transmitted))
    (e,) = contents.ephemerides
    assert e.toe == GnssTime.of_week(810, 345_600, "C")
    assert dict(e.group_delays_s) == pytest.approx({"B1I": -5.6e-9, "B2I": -1.01e-8})
    _assert_orbit(
        e,
        {
            "cus": -7.9278834164142608643e-06,
            "cuc": -1.6712117940187454224e-05,
            "crc": 2.45484375e02,
            "crs": -5.05640625e02,
            "cic": -2.10944563e-07,
            "cis": 8.05594027e-08,
            "m0": -1.916523214107468176,
            "delta_n": -6.54670127e-10,
            "e": 6.1676383484154939651e-04,
            "a": 4.2164428143935076892e07,
            "omega0": -3.1259749468667630268,
            "i0": 8.6141192515002310004e-02,
            "omega": 1.3510960489050376498,
            "omega_dot": 1.69721355e-09,
            "i_dot": 3.9573076900000001079e-10,
            "a0": -2.7373037301003932953e-04,
            "a1": 3.71924713e-11,
        },
    )
    (model,) = contents.ionosphere
    assert model.beta == (112_640, 180_224, -524_288, 458_752)
    assert len(dict(contents.health)) == 30  # no expanded almanac was sent
    assert {a.prn for a in contents.almanacs} >= {1, 2, 3, 4, 5, 6, 11, 19}
    for coarse in contents.almanacs:
        low = 4.1e7 if coarse.prn in (*range(1, 11), 13, 16) else 2.7e7
        assert low < coarse.a < 4.25e7
    own = next(a for a in contents.almanacs if a.prn == 1)
    assert own.a == pytest.approx(e.a, rel=1e-4)
    (utc,) = contents.utc
    assert (utc.leap_s, utc.leap_future_s) == (4, 4)


def test_lnav_ephemeris() -> None:
    bits = _subframes("LNAV", "G04")
    message = MESSAGES["LNAV"]
    near = GnssTime.of_week(1869, 0)
    frames = message.decode(_run("LNAV", 4, bits), near)
    assert [f.ok for f in frames] == [True] * 3
    assert frames[0].transmitted == near
    (e,) = message.read(frames).ephemerides
    assert e.group_delay_s("L1CA") == pytest.approx(-6.519258e-09, rel=1e-7)
    _assert_orbit(
        e,
        {
            "cuc": -4.73111868e-07,
            "cus": 8.9444220066070556641e-06,
            "crc": 1.97843750e02,
            "crs": -6.625,
            "cis": -2.14204192e-07,
            "cic": -2.2910535335540771484e-07,
            "m0": 1.6427405986254530745,
            "delta_n": 4.92949105e-09,
            "e": 0.012018375913612544537,
            "sqrt_a": 5153.6434803009033203,
            "omega0": 1.4502525982818956773,
            "i0": 0.9404723483911350268,
            "omega": 1.1153119288528794417,
            "omega_dot": -8.27748765e-09,
            "i_dot": 3.90730561e-10,
            "a0": -4.0083192288875579834e-05,
            "a1": -5.34328137e-12,
        },
    )


def test_lnav_pages() -> None:
    now = GnssTime.of_week(1869, 400)
    pages = {lnav_pages.PAGE_ID.raw(b): b for b in _subframes("LNAV", "G01")}
    assert set(pages) == {25, 26, 51, 56, 63}
    (coarse,) = lnav_pages.read(pages[25], now).almanacs
    _assert_orbit(
        coarse,
        {
            "m0": 1.714684548614031856,
            "e": 0.004675388336181640625,
            "sqrt_a": 5153.56005859375,
            "omega0": -0.62474775600600196412,
            "i0": 0.3 * 3.1415926535898 + 0.036186367101724167816,
            "omega": 0.72259183672470084225,
            "omega_dot": -7.92032991e-09,
            "a0": -6.103515625e-05,
            "a1": -3.63797881e-12,
        },
    )
    assert coarse.toe.week_tow()[1] == 147_456
    health = dict(lnav_pages.read(pages[51], now).health)
    health |= dict(lnav_pages.read(pages[63], now).health)
    assert len(health) == 32
    contents = lnav_pages.read(pages[56], now)
    (utc,) = contents.utc
    assert (utc.leap_s, utc.leap_future_s, utc.leap_day) == (17, 17, 3)
    for ident, bits in pages.items():
        # The page is where the schedule has it.
        place = lnav_pages.slot(lnav.NUMBER.raw(bits), (lnav.TOW.raw(bits) - 1) // 5 % 25 + 1)
        assert place.ident == ident
