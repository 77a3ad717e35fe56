"""Ranges, phases and Dopplers of a sky against an evaluation of its own."""

import math

import numpy as np
import pytest
import sky_reference as reference
from skies import CIRCLE, PLACE, satellite, sky

from sdr_spoof.scenario import Scenario, transmissions
from sdr_spoof.scenario.sky.ranges import geometry
from sdr_spoof.signals import signal_spec

C = 299_792_458.0
_DRIFT = {"offset_us": 350.0, "drift_ppb": 800.0}
_SEEN = [("C", 1), ("C", 38), ("C", 30), ("G", 25)]
"""Geostationary, inclined geosynchronous, medium orbit, GPS."""


def _geodetic_to_ecef(latitude: float, longitude: float, height: float) -> np.ndarray:
    a, f = 6378137.0, 1 / 298.257223563
    e2 = f * (2 - f)
    n = a / math.sqrt(1 - e2 * math.sin(latitude) ** 2)
    return np.array(
        [
            (n + height) * math.cos(latitude) * math.cos(longitude),
            (n + height) * math.cos(latitude) * math.sin(longitude),
            (n * (1 - e2) + height) * math.sin(latitude),
        ]
    )


ANTENNA = _geodetic_to_ecef(math.radians(31.2), math.radians(121.5), 30.0)


@pytest.fixture(scope="module")
def still() -> Scenario:
    return sky(clock=_DRIFT)


def expected_m(
    made: Scenario, system: str, prn: int, at_s: float, signal: str
) -> tuple[float, float]:
    """Pseudoranges of code and carrier of a receiver that stands still."""
    start = made.sky_model().start  # type: ignore[union-attr]
    ephemeris = satellite(made, system, prn).track.ephemeris
    ahead_s = 350e-6 + 800e-9 * at_s
    way_m, clock_s = reference.range_m(ephemeris, start + (at_s - ahead_s), ANTENNA)
    carrier_m = way_m + C * (ahead_s - clock_s)
    return carrier_m + C * ephemeris.group_delay_s(signal), carrier_m


@pytest.mark.parametrize(("system", "prn"), _SEEN)
def test_code_and_carrier_are_those_of_the_light_time_equation(
    still: Scenario, system: str, prn: int
) -> None:
    for t in transmissions(still):
        if (t.system, t.prn) != (system, prn):
            continue
        spec = signal_spec(t.signal)
        # Off the knots, and from end to end.
        at_s = np.array([0.013, 1.049, 2.55, 3.987])
        ranges = np.array([expected_m(still, system, prn, s, t.signal) for s in at_s])
        chips = t.emitter.code_phase_chips(at_s) / spec.chip_rate_hz
        behind_s = (at_s - chips) - ranges[:, 0] / C
        # Code phase 0 left at a multiple of 18 s: the same for all times.
        assert behind_s * C == pytest.approx(np.full(4, behind_s[0] * C), abs=1e-5)
        tow_s = still.sky_model().start.week_tow(system)[1] + behind_s[0]  # type: ignore[union-attr]
        assert (tow_s / 18) == pytest.approx(round(tow_s / 18), abs=1e-12)
        phase = -t.emitter.received_phase_cycles(at_s) * C / spec.carrier_hz
        assert phase == pytest.approx(ranges[:, 1], abs=2e-5)


def test_phase_delay_and_doppler_belong_together(still: Scenario) -> None:
    at_s = np.linspace(0.0, 4.0, 41)
    for t in transmissions(still):
        spec = signal_spec(t.signal)
        turned = np.diff(t.emitter.received_phase_cycles(at_s))
        rate = t.emitter.doppler_hz(at_s)
        middle = t.emitter.doppler_hz(at_s[:-1] + 0.05)
        # Simpson's rule over 0.1 s.
        assert turned == pytest.approx((rate[:-1] + 4 * middle + rate[1:]) / 60, abs=1e-4)
        chips = np.diff(t.emitter.code_phase_chips(at_s)) - 0.1 * spec.chip_rate_hz
        # 1e-4 cycle.
        assert chips / spec.chip_rate_hz == pytest.approx(turned / spec.carrier_hz, abs=6e-14)


