"""What the detectors say has the same distribution at correlator level and at IF level."""

from __future__ import annotations

import numpy as np
import pytest

from sdr_spoof.detectors import DetectionConfig, noise_floor
from sdr_spoof.studies.levels import ATTACKS, CN0_DBHZ, DRAG_S, scenario, tracks
from sdr_spoof.studies.levels_compare import LEAST_P, Observed, compare, same_law, summary

QUICK = DetectionConfig(
    code_difference_windows_s=(1.0,),
    code_difference_reference_s=5.0,
    code_minus_carrier_windows_s=(2.0,),
    code_minus_carrier_reference_s=5.0,
    phase_difference_glr_windows_s=(0.1, 0.5, 1.0),
    phase_difference_glr_reference_s=2.0,
    quality_reference_s=2.0,
    power_reference_s=2.0,
    power_floor_window_s=2.0,
)
"""References that a few seconds of signal hold."""


def test_every_detector_says_the_same_of_clean_signals() -> None:
    plan = scenario("clean", 38.0, duration_s=10.0)
    seen = [o for run in tracks(plan, "if", 1, QUICK) for o in run]
    made = [o for run in tracks(plan, "correlator", 8, QUICK) for o in run]
    found = compare("clean", 38.0, seen, made, DRAG_S)
    # A second peak is looked for in samples, by the pipeline: neither level here does that.
    assert {c.name[0] for c in found} == set(QUICK.detectors) - {"second_peak"}
    for c in found:
        shared = c.name[2] == noise_floor.QUANTITY
        assert c.tracks == ((1, 8) if shared else (2, 16)), c.name
        assert c.p > LEAST_P, c.name
        # Two tracks have no spread to speak of: theirs is that of the others.
        of = [o for o in made if o.name == c.name]
        spread = np.std([o.mean for o in of], ddof=1)
        assert abs(c.mean.made - c.mean.seen) <= 4 * spread * np.hypot(
            *(n**-0.5 for n in c.tracks)
        ), c.name


def observed(mean: float, rng: np.random.Generator, alarm_s: float) -> Observed:
    values = rng.normal(mean, 1.0, 50)
    square = float(np.mean(values**2))
    return Observed(("power", "B1I", "C/N0"), float(values.mean()), square, values, alarm_s)


@pytest.mark.parametrize(("off", "late", "agrees"), [(0, 0, True), (0.5, 0, False), (0, 1, False)])
def test_a_difference_is_found_and_none_is_not(off: float, late: float, agrees: bool) -> None:
    rng = np.random.default_rng(5)
    seen = [observed(0.0, rng, 14.0 + rng.normal(0, 0.3)) for _ in range(40)]
    made = [observed(off, rng, 14.0 + late + rng.normal(0, 0.3)) for _ in range(200)]
    (found,) = compare("coherent", 38.0, seen, made, 12.0)
    assert found.agrees == agrees
    assert found.row()["latency_seen_s"] == pytest.approx(2.0, abs=0.2)
    (line,) = summary([found])
    assert (line.disagree == 0) == agrees


def test_alarms_that_never_come_have_a_law_too() -> None:
    never = np.full(30, np.inf)
    assert same_law(never, never) == 1.0
    assert same_law(never, np.linspace(1, 2, 30)) < LEAST_P
    assert same_law(np.empty(0), never) == 1.0


@pytest.mark.parametrize("attack", ATTACKS)
def test_scenarios_attack_both_satellites(attack: str) -> None:
    plan = scenario(attack, CN0_DBHZ[0])
    prns = [prn for a in plan.attack for prn in a.prns]
    assert prns == ([] if attack == "clean" else [s.prn for s in plan.satellite])
