"""Induced capture: profiles against closed forms, the takeover, data, mistakes."""

import math
from typing import Any

import numpy as np
import pytest
from attacks import C, added, authentic, difference, differences, scenario
from correlation import FS_HZ, iq, prompt
from pydantic import ValidationError

from sdr_spoof.scenario import builtin_scenario, open_synthesizer, transmissions, truth
from sdr_spoof.signals import signal_spec

AT_S = np.arange(0.0, 20.0, 0.125)
ATTACK: dict[str, Any] = {
    "kind": "induced",
    "prns": [27],
    "signals": ["B1C"],
    "start_s": 2.0,
    "approach_offset_m": -80.0,
    "approach_s": 2.0,
    "power_start_db": -10.0,
    "eta": 1.5,
    "power_ramp_s": 1.0,
    "drag_start_s": 8.0,
    "drag_rate_m_s": 1.2,
    "drag_ramp_s": 2.0,
    "drag_end_s": 14.0,
}


def induced(**attack: Any) -> Any:
    return scenario(ATTACK | attack)


@pytest.mark.parametrize(
    ("phase", "cycles"), [("aligned", 0.0), ("antipodal", 0.5), (0.125, 0.125)]
)
@pytest.mark.parametrize("carrier", ["coherent", "frequency-locked"])
def test_phase_is_that_asked_for_when_the_code_is_aligned(
    phase: str | float, cycles: float, carrier: str
) -> None:
    made = induced(
        signals=["B1I", "B1C"], carrier_phase_cycles=phase, carrier=carrier, carrier_offset_hz=0.3
    )
    for signal in ("B1I", "B1CD", "B1CP"):
        d = difference(made, 27, signal, np.array([4.0]))
        assert abs(d.code_m[0]) < 1e-6
        assert d.phase_cycles[0] == pytest.approx(cycles, abs=1e-5)


def test_drag_ends_as_it_began() -> None:
    d = difference(induced(carrier_phase_cycles="aligned"), 27, "B1CP", AT_S)
    into, after = np.clip(AT_S - 8, 0, 2), np.clip(AT_S - 14, 0, 2)
    expected = 1.2 * (into**2 / 4 + np.clip(AT_S - 10, 0, 4) + after - after**2 / 4)
    on_air = AT_S >= 4
    assert np.abs(d.code_m - expected)[on_air].max() < 1e-3
    carrier_m = -d.phase_cycles * C / 1575.42e6
    assert np.abs(carrier_m - expected)[on_air].max() < 1e-3
    assert d.power_db[AT_S > 5] == pytest.approx(20 * math.log10(1.5))


def test_several_satellites_and_bands() -> None:
    made = induced(prns=[19, 27], signals=["B1I", "B1C"])
    spoofed = [(t.prn, t.signal) for t in transmissions(made) if t.role == "spoof"]
    assert spoofed == [(p, s) for p in (19, 27) for s in ("B1I", "B1CD", "B1CP")]
    told = truth(made)["attacks"]
    assert [(a["prn"], a["components"]) for a in told] == [
        (19, ["B1I", "B1CD", "B1CP"]),
        (27, ["B1I", "B1CD", "B1CP"]),
    ]
    assert {a["alignment_s"] for a in told} == {4.0}
    # Independent random phases.
    phases = [difference(made, p, s, AT_S[:1]).phase_cycles[0] for p, s in spoofed]
    assert len({round(math.fmod(p, 1.0), 6) for p in phases}) == len(phases) - 2  # data = pilot


def test_one_prn_needs_no_list() -> None:
    values = {k: v for k, v in ATTACK.items() if k != "prns"}
    assert scenario(values | {"prn": 27}) == scenario(ATTACK)


SEAMLESS = {
    "takeover": "seamless",
    "power_start_db": -20.0,
    "eta": 2.0,
    "power_ramp_s": 4.0,
    "carrier": "frequency-locked",
}


