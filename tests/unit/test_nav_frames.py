"""Frame synchronisation and anchors on symbols with noise, slips, gaps and of either sign."""

from dataclasses import replace

import numpy as np
import pytest
from nav_air import NOON, air, content, noisy_run
from scipy.stats import norm

from sdr_spoof.nav import anchors
from sdr_spoof.nav.frames import decode_runs
from sdr_spoof.nav.messages import MESSAGES
from sdr_spoof.nav.soft import amplitude_and_noise, weighted
from sdr_spoof.nav.symbols import Stretch
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.signals import signal_spec

ALL = [("D1", 27), ("D2", 3), ("LNAV", 12)]
FRAME_START = GnssTime.of_week(897, 43_500, "C")
"""Of D1 and D2; LNAV's are 14 s apart."""


def _part(run, start, stop=None):
    part = slice(start, stop)
    return replace(
        run,
        code_phase_chips=run.code_phase_chips[part],
        time_s=run.time_s[part],
        values=run.values[part],
    )


def _times_are_right(frames, start):
    return all(abs((f.transmitted - start) - f.time_s) < 1e-9 for f in frames)


@pytest.mark.parametrize(("message", "prn"), ALL)
@pytest.mark.parametrize("sign", [1, -1])
def test_frames_of_either_sign_from_any_symbol_on(message, prn, sign) -> None:
    encoder = MESSAGES[message]
    run = air(message, prn, NOON, 14.0, sign=sign)
    per_frame = 300
    for first in (0, 1, 77, 299, 300):
        frames = encoder.decode(_part(run, first), NOON)
        assert _times_are_right(frames, NOON)
        assert {f.inverted for f in frames} == {sign < 0}
        whole = (run.values.size - first) // per_frame - 1
        assert sum(f.ok for f in frames) >= whole
        assert all(f.corrected == 0 for f in frames)


@pytest.mark.parametrize(("message", "prn"), ALL)
def test_time_from_the_start_of_one_subframe(message, prn) -> None:
    encoder = MESSAGES[message]
    symbols = {"D1": 60, "D2": 90, "LNAV": 90}[message]
    start = FRAME_START if message != "LNAV" else FRAME_START + -14.0
    run = _part(air(message, prn, start, 6.0), 0, symbols + 5)
    (frame,) = encoder.decode(run, NOON)
    assert frame.transmitted == start
    assert not frame.ok
    navigation = decode_runs([run], NOON)
    (anchor,) = navigation.anchors
    assert anchor.transmitted == start
    assert (anchor.from_s, anchor.until_s) == (0.0, pytest.approx((symbols + 5) * run.symbol_s))


@pytest.mark.parametrize(("message", "prn"), ALL)
def test_noise_alone_tells_no_time(message, prn) -> None:
    run = air(message, prn, NOON, 1200.0 if message != "D2" else 120.0)
    for seed in range(3):
        rng = np.random.default_rng([11, seed])
        noise = rng.standard_normal(run.values.size).astype(np.float32)
        bits = rng.choice(np.array([-1, 1], np.float32), run.values.size)
        assert MESSAGES[message].decode(replace(run, values=noise)) == []
        assert MESSAGES[message].decode(replace(run, values=bits)) == []
    assert MESSAGES[message].decode(replace(run, values=0 * noise)) == []


def test_first_ephemeris_after_18_s_and_a_preamble() -> None:
    run = air("D1", 27, FRAME_START, 18.0 + 0.22)
    navigation = decode_runs([run])
    (e,) = navigation.ephemerides
    assert e.toe == content(27, "D1").ephemeris.toe
    # Without the preamble that follows, nothing shows that subframe 3 kept its sign.
    assert decode_runs([_part(run, 0, 900)]).ephemerides == ()
    # Any 30 s hold all three subframes, whichever comes first.
    for first_s in (3.0, 9.0, 15.0, 21.0, 27.0):
        run = air("D1", 27, FRAME_START + first_s, 36.24)
        assert len(decode_runs([run]).ephemerides) == 1


