"""Sinks of the track: NMEA, GeoJSON, KML, CSV."""

from __future__ import annotations

import csv
import json
from datetime import UTC, datetime
from xml.etree import ElementTree

import numpy as np
import pytest
from observed_tracks import Moving, navigation, observed_log
from pynmeagps import NMEAReader
from routes import NAMES, small_route

from sdr_spoof.errors import OutputError
from sdr_spoof.observables import observe
from sdr_spoof.sinks.csv_tables import write_fixes_csv, write_observations_csv
from sdr_spoof.sinks.geojson import write_geojson
from sdr_spoof.sinks.kml import NAMESPACE, write_kml
from sdr_spoof.sinks.nmea import write_nmea


@pytest.fixture
def sentences(tmp_path):
    path = tmp_path / "track.nmea"
    write_nmea(path, small_route())
    lines = path.read_bytes().splitlines(keepends=True)
    assert all(len(line) <= 82 for line in lines)
    return [NMEAReader.parse(line) for line in lines]


def of_kind(sentences, kind):
    return [m for m in sentences if m.msgID == kind]


def test_nmea_positions(sentences):
    route = small_route()
    for kind in ("GGA", "RMC"):
        found = of_kind(sentences, kind)
        assert len(found) == 8
        assert all(m.talker == "GN" for m in found[2:])
        assert found[0].lat == "" and found[1].lon == ""
        for i in range(2, 8):
            assert found[i].lat == pytest.approx(route.latitude_deg[i], abs=2e-8)
            assert found[i].lon == pytest.approx(route.longitude_deg[i], abs=2e-8)
    gga = of_kind(sentences, "GGA")
    assert [m.quality for m in gga] == [0, 0, 1, 1, 1, 1, 1, 1]
    assert (gga[2].numSV, gga[7].numSV) == (6, 5)
    assert gga[2].sep == pytest.approx(30.0)
    assert gga[2].alt + gga[2].sep == pytest.approx(570.12)


def test_nmea_says_what_the_detectors_say(sentences):
    rmc = of_kind(sentences, "RMC")
    assert [m.navStatus for m in rmc] == list("VVSUSCCC")
    assert [m.status for m in rmc] == list("VVAAAAAA")
    utc = small_route().times[2].utc()
    assert (rmc[2].date, rmc[2].time) == (utc.date(), utc.time())
    assert rmc[2].spd == pytest.approx(np.hypot(1.8, 1.1) * 3600 / 1852, abs=1e-3)
    assert rmc[2].cog == pytest.approx(np.degrees(np.arctan2(-1.8, -1.1)) % 360, abs=0.01)


def test_nmea_satellites(sentences):
    active = of_kind(sentences, "GSA")
    beidou = [m for m in active if str(m.systemId) == "4"]
    assert [beidou[0].svid_01, beidou[0].svid_05, beidou[0].svid_06] == [6, 33, ""]
    assert [beidou[-1].svid_01, beidou[-1].svid_02] == [6, 28]
    view = of_kind(sentences, "GSV")
    assert {(m.talker, str(m.signalID)) for m in view} == {("GB", "1"), ("GB", "3"), ("GP", "1")}
    first = next(m for m in view if m.talker == "GB")
    assert (first.numMsg, first.msgNum, first.numSV) == (2, 1, 5)
    assert (first.svid_02, first.elv_02, first.az_02, first.cno_02) == (27, 30, 60, 41)


def test_nmea_of_beidou_alone(tmp_path):
    path = tmp_path / "track.nmea"
    write_nmea(path, small_route(names=NAMES[:-1]))
    assert {m[:6] for m in path.read_text().splitlines()} == {"$GNGGA", "$GNRMC"} | {
        "$GB" + kind for kind in ("GGA", "RMC", "GSA", "GSV")
    }


def test_geojson_is_coloured_by_alarm(tmp_path):
    path = tmp_path / "track.geojson"
    write_geojson(path, small_route())
    features = json.loads(path.read_text())["features"]
    lines = [f for f in features if f["geometry"]["type"] == "LineString"]
    assert [f["properties"]["alarm"] for f in lines] == ["none", "suspect", "spoofed"]
    assert len({f["properties"]["stroke"] for f in lines}) == 3
    ends = [f["geometry"]["coordinates"] for f in lines]
    assert ends[0][-1] == ends[1][0] and ends[1][-1] == ends[2][0]
    points = [f for f in features if f["geometry"]["type"] == "Point"]
    assert len(points) == 6
    assert points[0]["geometry"]["coordinates"] == [-70.25004, -33.85002, 570.1234]
    assert points[-1]["properties"]["satellites"] == [n for n in NAMES if n != "C27"]
    assert points[1]["properties"]["quality"] == "suspect"


def test_kml_is_coloured_by_alarm(tmp_path):
    path = tmp_path / "track.kml"
    write_kml(path, small_route(), name="a <b> & c")
    root = ElementTree.parse(path).getroot()
    tag = f"{{{NAMESPACE}}}"
    marks = list(root.iter(f"{tag}Placemark"))
    assert [m.findtext(f"{tag}styleUrl") for m in marks] == ["#none", "#suspect", "#spoofed"]
    styles = {s.get("id"): s for s in root.iter(f"{tag}Style")}
    colours = {k: s.findtext(f"{tag}LineStyle/{tag}color") for k, s in styles.items()}
    assert colours["spoofed"] == "ff2b39c0"
    first = marks[0].findtext(f"{tag}LineString/{tag}coordinates").split()
    assert first[0].startswith("-70.250040000,-33.850020000,540.1")  # above the geoid
    assert root.findtext(f"{tag}Document/{tag}name") == "a <b> & c"


def test_csv_of_fixes(tmp_path):
    path = tmp_path / "fixes.csv"
    write_fixes_csv(path, small_route())
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert len(rows) == 8
    assert rows[0]["latitude_deg"] == "" and rows[0]["quality"] == "none"
    assert float(rows[2]["height_m"]) == 570.1234
    assert rows[-1]["alarm"] == "spoofed" and "C27" not in rows[-1]["satellites_used"]
    time = datetime.fromisoformat(rows[2]["gpst"]).replace(tzinfo=UTC)
    assert time == small_route().times[2].calendar()


def test_csv_of_observations(tmp_path):
    satellite = Moving()
    seen = observe(observed_log(satellite), navigation(satellite))
    path = tmp_path / "observations.csv"
    write_observations_csv(path, seen)
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert len(rows) == np.isfinite(seen.cn0_dbhz).sum()
    assert {r["signal"] for r in rows} == {"B1I", "B1CP"}
    first = next(r for r in rows if r["signal"] == "B1I")
    at = [s.signal for s in seen.signals].index("B1I")
    assert float(first["pseudorange_m"]) == pytest.approx(seen.pseudorange_m[0, at], abs=1e-4)
    assert first["lock_lost"] == "1"


@pytest.mark.parametrize("write", [write_nmea, write_geojson, write_kml, write_fixes_csv])
def test_nothing_is_replaced_by_accident(write, tmp_path):
    path = tmp_path / "out"
    write(path, small_route())
    before = path.read_bytes()
    with pytest.raises(OutputError, match="--force"):
        write(path, small_route())
    write(path, small_route(), force=True)
    assert path.read_bytes() == before


@pytest.mark.parametrize("write", [write_nmea, write_geojson, write_kml, write_fixes_csv])
def test_without_any_fix(write, tmp_path):
    write(tmp_path / "out", small_route(epochs=2))
    assert (tmp_path / "out").stat().st_size > 0
