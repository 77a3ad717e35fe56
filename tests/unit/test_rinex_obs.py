"""Our RINEX observation files, read back by georinex."""

from __future__ import annotations

from dataclasses import replace

import georinex
import numpy as np
import pytest
from observed_tracks import Moving, navigation, observed_log

from sdr_spoof.errors import OutputError
from sdr_spoof.observables import ClockPiece, ObservablesConfig, ReceiverClock, observe
from sdr_spoof.records import SatelliteVerdict, Verdict
from sdr_spoof.sinks.rinex_obs import UNSETTLED_M, write_rinex_obs
from sdr_spoof.sources.observed import rinex
from sdr_spoof.studies.gaps import BEGIN, SKIES, Case, received

SKY = (
    Moving(27, 0.0781234, signals=("B1I", "B1CP", "B1CD")),
    Moving(30, 0.0710077, -3000.0, 1.0, lost=((8.0, 11.0),)),
    Moving(3, 0.1251, 10.0, 0.1, signals=("B1I",)),
    Moving(12, 0.0721, 900.0, signals=("L1CA",)),
)
PLACE = np.array([-2_850_000.25, 4_650_000.5, 3_290_000.125])


@pytest.fixture(scope="module")
def seen():
    return observe(observed_log(*SKY), navigation(*SKY), ObservablesConfig(rate_hz=2))


@pytest.fixture(scope="module")
def written(seen, tmp_path_factory):
    path = tmp_path_factory.mktemp("rinex") / "ours.rnx"
    write_rinex_obs(path, seen, position_m=PLACE)
    return path


def settled_m(seen):
    """Pseudoranges that a file holds."""
    return np.where(seen.unsettled_m > UNSETTLED_M, np.nan, seen.pseudorange_m)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("system", ["C", "G"])
def test_georinex_reads_every_value_back(seen, written, system):
    read = georinex.load(written, use=system)
    quantities = {
        "C": settled_m(seen),
        "L": seen.carrier_phase_cycles,
        "D": seen.doppler_hz,
        "S": seen.cn0_dbhz,
    }
    rinex = {"B1I": "2I", "B1CP": "1P", "B1CD": "1D", "L1CA": "1C"}
    compared = 0
    for i, signal in enumerate(seen.signals):
        if signal.system != system:
            continue
        for letter, values in quantities.items():
            theirs = read[letter + rinex[signal.signal]].sel(sv=signal.satellite).values
            ours = values[:, i]
            assert np.array_equal(np.isfinite(theirs), np.isfinite(ours))
            assert np.nanmax(np.abs(theirs - ours)) <= 0.00051
            compared += 1
    assert compared == 4 * (6 if system == "C" else 1)
    first = seen.time(0).calendar().replace(tzinfo=None)
    assert abs((read.time.values[0] - np.datetime64(first)) / np.timedelta64(1, "us")) < 1
    assert read.sizes["time"] == seen.epochs


@pytest.mark.filterwarnings("ignore")
def test_header_says_where_and_when(written):
    header = georinex.rinexheader(written)
    assert header["version"] == 3.05
    assert np.allclose(header["position"], PLACE)
    assert header["fields"]["C"] == [kind + code for code in ("2I", "1D", "1P") for kind in "CLDS"]
    assert float(header["INTERVAL"]) == 0.5


def test_every_line_is_as_long_as_rinex_allows(written):
    lines = written.read_text(encoding="ascii").splitlines()
    header = lines[: lines.index(next(x for x in lines if x.endswith("END OF HEADER")))]
    assert all(len(line) <= 80 and line[60:].strip() for line in header)
    shifts = [line for line in header if "PHASE SHIFT" in line]
    assert [s[:14] for s in shifts] == [
        "C L2I  0.00000",
        "C L1D  0.00000",
        "C L1P  0.25000",
        "G L1C  0.00000",
    ]


