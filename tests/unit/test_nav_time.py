"""Instants in GNSS time."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest

from sdr_spoof.nav.time import GnssTime


def test_known_instants() -> None:
    bdt0 = GnssTime.of_week(0, 0.0, "C")
    assert bdt0.utc() == datetime(2006, 1, 1, tzinfo=UTC)
    assert bdt0.week_tow("G") == (1356, 14.0)
    day = GnssTime.of_utc(datetime(2023, 3, 12, tzinfo=UTC))
    assert day.week_tow("G") == (2253, 18.0)
    assert day.week_tow("C") == (897, 4.0)
    assert day.calendar("C") == datetime(2023, 3, 12, 0, 0, 4, tzinfo=UTC)
    assert GnssTime.of_calendar(day.calendar("C"), "C") == day


def test_leap_second_of_2017() -> None:
    before = GnssTime.of_utc(datetime(2016, 12, 31, 23, 59, 59, tzinfo=UTC))
    after = GnssTime.of_utc(datetime(2017, 1, 1, tzinfo=UTC))
    assert after - before == 2.0
    assert before.utc().second == 59
    assert after.utc() == datetime(2017, 1, 1, tzinfo=UTC)


@pytest.mark.parametrize("step", [1e-9, -1e-9, 0.75, -0.75, 604_800.5])
def test_differences_are_exact(step: float) -> None:
    start = GnssTime.of_week(2253, 604_799.5)
    assert (start + step) - start == pytest.approx(step, abs=1e-15)


def test_a_fraction_is_below_one() -> None:
    with pytest.raises(ValueError, match="must be in"):
        GnssTime(0, 1.0)
