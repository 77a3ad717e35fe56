"""Law of the search statistic; the long studies are in ``studies.acquisition.run``."""

import math

import numpy as np
import pytest
from scipy.stats import chi2

from sdr_spoof.acquisition_threshold import threshold
from sdr_spoof.studies.acquisition import Grid, detections, false_alarms, theoretical_pd


def test_threshold_of_independent_cells_is_exact():
    """Without correlation in delay and with one Doppler bin: 1 - (1 - p)^n = Pfa."""
    for pfa in (1e-6, 1e-3):
        cell = chi2.isf(-math.expm1(math.log1p(-pfa) / 4096), 40)
        assert threshold(pfa, 1, 4096, 20, ()) == pytest.approx(cell, rel=1e-3)


def test_correlated_cells_lower_the_threshold():
    free = threshold(1e-3, 21, 4096, 20, ())
    tied = threshold(1e-3, 21, 4096, 20, (0.9,))
    union = chi2.isf(1e-3 / (21 * 4096), 40)
    assert tied < free < union
    # All cells the same: as if there were one.
    assert threshold(1e-3, 1, 4096, 20, (0.9999999,)) < chi2.isf(1e-3 / 10, 40)


GRIDS = [
    (Grid("B1I", 10, 4), 63 * 16),
    (Grid("L1CA", 4, 6), 81 * 12),
    (Grid("B1CP", 3, 2), 53 * 5),
    (Grid("E5AQ", 4, 2), 36 * 8),
]


@pytest.mark.parametrize(("grid", "searches"), GRIDS, ids=lambda g: getattr(g, "signal", ""))
def test_false_alarms_agree_with_those_asked_for(grid, searches):
    """Within 4 standard errors of a binomial count (1 - 6e-5 confidence)."""
    for result in false_alarms(grid, [0.3, 0.1], searches, threads=2):
        pfa = result.asked
        error = math.sqrt(searches * pfa * (1 - pfa))
        assert result.searches == searches
        assert result.low <= result.alarms / searches <= result.high
        assert abs(result.alarms - searches * pfa) < 4 * error


@pytest.mark.parametrize(
    ("grid", "cn0_dbhz"), [(Grid("B1I", 20, 4), 35.0), (Grid("B1CP", 3, 2), 32.0)]
)
def test_detections_agree_with_theory(grid, cn0_dbhz):
    """Within 4 standard errors, and 0.08 above for the neighbouring cells that theory omits."""
    point = detections(grid, cn0_dbhz, 120, threads=2)
    assert 0.3 < point.theory < 0.95
    error = math.sqrt(point.theory * (1 - point.theory) / point.trials)
    share = point.detected / point.trials
    assert -4 * error < share - point.theory < 4 * error + 0.08


def test_theory_grows_from_nothing_to_certainty():
    pd = theoretical_pd(Grid("B1I", 20, 10), [15.0, 30.0, 35.0, 45.0], 1e-5)
    assert np.all(np.diff(pd) > 0)
    assert pd[0] < 1e-4
    assert pd[-1] > 1 - 1e-6


def test_strong_signals_are_always_found_with_true_cn0():
    for grid in (Grid("B1I", 20, 4), Grid("B1CP", 3, 2)):
        point = detections(grid, 42.0, 40, threads=2)
        assert point.detected == point.trials
        assert abs(point.cn0_bias_db) < 0.5
