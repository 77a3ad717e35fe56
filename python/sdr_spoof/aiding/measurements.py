"""From a receiver's observations to measurements of geometry, clock and noise alone.

What the broadcast orbits and the models of the atmosphere say is taken off, as for a fix: each
satellite's clock at transmission, the group delay of its signal, ionosphere (a delay of codes, an
advance of carriers) and troposphere, and the delay of a signal in the receiver against the first
of its system (the median of that of the fixes). What depends on the receiver's place only weakly
(the rays through the atmosphere, the Earth's turn during the signal's way) is computed at its fix,
or at that of the epochs around it; a false place spoils that by centimetres a kilometre.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError
from sdr_spoof.fixes import Cause, Status
from sdr_spoof.nav.atmosphere import gpst_s, ionosphere_m, troposphere_m
from sdr_spoof.nav.geodesy import azimuth_elevation, ecef_to_geodetic
from sdr_spoof.nav.orbit import states
from sdr_spoof.nav.store import Store
from sdr_spoof.pvt import PvtConfig, models, ranges, solve
from sdr_spoof.pvt.ephemerides import choose
from sdr_spoof.pvt.solution import causes
from sdr_spoof.signals import LIGHT_M_S

from .columns import best_columns, only
from .records import Measurements

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.fixes import Fixes
    from sdr_spoof.nav.broadcast import Contents
    from sdr_spoof.observations import Observations, ObservedSignal
    from sdr_spoof.pvt.ephemerides import Choice

_EARTH_RATE = {"C": 7.292115e-5}
_GPS_EARTH_RATE = 7.2921151467e-5
"""rad/s; BDS-SIS-ICD-B1I-3.0, section 3.2; IS-GPS-200, table 20-IV."""
_STEPS = 3
"""Of the way's length and the turn of the Earth: each leaves v/c = 1e-6 of the last one's error."""
_DELAY_STEP_S = 1.0
"""Over which the rate of the atmosphere's delay is taken."""


@dataclass(frozen=True)
class _Host:
    """What the fixes tell of the antenna, at every epoch."""

    position_m: NDArray[np.float64]
    """(E, 3)"""
    velocity_m_s: NDArray[np.float64]
    """(E, 3); 0 where it is not known."""
    clock_s: NDArray[np.float64]
    """(E,): receiver time less system time."""
    drift: NDArray[np.float64]
    """(E,): its rate."""


@dataclass(frozen=True)
class _Sent:
    """Of each measurement, (E, S) and (E, S, 3)."""

    position_m: NDArray[np.float64]
    velocity_m_s: NDArray[np.float64]
    clock_m: NDArray[np.float64]
    clock_m_s: NDArray[np.float64]


def of(
    observations: Observations,
    navigation: Contents | Store,
    config: PvtConfig | None = None,
    *,
    lever_arm_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    fixes: Fixes | None = None,
) -> Measurements:
    """Measurements of every satellite with an ephemeris, spoofed ones included.

    Of a satellite's signals the one with the least noise is taken that is there at most epochs
    without being called spoofed.

    Args:
        observations: what was observed.
        navigation: ephemerides and models.
        config: which signals, masks and models, as for fixes.
        lever_arm_m: antenna from the INS: forward, right, down.
        fixes: of the same observations, if they are known.

    Raises:
        AidingError: there is no fix at any epoch.
        NavigationError: as :func:`sdr_spoof.pvt.solve`.
    """
    config = config or PvtConfig()
    store = navigation if isinstance(navigation, Store) else Store(navigation)
    if fixes is None:
        fixes = solve(observations, store, config)
    bias_m = _bias_m(fixes, observations.signals)
    columns = best_columns(observations, causes(observations, choose(observations, store), config))
    seen = only(observations, columns)
    choice, host = choose(seen, store), _host(fixes)
    wanted = np.isin(causes(seen, choice, config), (Cause.USED, Cause.SPOOFED))
    row = np.where(wanted, choice.known, -1)
    sent = _sent(seen, choice, row, host)
    delays = _Delays(seen, config, store, host)
    high = delays.elevation_deg(sent.position_m) > config.elevation_mask_deg
    made = _corrected(seen, choice, config, host, sent, delays, bias_m[columns])
    row = np.where(high, row, -1)
    keep = np.where(row >= 0, 0.0, np.nan)
    change = made["carrier_m"] + keep
    cut = ranges.broken(seen) | (np.diff(row, axis=0, prepend=-1) != 0)
    return Measurements(
        reference=seen.reference,
        time_s=seen.time_s - host.clock_s,
        satellites=tuple(s.satellite for s in seen.signals),
        satellite_m=sent.position_m + keep[..., None],
        satellite_velocity_m_s=sent.velocity_m_s + keep[..., None],
        range_m=made["range_m"] + keep,
        rate_m_s=made["rate_m_s"] + keep,
        change_m=np.where(cut, np.nan, np.diff(change, axis=0, prepend=np.nan)),
        cn0_dbhz=seen.cn0_dbhz + keep,
        spoofed=seen.spoofed,
        lever_arm_m=lever_arm_m,
    )


