"""A change of ephemeris within a recording: sent, gathered as a whole, switched to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from nav_air import noisy_run
from observed_sky import EXACT, START, Sky, navigation, nearest
from skies import satellite, sky

from sdr_spoof import pvt, simulate
from sdr_spoof.config import load_config
from sdr_spoof.nav.broadcast import Broadcast, Contents
from sdr_spoof.nav.messages import MESSAGES
from sdr_spoof.nav.orbit import states
from sdr_spoof.nav.records import Navigation, SymbolRun
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.positioning import locate
from sdr_spoof.records import State
from sdr_spoof.scenario import truth
from sdr_spoof.signals import signal_spec

HOUR = GnssTime.of_week(897, 43_200.0, "C")
"""2023-03-12 12:00 BDT, which is 14 s after 12:00 GPST."""
NOON = GnssTime.of_week(2253, 43_200.0, "G")


def sent(message: str, system: str, prn: int, signal: str, boundary: GnssTime, lead_s: float):
    """A run of symbols of a sky whose messages change at a boundary, without noise."""
    date = (boundary + -lead_s).utc().isoformat().removesuffix("+00:00")
    made = sky(
        recording={"duration_s": 140.0}, start=date, signals=[signal], systems=[system],
        new_issues=True,
    )  # fmt: skip
    track = satellite(made, system, prn).track
    component = {"B1C": "B1CD"}.get(signal, signal)
    symbols = track.symbols(signal_spec(component))
    assert symbols is not None
    run = (
        noisy_run(symbols, message, prn, 60.0)
        if message != "CNV1"
        else SymbolRun(
            component, prn, np.arange(symbols.size) * 10230.0, np.arange(symbols.size) * 0.01,
            symbols.astype(np.float32), 0.01,
        )
    )  # fmt: skip
    return track, run


@pytest.mark.parametrize(
    ("message", "system", "prn", "signal"),
    [("D1", "C", 27, "B1I"), ("D2", "C", 3, "B1I"), ("LNAV", "G", 25, "L1CA"),
     ("CNV1", "C", 27, "B1C")],
)  # fmt: skip
def test_both_issues_come_out_whole_and_nothing_between(message, system, prn, signal):
    boundary = NOON if system == "G" else HOUR
    track, run = sent(message, system, prn, signal, boundary, 70.0)
    told = MESSAGES[message].read(MESSAGES[message].decode(run, boundary))
    known = [
        e
        for e in track.sky.navigation.ephemerides
        if (e.system, e.prn) == (system, prn) and abs(e.toe - boundary) < 7300
    ]
    old, new = (
        (
            min(known, key=lambda e: abs(e.toe - boundary)),
            max(known, key=lambda e: e.toe - boundary),
        )
        if system == "G"
        else (
            min(known, key=lambda e: abs(e.toe + 3600 - boundary)),
            min(known, key=lambda e: abs(e.toe - boundary)),
        )
    )
    assert [e.toe for e in told.ephemerides] == [old.toe, new.toe]
    for found, expected in zip(told.ephemerides, (old, new), strict=True):
        at = boundary - expected.toe
        apart = positions(found, at, expected.toe) - positions(expected, at, expected.toe)
        assert np.linalg.norm(apart) < 0.05  # the fields' quanta
        assert found.toc == expected.toc
    assert told.ephemerides[0].transmitted < boundary
    assert not told.ephemerides[1].transmitted < boundary


def positions(ephemeris, time_s, start):
    return states([ephemeris], np.zeros(1, np.int64), np.array([time_s]), start).position_m[0]


def test_the_truth_tells_the_issues_and_by_default_there_is_one():
    date = (HOUR + -5.0).utc().isoformat().removesuffix("+00:00")
    for new_issues, count in ((True, 2), (False, 1)):
        made = sky(
            recording={"duration_s": 8.0}, start=date, signals=["B1I"], systems=["C"],
            new_issues=new_issues,
        )  # fmt: skip
        for told in truth(made)["sky"]["satellites"]:
            assert len(told["issues"]) == count
            assert told["issues"][0]["from_s"] == 0.0
            if count == 2:
                assert told["issues"][1]["from_s"] == pytest.approx(5.0)


def frames_of(message: str, prn: int, change: int, count: int):
    """Frames of two sets that change after some frames, within an hour, ages of data the same."""
    own = sorted(
        (e for e in navigation().ephemerides if (e.system, e.prn) == ("C", prn)),
        key=lambda e: e.toe,
    )
    old, new = own[1], replace(own[2], iode=own[1].iode, iodc=own[1].iodc)
    frame_s = {"D1": 30.0, "D2": 3.0}[message]
    start = GnssTime.of_week(897, 21_600.0, "C") + 600.0
    coder = MESSAGES[message]
    middle = start + change * frame_s
    parts = [
        coder.encode(Broadcast(old), start, change * frame_s),
        coder.encode(Broadcast(new), middle, (count - change) * frame_s + 1.0),
    ]
    run = noisy_run(np.concatenate(parts), message, prn, 60.0)
    return (old, new), coder.decode(run, start)


@pytest.mark.parametrize(
    ("message", "prn", "change", "count"), [("D1", 27, 4, 9), ("D2", 3, 20, 50)]
)
def test_parts_of_two_sets_are_never_mixed_whatever_is_lost(message, prn, change, count):
    """Nothing in D1 and D2 marks a set where its ages stay the same, and this one changes at no
    full hour."""
    both, frames = frames_of(message, prn, change, count)
    whole = {}
    for e in MESSAGES[message].read(frames).ephemerides:
        whole[replace(e, transmitted=HOUR)] = e
    assert {e.toe for e in whole} == {e.toe for e in both}
    assert len(whole) == 2
    rng = np.random.default_rng(3)
    # With half of the pages of D2 lost, those of a new set may be just those lost of the old.
    for share in (0.1, 0.3, 0.5) if message == "D1" else (0.05, 0.1, 0.2):
        for _ in range(60):
            kept = [f for f in frames if rng.random() > share]
            for e in MESSAGES[message].read(kept).ephemerides:
                assert replace(e, transmitted=HOUR) in whole


def test_the_fix_steps_by_what_the_ephemerides_differ():
    """Received over the hour; the nearest reference serves, so that all switch at half past."""
    hour = GnssTime.of_week(897, 25_200.0, "C")  # 07:00 BDT
    found = Contents()
    for (system, prn), old in nearest(START).items():
        if system == "C":
            found += received(prn, old.message, hour)
    sky_ = Sky("C", epochs=50, interval_s=60.0)
    fixes = pvt.solve(sky_.observe(), Navigation(**vars(found)), EXACT)
    error = np.linalg.norm(fixes.position_m - sky_.place, axis=1)
    assert error[:30].max() < 0.2  # the message's quanta
    switch = int(np.argmax(np.linalg.norm(np.diff(fixes.position_m, axis=0), axis=1))) + 1
    # Half past six in BDT is 30.2 minutes after START; spans of choice are half a minute.
    assert abs(switch - 30) <= 1
    apart = differences(found, START + 60.0 * switch)
    step = np.linalg.norm(fixes.position_m[switch] - fixes.position_m[switch - 1])
    assert 0.05 < step < 3.0 * apart
    print(f"step {step:.2f} m, ephemerides differ by up to {apart:.2f} m")


def received(prn: int, message: str, hour: GnssTime) -> Contents:
    """What a satellite says about the change of an hour."""
    own = [e for e in navigation().ephemerides if (e.system, e.prn) == ("C", prn)]
    before, after = (
        min(own, key=lambda e, at=at: abs(e.toe - at)) for at in (hour + -3600.0, hour)
    )
    coder = MESSAGES[message]
    parts = [
        coder.encode(Broadcast(before), hour + -60.0, 60.0),
        coder.encode(Broadcast(after), hour, 61.0),
    ]
    run = noisy_run(np.concatenate(parts), message, prn, 60.0)
    told = coder.read(coder.decode(run, hour))
    return Contents(ephemerides=told.ephemerides)


def differences(found: Contents, time: GnssTime) -> float:
    """Largest difference of a satellite's two sets at a time, orbit and clock, in m."""
    pairs: dict[int, list[np.ndarray]] = {}
    for e in found.ephemerides:
        at = states([e], np.zeros(1, np.int64), np.zeros(1), time)
        pairs.setdefault(e.prn, []).append(np.append(at.position_m[0], 299792458.0 * at.clock_s[0]))
    return max(float(np.linalg.norm(p[1] - p[0])) for p in pairs.values() if len(p) == 2)


def test_tracks_over_the_boundary_give_fixes_before_and_after():
    """Loops, messages and positions over a change, at the level of correlators."""
    date = (HOUR + -36.0).utc().isoformat().removesuffix("+00:00")
    made = sky(
        recording={"duration_s": 70.0, "sample_rate_hz": 10e6, "lo_hz": 1561.098e6},
        start=date, signals=["B1I"], systems=["C"], elevation_mask_deg=45.0, new_issues=True,
    )  # fmt: skip
    log = simulate(made)
    assert all(State.LOST not in np.asarray(t.state) for t in log.signals)
    found = locate(log, load_config(flags={"pvt.ionosphere": "none", "pvt.troposphere": "none"}))
    toes = {e.toe for e in found.navigation.ephemerides}
    assert toes == {HOUR, HOUR + -3600.0}
    assert found.fixes.fixed.sum() >= 65
    steps = np.linalg.norm(np.diff(found.fixes.position_m[found.fixes.fixed], axis=0), axis=1)
    assert steps.max() < 8.0
