"""Positions from code phases alone."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from observed_sky import PLACE, START, Sky, navigation

from sdr_spoof import pvt
from sdr_spoof.fixes import Cause, Fixes, Status
from sdr_spoof.nav.records import Navigation
from sdr_spoof.pvt import CodePhase, PvtConfig
from sdr_spoof.pvt.ranges import LIGHT_M_S
from sdr_spoof.records import Acquisition
from sdr_spoof.signals import signal_spec

NOISE_M = 10.0
CONFIG = PvtConfig(ionosphere="none", troposphere="none", code_sigma_m=NOISE_M, weights="equal")


def phases(sky: Sky) -> list[CodePhase]:
    observations = sky.observe()
    found = []
    for k, signal in enumerate(observations.signals):
        spec = signal_spec(signal.signal)
        doppler = float(observations.doppler_hz[0, k])
        # Receiver time is a whole second: the code's own time is minus the range's.
        own = observations.pseudorange_m[0, k] / LIGHT_M_S % spec.period_s
        delay = own / (1.0 + doppler / spec.carrier_hz)
        found.append(CodePhase(signal.system, signal.prn, signal.signal, delay, 45.0, doppler))
    return found


def miss(fixes: Fixes) -> float:
    return float(np.linalg.norm(fixes.position_m[0] - PLACE))


def shifted(east_m: float, north_m: float) -> np.ndarray:
    up = PLACE / np.linalg.norm(PLACE)
    east = np.cross([0.0, 0.0, 1.0], up)
    east /= np.linalg.norm(east)
    return PLACE + east * east_m + np.cross(up, east) * north_m


@pytest.mark.parametrize(
    ("systems", "signals", "place", "late_s"),
    [
        ("C", {"C": ("B1I",)}, (35e3, -35e3), 30.0),
        ("C", {"C": ("B1I",)}, (-60e3, 78e3), -55.0),
        ("CG", {"C": ("B1I",), "G": ("L1CA",)}, (0.0, 50e3), 30.0),
        ("C", {"C": ("B1I", "B1CP")}, (70e3, 70e3), 59.0),
    ],
)
def test_place_and_time_from_code_phases(systems, signals, place, late_s) -> None:
    sky = Sky(systems, signals, sigma_m=NOISE_M, clock_m=0.0)
    at, time = shifted(*place), START + late_s
    fixes = pvt.snapshot(phases(sky), navigation(), at, time, CONFIG)
    assert fixes.status[0] == Status.FIX
    assert miss(fixes) < 4 * np.sqrt(np.trace(fixes.covariance_m2[0]))
    assert miss(fixes) < 150.0
    assert abs(fixes.time(0) - START) < 0.1
    assert fixes.used.all()


def test_exact_code_phases_give_the_exact_place() -> None:
    sky = Sky(clock_m=0.0)
    fixes = pvt.snapshot(phases(sky), navigation(), shifted(40e3, 30e3), START + 30.0, CONFIG)
    assert miss(fixes) < 1e-2
    assert abs(fixes.time(0) - START) < 1e-5


def test_errors_are_as_the_covariance_says() -> None:
    squares = []
    config = CONFIG.model_copy(update={"place_uncertainty_m": 10e3, "time_uncertainty_s": 5.0})
    known = phases(Sky(clock_m=0.0))
    random = np.random.default_rng(8)
    for _ in range(100):
        noisy = [
            dataclasses.replace(
                p, delay_s=(p.delay_s + NOISE_M / LIGHT_M_S * random.standard_normal()) % 1e-3
            )
            for p in known
        ]
        fixes = pvt.snapshot(noisy, navigation(), shifted(5e3, 0.0), START + 2.0, config)
        error = fixes.position_m[0] - PLACE
        squares.append(error @ np.linalg.inv(fixes.covariance_m2[0]) @ error)
    # The assumed noise includes what grows towards the horizon, 0.3 m at the zenith: next to none.
    assert np.mean(squares) == pytest.approx(3.0, abs=4 * np.sqrt(6.0 / 100))


def test_five_satellites_are_not_checked_and_four_give_nothing() -> None:
    def solved(count: int) -> Fixes:
        some = phases(Sky(satellites=count, clock_m=0.0))
        config = CONFIG.model_copy(update={"elevation_mask_deg": 0.0, "max_pdop": 1e4})
        return pvt.snapshot(some, navigation(), shifted(3e3, 0.0), START + 5.0, config)

    assert solved(5).status[0] == Status.UNCHECKED
    four = solved(4)
    assert four.status[0] == Status.NO_FIX
    assert "too few satellites" in four.reason(0)


def with_false(known: list[CodePhase], *which: int) -> list[CodePhase]:
    return [
        dataclasses.replace(p, delay_s=(p.delay_s + 3e-4 + 1e-5 * k) % 1e-3) if k in which else p
        for k, p in enumerate(known)
    ]


def test_one_false_code_phase_is_left_out_and_two_are_not_believed() -> None:
    known = phases(Sky(satellites=9, clock_m=0.0))
    near = CONFIG.model_copy(update={"place_uncertainty_m": 50e3, "time_uncertainty_s": 20.0})

    def solved(*which: int, exclusions: int = 1) -> Fixes:
        config = near.model_copy(update={"raim_exclusions": exclusions})
        at, time = shifted(9e3, 9e3), START + 9.0
        return pvt.snapshot(with_false(known, *which), navigation(), at, time, config)

    one = solved(3)
    assert one.status[0] == Status.FIX
    assert miss(one) < 1e-2
    assert [e.satellite for e in one.excluded] == [one.signals[3].satellite]
    assert solved(3, exclusions=0).status[0] != Status.FIX
    assert solved(3, 5).status[0] != Status.FIX


def test_without_ephemerides_there_is_no_fix() -> None:
    fixes = pvt.snapshot(phases(Sky()), Navigation(), PLACE, START, CONFIG)
    assert fixes.status[0] == Status.NO_FIX
    assert {e.cause for e in fixes.excluded} == {Cause.NO_EPHEMERIS}
    assert pvt.snapshot([], navigation(), PLACE, START).status[0] == Status.NO_FIX


def test_acquisitions_tell_code_phases() -> None:
    """Searched 30 ms apart in a recording: brought to the same sample, Doppler considered."""
    rate, doppler = 5e6, 4000.0
    spec = signal_spec("B1I")
    period = spec.period_s / (1 + doppler / spec.carrier_hz)

    def found(sample: int, detected: bool = True) -> Acquisition:
        delay = (2.5e-4 - sample / rate) % period
        return Acquisition("B1I", 20, detected, sample, doppler, delay, 44.0, 9.0, 5.0, 50.0)

    first, second = pvt.code_phases([found(0), found(150_000), found(0, False)], rate)
    assert first.system == "C"
    assert first.delay_s == pytest.approx(2.5e-4, abs=1e-12)
    assert second.delay_s == pytest.approx(first.delay_s, abs=1e-12)
