"""RINEX navigation files: read, written, and broken in every way."""

import math
from dataclasses import replace

import numpy as np
import pytest
from nav_air import FILE, NOON, navigation

from sdr_spoof.errors import NavigationError
from sdr_spoof.nav.broadcast import Bdgim, Contents, Klobuchar, TimeOffset, UtcParameters
from sdr_spoof.nav.rinex_nav import parse_navigation, read_navigation
from sdr_spoof.nav.rinex_nav_write import format_navigation
from sdr_spoof.nav.time import GnssTime

TEXT = FILE.read_text()
LINES = TEXT.split("\n")
HEADER = LINES[: next(n for n, line in enumerate(LINES) if "END OF HEADER" in line) + 1]
HEADER_3 = [
    f"{'     3.05           N: GNSS NAV DATA    M: MIXED':<60}RINEX VERSION / TYPE",
    f"{'GPSA   1.1176D-08  2.2352D-08 -5.9605D-08 -1.1921D-07 A 12':<60}IONOSPHERIC CORR",
    f"{'GPSB   1.1674D+05  1.8022D+05 -1.3107D+05 -4.5875D+05 A 12':<60}IONOSPHERIC CORR",
    f"{'BDSA   2.6077D-08  4.0978D-07 -4.4107D-06  7.8082D-06':<60}IONOSPHERIC CORR",
    f"{'BDUT -2.7939677238D-09 1.243449788D-14  14   897':<60}TIME SYSTEM CORR",
    f"{'    18    18  1929     7':<60}LEAP SECONDS",
    f"{'GPUT  9.3132257462D-10 8.881784197D-16 503808 2253':<60}TIME SYSTEM CORR",
    f"{'':<60}END OF HEADER",
]
RECORD_3 = [
    "C27 2023 03 12 12 00 00-3.241880331188e-04 1.465494392505e-11 0.000000000000e+00",
    "     1.000000000000e+00 1.042187500000e+01 3.690868025290e-09-2.553263499391e+00",
    "     2.803280949593e-07 5.316541064531e-04 6.664078682661e-06 5.282617059708e+03",
    "     4.320000000000e+04-3.771856427193e-08 2.096427087050e+00 2.095475792885e-08",
    "     9.600000000000e-01 2.244062500000e+02 5.111500000000e-01-6.953146718943e-09",
    "    -3.378712165600e-10 0.000000000000e+00 8.970000000000e+02 0.000000000000e+00",
    "     2.000000000000e+00 0.000000000000e+00-4.300000000000e-09-4.300000000000e-09",
    "     4.320000000000e+04 0.000000000000e+00",
]


def _file_3(*record: str) -> str:
    return "\n".join([*HEADER_3, *record]) + "\n"


def test_version_4() -> None:
    known = navigation()
    assert known.notes == ()
    assert {e.message for e in known.ephemerides} == {"LNAV", "D1", "D2"}
    first = next(e for e in known.ephemerides if (e.system, e.prn) == ("C", 27))
    assert first.toe.calendar("C").strftime("%Y-%m-%d %H") == "2023-03-12 11"
    assert math.sqrt(first.a) == pytest.approx(5282.617, abs=1.0)
    assert dict(first.group_delays_s) == {"B1I": -4.3e-9, "B2I": -4.3e-9}
    assert [type(i) for i in known.ionosphere] == [Klobuchar] * 3
    assert known.ionosphere[0].alpha[:3] == (
        3.259629011154e-08,
        7.450580596924e-09,
        -1.788139343262e-07,
    )
    assert (known.utc[0].leap_s, known.utc[0].a0) == (18, -3.725290298462e-09)