def _host(fixes: Fixes) -> _Host:
    """At epochs without a fix by a straight line between those that have one."""
    good = np.isin(fixes.status, (Status.FIX, Status.UNCHECKED))
    good = good if good.any() else fixes.fixed
    if not good.any():
        reason = fixes.reason(0) if fixes.epochs else "there are no observations"
        raise AidingError(
            f"no epoch has a position, which aiding begins with ({reason}); give more satellites, "
            "or navigation data of the same day"
        )
    times, known = fixes.time_s, fixes.time_s[good]

    def filled(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.interp(times, known, values[good]))

    velocity = np.nan_to_num(fixes.velocity_m_s)
    return _Host(
        np.stack([filled(x) for x in fixes.position_m.T], axis=-1),
        np.stack([filled(x) for x in velocity.T], axis=-1),
        filled(fixes.clock_s),
        filled(np.nan_to_num(fixes.drift_m_s)) / LIGHT_M_S,
    )


def _bias_m(fixes: Fixes, signals: Sequence[ObservedSignal]) -> NDArray[np.float64]:
    """Delay of each signal in the receiver against the first of its system (S,)."""
    known = dict(zip(fixes.biases, fixes.bias_m.T, strict=True))
    found = []
    for signal in signals:
        values = known.get(f"{signal.system} {signal.signal}", np.zeros(0))
        values = values[np.isfinite(values)]
        found.append(float(np.median(values)) if values.size else 0.0)
    return np.array(found)


def _sent(seen: Observations, choice: Choice, row: NDArray[np.int32], host: _Host) -> _Sent:
    """Where satellites were at transmission, in the axes at reception, and what they had wrong."""
    epochs, columns = np.nonzero(row >= 0)
    rows, late_s = row[epochs, columns], ranges.group_delay_s(seen, choice)[epochs, columns]
    # The code says when it left, by the satellite's clock; the receiver's does not matter.
    by_clock_s = seen.time_s[epochs] - seen.pseudorange_m[epochs, columns] / LIGHT_M_S + late_s
    clock_s = np.zeros(epochs.size)
    for _ in range(2):
        at = states(choice.ephemerides, rows, by_clock_s - clock_s, seen.reference)
        clock_s = at.clock_s
    systems = [s.system for s in seen.signals]
    rate = np.array([_EARTH_RATE.get(s, _GPS_EARTH_RATE) for s in systems])[columns]
    here, moving = host.position_m[epochs], host.velocity_m_s[epochs]
    way_s = np.linalg.norm(at.position_m - here, axis=1) / LIGHT_M_S
    for _ in range(_STEPS):
        place = turned(at.position_m, rate * way_s)
        way_s = np.linalg.norm(place - here, axis=1) / LIGHT_M_S
    speed = _apparent(place, turned(at.velocity_m_s, rate * way_s), here, moving, rate)
    found = [np.full((*row.shape, *v.shape[1:]), np.nan) for v in (place, speed, way_s, way_s)]
    values = (place, speed, LIGHT_M_S * at.clock_s, LIGHT_M_S * at.clock_drift)
    for target, value in zip(found, values, strict=True):
        target[epochs, columns] = value
    return _Sent(*found)


