"""Scenario files, attacks as profiles, and the truth."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof.errors import ConfigError
from sdr_spoof.scenario import (
    InducedAttack,
    Scenario,
    builtin_scenario,
    find_scenario,
    load_scenario,
    scenario_names,
    transmissions,
    truth,
)
from sdr_spoof.scenario.draw import integer, of_attack, uniform
from sdr_spoof.signals import signal_spec

C = 299_792_458.0
RECORDING = {
    "duration_s": 10.0,
    "sample_rate_hz": 25e6,
    "lo_hz": 1568.259e6,
    "sample_format": "ci8",
}
_QUIET = ("clean", "sky-static", "sky-moving")
ATTACK = {
    "prn": 27,
    "signals": ["B1C"],
    "start_s": 1.0,
    "approach_offset_m": 100.0,
    "approach_s": 2.0,
    "power_start_db": -10.0,
    "power_db": 5.0,
    "power_ramp_s": 1.5,
    "drag_start_s": 5.0,
    "drag_rate_m_s": -0.8,
    "drag_ramp_s": 2.0,
}


def scenario(attack: dict[str, object] | None = None, **satellite: object) -> Scenario:
    return Scenario.model_validate(
        {
            "recording": RECORDING,
            "satellite": [{"prn": 27} | satellite],
            "attack": [] if attack is None else [ATTACK | attack],
        }
    )


@pytest.mark.parametrize("name", scenario_names())
def test_shipped_scenarios_are_valid(name: str) -> None:
    shipped = builtin_scenario(name)
    assert len(shipped.satellites) >= 3
    assert bool(shipped.attack) == (name not in _QUIET)
    assert shipped.title
    assert len(transmissions(shipped)) > 0
    told = truth(shipped.sped_up(10))
    assert bool(told["attacks"]) == (name not in _QUIET and "multipath" not in name)


def test_a_scenario_is_found_by_name_or_path(tmp_path: Path) -> None:
    assert find_scenario("quick") == builtin_scenario("quick")
    with pytest.raises(ConfigError, match="did you mean 'meaconing'"):
        find_scenario("meacon")
    with pytest.raises(ConfigError, match=r"x\.toml: cannot be read"):
        find_scenario(tmp_path / "x.toml")


def test_random_draws_do_not_depend_on_the_machine() -> None:
    draws = [uniform("phase", 1), integer("data", 2), of_attack(3, 0)("C"), of_attack(3, 1)("C")]
    assert draws == [
        0.6986065058395358,
        3675562949694853439,
        0.9032991781107664,
        0.5665246225004743,
    ]


def test_power_of_b1c_is_shared_by_its_components() -> None:
    sent = {t.signal: t for t in transmissions(scenario(cn0_dbhz={"B1I": 40.0, "B1C": 45.0}))}
    assert sent["B1I"].cn0_dbhz == 40.0
    assert sent["B1CD"].cn0_dbhz == pytest.approx(45 + 10 * math.log10(1 / 4))
    assert sent["B1CP"].cn0_dbhz == pytest.approx(45 + 10 * math.log10(3 / 4))
    assert sent["B1CP"].data_seed is None
    only_pilot = transmissions(scenario(signals=["B1CP"]))
    assert [t.cn0_dbhz for t in only_pilot] == [45.0]


def test_other_systems() -> None:
    (sent,) = transmissions(scenario(system="G", prn=5, signals=["L1CA"]))
    assert (sent.system, sent.signal, sent.cn0_dbhz) == ("G", "L1CA", 45.0)


def test_doppler_scales_with_the_carrier() -> None:
    at = np.array([0.0, 2.0])
    for values in ({"range_rate_m_s": 500.0}, {"doppler_hz": -500.0 / C * 1575.42e6}):
        for t in transmissions(scenario(range_acceleration_m_s2=-3.0, **values)):
            carrier_hz = signal_spec(t.signal).carrier_hz
            expected = [-500.0 / C * carrier_hz, -494.0 / C * carrier_hz]
            assert t.emitter.doppler_hz(at).tolist() == pytest.approx(expected)


def test_geometric_phases_follow_the_range() -> None:
    for t in transmissions(scenario(range_rate_m_s=321.0, delay_ms=80.123)):
        spec = signal_spec(t.signal)
        at = np.array([0.0, 1.0])
        delay_s = at - t.emitter.code_phase_chips(at) / spec.chip_rate_hz
        cycles = t.emitter.received_phase_cycles(at) + spec.carrier_hz * delay_s
        assert np.abs(cycles - np.round(cycles)).max() < 1e-5


def spoofer(**attack: object) -> tuple[np.ndarray, list[np.ndarray]]:
    """Times, and offsets of the spoofer's B1C pilot from the authentic one."""
    sent = [t for t in transmissions(scenario(attack)) if t.signal == "B1CP"]
    at = np.arange(0.0, 10.0, 0.25)
    wavelength_m = C / 1575.42e6
    authentic, false = (
        (
            t.emitter.code_phase_chips(at),
            t.emitter.received_phase_cycles(at),
            t.emitter.cn0_dbhz(at),
        )
        for t in sent
    )
    code_m = -(false[0] - authentic[0]) * C / 1.023e6
    carrier_m = -(false[1] - authentic[1]) * wavelength_m
    return at, [code_m, carrier_m, false[2] - authentic[2]]