def test_version_3_with_its_header() -> None:
    known = parse_navigation(_file_3(*RECORD_3))
    (e,) = known.ephemerides
    assert (e.system, e.prn, e.message, e.iode) == ("C", 27, "D1", 1)
    assert e.toe == GnssTime.of_week(897, 43_200, "C")
    assert (e.crs, e.omega_dot, e.i0) == (10.421875, -6.953146718943e-09, 0.96)
    (gps,) = known.ionosphere
    assert (gps.system, gps.alpha[3], gps.beta[1]) == ("G", -1.1921e-07, 1.8022e5)
    bds, gps_utc = known.utc
    assert (gps_utc.system, gps_utc.reference) == ("G", GnssTime.of_week(2253, 503_808))
    assert (bds.system, bds.leap_s, bds.reference) == ("C", 4, GnssTime.of_week(897, 14, "C"))
    assert (bds.leap_week, bds.leap_day) == (573, 6)
    assert (gps_utc.leap_week, gps_utc.leap_day) == (1929, 7)
    assert known.notes == ()


def test_offsets_need_the_leap_seconds() -> None:
    text = _file_3(*RECORD_3).replace("LEAP SECONDS", "COMMENT     ")
    known = parse_navigation(text)
    assert known.utc == ()
    assert sum("leap seconds" in note for note in known.notes) == 2


def test_fortran_numbers_and_short_lines() -> None:
    record = [line.replace("e+", "D+").replace("e-", "d-") for line in RECORD_3]
    record[-1] = "     4.320000000000D+04"
    record[5] = "    -3.378712165600D-10"
    (e,) = parse_navigation(_file_3(*record)).ephemerides
    assert e.iodc == 0
    assert e.i_dot == -3.3787121656e-10


@pytest.mark.parametrize("version", ["3.05", "4.00"])
def test_what_is_written_is_read_back(version) -> None:
    known = navigation()
    bds = UtcParameters("C", 1e-9, 2e-15, GnssTime.of_week(897, 0, "C"), 4, 1000, 3, 4)
    contents = Contents(
        ephemerides=known.ephemerides,
        ionosphere=(
            *known.ionosphere,
            Klobuchar((1e-8, 2e-8, 3e-8, 4e-8), (1e5, 2e5, 3e5, 4e5), "C"),
        ),
        utc=(known.utc[0], bds),
    )
    back = parse_navigation(format_navigation(contents, version))
    assert back.notes == ()
    order = sorted(known.ephemerides, key=lambda e: (e.system, e.prn, e.toc, e.transmitted))
    assert len(back.ephemerides) == len(order)
    for written, read in zip(order, back.ephemerides, strict=True):
        assert read.a == pytest.approx(written.a, rel=1e-12)
        assert replace(read, a=written.a) == written
    assert {i.system for i in back.ionosphere} == {"G", "C"}
    assert {(u.system, u.leap_s) for u in back.utc} == {("G", 18), ("C", 4)}
    assert format_navigation(contents, version) == format_navigation(contents, version)


def test_b_cnav1_and_bdgim_in_version_4() -> None:
    e = navigation().ephemerides[0]
    modern = replace(
        next(x for x in navigation().ephemerides if x.system == "C"),
        message="CNV1",
        a_dot=0.0123,
        delta_n_dot=-3e-14,
        accuracy_m=math.nan,
        group_delays_s=(("B1CP", -1.5e-9), ("B1CD", -2.0e-9)),
        iode=37,
        iodc=805,
    )
    alpha = (20.25, -1.0, 3.5, 8.0, -2.25, 0.5, 1.0, -0.125, 0.25)
    offset = TimeOffset("C", "G", 1e-9, 2e-15, GnssTime.of_week(897, 3600, "C"))
    contents = Contents((e, modern), (Bdgim(alpha, "C", NOON),), (), (offset,))
    back = parse_navigation(format_navigation(contents))
    assert back.notes == ()
    (read,) = [x for x in back.ephemerides if x.message == "CNV1"]
    assert (read.a_dot, read.delta_n_dot, read.iode, read.iodc) == (0.0123, -3e-14, 37, 805)
    assert read.group_delay_s("B1CD") == pytest.approx(-2.0e-9)
    assert math.isnan(read.accuracy_m)
    assert back.ionosphere[0].alpha == alpha
    assert (back.offsets[0].other, back.offsets[0].a0) == ("G", 1e-9)
    assert "CNV1" not in format_navigation(contents, "3.05")
    with pytest.raises(ValueError, match="must be one of"):
        format_navigation(contents, "2.11")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "RINEX VERSION"),
        ("hello\n" * 30, "RINEX VERSION"),
        (TEXT.replace("     4.00  ", "     2.11  "), "version 3 or 4"),
        (TEXT.replace("NAVIGATION DATA     M", "OBSERVATION DATA    M"), "navigation file"),
        ("\n".join(HEADER[:-1]), "END OF HEADER"),
    ],
)
def test_files_that_are_none(text, told, tmp_path) -> None:
    path = tmp_path / "x.rnx"
    path.write_text(text)
    with pytest.raises(NavigationError, match=told):
        read_navigation(path)