def test_first_ephemeris_of_geostationary_satellites_and_gps() -> None:
    assert len(decode_runs([air("D2", 3, FRAME_START, 27.7)]).ephemerides) == 1
    assert len(decode_runs([air("LNAV", 12, FRAME_START + -14.0, 18.0)]).ephemerides) == 1


@pytest.mark.parametrize(("message", "prn", "cn0_dbhz"), [("D1", 27, 28), ("D1", 27, 24)])
def test_error_rates_follow_theory(message, prn, cn0_dbhz) -> None:
    run = air(message, prn, FRAME_START, 1800.0, cn0_dbhz=cn0_dbhz)
    sent = MESSAGES[message].encode(content(prn, message, FRAME_START), FRAME_START, 1800.0)
    snr = 10 ** (cn0_dbhz / 10) * run.symbol_s
    errors = np.count_nonzero((run.values < 0) != (sent < 0))
    expected = norm.sf(np.sqrt(2 * snr)) * sent.size
    assert errors == pytest.approx(expected, abs=4 * np.sqrt(expected) + 4)
    amplitude, noise = amplitude_and_noise(run.values)
    assert amplitude == pytest.approx(1.0, abs=0.01)
    assert noise == pytest.approx(np.sqrt(0.5 / snr), rel=0.03)
    frames = MESSAGES[message].decode(run)
    good = [f for f in frames if f.ok]
    assert _times_are_right(frames, FRAME_START)
    # Soft decisions: a block is wrong if any of its 35 neighbours at distance 3 is closer.
    block = 35 * norm.sf(np.sqrt(3 * 2 * snr))
    lost = 1 - (1 - block) ** 19
    assert len(frames) == 300
    assert len(good) >= 299 - 3 - 300 * (lost + 0.06 * (cn0_dbhz < 25))
    assert sum(f.corrected for f in good) == pytest.approx(errors * 285 / 300, rel=0.15, abs=4)


@pytest.mark.parametrize(("message", "prn", "cn0_dbhz"), [("D1", 27, 22.5), ("LNAV", 12, 23.0)])
def test_what_is_trusted_is_right_where_symbols_are_bad(message, prn, cn0_dbhz) -> None:
    start = FRAME_START if message == "D1" else FRAME_START + -14.0
    data = content(prn, message, start)
    clean = MESSAGES[message].decode(air(message, prn, start, 1800.0, cn0_dbhz=60))
    noisy = MESSAGES[message].decode(
        noisy_run(MESSAGES[message].encode(data, start, 1800.0), message, prn, cn0_dbhz)
    )
    truth = {f.code_phase_chips: f for f in clean}
    good = [f for f in noisy if f.ok]
    assert 30 < len(good) < 290
    assert len(noisy) > 200
    assert _times_are_right(noisy, start)
    same = slice(15, 300) if message == "D1" else slice(0, 300)
    assert all((f.bits[same] == truth[f.code_phase_chips].bits[same]).all() for f in good)


@pytest.mark.parametrize(("message", "prn"), ALL)
@pytest.mark.parametrize("at", [900, 900 + 30, 900 + 77, 900 + 150, 1199])
def test_a_half_cycle_slip_spoils_one_subframe_only(message, prn, at) -> None:
    start = FRAME_START if message != "LNAV" else FRAME_START + -14.0
    symbol_s = MESSAGES[message].symbol_s
    run = air(message, prn, start, 2400 * symbol_s)
    values = run.values.copy()
    values[at:] *= -1
    frames = MESSAGES[message].decode(replace(run, values=values), NOON)
    places = [round(f.time_s / symbol_s / 300) for f in frames]
    assert len(places) >= 7
    assert _times_are_right(frames, start)
    # A slip between two subframes shows in the first one's closing preamble, in D1 and D2.
    spoilt = {2} if at == 900 else {3}
    if message == "LNAV":
        spoilt -= {2}
    else:
        spoilt.add(7)  # its closing preamble is not there
    assert {k for k, f in zip(places, frames, strict=True) if f.ok} == set(range(8)) - spoilt
    assert [f.inverted for f in frames] == [k * 300 >= at for k in places]


