"""RINEX observation files: our own read back, those of others, and damaged ones."""

from __future__ import annotations

import gzip
import random
import re
from pathlib import Path

import numpy as np
import pytest
from observed_sky import Sky

from sdr_spoof.errors import ObservationError
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.sinks.rinex_obs import write_rinex_obs
from sdr_spoof.sources.observed import open_observations
from sdr_spoof.sources.observed.rinex import parse

VALUES = ("pseudorange_m", "carrier_phase_cycles", "doppler_hz", "cn0_dbhz")


@pytest.fixture(scope="module")
def seen():
    sky = Sky("CG", {"C": ("B1I", "B1CP"), "G": ("L1CA",)}, epochs=5, interval_s=0.2)
    return sky.observe()


@pytest.fixture(scope="module")
def written(seen, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("rinex") / "ours.rnx"
    write_rinex_obs(path, seen, position_m=np.array([1.0, 2.0, 3.5]))
    return path


@pytest.fixture(scope="module")
def text(written) -> str:
    return written.read_text(encoding="ascii")


def test_what_we_write_comes_back(seen, written):
    read = open_observations(written)
    found = read.observations
    assert found.reference == seen.reference and found.interval_s == pytest.approx(0.2)
    np.testing.assert_allclose(found.time_s, seen.time_s, atol=1e-9)
    assert read.position_m is not None and read.position_m.tolist() == [1.0, 2.0, 3.5]
    column = {s: k for k, s in enumerate(seen.signals)}
    assert set(found.signals) == set(seen.signals) and list(found.signals) == sorted(found.signals)
    order = [column[s] for s in found.signals]
    for name in VALUES:
        theirs = getattr(seen, name)[:, order]
        np.testing.assert_allclose(getattr(found, name), theirs, atol=0.00051, err_msg=name)
    assert found.lock_lost[0].all() and not found.lock_lost[1:].any()


HEADER = """\
     3.02           OBSERVATION DATA    M                   RINEX VERSION / TYPE
C    4 C1I L1I D1I S1I                                      SYS / # / OBS TYPES
G    2 C1C L1C                                              SYS / # / OBS TYPES
E    2 C1C L1C                                              SYS / # / OBS TYPES
G   10   1 L1C                                              SYS / SCALE FACTOR
  2023     3    12    12     0    0.0000000     BDT         TIME OF FIRST OBS
                                                            END OF HEADER
"""
BODY = """\
> 2023 03 12 12 00  0.0000000  0  3
C21  21000000.125 7 109000000.25027     -1234.500          44.250
G05  22000000.250 61156000000.500 6
E11  23000000.000
> 2023 03 12 12 00  1.0000000  4  1
comment                                                     COMMENT
> 2023 03 12 12 00  1.0000000  0  1
C21  21000000.125 7         0.000       -1234.500          44.250
> 2023 03 12 12 00  2.0000000  1  2
C21  21000000.125 7 109000000.250 7     -1234.500          44.250
G05  22000000.250 61156000000.500 6
"""


def test_files_of_others():
    """Version 3.02 calls B1I 1I; times are BDT; scale factors, events and power failures."""
    read = parse(HEADER + BODY)
    found = read.observations
    assert [s.satellite for s in found.signals] == ["C21", "G05"]
    assert found.time(0) == GnssTime.of_week(897, 43200.0, "C")
    assert found.time_s.tolist() == [0.0, 1.0, 2.0]
    assert found.carrier_phase_cycles[0].tolist() == [109000000.25, 115600000.05]
    assert np.isnan(found.carrier_phase_cycles[1]).all()
    assert found.cn0_dbhz[0].tolist() == [44.25, 39.0]
    assert found.lock_lost[:, 0].tolist() == [True, False, True]
    assert found.half_cycle[:, 0].tolist() == [True, False, False]
    assert any("system E" in note for note in read.notes)


def test_gzip(seen, written, tmp_path):
    path = tmp_path / "ours.rnx.gz"
    path.write_bytes(gzip.compress(written.read_bytes()))
    found = open_observations(path).observations
    assert found.epochs == seen.epochs
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(ObservationError, match="fetch it again"):
        open_observations(path)


def broken(old: str, new: str) -> str:
    assert old in HEADER + BODY
    return (HEADER + BODY).replace(old, new, 1)


@pytest.mark.parametrize(
    ("damaged", "line", "why"),
    [
        (broken("     3.02", "     2.11"), 1, "is RINEX 2.11 of type 'O'; give an observation"),
        (broken("OBSERVATION DATA", "NAVIGATION  DATA"), 1, "of type 'N'"),
        (broken("RINEX VERSION / TYPE", "CRINEX VERS   / TYPE"), 1, "expand it with CRX2RNX"),
        ("what is this", 1, "does not begin with"),
        (HEADER[:200], 3, "ends within its header"),
        (broken("C    4 C1I", "C    5 C1I"), 3, "has 4 observation types, the header says 5"),
        (broken("BDT ", "XYZ "), 6, "time system 'XYZ'"),
        (HEADER, 7, "the file has no epoch"),
        (HEADER + BODY[:60], 9, "ends within an epoch; it is cut off"),
        (broken("-1234.500", "-12x4.500"), 9, "'-12x4.500' in column 36 is not a number"),
        (broken("0.25027", "0.250a7"), 9, "indicator 'a' is not a digit"),
        (broken("> 2023 03 12 12 00  0", "> 2023 03 32 12 00  0"), 8, "is not a date"),
        (broken("00  2.0000000", "00  1.0000000"), 16, "not later than the one before"),
        (broken("  0  3\n", "  0  2\n"), 11, "stands where an epoch"),
        (broken("  0  3\n", "  0  x\n"), 8, "flag and number of satellites"),
        (broken("G05 ", "X05 "), 10, "'X05' is not a satellite of the header's systems"),
        (broken("C21 ", "C99 "), 9, "there is no satellite C99 that sends B1I"),
        (broken("E11  23000000.000", "E11  23000000.000" + "9" * 60), 11, "more values than"),
        (broken("E11 ", "C21 "), 11, "satellite C21 comes twice"),
    ],
)
def test_damage_is_named_with_its_line(damaged, line, why):
    with pytest.raises(ObservationError, match=rf"^file, line {line}: .*{re.escape(why)}"):
        parse(damaged, "file")


def test_no_known_signal(tmp_path):
    only_galileo = HEADER + "\n".join(
        ["> 2023 03 12 12 00  0.0000000  0  1", "E11  23000000.000", ""]
    )
    with pytest.raises(ObservationError, match="no signal that the registry knows"):
        parse(only_galileo)
    with pytest.raises(ObservationError, match="does not exist; name a RINEX"):
        open_observations(tmp_path / "none.rnx")
    with pytest.raises(ObservationError, match="is a folder"):
        open_observations(tmp_path)


@pytest.mark.parametrize("seed", range(8))
def test_fuzzed_files_are_read_or_refused(text, seed):
    draw = random.Random(seed)
    base = (HEADER + BODY) if seed % 2 else text
    for _ in range(25):
        data = list(base)
        for _ in range(draw.choice([1, 3, 30])):
            at = draw.randrange(len(data))
            kind = draw.randrange(4)
            if kind == 0:
                data[at] = chr(draw.randrange(256))
            elif kind == 1:
                del data[at : at + draw.choice([1, 5, 200])]
            elif kind == 2:
                data[at:at] = data[at : at + draw.choice([1, 16, 80])]
            else:
                data[at] = draw.choice("0123456789 -.\n>")
        try:
            found = parse("".join(data)).observations
        except ObservationError:
            continue
        assert found.pseudorange_m.shape == (found.epochs, len(found.signals))