def test_seamless_takeover_keeps_the_amplitude() -> None:
    """1 + eta exp(j phi) = -exp(2 j phi): TEXBAT ds7."""
    d = difference(induced(**SEAMLESS), 27, "B1CP", AT_S)
    on = (AT_S >= 4) & (AT_S < 8)
    composite = 1 + d.phasor[on]
    assert np.abs(np.abs(composite) - 1).max() < 0.01
    turn = np.unwrap(np.angle(composite))
    assert np.abs(turn[-1] - turn[0] - math.pi * (1 - 0.0319)).max() < 0.1  # begins 2.9 degrees in
    held = 1 + d.phasor[(AT_S >= 8) & (AT_S < 9)]
    assert np.abs(held + 1).max() < 1e-3
    assert truth(induced(**SEAMLESS))["attacks"][0]["eta"] == pytest.approx(2.0)


def test_amplitude_follows_the_dragged_offset() -> None:
    made = induced(**SEAMLESS, drag_eta=1.0, drag_rate_m_s=60.0, drag_ramp_s=0.0, drag_end_s=None)
    d = difference(made, 27, "B1CP", AT_S[AT_S >= 8])
    chip_m = C / 1.023e6
    expected = 2.0 - np.clip(d.code_m / chip_m, 0, 1)
    assert 10 ** (d.power_db / 20) == pytest.approx(expected, abs=1e-3)
    # A drag that ends before a chip leaves the amplitude where it is then.
    short = induced(**SEAMLESS, drag_eta=1.0, drag_rate_m_s=-1.2)
    d = difference(short, 27, "B1CP", np.array([16.0, 19.0]))
    assert 10 ** (d.power_db / 20) == pytest.approx(2.0 + d.code_m / chip_m, abs=1e-4)


@pytest.mark.parametrize("factor", [1.0, 10.0])
def test_ds7_has_its_timeline_and_its_speed(factor: float) -> None:
    made = builtin_scenario("ds7").sped_up(factor)
    assert made.recording.duration_s == pytest.approx(468 / factor)
    at_s = np.array([109.9, 130.1, 149.9, 250.0]) / factor
    for prn in (19, 40):
        d = difference(made, prn, "B1CP", at_s)
        assert np.isneginf(d.power_db[0])
        assert d.phasor[1:3] == pytest.approx([-2.0, -2.0], abs=1e-3)
        assert d.code_m[1:3] == pytest.approx([0.0, 0.0], abs=1e-3)
        assert d.code_m[3] == pytest.approx(1.2 * 100 / factor, rel=1e-6)
        assert d.phase_cycles[3] == pytest.approx(d.phase_cycles[2], abs=1e-6)  # the same Doppler
    assert {t.signal for t in transmissions(made) if t.role == "spoof"} == {"B1CD", "B1CP"}


def test_delayed_data() -> None:
    made = induced(signals=["B1I", "B1C"], data="delayed", data_delay_ms=7.0)
    assert [added(made, 27, s)[0].emitter.data_delay_s for s in ("B1I", "B1CD", "B1CP")] == [
        pytest.approx(7e-3),
        pytest.approx(7e-3),
        0.0,
    ]


def test_guessed_data_become_known() -> None:
    made = induced(data="guessed", data_error_rate=0.25, data_known_s=6.0)
    index = np.arange(4000)
    right = authentic(made, 27, "B1CD").emitter.data_symbols(index)
    first, second = added(made, 27, "B1CD")
    wrong = np.count_nonzero(first.emitter.data_symbols(index) != right)
    assert abs(wrong - 1000) < 4 * math.sqrt(4000 * 0.25 * 0.75)
    assert np.array_equal(second.emitter.data_symbols(index), right)
    a, b = differences(made, 27, "B1CD", AT_S)
    assert np.array_equal(np.isfinite(a.power_db), (AT_S >= 2) & (AT_S < 6))
    assert np.array_equal(np.isfinite(b.power_db), AT_S >= 6)
    assert np.array_equal(a.phase_cycles, b.phase_cycles)
    assert len(added(made, 27, "B1CP")) == 1  # a pilot has none to guess
    assert [e["data_error_rate"] for e in truth(made)["emitters"][-3:]] == [0.25, 0.0, 0.0]