@pytest.mark.parametrize(("message", "prn"), ALL)
def test_missing_symbols_spoil_one_subframe_only(message, prn) -> None:
    start = FRAME_START if message != "LNAV" else FRAME_START + -14.0
    run = air(message, prn, start, 2400 * MESSAGES[message].symbol_s)
    values = run.values.copy()
    values[930:955] = 0.0
    frames = MESSAGES[message].decode(replace(run, values=values), NOON)
    assert _times_are_right(frames, start)
    good = {round(f.code_phase_chips / run.code_phase_chips[300]) for f in frames if f.ok}
    assert good - {7} == {0, 1, 2, 4, 5, 6}


@pytest.mark.parametrize(("message", "prn"), [("D1", 27), ("LNAV", 12)])
def test_bursts_of_noise_are_not_trusted(message, prn) -> None:
    """The mean noise of the run is far below that of the bursts."""
    start = FRAME_START if message != "LNAV" else FRAME_START + -14.0
    strong = air(message, prn, start, 1800.0, cn0_dbhz=40)
    weak = air(message, prn, start, 1800.0, cn0_dbhz=20, seed=5)
    values = strong.values.copy()
    bursts = [slice(5000 + 17_000 * k, 8000 + 17_000 * k) for k in range(5)]
    for burst in bursts:
        values[burst] = weak.values[burst]
    amplitude, noise = amplitude_and_noise(values)
    weights = weighted(values, noise / amplitude) / values
    assert all((weights[b] < 0.7).mean() > 0.95 for b in bursts)
    assert (weights > 0.99).mean() > 0.8
    truth = {f.code_phase_chips: f for f in MESSAGES[message].decode(strong)}
    frames = MESSAGES[message].decode(replace(strong, values=values))
    assert _times_are_right(frames, start)
    good = [f for f in frames if f.ok]
    assert all((f.bits[15:] == truth[f.code_phase_chips].bits[15:]).all() for f in good)
    inside = [f for f in good if any(b.start <= f.time_s * 50 <= b.stop - 300 for b in bursts)]
    assert len(inside) < 3
    assert len(good) > 235


def test_steady_symbols_are_all_weighted_alike() -> None:
    for cn0_dbhz in (22, 25, 40):
        run = air("D1", 27, FRAME_START, 1800.0, cn0_dbhz=cn0_dbhz)
        amplitude, noise = amplitude_and_noise(run.values)
        same = weighted(run.values, noise / amplitude) == run.values
        assert same.mean() > 0.995


def _with_gap(run, at, dropped):
    """The recording lost so many symbols: the code goes on counting without them."""
    chips = run.code_phase_chips
    keep = chips.size - dropped
    return replace(
        run,
        code_phase_chips=chips[:keep],
        time_s=run.time_s[:keep],
        values=np.concatenate([run.values[:at], run.values[at + dropped :]]),
    )


def test_dropped_samples_give_a_new_anchor() -> None:
    run = _with_gap(air("D1", 27, FRAME_START, 60.0), 1400, 31)
    navigation = decode_runs([run])
    before, after = navigation.anchors
    (note,) = navigation.notes
    assert "C27 B1I: its time jumps by +0.620 s" in note
    rate = signal_spec("B1I").chip_rate_hz
    assert before.until_s <= 1400 * 0.02 + 1e-9 < after.from_s
    assert before.transmitted - FRAME_START == pytest.approx(before.code_phase_chips / rate)
    later = after.transmitted - FRAME_START - after.code_phase_chips / rate
    assert later == pytest.approx(31 * 0.02)
    assert [f.ok for f in navigation.frames] == [True] * 4 + [True] * 4 + [False]


@pytest.mark.parametrize(("message", "prn"), [("D2", 3), ("LNAV", 12)])
def test_whole_symbols_dropped_from_plain_codes(message, prn) -> None:
    """The tracker sees where their symbols begin, so that the time after the jump is exact."""
    start = FRAME_START if message != "LNAV" else FRAME_START + -14.0
    run = _with_gap(air(message, prn, start, 3000 * MESSAGES[message].symbol_s), 1400, 31)
    navigation = decode_runs([run], NOON)
    before, after = navigation.anchors
    at_s = 1400 * run.symbol_s
    assert at_s - 300 * run.symbol_s < before.until_s <= at_s + 1e-9 <= after.from_s
    assert after.from_s < at_s + 300 * run.symbol_s
    jump_s = after.transmitted - anchors.at(before, after.code_phase_chips)
    assert jump_s == pytest.approx(31 * run.symbol_s)
    (note,) = navigation.notes
    assert "missing from the recording" in note
    assert len(navigation.frames) > 7


