"""Filters without each satellite, and levels that hold whichever one is wrong."""

from __future__ import annotations

import csv
from dataclasses import replace

import aided_case as case
import numpy as np
import pytest
from tight_voyage import CONFIG, distance, made, measured, start

from sdr_spoof.aided.files import ONE_WRONG, write_csv
from sdr_spoof.aided.filtered import one_wrong
from sdr_spoof.aiding.simulated import range_pull
from sdr_spoof.aiding.tight import run

FACTOR = 4.8


def flown(*attacks, **settings):
    config = CONFIG.model_copy(update={"one_wrong": True, "exclusion": "off"} | settings)
    voyage = made()
    return run(voyage[0], measured(voyage, *attacks), start(voyage), config)


def levels(found):
    p = found.covariance[:, 0, :2, :2]
    level = FACTOR * np.sqrt(np.linalg.eigvalsh(p)[:, -1])
    return level, one_wrong(found.apart_m, 0, FACTOR, level)


def test_nothing_unless_asked_for():
    found = flown(one_wrong=False)
    assert found.apart_m is None
    assert one_wrong(None, 0, FACTOR, np.ones(3)) is None


def test_filters_without_a_satellite_know_less_and_agree():
    found = flown()
    assert found.apart_m.shape == (200, 8, 4)
    own = np.sqrt(np.linalg.eigvalsh(found.covariance[:, 0, :2, :2])[:, -1:])
    assert (found.apart_m[5:, :, 1] > own[5:]).all()
    # What both have in common errs alike: the distance has the difference of the variances.
    spread = np.sqrt(found.apart_m[5:, :, 3] ** 2 - found.covariance[5:, 0, 2, 2][:, None])
    assert (found.apart_m[5:, :, 2] < 5 * spread).all()
    level, wrong = levels(found)
    assert (wrong >= level).all() and (distance(found, made()) < level).all()


def test_one_satellite_that_nobody_suspects_stays_within_the_level():
    # The third is low and alone in the east.
    pull = range_pull((0.0, 0.3, 0.0), 60.0, satellites=("C03",), code_only=True)
    found = flown(pull, robust_sigma=0.0)
    off, (level, wrong) = distance(found, made()), levels(found)
    assert (off > level).any()
    assert (off < wrong).all()
    worst = np.argmax(found.apart_m[-1, :, 0] + FACTOR * found.apart_m[-1, :, 1])
    assert found.satellites[worst] == "C03"


def test_levels_are_columns_of_the_csv(tmp_path):
    ones = np.ones(case.EPOCHS)
    track = replace(
        case.track(),
        smoothed=case.smoothed(),
        horizontal_one_wrong_m=7 * ones,
        vertical_one_wrong_m=8 * ones,
    )
    write_csv(tmp_path / "a.csv", track)
    row = list(csv.DictReader((tmp_path / "a.csv").read_text().splitlines()))[80]
    assert [float(row[name]) for name in ONE_WRONG] == pytest.approx([7.0, 8.0])
    assert tuple(row)[-2:] == ONE_WRONG
