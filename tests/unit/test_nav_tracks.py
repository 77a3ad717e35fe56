"""From the receiver's own loops to symbols, frames, ephemerides and time anchors."""

from dataclasses import replace

import numpy as np
import pytest
from nav_air import LEAD_S, Sent, track

from sdr_spoof.nav import anchors, frames
from sdr_spoof.nav.messages import MESSAGES
from sdr_spoof.nav.symbols import stretches_of, symbols_of
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.records import State
from sdr_spoof.signals import signal_spec
from sdr_spoof.tracking import TrackingConfig

START = GnssTime.of_week(897, 43_500 - 2.6, "C")
"""2.6 s before a frame of D1 and D2."""
DATA = TrackingConfig(fallback=False, data_component=True)


def _log(*sent, duration_s=22.0, **more):
    log, emitters = track(*sent, start=START, duration_s=duration_s, **more)
    by_name = {(e.signal, e.prn): e for e in emitters}
    return log, by_name


def _assert_anchored(log, emitters, navigation, tracks=None):
    """Each anchor tells when its rows were sent, to a microsecond: as the code is tracked."""
    for t in log.signals:
        rate = signal_spec(t.signal).chip_rate_hz
        emitter = emitters[t.signal, t.prn]
        held = [a for a in navigation.anchors if (a.signal, a.prn) == (t.signal, t.prn)]
        if tracks is not None:
            assert len(held) == tracks[t.signal, t.prn], (t.signal, t.prn)
        for a in held:
            rows = (t.time_s >= a.from_s) & (t.time_s <= a.until_s)
            assert rows.any()
            true = emitter.code_phase_chips(t.time_s[rows]) / rate
            told = (a.transmitted - (START + -LEAD_S)) - a.code_phase_chips / rate
            error = told + t.code_phase_chips[rows] / rate - true
            assert np.abs(error).max() < 1e-6, (t.signal, t.prn)


@pytest.mark.parametrize("integration_ms", [1, 5, 10, 20])
def test_anchors_tell_the_transmit_time(integration_ms) -> None:
    config = TrackingConfig(fallback=False, integration_ms=integration_ms)
    sent = (
        Sent("B1I", 27),
        Sent("B1CP", 27),
        Sent("B1I", 3, cn0_dbhz=42.0, doppler_hz=30.0),
        Sent("L1CA", 12, cn0_dbhz=38.0, doppler_hz=-3100.0),
        Sent("B1I", 30, cn0_dbhz=33.0, doppler_hz=-2000.0),
    )
    log, emitters = _log(*sent, config=config)
    navigation = frames.decode(log)
    assert navigation.notes == ()
    _assert_anchored(log, emitters, navigation, {(s.signal, s.prn): 1 for s in sent})
    assert {(e.system, e.prn) for e in navigation.ephemerides} >= {("C", 27), ("C", 30)}


def test_symbols_are_those_sent() -> None:
    rng = np.random.default_rng(8)
    data = rng.choice(np.array([-1, 1], np.int8), 4000)
    sent = (
        Sent("B1I", 30),
        Sent("L1CA", 9),
        Sent("B1CP", 30),
        Sent("B1CD", 30, 42.0, symbols=data),
    )
    log, _ = _log(*sent, duration_s=12.0, config=DATA)
    for t in log.signals:
        (run,) = symbols_of(t)
        signal, symbol_s, chips = {
            "B1CP": ("B1CD", 0.01, 10_230),
            "L1CA": ("L1CA", 0.02, 20_460),
            "B1I": ("B1I", 0.02, 40_920),
        }[t.signal]
        assert (run.signal, run.symbol_s) == (signal, pytest.approx(symbol_s))
        assert np.diff(run.code_phase_chips) == pytest.approx(chips)
        assert np.abs(run.values).mean() == pytest.approx(1.0, abs=1e-3)
        assert np.all(np.diff(run.time_s) == pytest.approx(run.symbol_s, abs=1e-6))
    pilot = next(t for t in log.signals if t.signal == "B1CP")
    (run,) = symbols_of(pilot)
    signs = np.sign(run.values)
    first = next(k for k in range(2000) if (signs[:200] == data[k : k + 200]).all())
    assert (signs == data[first : first + signs.size]).all()


def test_a_pilot_alone_has_no_symbols_but_takes_the_time_of_the_other_signal() -> None:
    log, emitters = _log(Sent("B1I", 27), Sent("B1CP", 27), duration_s=12.0)
    pilot = next(t for t in log.signals if t.signal == "B1CP")
    assert symbols_of(pilot) == []
    navigation = frames.decode(log, START)
    _assert_anchored(log, emitters, navigation, {("B1I", 27): 1, ("B1CP", 27): 1})
    (anchor,) = [a for a in navigation.anchors if a.signal == "B1CP"]
    assert anchor.code_phase_chips % 10_230 == 0
    assert round(anchor.transmitted.fraction * 1e9) % 10_000_000 == 0


def test_a_slip_in_the_middle() -> None:
    log, emitters = _log(Sent("B1I", 27, flips=(11.0,)), duration_s=30.0)
    navigation = frames.decode(log)
    _assert_anchored(log, emitters, navigation, {("B1I", 27): 1})
    flags = {round(f.transmitted.week_tow("C")[1]): f for f in navigation.frames}
    assert not flags[43_506].ok
    assert flags[43_500].ok
    assert flags[43_512].ok
    assert flags[43_500].inverted != flags[43_512].inverted