def test_one_misread_time_does_not_move_the_anchor() -> None:
    run = air("D1", 27, FRAME_START, 48.5)
    frames = MESSAGES["D1"].decode(run)
    wrong = replace(frames[3], transmitted=frames[3].transmitted + 30.0)
    stretch = Stretch("B1I", 27, 0.0, 48.5)
    (anchor,) = anchors.from_frames([*frames[:3], wrong, *frames[4:]], stretch)
    assert anchor.transmitted == FRAME_START
    assert (anchor.from_s, anchor.until_s) == (0.0, 48.5)


def test_the_week_comes_from_another_satellite_or_the_caller() -> None:
    whole = air("D1", 27, FRAME_START, 12.5)
    short = _part(air("LNAV", 12, FRAME_START, 24.0), 200, 700)
    both = decode_runs([whole, short])
    assert {(a.signal, a.prn) for a in both.anchors} == {("B1I", 27), ("L1CA", 12)}
    assert all(_times_are_right([f], FRAME_START) for f in both.frames)
    alone = decode_runs([short])
    assert alone.anchors == ()
    assert any("week" in note for note in alone.notes)
    dated = decode_runs([short], FRAME_START + 86_400.0)
    assert dated.anchors[0].transmitted == both.anchors[1].transmitted
    assert dated.notes == ()


def test_a_satellite_with_another_time_is_told() -> None:
    runs = [air("D1", prn, FRAME_START, 13.0) for prn in (27, 30, 36)]
    late = air("D1", 28, FRAME_START + -6.0, 13.0)
    assert decode_runs(runs).notes == ()
    (note,) = decode_runs([*runs, late]).notes
    assert note.startswith("C28 B1I tells a time -6.000 s from that of the others")


def test_decoding_does_not_depend_on_amplitude() -> None:
    run = air("D1", 27, FRAME_START, 20.0, cn0_dbhz=25)
    strong = replace(run, values=1000 * run.values)
    one, other = (MESSAGES["D1"].decode(r) for r in (run, strong))
    assert [f.transmitted for f in one] == [f.transmitted for f in other]
    assert all((a.bits == b.bits).all() for a, b in zip(one, other, strict=True))


def test_a_message_that_ends_before_its_signal_is_told() -> None:
    """As after missing samples of whole code periods, which the loops do not notice."""
    run = air("D1", 27, NOON, 40)
    frames = MESSAGES["D1"].decode(run, NOON)
    end_s = frames[-1].time_s + 6.0
    assert anchors.silences(frames, Stretch("B1I", 27, 0.0, end_s + 11.0)) == []
    (told,) = anchors.silences(frames, Stretch("B1I", 27, 0.0, end_s + 13.0))
    assert told.startswith(f"C27 B1I: no message was received after {end_s:.1f} s")
    assert anchors.silences([], Stretch("B1I", 27, 0.0, 99.0)) == []


@pytest.mark.parametrize(("message", "prn"), ALL)
def test_frames_before_a_stronger_signal_takes_over(message, prn) -> None:
    # A capture raises the amplitude threefold: what was said before is as good as it was.
    clean = air(message, prn, NOON, 60.0)
    run = noisy_run(clean.values, message, prn, 40.0, seed=3)
    stronger = run.values.copy()
    stronger[run.values.size // 2 :] *= 3.0
    frames = MESSAGES[message].decode(replace(run, values=stronger), NOON)
    even = MESSAGES[message].decode(run, NOON)
    assert [f.ok for f in frames] == [f.ok for f in even]
    assert sum(f.ok for f in frames) >= 60.0 / (300 * run.symbol_s) - 2
