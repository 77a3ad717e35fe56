"""Samples missing from a recording: found, told, and no fix across them with a wrong time."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from test_positioning import BROADCAST, PLACE, PLAIN, SKY, START

from sdr_spoof import simulate
from sdr_spoof.config import load_config
from sdr_spoof.fixes import Status
from sdr_spoof.gaps import CountBreak, gaps_of, uncounted
from sdr_spoof.nav.geodesy import enu, geodetic_to_ecef
from sdr_spoof.nav.missing import outages
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.observables.runs import runs_of
from sdr_spoof.positioning import locate
from sdr_spoof.records import State, TrackLog
from sdr_spoof.scenario import load_scenario
from sdr_spoof.signals import LIGHT_M_S
from sdr_spoof.sinks.hdf5 import Result, read_result, write_result
from sdr_spoof.sources import RecordingFormat

DURATION_S = 33.0
FLAGS = PLAIN | {"navigation.files": str(BROADCAST), "observables.rate_hz": "10"}
SIGMAS = 5.0
"""No sure place is farther off, in standard deviations of its own."""
Gaps = tuple[tuple[float, float], ...]


@pytest.fixture(scope="module")
def sky(tmp_path_factory):
    folder: Path = tmp_path_factory.mktemp("gaps")

    @cache
    def of(signals: str = '"B1I"', systems: str = '"C"', lost_s: float = 1.1):
        lo = 1561.098e6 if systems == '"C"' else 1575.42e6
        text = SKY.format(duration=DURATION_S + lost_s, signals=signals, rate=10e6, lo=lo)
        path = folder / "sky.toml"
        path.write_text(text.replace('["C"]', f"[{systems}]"))
        return load_scenario(path)

    return of


def _fixes(scenario, gaps: Gaps):
    """Times of fixes by the samples, errors of time and place, whether each is called sure, and the
    error of the place over the standard deviation that the fix states."""
    log = simulate(scenario, gaps=gaps)
    found = locate(log, load_config(flags=FLAGS))
    fixes, rows = found.fixes, np.flatnonzero(found.fixes.fixed)
    sampled_s = found.observations.sample_time_s[rows]
    missing_s = sum(length * (sampled_s >= at) for at, length in gaps)
    start = GnssTime.of_utc(START)
    late = np.array([found.observations.time(i) + -fixes.clock_s[i] - start for i in rows])
    away = np.linalg.norm(enu(fixes.position_m[rows], geodetic_to_ecef(PLACE)), axis=1)
    sure = fixes.status[rows] == Status.FIX
    stated = np.sqrt(np.trace(fixes.covariance_m2[rows], axis1=1, axis2=2))
    return log, found, sampled_s, late - (sampled_s + missing_s), away, sure, away / stated


@pytest.mark.parametrize("missing_s", [0.001, 0.003, 0.0073, 0.020, 1.0])
@pytest.mark.parametrize("at_s", [20.2, 12.0, 31.5])
def test_no_sure_fix_with_a_wrong_time(sky, at_s, missing_s):
    """At the start of a subframe, within one, and too late for another one."""
    gaps = ((at_s, missing_s),)
    _, found, sampled_s, late_s, away_m, sure, sigmas = _fixes(sky(), gaps)
    assert np.abs(late_s[sure]).max() < 1e-6
    assert sigmas[sure].max() < SIGMAS
    assert np.median(away_m[sure]) < 3.0
    assert (sampled_s < at_s - 1.0).any()
    assert (sampled_s > at_s + 8.0).any() == (at_s < 31.0)
    if at_s < 31.0 or missing_s in (0.001, 0.003):
        assert any("samples" in n and "missing" in n for n in found.notes)


@pytest.mark.parametrize(
    "gaps",
    [
        ((14.1, 0.003), (22.3, 0.001)),
        ((20.1, 0.003), (20.3, 0.007)),
        ((14.1, 0.020), (22.3, 1.0)),
    ],
)
def test_two_gaps(sky, gaps: Gaps):
    _, _, sampled_s, late_s, _, sure, sigmas = _fixes(sky(), gaps)
    assert np.abs(late_s[sure]).max() < 1e-6
    assert sigmas[sure].max() < SIGMAS
    assert (sampled_s[sure] > gaps[-1][0] + 3.0).any()


@pytest.mark.parametrize("missing_s", [0.003, 0.020])
def test_gps(sky, missing_s):
    """Plain codes: bit edges show the one, parity of words the other."""
    scenario = sky('"L1CA"', '"G"')
    _, _, sampled_s, late_s, _, sure, sigmas = _fixes(scenario, ((22.2, missing_s),))
    assert np.abs(late_s[sure]).max() < 1e-6
    assert sigmas[sure].max() < SIGMAS
    assert (sampled_s < 22.2).any() and (sampled_s > 26.0).any()


def test_a_loop_that_holds_on_beside_its_signal(sky):
    """C10 is 0.9 chip off after the gap, its phase held by what power there is; the four satellites
    that do not move held too, and a fix of these five would be 449 m off."""
    scenario = sky()
    plan = scenario.recording.model_copy(update={"seed": 102})
    scenario = scenario.model_copy(update={"recording": plan})
    log, _, sampled_s, _, _, sure, sigmas = _fixes(scenario, ((7.5, 1.0),))
    (held,) = (t for t in log.signals if t.prn == 10)
    assert (held.state[held.time_s > 7.4] >= State.SYNCED).all()
    assert (sampled_s[sure] < 8.0).any()
    assert sigmas[sure].max() < SIGMAS


def test_the_stated_noise_of_a_code_loop_that_settles(sky):
    """By the discriminator, whose mean over a tenth of a second has 1 m of noise."""
    short = sky().recording.model_copy(update={"duration_s": 3.0})
    log = simulate(sky().model_copy(update={"recording": short}))
    (runs,) = zip(*(runs_of(t) for t in log.signals), strict=True)
    for from_s, until_s in ((0.1, 0.2), (0.2, 0.3), (0.3, 0.4), (1.5, 1.6)):
        off_m, stated_m = [], []
        for track, run in zip(log.signals, runs, strict=True):
            held_s = run.time_s - track.time_s[0]
            rows = (held_s >= from_s) & (held_s < until_s)
            if rows.sum() >= 5:
                off_m.append(LIGHT_M_S * run.code_error_s[rows].mean())
                stated_m.append(np.hypot(LIGHT_M_S * run.unsettled_s[rows].mean(), 1.0))
        assert len(off_m) >= 5
        # Four standard errors of a mean square.
        square = np.mean((np.array(off_m) / stated_m) ** 2)
        assert square < 1.0 + 4.0 * np.sqrt(2.0 / len(off_m))


def test_secondary_code_is_found_again(sky):
    """Where code periods are missing, D1 is in step again within half a second."""
    at_s, missing_s = 9.3, 0.003
    scenario = sky()
    short = scenario.recording.model_copy(update={"duration_s": 11.0})
    log = simulate(scenario.model_copy(update={"recording": short}), gaps=((at_s, missing_s),))
    (gap,) = gaps_of(log)
    assert gap.from_s <= at_s <= gap.until_s <= gap.from_s + 0.5
    for track in log.signals:
        if track.prn not in range(6, 59):
            continue
        after = track.state[track.time_s > at_s + 0.5]
        assert (after >= State.SYNCED).all()
        (span,) = uncounted(log, track)
        assert span[0] <= at_s <= span[1]
        mean = [track.cn0_dbhz[abs(track.time_s - t) < 0.3].mean() for t in (at_s - 1, at_s + 1.3)]
        assert mean[1] == pytest.approx(mean[0], abs=1.5)


def test_clean_recordings_have_no_breaks(sky):
    log = simulate(sky())
    assert log.breaks == () and gaps_of(log) == []


def _log(*breaks: CountBreak) -> TrackLog:
    return TrackLog("none", 1e6, 60.0, False, (), (), breaks=breaks)


def test_one_satellite_out_of_step_is_no_gap():
    one = CountBreak("B1I", 20, 1.0, 1.4)
    assert gaps_of(_log(one)) == []
    (gap,) = gaps_of(_log(one, CountBreak("B1I", 27, 1.1, 1.5), CountBreak("B1I", 30, 3.0, 3.1)))
    assert (gap.from_s, gap.until_s, gap.satellites) == (1.1, 1.4, ("C20", "C27"))


def test_outages():
    spans = [(0.0, 5.0), (0.5, 5.2), (6.0, 20.0), (19.0, 30.0)]
    (lost,) = outages(spans, 30.0)
    assert lost[1] == 5.2
    assert [until for _, until in outages(spans, 40.0)] == [5.2, 30.0]


def test_breaks_are_kept_in_result_files(tmp_path):
    form = RecordingFormat(sample_format="ci8", sample_rate_hz=1e6, lo_hz=1561.098e6)
    log = _log(CountBreak("B1I", 20, 1.0, 1.4))
    for name, kept in (("with.h5", log), ("without.h5", replace(log, breaks=()))):
        write_result(tmp_path / name, Result("rec", form, {}, log=kept))
        back = read_result(tmp_path / name).log
        assert back is not None and back.breaks == kept.breaks