def test_waveform_of_antipodal_capture_with_late_data() -> None:
    """Amplitude 0.5 in antiphase, its data 5 ms late: half of the authentic where they agree."""
    made = scenario(
        {"prn": 27, "signals": ["B1I"], "start_s": 0.0, "eta": 0.5, "power_ramp_s": 0.0}
        | {"carrier_phase_cycles": "antipodal", "data": "delayed", "data_delay_ms": 5.0},
        duration_s=0.1,
        prns=(27,),
        cn0_dbhz=70.0,
        range_rate_m_s=0.0,
    )
    true, false = authentic(made, 27, "B1I").emitter, added(made, 27, "B1I")[0].emitter
    samples = int(0.02 * FS_HZ)
    x = iq(open_synthesizer(made, threads=1).generate(0, 2 * samples))
    full = 16 * math.sqrt(2 * 1e7 / FS_HZ)
    for start in (0, samples):
        at_s = (start + np.arange(samples)) / FS_HZ
        chips = np.floor(true.code_phase_chips(at_s)).astype(np.int64)
        late = round(5e-3 * 2.046e6)
        symbols = true.data_symbols(chips // 40920), true.data_symbols((chips - late) // 40920)
        agree = float(np.mean(symbols[0] * symbols[1]))
        part = x[start : start + samples]
        # 4 standard errors at 70 dB-Hz over 20 ms, and the clipping of 8-bit samples
        assert prompt(true, start, part) / full == pytest.approx(1 - 0.5 * agree, abs=0.01)
        # Against the spoofer's own replica, which is in antiphase.
        assert prompt(false, start, part) / full == pytest.approx(0.5 - agree, abs=0.01)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"eta": 1.5, "power_db": 3.0}, "power_db and eta say the same"),
        ({"drag_end_s": 9.0}, "drag_end_s 9 is before the drag has its full rate at 10 s"),
        ({"drag_start_s": None}, "drag_rate_m_s needs drag_start_s"),
        ({"drag_eta": 1.0, "drag_start_s": 4.5}, "before the end of the power ramp at 5 s"),
        ({"data": "delayed"}, "needs data_delay_ms"),
        ({"data_delay_ms": 3.0}, "data_delay_ms needs data = 'delayed'"),
        ({"data_known_s": 3.0}, "data_known_s needs data = 'guessed'"),
        ({"data": "guessed", "data_known_s": 1.0}, "data_known_s 1 must be after start_s 2"),
        ({"takeover": "seamless", "eta": 2.5}, "eta of at most 2"),
        ({"takeover": "seamless", "power_ramp_s": 0.0}, "power_ramp_s above 0"),
        ({"takeover": "seamless", "carrier_phase_cycles": 0.5}, "remove carrier_phase_cycles"),
        ({"prns": [27, 27]}, "names a satellite twice"),
        ({"prn": 27}, "prn and prns say the same"),
        ({"prns": [22]}, r"no \[\[satellite\]\] C22 with B1C for this attack"),
        ({"carrier_phase_cycles": "opposed"}, "'aligned' or 'antipodal'"),
    ],
)
def test_mistakes_are_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        induced(**change)


def test_full_drag_offset_in_the_truth() -> None:
    told = truth(induced(signals=["B1I", "B1C"]))["attacks"][0]
    for component in ("B1I", "B1CP"):
        expected = -1.2 * signal_spec(component).carrier_hz / C
        assert told["carrier_offset_hz"][component] == pytest.approx(expected)
    assert told["drag_end_s"] == 14.0