def test_induced_attack_approaches_rises_holds_and_drags() -> None:
    at, (code_m, _, power_db) = spoofer()
    expected = np.interp(at, [1, 3], [100, 0])
    into = np.clip(at - 5, 0, 2)
    expected += -0.8 * into**2 / 4 - 0.8 * np.clip(at - 7, 0, None)
    assert np.abs(code_m - expected).max() < 1e-3
    on_air = at >= 1.0
    assert np.isneginf(power_db[~on_air]).all()
    assert power_db[on_air] == pytest.approx(np.interp(at[on_air], [3, 4.5], [-10, 5]))


def test_coherent_carrier_moves_with_the_code() -> None:
    at, (code_m, carrier_m, _) = spoofer(carrier_phase_cycles=0.0)
    on_air = at >= 1.0
    assert np.abs(carrier_m - code_m)[on_air].max() < 1e-3  # in phase when aligned


def test_frequency_locked_carrier_stays() -> None:
    _, (_, carrier_m, _) = spoofer(
        carrier="frequency-locked", carrier_phase_cycles=0.25, carrier_offset_hz=0.0
    )
    assert carrier_m == pytest.approx(np.full(carrier_m.size, -0.25 * C / 1575.42e6), abs=1e-6)


def test_random_phases_come_from_the_seed() -> None:
    def phase(seed: int) -> float:
        values = scenario({}).model_dump()
        values["recording"]["seed"] = seed
        last = transmissions(Scenario.model_validate(values))[-1]
        return float(last.emitter.received_phase_cycles(np.zeros(1))[0])

    assert phase(1) == phase(1) != phase(2)


def test_spoofer_repeats_the_data() -> None:
    sent = [t for t in transmissions(scenario({})) if t.signal == "B1CD"]
    index = np.arange(-5, 200)
    authentic, false = (t.emitter.data_symbols(index) for t in sent)
    assert np.array_equal(authentic, false)
    assert 60 < np.count_nonzero(authentic == 1) < 145  # 4 standard errors of fair coins


def test_truth_tells_the_attack_and_the_motion() -> None:
    told = json.loads(json.dumps(truth(scenario({}, range_rate_m_s=100.0))))
    attack = told["attacks"][0]
    assert attack["capture_s"] == pytest.approx(3 + 1.5 * 10 / 15)
    assert (attack["power_ramp_start_s"], attack["drag_full_s"]) == (3.0, 7.0)
    assert attack["carrier_offset_hz"]["B1CP"] == pytest.approx(0.8 * 1575.42e6 / C)
    assert [e["role"] for e in told["emitters"]] == ["authentic"] * 3 + ["spoof"] * 2
    first, false = told["emitters"][0], told["emitters"][-1]
    rows = len(told["time_s"])
    assert rows == 101
    assert all(len(e["code_delay_s"]) == rows for e in told["emitters"])
    # Carrier phase grows as range grows, delay too, and Doppler is negative.
    assert first["carrier_phase_cycles"][-1] > first["carrier_phase_cycles"][0]
    slope = (first["code_delay_s"][-1] - first["code_delay_s"][0]) / told["time_s"][-1] * C
    assert slope == pytest.approx(100.0, abs=1e-4)
    assert first["doppler_hz"][0] < 0
    assert false["cn0_dbhz"][0] is None
    assert false["cn0_dbhz"][-1] == pytest.approx(45 - 1.2494 + 5, abs=1e-3)