def test_missing_files(tmp_path) -> None:
    with pytest.raises(NavigationError, match="cannot read"):
        read_navigation(tmp_path / "none.rnx")
    with pytest.raises(NavigationError, match="cannot read"):
        read_navigation(tmp_path)


@pytest.mark.parametrize(
    ("line", "change", "told"),
    [
        (0, lambda s: s.replace("2023", "20x3"), "whole number"),
        (0, lambda s: s.replace("2023 03", "2023 13"), "not a date"),
        (2, lambda s: s.replace("5.316541064531e-04", "5.316541064531e+04"), "e is 53165.4"),
        (2, lambda s: s.replace("5.282617059708e+03", "5.2826170597#8e+03"), "is not a number"),
        (3, lambda s: s.replace("4.320000000000e+04", "9.999999999999e+08"), "toe is"),
        (0, lambda s: s.replace("C27", "C77"), "does not send"),
        (4, lambda s: s.replace("9.600000000000e-01", "               nan"), "finite"),
        (7, lambda s: "", "lines, must have 8"),
    ],
)
def test_malformed_records_are_told_with_their_line(line, change, told) -> None:
    record = list(RECORD_3)
    record[line] = change(record[line])
    known = parse_navigation(_file_3(*record, *RECORD_3), "f.rnx")
    assert len(known.ephemerides) == 1
    (note,) = [n for n in known.notes if "line 9:" in n]
    assert note.startswith("f.rnx, line 9: record left out")
    assert told in note


def test_other_systems_are_counted() -> None:
    glonass = ["R01 2023 03 12 12 15 00 1.0e-04 0.0e+00 0.0e+00"] + ["     0.0"] * 3
    known = parse_navigation(_file_3(*glonass, *glonass, *RECORD_3))
    assert len(known.ephemerides) == 1
    assert any("2 records of system R are not used" in n for n in known.notes)


def test_dos_line_ends() -> None:
    known = parse_navigation(_file_3(*RECORD_3).replace("\n", "\r\n"))
    assert len(known.ephemerides) == 1


@pytest.mark.parametrize("seed", range(8))
def test_fuzzed_files_never_raise_anything_else(seed) -> None:
    rng = np.random.default_rng(seed)
    texts = [_file_3(*RECORD_3, *RECORD_3), "\n".join(LINES[:60]), "\n".join(LINES[-60:])]
    texts[2] = "\n".join(HEADER) + "\n" + texts[2]
    for text in texts:
        for _ in range(40):
            data = bytearray(text.encode())
            for _ in range(int(rng.integers(1, 30))):
                data[int(rng.integers(len(data)))] = int(rng.integers(256))
            if rng.random() < 0.5:
                del data[int(rng.integers(len(data))) :]
            try:
                known = parse_navigation(data.decode("latin-1"))
            except NavigationError:
                continue
            for e in known.ephemerides:
                assert 0 <= e.e < 0.5
                assert math.isfinite(e.a0 + e.toe.seconds)