def test_flags_of_lock_and_half_cycles(seen, written):
    first = written.read_text(encoding="ascii").split("END OF HEADER\n")[1].splitlines()
    row = next(line for line in first if line.startswith("C03"))
    # Lock begins; the message told the sign.
    assert row[3 + 16 : 3 + 32].endswith("17")
    blind = observe(observed_log(SKY[2]), navigation(SKY[2]))
    assert not blind.half_cycle.any()


def test_spoofed_satellites_are_left_out_and_named(seen, tmp_path):
    verdict = Verdict(True, (SatelliteVerdict(27, "spoofed", (), "", onset_s=8.0),), "")
    flagged = observe(observed_log(*SKY), navigation(*SKY), verdict=verdict)
    path = tmp_path / "a.rnx"
    write_rinex_obs(path, flagged)
    text = path.read_text(encoding="ascii")
    assert f"C27 left out as spoofed from {flagged.reference.calendar():%Y-%m-%d}" in text
    before = np.count_nonzero(flagged.sample_time_s < 8.0)
    assert text.count("\nC27") == before + 1  # and the comment
    write_rinex_obs(path, flagged, keep_spoofed=True, force=True)
    assert path.read_text(encoding="ascii").count("\nC27") == flagged.epochs


def test_the_same_observations_give_the_same_bytes(seen, written, tmp_path):
    path = tmp_path / "again.rnx"
    write_rinex_obs(path, seen, position_m=PLACE)
    assert path.read_bytes() == written.read_bytes()
    with pytest.raises(OutputError, match="--force"):
        write_rinex_obs(path, seen)


@pytest.mark.filterwarnings("ignore")
def test_ranges_after_a_lock_are_blank_and_the_phase_says_why(tmp_path):
    """As georinex reads it, and as we do: no range before the code loop has settled after samples
    were missing and lock was lost; the phase is there, and its indicator says it began anew."""
    case = Case(BEGIN, 16.0, ((2.0, 0.0073),), 45.0, 1)
    seen = received(SKIES["B1I, D1"], "messages", case)[1].observations
    settling = np.isfinite(seen.pseudorange_m) & (seen.unsettled_m > UNSETTLED_M)
    assert settling.sum() > 20 and seen.sample_time_s[settling.any(axis=1)].min() > 2.0
    path = tmp_path / "gap.rnx"
    write_rinex_obs(path, seen)
    ours = rinex.read(path).observations
    assert ours.signals == seen.signals and ours.epochs == seen.epochs
    theirs = georinex.load(path, useindicators=True)
    by_georinex = (theirs[x].values for x in ("C2I", "L2I", "L2Illi"))
    for ranges, phases, lost in (
        by_georinex,
        (ours.pseudorange_m, ours.carrier_phase_cycles, ours.lock_lost),
    ):
        assert np.array_equal(np.isfinite(ranges), np.isfinite(settled_m(seen)))
        first = np.isfinite(phases).argmax(axis=0)
        assert (lost[first, np.arange(len(seen.signals))].astype(int) % 2 == 1).all()
        assert np.isfinite(phases[settling]).mean() > 0.9
    assert "C is blank where it may be off by over 1 m" in path.read_text(encoding="ascii")


@pytest.mark.filterwarnings("ignore")
def test_a_clock_set_anew_is_a_power_failure(seen, tmp_path):
    """Where samples are missing, nothing holds across: epoch flag 1, all phases begin anew."""
    first = ClockPiece(0.0, seen.reference)
    clock = ReceiverClock((first, replace(first, sample_s=12.25)))
    path = tmp_path / "anew.rnx"
    write_rinex_obs(path, replace(seen, clock=clock))
    (row,) = np.flatnonzero([x[31] == "1" for x in _epoch_lines(path)])
    assert row == np.searchsorted(seen.sample_time_s, 12.25)
    ours = rinex.read(path).observations
    assert ours.lock_lost[row, np.isfinite(ours.carrier_phase_cycles[row])].all()
    assert georinex.load(path, use="C").sizes["time"] == seen.epochs


def _epoch_lines(path):
    return [x for x in path.read_text(encoding="ascii").splitlines() if x.startswith(">")]