def test_power_below_the_authentic_captures_nothing() -> None:
    quiet = scenario({"power_db": -1.0})
    assert truth(quiet)["attacks"][0]["capture_s"] is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[recordin]\n", r"unknown key 'recordin'; did you mean 'recording'"),
        ("satelite = []\n", "did you mean 'satellite'"),
        ("[recording]\nduration_s = -1\n", r"\[recording\] duration_s: .*greater than 0"),
        ("RECORDING\nbandwith_hz = 1\n", "did you mean 'bandwidth_hz'"),
        ("RECORDING\nsample_format = 'u8'\n", "unknown sample format 'u8'"),
        ("RECORDING\nbandwidth_hz = 3e7\n", "not inside the sampled band"),
        ("RECORDING\nfilter_taps = 8\nbandwidth_hz = 1e6\n", "odd number, not 8"),
        ("RECORDING\ncentre_hz = 1.5e9\n", "needs bandwidth_hz"),
        ("RECORDING\n[[satellite]]\nprn = 19\nsignals = ['B1X']\n", "unknown signal 'B1X'"),
        ("RECORDING\n[[satellite]]\nprn = 3\nsignals = ['B1C']\n", "C03 does not transmit B1C"),
        ("RECORDING\n[[satellite]]\nprn = 5\nsignals = ['L1CA']\n", "belongs to system 'G'"),
        ("RECORDING\n[[satellite]]\nprn = 19\n[[satellite]]\nprn = 19\n", "C19 appears twice"),
        ("RECORDING\n[[satellite]]\nprn = 19\ndoppler_hz=1\nrange_rate_m_s=1\n", "give one"),
        ("RECORDING\n[[satellite]]\nprn = 19\ndelay_ms = nan\n", "finite"),
        ("RECORDING\n[[satellite]]\nprn = 19\ncn0_dbhz = {B1I = 40}\n", "exactly the signals"),
        ("SLOW\n[[satellite]]\nprn = 19\nsignals = ['B1I']\n", "raise sample_rate_hz"),
        ("RECORDING\n[[attack]]\nprn=9\nsignals=['B1C']\nstart_s=1\n", r"no \[\[satellite\]\] C09"),
        (
            "TARGET\nstart_s = -1\n",
            r"\[\[attack\]\] \(number 1\) start_s: .*greater than or equal to 0",
        ),
        ("TARGET\nstart_s = 11\n", "after the end of the recording"),
        ("TARGET\nstart_s = 2\nend_s = 1\n", "must be after start_s"),
        ("TARGET\nstart_s = 2\ndrag_rate_m_s = 1\n", "needs drag_start_s"),
        (
            "TARGET\nstart_s = 2\napproach_s = 2\ndrag_start_s = 3\n",
            "before the end of the approach",
        ),
        ("TARGET\nstart_s = 2\napproach_offset_m = 5\n", "needs approach_s"),
        ("TARGET\nstart_s = 2\ncarrier = 'x'\n", "'coherent' or 'frequency-locked'"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, text: str, message: str) -> None:
    recording = "[recording]\nduration_s=10\nsample_rate_hz={}\nlo_hz=1568.259e6\n"
    text = text.replace(
        "TARGET", "RECORDING\n[[satellite]]\nprn=9\n[[attack]]\nprn=9\nsignals=['B1C']"
    )
    settings = recording + ("" if "sample_format" in text else "sample_format='ci8'\n")
    text = text.replace("RECORDING\n", settings.format(25e6)).replace(
        "SLOW\n", settings.format(5e6)
    )
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=message) as caught:
        load_scenario(path)
    assert "wrong.toml" in str(caught.value)


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="nowhere"):
        load_scenario(tmp_path / "nowhere.toml")


def test_attack_model_stands_alone() -> None:
    attack = InducedAttack.model_validate(ATTACK)
    assert (attack.ramp_start_s, attack.ramp_end_s) == (3.0, 4.5)
