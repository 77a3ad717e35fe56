"""The ship's study with few runs: every acceptance number is there, and most are met."""

import numpy as np
import pytest

from sdr_spoof.errors import ConfigError
from sdr_spoof.progress import silent
from sdr_spoof.reproduce import reproduce
from sdr_spoof.reproduce.ship import (
    attack_runs,
    attack_section,
    attacks,
    clean_section,
    coasting_section,
    errata,
    literal_section,
    published,
    simulation,
    statistic_section,
)
from sdr_spoof.reproduce.study import Effort

FEW = Effort(1, 1, quick=True)


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(literal_section, "CALIBRATION_RUNS", 1)
    monkeypatch.setattr(literal_section, "LEAST_RUNS", 1)
    monkeypatch.setattr(literal_section, "DRAGS", {0.5: "all_0.5"})
    monkeypatch.setattr(coasting_section, "LEAST_RUNS", 1)
    monkeypatch.setattr(clean_section, "WHITE_RUNS", 1)
    literal_section.divisors.cache_clear()
    yield
    literal_section.divisors.cache_clear()


def test_statistic_as_the_study_has_it():
    section = statistic_section.section(FEW, silent)
    assert {n.name for n in section.numbers if not n.met} == set()
    assert len(section.numbers) == 8


def test_forms_are_those_of_the_core():
    deviations = np.array([1.0, -2.0, 3.0, 0.5, 1.0, 0.0, 2.0, -1.0, 1.5, 1.0])
    square, lagged, coherent = statistic_section.forms(deviations)
    assert square[0] == pytest.approx(np.mean(deviations**2))
    assert lagged[0] == pytest.approx(np.sum(deviations[1:] * deviations[:-1]) / 9)
    assert coherent[0] == pytest.approx(np.mean(deviations) ** 2)


def test_literal_loop_is_captured_and_locked(few):
    section = literal_section.section(FEW, silent)
    names = {n.name for n in section.numbers}
    assert names == {"captured_0.5", "literal_captured", "literal_locked"}
    assert next(n for n in section.numbers if n.name == "captured_0.5").met
    assert section.pictures[0].png.startswith(b"\x89PNG")


def test_coasting_has_a_number_for_each_time(few):
    section = coasting_section.section(FEW, silent)
    assert len(section.numbers) == len(published.COASTING_M) * len(published.COASTING_S)
    assert len(section.tables[0].rows) == 3 * len(published.COASTING_M)


def test_clean_runs_are_consistent(few):
    section = clean_section.section(FEW, silent)
    names = [n.name for n in section.numbers]
    assert names == ["clean_rms", "clean_nis", "nees_position", "nees_velocity", "locked_out"]
    low, high = clean_section.band(100)
    assert (low, high) == (pytest.approx(2.539, abs=1e-3), pytest.approx(3.499, abs=1e-3))


def test_attacks_are_seen_and_left(monkeypatch):
    chosen = [a for a in attacks.LIST if a.name in ("three_0.5", "all_0.2")]
    monkeypatch.setattr(attack_section, "LIST", chosen)
    section = attack_section.section(FEW, silent)
    assert all(n.met for n in section.numbers)
    assert {n.name for n in section.numbers} >= {"delay_all_0.2", "after_three_0.5"}
    assert [p.name for p in section.pictures] == ["attack_errors", "attack_delays"]


def test_an_undetected_capture_is_put_into_words():
    slow = next(a for a in attacks.LIST if a.name == "all_0.001_s2")
    found = attack_runs.outcome(slow, Effort(2))
    assert "No rule tells them apart" in found.said


def test_runs_are_their_own(few):
    config = simulation.default_set()
    one = list(simulation.runs(simulation.Case(config=config, runs=2)))
    other = list(simulation.runs(simulation.Case(config=config, runs=1, first=1)))
    assert np.array_equal(one[1].position_m, other[0].position_m)
    fresh = next(simulation.runs(simulation.Case(config=config, runs=1), Effort(1, seed=3)))
    assert not np.array_equal(one[0].position_m, fresh.position_m)
    assert config.clock_drift_m2_s3 == simulation.CLOCK_DRIFT_M2_S3


def test_a_study_without_fresh_numbers_says_so(tmp_path):
    with pytest.raises(ConfigError, match="leave out the seed"):
        reproduce("combo", tmp_path, seed=1)


def test_errata_and_list():
    assert len(errata.errata()) == 7
    assert len({a.name for a in attacks.LIST}) == len(attacks.LIST)
    assert {*published.ROBUST_S, *published.FLOOR} <= {a.name for a in attacks.LIST}
