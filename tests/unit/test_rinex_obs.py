"""Our RINEX observation files, read back by georinex."""

from __future__ import annotations

import georinex
import numpy as np
import pytest
from observed_tracks import Moving, navigation, observed_log

from sdr_spoof.errors import OutputError
from sdr_spoof.observables import ObservablesConfig, observe
from sdr_spoof.records import SatelliteVerdict, Verdict
from sdr_spoof.sinks.rinex_obs import write_rinex_obs

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


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("system", ["C", "G"])
def test_georinex_reads_every_value_back(seen, written, system):
    read = georinex.load(written, use=system)
    quantities = {
        "C": seen.pseudorange_m,
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
