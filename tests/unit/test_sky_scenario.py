"""What a sky puts on the air, and what is told of it."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from correlation import FS_HZ, iq, prompt
from skies import PLACE, satellite, sky

from sdr_spoof import _core
from sdr_spoof.correlator_level import simulate
from sdr_spoof.errors import ConfigError
from sdr_spoof.nav.messages import MESSAGES
from sdr_spoof.nav.records import SymbolRun
from sdr_spoof.records import State
from sdr_spoof.scenario import (
    builtin_scenario,
    load_scenario,
    open_synthesizer,
    synthesize,
    transmissions,
    truth,
    truth_path,
)
from sdr_spoof.signals import signal_spec

C = 299_792_458.0


def test_samples_correlate_where_the_truth_says() -> None:
    """A replica made of numbers of the truth alone, around one of its rows."""
    made = sky(elevation_mask_deg=60.0, cn0_zenith_dbhz=60.0, clock={"oscillator": "TCXO"})
    told = truth(made)
    row, count = 23, 500_000
    time_s = told["time_s"][row]
    start = round(time_s * FS_HZ)
    x = iq(open_synthesizer(made).generate(start, count))
    for t, numbers in zip(transmissions(made), told["emitters"], strict=True):
        if t.signal == "B1CP":
            continue  # the replica of correlation.py has no BOC(6,1)
        doppler_hz = numbers["doppler_hz"][row]
        turned = doppler_hz * time_s
        replica = _core.Emitter(
            t.signal,
            t.prn,
            60.0,
            delay_s=numbers["code_delay_s"][row] + turned / signal_spec(t.signal).carrier_hz,
            phase_cycles=-numbers["carrier_phase_cycles"][row] - turned,
            doppler_hz=doppler_hz,
            symbols=t.emitter.data_symbols(np.arange(-100, 3000)),
            first_symbol=-100,
        )
        found = prompt(replica, start, x)
        amplitude = 16.0 * math.sqrt(2 * 10 ** (numbers["cn0_dbhz"][row] / 10) / FS_HZ)
        # 20 ms of 60 dB-Hz (54 of B1CD) beside the others' codes, and samples on edges.
        assert found / amplitude == pytest.approx(1.0, abs=0.06), (t.signal, t.prn)


def test_tracks_follow_the_ranges_at_the_level_of_correlators() -> None:
    made = sky(elevation_mask_deg=57.0, systems=["C"], receiver=PLACE, signals=["B1I", "B1C"])
    sent = {(t.prn, t.signal): t.emitter for t in transmissions(made)}
    log = simulate(made)
    assert len(log.signals) > 6
    for t in log.signals:
        settled = (np.asarray(t.state) >= State.SYNCED) & (np.asarray(t.time_s) > 2.5)
        if not settled.any():
            continue  # D2 takes its time
        at_s, emitter = np.asarray(t.time_s)[settled], sent[t.prn, t.signal]
        late = emitter.code_phase_chips(at_s) - np.asarray(t.code_phase_chips)[settled]
        length = signal_spec(t.signal).code_length
        late = (late + length / 2) % length - length / 2
        metres = late * C / signal_spec(t.signal).chip_rate_hz
        assert abs(metres.mean()) < 2.0, (t.signal, t.prn)
        phase = np.asarray(t.carrier_phase_cycles)[settled] + emitter.received_phase_cycles(at_s)
        assert np.abs(phase - phase.mean()).max() < 0.1
        off_hz = np.asarray(t.doppler_hz)[settled] - emitter.doppler_hz(at_s)
        assert abs(off_hz.mean()) < 0.5


def test_turns_of_one_g_are_tracked() -> None:
    """The first turn of sky-moving, by a TCXO."""
    made = builtin_scenario("sky-moving").sped_up(3)
    sent = {(t.prn, t.signal): t.emitter for t in transmissions(made)}
    for t in simulate(made).signals:
        at_s = np.asarray(t.time_s)
        settled = (np.asarray(t.state) >= State.SYNCED) & (at_s > 4.0)
        assert State.LOST not in np.asarray(t.state)
        received = sent[t.prn, t.signal].received_phase_cycles(at_s[settled])
        off = np.asarray(t.carrier_phase_cycles)[settled] + received
        # A slip of half a cycle would be 0.5.
        assert np.ptp(off) < 0.25, (t.signal, t.prn)


@pytest.mark.parametrize(("signal", "prn"), [("B1I", 30), ("B1I", 1), ("L1CA", 25)])
def test_symbols_are_messages_of_the_orbit(signal: str, prn: int) -> None:
    made = sky(
        recording={"duration_s": 40.0}, signals=[signal], systems=["G" if prn == 25 else "C"]
    )
    (sent,) = (t for t in transmissions(made) if t.prn == prn)
    assert sent.has_message
    assert sent.data_seed is None
    spec, model = signal_spec(signal), made.sky_model()
    assert model is not None
    symbol_s = spec.period_s * (_core.periods_per_symbol(signal, prn) or 0)
    track = satellite(made, spec.system, prn).track
    sent_s = model.start - track.reference + 40.0
    indices = np.arange(round(sent_s / symbol_s))
    run = SymbolRun(
        signal=signal,
        prn=prn,
        code_phase_chips=indices * symbol_s * spec.chip_rate_hz,
        time_s=indices * symbol_s,
        values=sent.emitter.data_symbols(indices).astype(np.float32),
        symbol_s=symbol_s,
    )
    message = MESSAGES[track.ephemeris.message]
    frames = message.decode(run, near=model.start)
    whole = [f for f in frames if f.time_s + f.duration_s <= sent_s]
    assert whole
    for frame in whole:
        assert frame.ok
        # Code phases count from the reference: no symbol is off by one.
        sent_at = track.reference + frame.code_phase_chips / spec.chip_rate_hz
        assert frame.transmitted - sent_at == pytest.approx(0.0, abs=1e-6)
    (orbit,) = {e.toe for e in message.read(whole).ephemerides}
    assert orbit == track.ephemeris.toe


@pytest.mark.parametrize(("prn", "mask_deg", "edge"), [(25, 8.0, 0), (4, 15.0, 1)])
def test_satellites_rise_and_set(prn: int, mask_deg: float, edge: int) -> None:
    made = sky(
        recording={"duration_s": 1200.0},
        systems=["G"],
        signals=["L1CA"],
        elevation_mask_deg=mask_deg,
        messages=False,
    )
    track = satellite(made, "G", prn).track
    assert track.span_s is not None
    time_s = track.span_s[edge]
    elevation = np.degrees(track.view.way.elevation_rad)
    assert np.interp(time_s, track.sky.time_s, elevation) == pytest.approx(mask_deg, abs=1e-4)
    assert not math.isfinite(track.span_s[1 - edge])
    (sent,) = (t for t in transmissions(made) if t.prn == prn)
    assert (sent.start_s, sent.end_s)[edge] == time_s
    before, after = np.isfinite(sent.emitter.cn0_dbhz(time_s + np.array([-0.1, 0.1])))
    assert (before, after) == ((False, True) if edge == 0 else (True, False))


def test_cn0_by_elevation_and_by_name() -> None:
    fixed = {"prn": 30, "cn0_dbhz": 33.0}
    gone = {"prn": 38, "on_air": False}
    alone = {"prn": 27, "signals": ["B1I"]}
    made = sky(cn0_zenith_dbhz=48.0, cn0_horizon_dbhz=36.0, satellite=[fixed, gone, alone])
    names = {(s.system, s.prn) for s in made.satellites}
    assert ("C", 38) not in names
    assert satellite(made, "C", 27).signals == ("B1I",)
    for t in transmissions(made):
        if t.signal not in ("B1I", "L1CA"):
            continue
        elevation = satellite(made, t.system, t.prn).track.view.way.elevation_rad[30]
        expected = 36.0 + 12.0 * math.sin(elevation)
        expected = 33.0 if (t.system, t.prn) == ("C", 30) else expected
        assert t.emitter.cn0_dbhz(np.array([1.0]))[0] == pytest.approx(expected, abs=1e-4)


def test_the_truth_tells_of_receiver_and_satellites(tmp_path: Path) -> None:
    clock = {"offset_us": 20.0, "drift_ppb": 50.0}
    small = {"duration_s": 0.4, "sample_rate_hz": 5e6, "lo_hz": 1561.098e6}
    made = sky(recording=small, clock=clock, systems=["C"], signals=["B1I"])
    path = synthesize(made, tmp_path / "sky")
    told = json.loads(truth_path(path).read_text())
    receiver = told["sky"]["receiver"]
    assert len(told["time_s"]) == len(receiver["clock_s"]) == 5
    assert receiver["clock_s"][4] == pytest.approx(20e-6 + 0.4 * 50e-9, abs=1e-14)
    assert receiver["clock_drift"][2] == pytest.approx(50e-9, abs=1e-13)
    assert receiver["height_m"][0] == pytest.approx(30.0, abs=1e-3)
    assert told["sky"]["start"]["gpst_s"] == 1362657618
    for seen in told["sky"]["satellites"]:
        (sent,) = (e for e in told["emitters"] if e["prn"] == seen["prn"])
        way = np.array(seen["distance_m"])
        clocks = np.array(receiver["clock_s"]) - np.array(seen["satellite_clock_s"])
        delay = satellite(made, "C", seen["prn"]).track.ephemeris.group_delay_s("B1I")
        pseudorange = np.array(seen["pseudorange_m"]["B1I"])
        assert pseudorange == pytest.approx(way + C * (clocks + delay), abs=1e-3)
        code_s = np.array(sent["code_delay_s"]) - seen["delay_s"]
        assert C * code_s == pytest.approx(pseudorange, abs=1e-3)
        assert all(e > 5.0 for e in seen["elevation_deg"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"start": "2023-04-01T00:00:00"}, "has no orbit for 2023-04-01 00:00:00"),
        ({"start": "2023-03-12T18:00:00"}, "give the navigation of that day"),
        ({"start": "noon"}, "neither a date"),
        ({"elevation_mask_deg": 89.5}, "none of the .* satellites .* lower it"),
        ({"navigation": "/nowhere/x.rnx"}, "navigation: /nowhere/x.rnx: cannot be read"),
        ({"ionosphere": "bdgim"}, "give bdgim_tecu"),
        ({"klobuchar_alpha": (0.0, 0.0, 0.0, 0.0)}, "belong together"),
        ({"systems": ["G"], "signals": ["B1I"]}, "none of the systems"),
        ({"signals": ["B1I", "B1I"]}, "names a signal twice"),
        ({"receiver": {"kind": "train"}}, "train"),
    ],
)
def test_mistakes_are_told(change: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sky(**change)  # type: ignore[arg-type]


def test_start_in_every_form() -> None:
    forms = ("2023-03-12T12:00:00", "2023-03-12T20:00:00+08:00", "BDT 897 43204", "GPS 2253 43218")
    starts = {sky(start=f).sky_model().start for f in forms}  # type: ignore[union-attr]
    assert len(starts) == 1


@pytest.mark.parametrize("start", ["2023-03-12T12:00:07.3", "2023-03-12T11:59:59.999"])
def test_codes_begin_at_multiples_of_18_seconds(start: str) -> None:
    made = sky(start=start, elevation_mask_deg=50.0)
    for seen in made.satellites:
        track = satellite(made, seen.system, seen.prn).track
        week_s = track.reference.seconds - (14 if seen.system == "C" else 0)
        assert (week_s % 604_800 % 18, track.reference.fraction) == (0, 0.0)
        assert 1.0 <= track.sky.start - track.reference < 20.0


def test_messages_tell_of_the_atmosphere_that_there_is() -> None:
    tecu = (20.0, 1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0)
    bdgim = sky(ionosphere="bdgim", bdgim_tecu=tecu).sky_model()
    plain = sky(ionosphere="none").sky_model()
    usual = sky(ionosphere="klobuchar").sky_model()
    assert bdgim is not None and plain is not None and usual is not None
    assert bdgim.propagation.bdgim is not None
    assert bdgim.propagation.bdgim.alpha == tecu
    delay_m = bdgim.satellites[0].track.view.delays.ionosphere_m
    assert 1.0 < delay_m[0] < 40.0
    assert plain.propagation.klobuchar("C") is None
    known = usual.propagation.klobuchar("C")
    assert known is not None
    assert known.system == "C"
    assert known.alpha == usual.propagation.klobuchar("G").alpha  # type: ignore[union-attr]


def test_paths_are_from_the_folder_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_text(
        "[recording]\nduration_s = 1\nsample_rate_hz = 5e6\nlo_hz = 1561.098e6\n"
        'sample_format = "ci8"\n[sky]\nstart = 2023-03-12T12:00:00\nsignals = ["B1I"]\n'
        'navigation = "mine.rnx"\n[sky.receiver]\nkind = "static"\nlatitude_deg = 31\n'
        "longitude_deg = 121\n"
    )
    with pytest.raises(ConfigError, match=r"mine\.rnx: cannot be read") as error:
        load_scenario(tmp_path / "x.toml")
    assert str(tmp_path) in str(error.value)


def test_a_sky_is_as_fast_as_ever_when_time_flies() -> None:
    made = builtin_scenario("sky-static")
    fast = made.sped_up(10)
    assert fast.recording.duration_s == 6.0
    assert fast.sky == made.sky
    assert len(made.satellites) >= 10
