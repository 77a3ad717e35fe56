"""Clocks of IMU and GNSS, and places by GNSS alone."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sdr_spoof.aided import alone
from sdr_spoof.aided.clocks import on_one_clock
from sdr_spoof.aiding import simulated as sim
from sdr_spoof.aiding.records import ImuLog
from sdr_spoof.aiding.simulated.clock import IDEAL
from sdr_spoof.aiding.simulated.noise import SILENT
from sdr_spoof.errors import AidingError
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.nav.time import GnssTime

PLACE = geodetic_to_ecef([34.0, 108.0, 400.0])
TIME = np.arange(30.0)
LOOKS = [(20, 72), (70, 36), (150, 42), (230, 34), (310, 47), (100, 10)]
NAMES = ("C01", "C02", "C03", "G04", "G05", "G06")
START = GnssTime(1_362_571_218)


def measured(**other):
    sky = sim.fixed(TIME, PLACE, LOOKS, NAMES)
    still = (np.broadcast_to(PLACE, (TIME.size, 3)), np.zeros((TIME.size, 3)))
    clock = dataclasses.replace(IDEAL, offset_m=5e4)
    return sim.simulate(still, sky, TIME, SILENT, clock, reference=START, **other).run()


def imu(reference, first_s=0.0, length_s=29.0):
    time_s = first_s + np.arange(0.01, length_s, 0.01)
    return ImuLog(reference, time_s, 0.01, np.zeros((time_s.size, 3)), np.zeros((time_s.size, 3)))


def test_places_of_two_systems():
    found = measured()
    ranges = found.range_m + np.array([0, 0, 0, 70.0, 70.0, 70.0])
    places = alone.places(dataclasses.replace(found, range_m=ranges))
    np.testing.assert_allclose(places, np.broadcast_to(PLACE, places.shape), atol=1e-4)


def test_no_place_with_too_few_satellites():
    found = measured()
    ranges = found.range_m.copy()
    ranges[5, :2] = np.nan
    ranges[7, 3:] = np.nan
    places = alone.places(dataclasses.replace(found, range_m=ranges))
    assert np.flatnonzero(np.isnan(places[:, 0])).tolist() == [5, 7]


def test_false_ranges_lead_away():
    attack = sim.position_step((100.0, 0.0, 0.0), 20.0)
    places = alone.places(measured(attacks=[attack]))
    away = np.linalg.norm(places - PLACE, axis=1)
    assert away[:20].max() < 1e-3 and away[20:] == pytest.approx(100.0, abs=0.1)


def test_the_log_is_cut_to_what_both_have():
    log = on_one_clock(imu(START + -10.0, length_s=25.0), measured())
    assert log.reference == START
    assert log.time_s[0] == pytest.approx(0.0, abs=0.011)
    assert log.time_s[-1] == pytest.approx(14.99)
    assert len(log.rotation_rad) == log.time_s.size


@pytest.mark.parametrize(
    ("log", "why"),
    [
        (imu(None), "does not tell its time by GNSS; give the UTC .* --imu-start"),
        (imu(START, 86400.0 * 3), "nothing in common: the IMU covers 2023-03-14 .* same drive"),
        (imu(START, 40.0), "UTC, which is 18 s behind"),
        (imu(START, 8 * 3600.0 + 29), "local time"),
        (imu(START, 0.0, 0.0), "no increments of an IMU"),
    ],
)
def test_clocks_that_do_not_meet(log, why):
    with pytest.raises(AidingError, match=why):
        on_one_clock(log, measured())
