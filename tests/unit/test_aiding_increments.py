"""Checks of increments, gaps, and increments from rates."""

from dataclasses import replace

import numpy as np
import pytest
from inertial_paths import rest

from sdr_spoof.aiding import increments
from sdr_spoof.errors import InertialError

LOG, _ = rest(1.0)


def spoiled(name, row, value):
    values = getattr(LOG, name).copy()
    values[row] = value
    return replace(LOG, **{name: values})


@pytest.mark.parametrize(
    ("log", "message"),
    [
        (replace(LOG, rotation_rad=LOG.rotation_rad[:5]), r"rotation_rad has shape \(5, 3\)"),
        (replace(LOG, velocity_m_s=LOG.velocity_m_s.T), r"velocity_m_s has shape \(3, 100\)"),
        (replace(LOG, interval_s=0.1), "50 to 400 Hz"),
        (replace(LOG, interval_s=0.001), "50 to 400 Hz"),
        (replace(LOG, interval_s=0.0), "50 to 400 Hz"),
        (spoiled("rotation_rad", 7, np.nan), "first in row 7"),
        (spoiled("velocity_m_s", 8, np.inf), "first in row 8"),
        (spoiled("time_s", 9, 0.05), "time of row 9 .* is not after"),
        (spoiled("time_s", 50, 0.5), "clock was set back"),
    ],
)
def test_logs_that_are_refused(log, message):
    with pytest.raises(InertialError, match=message):
        increments.check(log)


def test_gaps_and_what_bridges_them():
    keep = np.r_[0:40, 45:80, 95:100]
    holed = replace(
        LOG,
        time_s=LOG.time_s[keep],
        rotation_rad=LOG.rotation_rad[keep],
        velocity_m_s=LOG.velocity_m_s[keep],
    )
    found = increments.gaps(holed)
    assert [(g.start_s, g.end_s) for g in found] == [
        (pytest.approx(0.4), pytest.approx(0.45)),
        (pytest.approx(0.8), pytest.approx(0.95)),
    ]
    whole = increments.bridged(holed, 0.1)
    assert [g.length_s for g in increments.gaps(whole)] == [pytest.approx(0.15)]
    assert np.allclose(whole.time_s[:80], LOG.time_s[:80])
    assert np.allclose(whole.velocity_m_s[:80], LOG.velocity_m_s[:80])
    assert increments.bridged(LOG) is LOG


def test_a_bridge_is_a_straight_line():
    slope = np.arange(100.0)[:, None] * np.ones(3)
    keep = np.r_[0:40, 45:100]
    holed = replace(
        LOG, time_s=LOG.time_s[keep], rotation_rad=slope[keep], velocity_m_s=slope[keep]
    )
    whole = increments.bridged(holed)
    assert np.allclose(whole.rotation_rad[40:45], slope[40:45], atol=0.01)


def test_increments_from_rates_are_integrals():
    def wave(t):
        return np.stack([np.sin(7 * t), np.cos(3 * t), t**2], axis=-1)

    def integral(t):
        return np.stack([-np.cos(7 * t) / 7, np.sin(3 * t) / 3, t**3 / 3], axis=-1)

    time_s = np.arange(201) / 100
    log = increments.from_rates(time_s, wave(time_s), 2 * wave(time_s))
    want = np.diff(integral(time_s), axis=0)
    assert log.time_s[0] == pytest.approx(0.01)
    assert np.abs(log.rotation_rad - want)[1:-1].max() < 5e-9
    assert np.abs(log.velocity_m_s - 2 * want).max() < 3e-7


def test_rates_that_are_refused():
    time_s = np.arange(10) / 100
    with pytest.raises(InertialError, match="at least 4"):
        increments.from_rates(time_s[:3], np.zeros((3, 3)), np.zeros((3, 3)))
    time_s[5:] += 0.001
    with pytest.raises(InertialError, match="after row 4"):
        increments.from_rates(time_s, np.zeros((10, 3)), np.zeros((10, 3)))
