"""Arrays of antennas in scenarios: phases of each antenna, near transmitters, files, mistakes."""

import json
from typing import Any

import numpy as np
import pytest
from skies import CIRCLE, PLACE, satellite, sky

from sdr_spoof.errors import ConfigError
from sdr_spoof.nav.geodesy import enu_matrix
from sdr_spoof.scenario import Scenario, find_scenario, synthesize
from sdr_spoof.scenario.emitters import transmissions
from sdr_spoof.scenario.sky.trajectory import rotations
from sdr_spoof.signals import signal_spec
from sdr_spoof.sources import open_recording

C = 299_792_458.0
ELEMENTS = ((0.0, 0.0, 0.0), (0.4, 0.0, 0.0), (0.2, 0.35, -0.1))
ARRAY: dict[str, Any] = {"elements_m": ELEMENTS, "line_cycles": (0.0, 0.1, -0.2)}
SPOOF: dict[str, Any] = {
    "kind": "position",
    "start_s": 0.5,
    "power_ramp_s": 0.5,
    "power_db": 6.0,
    "carrier_phase_cycles": "aligned",
    "drag_start_s": 1.5,
    "velocity_enu_m_s": (3.0, 4.0, 0.0),
}
TIMES = np.array([1.0, 2.5, 3.5])


def phases(scenario: Scenario, prn: int, signal: str, role: str) -> np.ndarray:
    """Carrier phase in the RINEX sense, cycles, (antennas, times)."""
    rows = []
    for part in scenario.antennas():
        sent = transmissions(part)
        t = next(t for t in sent if (t.prn, t.signal, t.role) == (prn, signal, role))
        rows.append(-np.asarray(t.emitter.received_phase_cycles(TIMES)))
    return np.array(rows)


def test_antennas_see_a_satellite_as_a_plane_wave() -> None:
    scenario = sky(receiver=CIRCLE, array=ARRAY)
    found = phases(scenario, 30, "B1CP", "authentic")
    model = scenario.sky_model()
    assert model is not None
    view = satellite(scenario, "C", 30).track.view
    at = np.searchsorted(model.time_s, TIMES)
    azimuth, elevation = view.way.azimuth_rad[at], view.way.elevation_rad[at]
    level = np.cos(elevation)
    unit = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), -np.sin(elevation)], -1)
    turn = rotations(model.trajectory.attitude_rad(model.system_s[at]))
    wavelength = C / signal_spec("B1CP").carrier_hz
    arms = np.array(ELEMENTS[1:])
    expected = -np.einsum("ak,eik,ei->ae", arms, turn, unit) / wavelength
    lines = np.array(ARRAY["line_cycles"][1:])
    np.testing.assert_allclose(found[1:] - found[0] - lines[:, None], expected, atol=2e-4)


def test_a_near_transmitter_is_heard_from_where_it_stands() -> None:
    place = np.array([120.0, 60.0, 5.0])
    scenario = sky(receiver=CIRCLE, array=ARRAY, attack=SPOOF | {"transmitters_enu_m": [place]})
    found = phases(scenario, 30, "B1CP", "spoof")
    parts = scenario.antennas()
    reference = parts[0].sky_model()
    assert reference is not None
    start = int(np.argmin(np.abs(reference.time_s)))
    at = np.searchsorted(reference.time_s, TIMES)
    source = reference.antenna_m[start] + place @ _axes(reference.antenna_m[start])
    ways = []
    for part in parts:
        model = part.sky_model()
        assert model is not None
        ways.append(np.linalg.norm(source - model.antenna_m[at], axis=1))
    wavelength = C / signal_spec("B1CP").carrier_hz
    expected = (np.array(ways[1:]) - ways[0]) / wavelength
    lines = np.array(ARRAY["line_cycles"][1:])[:, None]
    np.testing.assert_allclose(found[1:] - found[0] - lines, expected, atol=2e-4)
    # The reference hears what a single antenna would: aligned with the satellite before the drag.
    single = phases(sky(receiver=CIRCLE, attack=SPOOF), 30, "B1CP", "spoof")
    np.testing.assert_allclose(found[0], single[0], atol=1e-4)


def _axes(place_m: np.ndarray) -> np.ndarray:
    from sdr_spoof.nav.geodesy import ecef_to_geodetic  # noqa: PLC0415

    return enu_matrix(*ecef_to_geodetic(place_m)[:2])


def test_without_a_transmitter_counterfeits_come_from_their_satellites() -> None:
    scenario = sky(array=ARRAY, attack=SPOOF)
    false, true = (phases(scenario, 30, "B1CP", role) for role in ("spoof", "authentic"))
    apart = (false[1:] - false[0]) - (true[1:] - true[0])
    np.testing.assert_allclose(apart, 0.0, atol=1e-4)


def test_each_antenna_is_a_recording_with_noise_of_its_own(tmp_path: Any) -> None:
    small = {"duration_s": 0.01, "sample_rate_hz": 4.092e6, "lo_hz": 1575.42e6}
    shown: list[tuple[int, int]] = []
    meta = synthesize(
        sky(recording=small, array=ARRAY, signals=("L1CA",)),
        tmp_path / "rec",
        progress=lambda done, total: shown.append((done, total)),
    )
    assert meta.name == "rec.a0.sigmf-meta"
    names = [f"rec.a{k}.sigmf-meta" for k in range(3)]
    assert sorted(p.name for p in tmp_path.glob("*.sigmf-meta")) == names
    assert shown[-1][0] == shown[-1][1]
    data = [np.fromfile(tmp_path / f"rec.a{k}.sigmf-data", np.int8) for k in range(3)]
    for one, other in ((0, 1), (0, 2), (1, 2)):
        share = np.corrcoef(data[one].astype(float), data[other].astype(float))[0, 1]
        assert abs(share) < 0.05
    assert open_recording(meta).duration_s == pytest.approx(0.01, abs=1e-5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"elements_m": ELEMENTS[:2]}, "at least 3"),
        ({"elements_m": ((0, 0, 0), (1, 0, 0), (2, 0, 0))}, "one line"),
        ({"line_cycles": (0.0, 0.1)}, "one for each of the 3"),
        ({"antenna": 3}, "numbered from 0"),
    ],
)
def test_mistakes_name_the_key(change: dict[str, Any], message: str, tmp_path: Any) -> None:
    path = tmp_path / "wrong.toml"
    table = ARRAY | change
    rows = "\n".join(f"{k} = {json.dumps(v)}" for k, v in table.items())
    path.write_text(
        "[recording]\nduration_s = 1.0\nsample_rate_hz = 4.092e6\nlo_hz = 1575.42e6\n"
        'sample_format = "ci8"\n[sky]\nstart = "2023-03-12T12:00:00"\nsignals = ["L1CA"]\n'
        '[sky.receiver]\nkind = "static"\nlatitude_deg = 31.2\nlongitude_deg = 121.5\n'
        f"[sky.array]\n{rows}\n"
    )
    with pytest.raises(ConfigError, match=message):
        find_scenario(str(path))


def test_one_antenna_is_the_scenario_itself() -> None:
    scenario = sky(receiver=PLACE)
    assert scenario.antennas() == (scenario,)
    assert len(sky(array=ARRAY).antennas()) == 3
