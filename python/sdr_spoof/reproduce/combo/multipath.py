"""Multipath mistaken for spoofing: delta, ratio and phase difference at equal detection.

Each statistic gets the threshold at which it detects 95 % of one and the same spoofing case; an
echo is then put in the spoofer's place. Static echoes are Figure 4 of the publication, moving ones
it leaves open. On correlator taps in closed form (:mod:`.tap_loops`).

Statistics, each the largest of the windows of a run:

* delta: |(E - L) - (E' - L')| / (2 P), with pairs at +-0.1 and +-0.2 chip (Phelts, 2001); the
  second pair because a code loop makes E - L of its own pair zero;
* ratio: |(E + L) / (2 P) - its value without an echo|, pair at +-0.2 chip;
* this method: |slope of the carrier-scaled phase difference|.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.detectors import combo_model as model

from . import published
from .tap_loops import B1C, B1I, EPOCH_S, Rays, WindowSlope, follow

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from .tap_loops import Epoch

    Floats = NDArray[np.float64]

SEED = 20_180_400
DURATION_S = 60.0
WINDOW_S = 1.0
EPOCHS, ROWS = round(DURATION_S / EPOCH_S), round(WINDOW_S / EPOCH_S)
DELAYS_M = (5.0, 150.0)
"""Extra path of an echo, uniform."""
DETECTION = 0.95
LOST_DBHZ = 25.0
"""Windows in which a band falls below this C/N0 count as lost, as in the receiver."""
METHODS = ("delta metric", "ratio metric", "phase difference rate")


@dataclass(frozen=True)
class Maxima:
    """Largest statistic of each run, one array a method, shape (runs,)."""

    values: dict[str, Floats]


def spoofing(runs: int, cn0_dbhz: float) -> Maxima:
    """The spoofing case: eta 1.5, coherent drag of B1C at 10 Hz from 0 s on, aligned at first."""
    eta = np.full(runs, published.ETA)
    drag = np.full(runs, published.DRAG_HZ)
    wavelength = 299_792_458.0 / B1C.carrier_hz

    def captured(time_s: float) -> Rays:
        return Rays(eta, -drag * wavelength * time_s, drag * time_s, drag)

    def untouched(_: float) -> Rays:
        nothing = np.zeros(runs)
        return Rays(nothing, nothing, nothing, nothing)

    return _maxima(runs, cn0_dbhz, captured, untouched, SEED)


def echoes(amplitude: Floats, fading_hz: Floats, cn0_dbhz: float, part: int = 0) -> Maxima:
    """Echoes of both bands: amplitude and fading rate of each run, delay and phases random.

    Another ``part`` has other noise, delays and phases.

    A fading rate is the echo's Doppler against the direct signal at B1C; its delay grows with it.
    """
    runs = amplitude.size
    seed = SEED + 10 * (part + 1)
    rng = np.random.default_rng(seed)
    delay_m = rng.uniform(*DELAYS_M, runs)
    starts = rng.uniform(0.0, 1.0, (2, runs))

    def rays(carrier_hz: float, start: Floats) -> Callable[[float], Rays]:
        offset = fading_hz * carrier_hz / B1C.carrier_hz
        wavelength = 299_792_458.0 / carrier_hz

        def at(time_s: float) -> Rays:
            moved = delay_m - offset * wavelength * time_s
            return Rays(amplitude, moved, start + offset * time_s, offset)

        return at

    upper, lower = rays(B1C.carrier_hz, starts[0]), rays(B1I.carrier_hz, starts[1])
    return _maxima(runs, cn0_dbhz, upper, lower, seed + 1)


def _maxima(
    runs: int,
    cn0_dbhz: float,
    upper: Callable[[float], Rays],
    lower: Callable[[float], Rays],
    seed: int,
) -> Maxima:
    windows = EPOCHS // ROWS
    slopes = [WindowSlope(runs, EPOCHS, ROWS) for _ in range(2)]
    power = np.zeros((2, windows, runs))
    sums = np.zeros((windows, B1C.tap_chips.size, runs))

    def each_upper(epoch: int, got: Epoch) -> None:
        slopes[0].add(epoch, got.phase_cycles)
        sums[epoch // ROWS] += got.taps.real
        power[0, epoch // ROWS] += np.abs(got.taps[2]) ** 2 / ROWS

    def each_lower(epoch: int, got: Epoch) -> None:
        slopes[1].add(epoch, got.phase_cycles)
        power[1, epoch // ROWS] += np.abs(got.taps[2]) ** 2 / ROWS

    follow(B1C, cn0_dbhz, runs, EPOCHS, upper, seed, each_upper)
    follow(B1I, cn0_dbhz, runs, EPOCHS, lower, seed + 1, each_lower)
    ratio = B1C.carrier_hz / B1I.carrier_hz
    rate = np.abs(slopes[0].slope_hz - ratio * slopes[1].slope_hz)
    delta, peak_ratio = metrics(sums)
    held = ((power - 2.0) / (2.0 * EPOCH_S) > 10.0 ** (LOST_DBHZ / 10.0)).all(axis=0)
    # The first window holds the loops' own transient to an echo that is there from the start.
    held[0] = False
    found = zip(METHODS, (delta, peak_ratio, rate), strict=True)
    return Maxima({name: np.where(held, value, 0.0).max(axis=0) for name, value in found})


def metrics(sums: Floats) -> tuple[Floats, Floats]:
    """Delta and ratio metric, from in-phase sums of shape (windows, 5 taps, runs)."""
    wide_early, early, prompt, late, wide_late = np.moveaxis(sums, 1, 0)
    delta = ((early - late) - (wide_early - wide_late)) / (2.0 * prompt)
    clean = float(B1C.correlation(B1C.tap_chips[-1:])[0])
    return np.abs(delta), np.abs((wide_early + wide_late) / (2.0 * prompt) - clean)


def thresholds(case: Maxima) -> dict[str, float]:
    """Of each method: what 95 % of the spoofing runs exceed."""
    return {name: float(np.quantile(v, 1.0 - DETECTION)) for name, v in case.values.items()}


def calibrated_hz(cn0_dbhz: float) -> float:
    """Threshold of the rate by the published law at Pfa 1e-6, two-sided."""
    cn0_hz = 10.0 ** (cn0_dbhz / 10.0)
    sigma = model.fll_sigma_hz(cn0_hz, published.INTEGRATION_S, published.LOOP_BANDWIDTH_HZ)
    both = model.difference_sigma_hz(sigma, sigma, B1C.carrier_hz / B1I.carrier_hz)
    return float(model.threshold_for_pfa_hz(both, published.PFA, two_sided=True))