def test_without_sagnac_it_would_be_tens_of_metres_off(still: Scenario) -> None:
    """The correction is omega / c (x_s y_r - y_s x_r) (IS-GPS-200, 20.3.3.4.3.4)."""
    found = satellite(still, "C", 27).track
    model = found.sky
    start, times = model.start, np.array([2.0])
    place = reference.position(found.ephemeris, start + 1.92)
    still_m = np.linalg.norm(place - ANTENNA)
    correction = 7.292115e-5 / C * (place[0] * ANTENNA[1] - place[1] * ANTENNA[0])

    def orbit(time_s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        del time_s
        return place[None, :], np.zeros(1)

    way = geometry(orbit, 7.292115e-5, times, ANTENNA[None, :])
    assert abs(correction) > 10.0
    assert way.distance_m[0] - still_m == pytest.approx(correction, abs=1e-3)


@pytest.mark.parametrize("receiver", [PLACE, CIRCLE])
def test_knots_are_near_enough(receiver: dict[str, object]) -> None:
    """Between the knots the spline is where the orbit is, to 0.1 mm."""
    made = sky(receiver, elevation_mask_deg=40.0, systems=["C"], signals=["B1I"])
    model = made.sky_model()
    assert model is not None
    between_s = model.time_s[20:-21] + 0.05
    from sdr_spoof.scenario.sky import orbits  # noqa: PLC0415

    for seen in made.satellites:
        track = seen.track  # type: ignore[attr-defined]
        antenna_m = model.trajectory.position_m(between_s)
        orbit = orbits.orbit(track.ephemeris, model.start)
        way = geometry(orbit, orbits.earth_rate(track.ephemeris), between_s, antenna_m)
        true_m = way.distance_m - C * way.clock_s
        found_m = track.view.spline(1561.098e6).value(between_s)
        assert np.abs(found_m - true_m).max() < 1e-4 / 10


def test_ionosphere_parts_code_and_carrier() -> None:
    alpha, beta = (2.0e-8, 0.0, -1e-7, 0.0), (1.2e5, 0.0, -2e5, 0.0)
    more = {"klobuchar_alpha": alpha, "klobuchar_beta": beta, "signals": ["B1I", "B1C"]}
    off = sky(systems=["C"], **more)
    on = sky(systems=["C"], ionosphere="klobuchar", **more)
    at_s = np.array([0.5, 3.3])
    delays: dict[int, dict[str, float]] = {}
    for a, b in zip(transmissions(off), transmissions(on), strict=True):
        spec = signal_spec(a.signal)
        code_m = -(b.emitter.code_phase_chips(at_s) - a.emitter.code_phase_chips(at_s))
        code_m *= C / spec.chip_rate_hz
        phase_m = b.emitter.received_phase_cycles(at_s) - a.emitter.received_phase_cycles(at_s)
        assert code_m == pytest.approx(phase_m * C / spec.carrier_hz, abs=1e-4)
        assert 1.0 < code_m[0] < 30.0
        delays.setdefault(a.prn, {})[a.signal] = code_m[0]
    for found in delays.values():
        if "B1CP" in found:
            assert found["B1I"] / found["B1CP"] == pytest.approx(
                (1575.42 / 1561.098) ** 2, rel=1e-4
            )


def test_troposphere_grows_towards_the_horizon() -> None:
    off, on = sky(systems=["C"]), sky(systems=["C"], troposphere="saastamoinen")
    for a, b in zip(off.satellites, on.satellites, strict=True):
        assert isinstance(a.prn, int)
        first, second = a.track.view, b.track.view  # type: ignore[attr-defined]
        extra_m = second.range_m[0] - first.range_m[0]
        # 2.3 m and a little water over sea level, within 3 % of 1 / sin above 15 degrees.
        slant = 1 / np.sin(first.way.elevation_rad[0])
        if slant < 1 / math.sin(math.radians(15)):
            assert 2.25 * slant * 0.95 < extra_m < 2.65 * slant