def turned(vectors: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors (N, 3) in axes that have turned by an angle (N,) with the Earth since."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = vectors.T
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=-1)


def _apparent(
    place: NDArray[np.float64],
    velocity: NDArray[np.float64],
    here: NDArray[np.float64],
    moving: NDArray[np.float64],
    earth_rate: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Rate of a place at transmission by the time of reception: the way's length changes too."""
    unit = place - here
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    x, y, z = place.T
    turning = np.stack([y, -x, 0 * z], axis=-1) * earth_rate[:, None]
    # With r the way's rate over c: r = unit . (velocity (1 - r) + turning r - moving) / c.
    still = np.einsum("nx,nx->n", unit, velocity - moving) / LIGHT_M_S
    grows = still / (1 + np.einsum("nx,nx->n", unit, velocity - turning) / LIGHT_M_S)
    return np.asarray(velocity + (turning - velocity) * grows[:, None])


def _corrected(
    seen: Observations,
    choice: Choice,
    config: PvtConfig,
    host: _Host,
    sent: _Sent,
    delays: _Delays,
    bias_m: NDArray[np.float64],
) -> dict[str, NDArray[np.float64]]:
    """Ranges of code and carrier, and rates, without what is known of satellites and air."""
    air, later = (
        delays.of(sent.position_m + s * sent.velocity_m_s, s) for s in (0.0, _DELAY_STEP_S)
    )
    code_m, carrier_m = air[1] + air[0], air[1] - air[0]
    growing = (later[1] - later[0] - carrier_m) / _DELAY_STEP_S
    wavelength_m = LIGHT_M_S / np.array([ranges.carrier_hz(s.signal) for s in seen.signals])
    # A second of receiver time is 1 / (1 + drift) seconds long.
    rates = ranges.rates_m_s(seen) * (1 + host.drift[:, None])
    return {
        "range_m": ranges.ranges_m(seen, choice, config) + sent.clock_m - code_m - bias_m,
        "carrier_m": seen.carrier_phase_cycles * wavelength_m + sent.clock_m - carrier_m,
        "rate_m_s": rates + sent.clock_m_s - growing,
    }


class _Delays:
    """Ionosphere and troposphere on the ways of the measurements."""

    def __init__(self, seen: Observations, config: PvtConfig, store: Store, host: _Host) -> None:
        middle = seen.time(seen.epochs // 2)
        self._models = [models.ionosphere(config, s.system, store, middle) for s in seen.signals]
        self._carriers = [ranges.carrier_hz(s.signal) for s in seen.signals]
        self._troposphere = config.troposphere != "none"
        self._seen, self._here = seen, host.position_m

    def elevation_deg(self, satellite_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of satellites (E, S, 3) over the antenna's horizon (E, S)."""
        return azimuth_elevation(self._here[:, None], satellite_m)[..., 1]

    def of(
        self, satellite_m: NDArray[np.float64], later_s: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ionosphere and troposphere in m (E, S), so much after the epochs."""
        shape = satellite_m.shape[:2]
        ionosphere, troposphere = np.zeros(shape), np.zeros(shape)
        place = ecef_to_geodetic(self._here)
        instants = gpst_s(self._seen.reference, self._seen.time_s + later_s)
        for k, (model, carrier) in enumerate(zip(self._models, self._carriers, strict=True)):
            rows = np.flatnonzero(np.isfinite(satellite_m[:, k, 0]))
            look = azimuth_elevation(self._here[rows], satellite_m[rows, k])
            ray = (place[rows], look, instants[rows])
            ionosphere[rows, k] = ionosphere_m(model, *ray, carrier)
            if self._troposphere:
                troposphere[rows, k] = troposphere_m(*ray)
        return ionosphere, troposphere