def test_a_signal_that_is_lost_begins_a_new_run() -> None:
    gone = ((0.0, 0.0), (11.9, 0.0), (12.0, -60.0), (14.0, -60.0), (14.1, 0.0))
    log, emitters = _log(Sent("B1I", 27, power_db=gone), Sent("B1I", 30), duration_s=30.0)
    t = next(t for t in log.signals if t.prn == 27)
    assert (t.state == State.LOST).any()
    assert len(stretches_of(t)) == 2
    runs = symbols_of(t)
    assert len(runs) == 2
    assert runs[0].time_s[-1] < 12.6
    assert runs[1].time_s[0] > 14.0
    navigation = frames.decode(log)
    _assert_anchored(log, emitters, navigation, {("B1I", 27): 2, ("B1I", 30): 1})
    first, second = sorted((a for a in navigation.anchors if a.prn == 27), key=lambda a: a.from_s)
    assert first.until_s < second.from_s


def test_missing_rows_are_missing_symbols() -> None:
    log, emitters = _log(Sent("B1I", 27), duration_s=22.0)
    (t,) = log.signals
    keep = np.ones(t.epochs, dtype=bool)
    keep[1500:1507] = False
    holed = replace(t, **{name: getattr(t, name)[keep] for name in t.columns()})
    (run,) = symbols_of(holed)
    assert np.count_nonzero(run.values == 0) == 4
    navigation = frames.decode(replace(log, signals=(holed,)))
    _assert_anchored(log, emitters, navigation, {("B1I", 27): 1})


def test_a_short_or_empty_track_has_none() -> None:
    log, _ = _log(Sent("B1I", 27), duration_s=0.2)
    assert frames.decode(log).frames == ()
    (t,) = log.signals
    assert symbols_of(t.part(0, 0)) == []
    assert frames.decode(replace(log, signals=())).anchors == ()


def test_unbroken_track_matches_message_decode() -> None:
    log, _ = _log(Sent("B1I", 3), duration_s=8.0)
    (run,) = symbols_of(log.signals[0])
    own = MESSAGES["D2"].decode(run, START)
    navigation = frames.decode(log, START)
    assert [f.transmitted for f in navigation.frames] == [f.transmitted for f in own]
    frame = own[3]
    anchor = navigation.anchors[0]
    assert anchors.at(anchor, frame.code_phase_chips) - frame.transmitted == pytest.approx(
        0, abs=1e-9
    )


def test_b_cnav1_dates_the_pilot_beside_it() -> None:
    sent = (Sent("B1CP", 27, 44.0), Sent("B1CD", 27, 38.0))
    log, emitters = _log(*sent, duration_s=42.0, config=DATA)
    navigation = frames.decode(log)
    assert {f.message for f in navigation.frames} == {"CNV1"}
    _assert_anchored(log, emitters, navigation, {("B1CP", 27): 1})
    assert {e.message for e in navigation.ephemerides} == {"CNV1"}


def test_both_messages_of_a_satellite() -> None:
    sent = (Sent("B1I", 27), Sent("B1CP", 27, 44.0), Sent("B1CD", 27, 38.0))
    log, emitters = _log(*sent, duration_s=42.0, config=DATA)
    navigation = frames.decode(log)
    assert navigation.notes == ()
    assert {e.message for e in navigation.ephemerides} == {"CNV1", "D1"}
    _assert_anchored(log, emitters, navigation, {("B1CP", 27): 1, ("B1I", 27): 1})


def test_the_pilot_hands_the_time_on_where_the_other_signal_was_lost() -> None:
    gone = ((0.0, 0.0), (16.9, 0.0), (17.0, -60.0), (18.5, -60.0), (18.6, 0.0))
    sent = (Sent("B1I", 27, power_db=gone), Sent("B1CP", 27))
    log, emitters = _log(*sent, duration_s=22.0)
    navigation = frames.decode(log, START)
    # The second stretch of B1I is too short for a subframe.
    _assert_anchored(log, emitters, navigation, {("B1I", 27): 2, ("B1CP", 27): 1})


def test_a_jump_holds_for_the_other_signal_too() -> None:
    log, _ = _log(Sent("B1I", 27), Sent("B1CP", 27), duration_s=20.0)
    navigation = frames.decode(log, START)
    (own,) = [a for a in navigation.anchors if a.signal == "B1I"]
    halves = (
        replace(own, until_s=9.0),
        replace(own, from_s=11.0, transmitted=own.transmitted + 0.5),
    )
    tracks = {t.signal: t for t in log.signals}
    (stretch,) = stretches_of(tracks["B1CP"])
    borrowed = anchors.from_others(stretch, tracks["B1CP"], [(a, tracks["B1I"]) for a in halves])
    before, after = borrowed
    assert before.until_s == 9.0
    assert after.from_s == 11.0
    jump = after.transmitted - anchors.at(before, after.code_phase_chips)
    assert jump == pytest.approx(0.5, abs=1e-9)
