"""Carrier and code loops on correlator taps in closed form, many runs side by side.

A run receives the sum of some rays: the authentic signal and a spoofer, or its echo. The taps are
the sum of each ray's amplitude, autocorrelation and phasor (the turn within the epoch included),
plus Gaussian noise that is correlated between taps as the code is. Second-order phase loop,
first-order code loop, updates each 10 ms. It shows what the physics does, apart from the receiver
proper: no pull-in, no loss of lock, no data.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Complex = NDArray[np.complex128]

EPOCH_S = 0.01
PLL_BANDWIDTH_HZ = 10.0
DLL_BANDWIDTH_HZ = 1.0
POWER_MEMORY = 0.02
"""Weight of the newest epoch in the power that normalises the code discriminator."""


@dataclass(frozen=True)
class Band:
    """One signal as the loops see it."""

    carrier_hz: float
    chip_m: float
    boc: bool
    """BOC(1,1), otherwise BPSK."""
    costas: bool
    """Data unknown: phase known up to half a cycle."""
    tap_chips: Floats
    """Very early, early, prompt, late, very late."""

    def correlation(self, chips: Floats) -> Floats:
        """Autocorrelation at an offset in chips."""
        off = np.abs(chips)
        if self.boc:
            return np.where(off < 0.5, 1.0 - 3.0 * off, np.minimum(off - 1.0, 0.0))
        return np.maximum(1.0 - off, 0.0)


LIGHT_M_S = 299_792_458.0
B1C = Band(1575.42e6, LIGHT_M_S / 1.023e6, True, False, np.array([-0.2, -0.1, 0.0, 0.1, 0.2]))
B1I = Band(1561.098e6, LIGHT_M_S / 2.046e6, False, True, np.array([-0.5, -0.25, 0.0, 0.25, 0.5]))


@dataclass(frozen=True)
class Rays:
    """What arrives at one time, beside the authentic signal of amplitude 1 and delay 0.

    Arrays of shape (runs,), against the authentic signal.
    """

    amplitude: Floats
    delay_m: Floats
    phase_cycles: Floats
    offset_hz: Floats


@dataclass(frozen=True)
class Epoch:
    """What the loops give each 10 ms."""

    taps: Complex
    """Prompt in phase where the loop is locked, noise variance 2, shape (taps, runs)."""
    phase_cycles: Floats
    """Oscillator plus discriminator, growing with the received phase, shape (runs,)."""


class Loops:
    """State of the loops of one band in all runs."""

    def __init__(self, band: Band, cn0_dbhz: float, runs: int, rng: np.random.Generator) -> None:
        """Locked to the authentic signal at zero phase, frequency and delay."""
        self._band = band
        self._rng = rng
        self._amplitude = float(np.sqrt(2.0 * 10.0 ** (cn0_dbhz / 10.0) * EPOCH_S))
        spacing = band.tap_chips[:, None] - band.tap_chips
        self._colour = np.linalg.cholesky(band.correlation(spacing))
        self._phase = np.zeros(runs)
        self._frequency = np.zeros(runs)
        self._delay = np.zeros(runs)
        self._power = np.full(runs, self._amplitude**2)
        natural = PLL_BANDWIDTH_HZ / 0.53
        self._gains = (np.sqrt(2.0) * natural * EPOCH_S, natural**2 * EPOCH_S)

    def step(self, rays: Rays) -> Epoch:
        """One epoch: taps, discriminators, loops."""
        taps = self._noise()
        for amplitude, delay_m, phase, offset_hz in (
            (1.0, 0.0, 0.0, 0.0),
            (rays.amplitude, rays.delay_m, rays.phase_cycles, rays.offset_hz),
        ):
            taps += self._received(amplitude, delay_m, phase, offset_hz)
        error = self._phase_error(taps[2])
        measured = self._phase + error
        self._steer_code(taps)
        self._phase = self._phase + self._frequency * EPOCH_S + self._gains[0] * error
        self._frequency = self._frequency + self._gains[1] * error
        return Epoch(taps, measured)

    def _received(
        self,
        amplitude: Floats | float,
        delay_m: Floats | float,
        phase: Floats | float,
        offset_hz: Floats | float,
    ) -> Complex:
        late = delay_m / self._band.chip_m - self._delay
        shape = self._band.correlation(late - self._band.tap_chips[:, None])
        turn = np.sinc((offset_hz - self._frequency) * EPOCH_S)
        phasor = np.exp(2j * np.pi * (phase - self._phase))
        return np.asarray(self._amplitude * amplitude * turn * phasor * shape)

    def _noise(self) -> Complex:
        shape = (self._band.tap_chips.size, self._phase.size)
        white = self._rng.standard_normal(shape) + 1j * self._rng.standard_normal(shape)
        return np.asarray(self._colour @ white)

    def _phase_error(self, prompt: Complex) -> Floats:
        if self._band.costas:
            prompt = np.where(prompt.real < 0, -prompt, prompt)
        return np.asarray(np.angle(prompt) / (2.0 * np.pi))

    def _steer_code(self, taps: Complex) -> None:
        early, prompt, late = taps[1], taps[2], taps[3]
        self._power += POWER_MEMORY * (np.abs(prompt) ** 2 - self._power)
        slope = 6.0 if self._band.boc else 2.0
        dot = ((late - early) * prompt.conj()).real
        error = dot / (slope * np.maximum(self._power, 0.05 * self._amplitude**2))
        self._delay = self._delay + 4.0 * DLL_BANDWIDTH_HZ * EPOCH_S * np.clip(error, -0.1, 0.1)


def follow(
    band: Band,
    cn0_dbhz: float,
    runs: int,
    epochs: int,
    rays: Callable[[float], Rays],
    seed: int,
    each: Callable[[int, Epoch], None],
) -> None:
    """Run the loops of one band; ``each`` gets the number of an epoch and what it gave.

    ``rays`` is asked for the middle of each epoch, in s.
    """
    loops = Loops(band, cn0_dbhz, runs, np.random.default_rng(seed))
    for epoch in range(epochs):
        each(epoch, loops.step(rays((epoch + 0.5) * EPOCH_S)))


class WindowSlope:
    """Least-squares slope of the phase over consecutive windows, in Hz, shape (windows, runs)."""

    def __init__(self, runs: int, epochs: int, rows: int) -> None:
        """Windows of ``rows`` epochs."""
        self._rows = rows
        lever = np.arange(rows) - (rows - 1) / 2.0
        self._lever = lever / (float(lever @ lever) * EPOCH_S)
        self.slope_hz = np.zeros((epochs // rows, runs))

    def add(self, epoch: int, phase_cycles: Floats) -> None:
        """Take one epoch's phase."""
        window, row = divmod(epoch, self._rows)
        if window < len(self.slope_hz):
            self.slope_hz[window] += self._lever[row] * phase_cycles
