"""Meaconing, asynchronous generation and multipath: profiles, waveforms, truth, mistakes."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attacks import C, added, authentic, difference, differences, scenario
from correlation import FS_HZ, iq, prompt
from pydantic import BaseModel

from sdr_spoof.errors import ConfigError
from sdr_spoof.scenario import (
    Asynchronous,
    InducedAttack,
    Meaconing,
    Multipath,
    Ray,
    RecordingPlan,
    Satellite,
    Scenario,
    load_scenario,
    open_synthesizer,
    transmissions,
    truth,
)
from sdr_spoof.signals import signal_spec

AT_S = np.arange(0.0, 20.0, 0.125)
FULL = 16 * math.sqrt(2 * 1e7 / FS_HZ)
"""Amplitude of 70 dB-Hz with 16 of noise."""


def samples(made: Scenario) -> np.ndarray:
    """The first 20 ms: at 70 dB-Hz, amplitudes have a standard error of 0.0016."""
    return iq(open_synthesizer(made, threads=1).generate(0, int(0.02 * FS_HZ)))


MEACON: dict[str, Any] = {
    "kind": "meaconing",
    "start_s": 4.0,
    "delay_m": 400.0,
    "gain_db": 6.0,
    "gain_start_db": -14.0,
    "gain_ramp_s": 2.0,
    "delay_rate_m_s": 3.0,
    "delay_start_s": 8.0,
}


def test_a_meacon_delays_everything() -> None:
    made = scenario(MEACON)
    sent = [t for t in transmissions(made) if t.role == "meacon"]
    assert len(sent) == 6
    for t in sent:
        d = difference(made, t.prn, t.signal, AT_S)
        delay_m = 400 + 3 * np.clip(AT_S - 8, 0, None)
        assert np.abs(d.code_m - delay_m).max() < 1e-3
        cycles = d.phase_cycles + delay_m * signal_spec(t.signal).carrier_hz / C
        assert np.abs(cycles - np.round(cycles)).max() < 1e-4
        on_air = AT_S >= 4
        expected = np.interp(AT_S, [4, 6], [-14, 6])
        assert d.power_db[on_air] == pytest.approx(expected[on_air])
        assert np.isneginf(d.power_db[~on_air]).all()
        index = np.arange(100)
        true = authentic(made, t.prn, t.signal).emitter
        assert np.array_equal(t.emitter.data_symbols(index), true.data_symbols(index))


def test_a_meacon_has_one_phase_and_offset_for_all_satellites() -> None:
    extra = {"carrier_phase_cycles": "random", "carrier_offset_hz": 7.0, "delay_rate_m_s": 0.0}
    made = scenario({k: v for k, v in (MEACON | extra).items() if k != "delay_start_s"})
    at_s = np.array([4.0, 5.0])
    phases = {}
    for signal in ("B1I", "B1CD", "B1CP"):
        a, b = (difference(made, prn, signal, at_s).phase_cycles for prn in (19, 27))
        assert a == pytest.approx(b, abs=1e-4)
        assert a[1] - a[0] == pytest.approx(7.0, abs=1e-4)
        phases[signal] = a[0]
    assert phases["B1CD"] == pytest.approx(phases["B1CP"], abs=1e-4)
    told = truth(made)["attacks"]
    assert [(a["prn"], a["delay_m"], a["role"]) for a in told] == [
        (19, 400.0, "meacon"),
        (27, 400.0, "meacon"),
    ]


def test_a_meacon_of_some_satellites_and_signals() -> None:
    made = scenario(MEACON | {"prn": 19, "signals": ["B1C"]})
    sent = [(t.prn, t.signal) for t in transmissions(made) if t.role == "meacon"]
    assert sent == [(19, "B1CD"), (19, "B1CP")]
    locked = scenario(MEACON | {"carrier": "frequency-locked", "carrier_phase_cycles": 0.25})
    assert difference(locked, 19, "B1I", AT_S).phase_cycles == pytest.approx(0.25, abs=1e-4)


def test_waveform_of_a_meacon() -> None:
    attack = {"kind": "meaconing", "start_s": 0.0, "delay_m": 3000.0, "gain_db": -6.0206}
    made = scenario(attack, duration_s=0.1, prns=(27,), cn0_dbhz=70.0)
    x = samples(made)
    for signal, share in (("B1I", 1.0), ("B1CD", 0.25)):
        (late,) = added(made, 27, signal)
        # 20 chips of B1I away from the satellite's own code: cross-correlation within 2 %.
        assert prompt(late.emitter, 0, x) / FULL == pytest.approx(0.5 * share**0.5, abs=0.02)


ASYNCHRONOUS: dict[str, Any] = {
    "kind": "asynchronous",
    "prns": [22, 27],
    "signals": ["B1I", "B1C"],
    "start_s": 3.0,
    "end_s": 15.0,
    "cn0_dbhz": 55.0,
}


def test_asynchronous_signals_are_on_their_own() -> None:
    values = {"delay_ms": 75.5, "doppler_hz": 1234.0, "cn0_start_dbhz": 35.0, "power_ramp_s": 2.0}
    made = scenario(ASYNCHRONOUS | values)
    for prn in (22, 27):
        for t in added(made, prn, "B1I"):
            assert t.emitter.cn0_dbhz(AT_S)[AT_S == 4.0] == pytest.approx(45.0)
            assert t.emitter.cn0_dbhz(AT_S)[AT_S == 6.0] == pytest.approx(55.0)
            assert np.isfinite(t.emitter.cn0_dbhz(AT_S)).sum() == np.sum((AT_S >= 3) & (AT_S < 15))
            doppler_hz = 1234.0 * 1561.098 / 1575.42
            assert t.emitter.doppler_hz(AT_S) == pytest.approx(doppler_hz)
            (chips,) = t.emitter.code_phase_chips(np.zeros(1))
            assert chips == pytest.approx(-75.5e-3 * 2.046e6)
    index = np.arange(400)
    true, false = authentic(made, 27, "B1I").emitter, added(made, 27, "B1I")[0].emitter
    agree = np.count_nonzero(true.data_symbols(index) == false.data_symbols(index))
    assert abs(agree - 200) < 4 * 10
    told = truth(made)["attacks"]
    assert [(a["prn"], a["role"], a["delay_ms"]) for a in told] == [
        (22, "spoof", 75.5),
        (27, "spoof", 75.5),
    ]


def test_asynchronous_motion_is_random_unless_given() -> None:
    made = scenario(ASYNCHRONOUS)
    told = truth(made)["attacks"]
    assert told == truth(scenario(ASYNCHRONOUS))["attacks"]
    assert told[0]["delay_ms"] != told[1]["delay_ms"]
    assert all(60 <= a["delay_ms"] < 90 for a in told)
    assert all(abs(a["range_rate_m_s"]) < 4000 * C / 1575.42e6 for a in told)
    # Both bands of one satellite share the motion.
    one, other = (added(made, 22, s)[0].emitter.doppler_hz(AT_S[:1])[0] for s in ("B1I", "B1CP"))
    assert one / other == pytest.approx(1561.098 / 1575.42)
    random = scenario(ASYNCHRONOUS | {"carrier_phase_cycles": "random"})
    phases = [
        added(random, prn, s)[0].emitter.received_phase_cycles(np.zeros(1))[0]
        for prn in (22, 27)
        for s in ("B1I", "B1CP")
    ]
    assert len({round(p, 6) for p in phases}) == 4


def test_waveform_of_an_asynchronous_signal() -> None:
    attack = ASYNCHRONOUS | {"start_s": 0.0, "end_s": None, "cn0_dbhz": 70.0, "prns": [22]}
    made = scenario(attack, duration_s=0.1, prns=(27,))
    x = samples(made)
    for signal, share in (("B1I", 1.0), ("B1CD", 0.25)):
        (sent,) = added(made, 22, signal)
        assert prompt(sent.emitter, 0, x) / FULL == pytest.approx(share**0.5, abs=0.01)


def rays(*ray: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"kind": "multipath", "prn": 27, "ray": list(ray)} | more


def test_a_ray_that_stays_has_the_same_delay_in_both_bands() -> None:
    made = scenario(rays({"ratio": 0.5, "delay_m": 30.0}, {"ratio": 0.2, "delay_m": 75.0}))
    reflector = {}
    for signal in ("B1I", "B1CD", "B1CP"):
        first, second = differences(made, 27, signal, AT_S)
        assert (first.code_m.mean(), second.code_m.mean()) == pytest.approx((30.0, 75.0), abs=1e-4)
        assert first.power_db == pytest.approx(20 * math.log10(0.5))
        assert np.ptp(first.phase_cycles) < 1e-4
        turn = 30.0 * signal_spec(signal).carrier_hz / C
        reflector[signal] = (first.phase_cycles[0] + turn) % 1
    assert reflector["B1I"] == pytest.approx(reflector["B1CP"], abs=1e-4)
    assert [t.prn for t in transmissions(made) if t.role == "multipath"] == [27] * 6
    told = truth(made)
    assert told["attacks"] == []
    (disturbance,) = told["disturbances"]
    assert (disturbance["prn"], disturbance["kind"], disturbance["start_s"]) == (27, "multipath", 0)
    assert [r["delay_m"] for r in disturbance["rays"]] == [30.0, 75.0]


def test_a_ray_moves_its_carrier_with_its_path() -> None:
    ray = {"ratio": 0.4, "delay_m": 60.0, "delay_rate_m_s": -2.0, "start_s": 2.0, "end_s": 12.0}
    made = scenario(rays(ray | {"phase_cycles": 0.25, "phase_rate_hz": 1.5}))
    for signal in ("B1I", "B1CP"):
        d = difference(made, 27, signal, AT_S)
        there = (AT_S >= 2) & (AT_S < 12)
        assert np.array_equal(np.isfinite(d.power_db), there)
        into = AT_S[there] - 2
        assert np.abs(d.code_m[there] - (60 - 2 * into)).max() < 1e-3
        rate = 1.5 + 2.0 * signal_spec(signal).carrier_hz / C
        assert np.abs(d.phase_cycles[there] - (0.25 + rate * into)).max() < 1e-3


def test_a_ray_comes_and_goes_smoothly() -> None:
    ray = {"ratio": 0.8, "delay_m": 10.0, "start_s": 4.0, "end_s": 16.0, "rise_s": 2.0}
    d = difference(scenario(rays(ray)), 27, "B1I", AT_S)
    there = (AT_S >= 4) & (AT_S < 16)
    assert np.array_equal(np.isfinite(d.power_db), there)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.clip(np.minimum(AT_S - 4, 16 - AT_S) / 2, 0, 1))
    assert 10 ** (d.power_db[there] / 20) == pytest.approx(0.8 * rise[there], abs=0.01)


def test_waveform_of_multipath() -> None:
    ray = {"ratio": 0.5, "delay_m": 30.0, "phase_cycles": 0.25}
    made = scenario(rays(ray), duration_s=0.1, prns=(27,), cn0_dbhz=70.0)
    overlap = 1 - 30.0 / (C / 2.046e6)
    amplitude = prompt(authentic(made, 27, "B1I").emitter, 0, samples(made)) / FULL
    assert amplitude == pytest.approx(1 + 0.5j * overlap, abs=0.01)


def test_all_satellites_have_multipath_unless_named() -> None:
    attack = rays({"ratio": 0.5, "delay_m": 30.0}, signals=["B1I"])
    del attack["prn"]
    sent = [(t.prn, t.signal) for t in transmissions(scenario(attack)) if t.role == "multipath"]
    assert sent == [(19, "B1I"), (27, "B1I")]


TIMES = re.compile(r"(?<!_m)_s$")


DOCUMENT = Path(__file__).parents[2] / "docs" / "scenarios.md"


@pytest.mark.parametrize(
    ("model", "heading"),
    [
        (InducedAttack, "### `induced`"),
        (Meaconing, "### `meaconing`"),
        (Asynchronous, "### `asynchronous`"),
        (Ray, "### `multipath`"),
    ],
)
def test_every_key_is_documented(model: type[BaseModel], heading: str) -> None:
    section = DOCUMENT.read_text().split(heading)[1].split("\n#")[0]
    for key in model.model_fields.keys() - {"kind", "prns", "system", "signals"}:
        assert f"`{key}`" in section, key


@pytest.mark.parametrize(
    "model", [InducedAttack, Meaconing, Asynchronous, Multipath, Ray, RecordingPlan, Satellite]
)
def test_every_time_is_named_as_such(model: type[BaseModel]) -> None:
    """``sped_up`` tells times by their names."""
    no_times = {"prns", "signals", "kind", "system", "prn", "ray"}
    for name in model.model_fields:
        words = ("start", "end", "ramp", "approach", "rise", "known", "duration")
        if name.split("_")[-2:-1] and name.split("_")[-2] in words and name not in no_times:
            assert TIMES.search(name) or name.endswith(("_db", "_dbhz")), name


def test_speed_up_divides_times_and_nothing_else() -> None:
    ray = {"ratio": 0.5, "delay_m": 60.0, "delay_rate_m_s": -2.0, "start_s": 4.0, "rise_s": 1.0}
    fast = scenario(rays(ray)).sped_up(4).model_dump()
    slow = scenario(rays(ray)).model_dump()
    assert fast["recording"].pop("duration_s") == slow["recording"].pop("duration_s") / 4 == 5.0
    (fast_ray,), (slow_ray,) = (s["attack"][0].pop("ray") for s in (fast, slow))
    assert fast_ray.pop("start_s") == slow_ray.pop("start_s") / 4 == 1.0
    assert fast_ray.pop("rise_s") == slow_ray.pop("rise_s") / 4 == 0.25
    assert (fast, fast_ray) == (slow, slow_ray)
    for factor in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(ConfigError, match="must be a number above 0"):
            scenario(rays(ray)).sped_up(factor)


HEAD = """
[recording]
duration_s = 10
sample_rate_hz = 25e6
lo_hz = 1568.259e6
sample_format = "ci8"
[[satellite]]
prn = 27
[[attack]]
"""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("kind = 'jamming'", r"\(number 1\): unknown kind 'jamming'; known kinds: .*'meaconing'"),
        ("kind = 'meaconing'\nstart_s = 1", r"\[\[attack\]\] \(number 1\) delay_m: missing"),
        ("kind = 'meaconing'\nstart = 1", "unknown key 'start'; did you mean 'start_s'"),
        ("kind = 'meaconing'\nstart_s=1\ndelay_m=1\ngain_ramp_s=1", "needs gain_start_db"),
        ("kind = 'meaconing'\nstart_s=1\ndelay_m=1\ngain_start_db=1", "needs gain_ramp_s"),
        ("kind = 'meaconing'\nstart_s=1\ndelay_m=1\ndelay_start_s=2", "needs delay_rate_m_s"),
        (
            "kind = 'meaconing'\nstart_s=3\ndelay_m=1\ndelay_start_s=2\ndelay_rate_m_s=1",
            "delay_start_s 2 is before start_s 3",
        ),
        ("kind = 'meaconing'\nstart_s=1\ndelay_m=1\nprn=19", r"no \[\[satellite\]\] C19 for"),
        ("kind = 'meaconing'\nstart_s=1\ndelay_m=-1", "greater than or equal to 0"),
        (
            "kind = 'meaconing'\nstart_s=1\ndelay_m=1\nsystem='G'",
            "no satellite of the scenario is meant",
        ),
        (
            "kind = 'meaconing'\nstart_s=11\ndelay_m=1",
            r"\[\[attack\]\] \(number 1\) start_s: 11 is after the end",
        ),
        ("kind = 'asynchronous'\nstart_s=1\nprn=3\nsignals=['B1C']", "C03 does not transmit B1C"),
        (
            "kind = 'asynchronous'\nsystem='G'\nstart_s=1\nprn=3\nsignals=['L1CA']\ndoppler_hz=1\n"
            "range_rate_m_s=1",
            "give one of them",
        ),
        (
            "kind = 'asynchronous'\nstart_s=1\nprn=22\nsignals=['B1I']\npower_ramp_s=1",
            "needs cn0_start_dbhz",
        ),
        ("kind = 'multipath'\nray=[]", "at least 1 item"),
        ("kind = 'multipath'\n[[attack.ray]]\nratio=1", r"\[\[attack.0.ray\]\].* delay_m: missing"),
        ("kind = 'multipath'\n[[attack.ray]]\ndelaym=1", "did you mean 'delay_m'"),
        (
            "kind = 'multipath'\n[[attack.ray]]\nratio=1\ndelay_m=5\ndelay_rate_m_s=-1",
            "the extra path shrinks to -5 m; give an end_s",
        ),
        (
            "kind = 'multipath'\n[[attack.ray]]\nratio=1\ndelay_m=5\nend_s=2\nrise_s=1.5",
            "rise_s 1.5: the ray grows and falls for longer than it is there",
        ),
        (
            "kind = 'multipath'\n[[attack.ray]]\nratio=1\ndelay_m=5\nstart_s=12",
            r"ray \(number 1\) start_s: 12 is after the end",
        ),
    ],
)
def test_mistakes_are_named(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(HEAD + text)
    with pytest.raises(ConfigError, match=message):
        load_scenario(path)


def test_a_counterfeit_must_be_in_the_recorded_band(tmp_path: Path) -> None:
    text = "kind = 'asynchronous'\nsystem = 'G'\nstart_s=1\nprn=3\nsignals=['L1CA']"
    path = tmp_path / "band.toml"
    path.write_text(
        HEAD.replace("1568.259e6", "1562e6").replace("prn = 27", "prn=27\nsignals=['B1I']") + text
    )
    with pytest.raises(ConfigError, match=r"\[\[attack\]\] signals: L1CA of PRN 3 needs"):
        load_scenario(path)
