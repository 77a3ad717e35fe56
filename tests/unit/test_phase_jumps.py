"""Phase jumps: found at gaps, silent otherwise, and no gap where messages deny them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sdr_spoof import simulate
from sdr_spoof.nav.frames import decode
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.phase_jumps import phase_jumps_of
from sdr_spoof.records import SignalTrack, TrackLog
from sdr_spoof.scenario import Scenario, builtin_scenario
from sdr_spoof.studies.gaps import BEGIN, SKIES, Case, received
from sdr_spoof.tracking import TrackingConfig

C_A, ALL = SKIES["L1 C/A"], SKIES["all"]


def tracks(sky=C_A, gaps=(), cn0_dbhz=45.0, duration_s=8.0):
    return received(sky, "messages", Case(BEGIN, duration_s, gaps, cn0_dbhz, 4))[0]


def knocked(log: TrackLog, at_s: float, cycles: float) -> TrackLog:
    """All phases moved from an instant on, each elsewhere."""

    def moved(number: int, track: SignalTrack) -> SignalTrack:
        step = cycles * np.cos(2.4 * number) * (track.time_s > at_s)
        return replace(track, carrier_phase_cycles=track.carrier_phase_cycles + step)

    return replace(log, signals=tuple(moved(i, t) for i, t in enumerate(log.signals)))


@pytest.mark.parametrize("cn0_dbhz", [33.0, 45.0])
def test_silent_without_gaps(cn0_dbhz):
    """Also at the start, while some are not in step yet, and where pilots turn over."""
    assert phase_jumps_of(tracks(ALL, cn0_dbhz=cn0_dbhz, duration_s=3.0)) == []


def test_silent_in_turns():
    """The car of the package brakes and turns by up to 1 g."""
    values = builtin_scenario("sky-moving").model_dump(exclude_unset=True)
    values["recording"]["duration_s"] = 12.0
    scenario = Scenario.model_validate(values)
    assert phase_jumps_of(simulate(scenario, TrackingConfig())) == []


@pytest.mark.parametrize("missing_s", [0.001, 0.0073, 0.02, 0.3])
def test_every_gap_jumps(missing_s):
    """Whole symbols or not; the span holds the gap, and is no longer than lines and transients."""
    at_s = 3.7
    (jump,) = phase_jumps_of(tracks(gaps=((at_s, missing_s),)))
    assert jump.from_s < at_s < jump.until_s < at_s + 1.0
    assert at_s - jump.from_s < 0.2
    assert jump.satellites >= 4


def test_one_satellite_is_no_jump():
    log = tracks()
    first, *others = log.signals
    one = knocked(replace(log, signals=(first,)), 4.0, 0.2)
    assert phase_jumps_of(replace(log, signals=(*one.signals, *others))) == []


def test_messages_deny_a_knock():
    """Words go on in step, or frames do: an oscillator was knocked, and nothing is missing."""
    log = tracks(SKIES["B1I, D1"], duration_s=16.0)
    near = GnssTime.of_utc(BEGIN)
    before = decode(log, near).anchors
    for at_s in (0.9, 5.0, 13.9):
        shaken = knocked(log, at_s, 0.2)
        (jump,) = phase_jumps_of(shaken)
        assert jump.from_s < at_s < jump.until_s
        told = decode(shaken, near)
        noted = any("jumped at once" in n for n in told.notes)
        held = [(a.from_s, a.until_s) for a in told.anchors]
        if at_s == 0.9:
            assert noted and min(begin for begin, _ in held) > at_s
        else:
            assert not noted and held == [(a.from_s, a.until_s) for a in before]
