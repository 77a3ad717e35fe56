"""Search for the onset of a drag in what a filter of the INS errors cannot explain.

The filter learns the errors of the INS (:mod:`.growth`) from the displacements that the phases
give: drift, tilt, heading and biases become known as far as the motion shows them, and what it does
not know yet widens its innovations, as in the first turn after a straight flight. Changes of phase
are summed up first: their sum has *white* noise, that of one phase, and an unknown offset, which is
a state. A change of the satellites in use moves the offset.

A drag A that begins at t adds A (now - t) to the sum. Its signature in the innovations follows from
the filter's own gains, and the generalised likelihood ratio of any drag in space that began at one
of the last epochs is a chi-square of three degrees of freedom:

    max over t of b' C^-1 b,   C = sum g' S^-1 g,   b = sum g' S^-1 innovation.

Willsky and Jones, A generalized likelihood ratio approach to the detection and estimation of jumps
in linear systems, IEEE Trans. AC 21 (1976).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .growth import ACCELEROMETER, ATTITUDE, GYRO, POSITION, STATES, VELOCITY

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .growth import Steps

    Floats = NDArray[np.float64]

OFFSET = slice(STATES, STATES + 3)
ALL = STATES + 3
LEAST_EPOCHS = 5
"""Epochs of a piece before anything is tested: until then the offset is barely known."""


@dataclass(frozen=True)
class Displacements:
    """What the filter is given: G flights (geometry) with M runs each, E epochs; Earth-fixed."""

    time_s: Floats
    """(E,)"""
    moved_m: Floats
    """GNSS minus INS over each interval, (G, M, E, 3)."""
    noise_m2: Floats
    """Covariance of one epoch's phase, (G, E, 3, 3)."""
    begins: NDArray[np.bool_]
    """Whether the epoch before is the first of a piece, (E,)."""
    usable: NDArray[np.bool_]
    """(E,)"""
    same_set: NDArray[np.bool_]
    """(E,)"""


@dataclass(frozen=True)
class Searched:
    """What the search finds at each epoch; NaN where nothing is tested."""

    statistic: Floats
    """Largest likelihood ratio of a drag, chi-square of 3 for each onset, (G, M, E)."""
    onset: NDArray[np.int64]
    """Epoch of that onset, (G, M, E)."""
    drag_m_s: Floats
    """That drag, Earth-fixed, (G, M, E, 3)."""
    sigma_m_s: Floats
    """Standard deviation, in its worst direction, of a drag that began a window ago, (G, E)."""
    innovation: Floats
    """Normalised: N(0, I) without an attack, (G, M, E, 3)."""


def search(given: Displacements, steps: Steps, window: int) -> Searched:
    """Filter all runs and look for drags that began up to ``window`` epochs ago."""
    return _Search(given, steps, window).run()


class _Search:
    """Filter, and signatures of the last onsets in a ring."""

    def __init__(self, given: Displacements, steps: Steps, window: int) -> None:
        flights, runs, epochs, _ = given.moved_m.shape
        self.given, self.steps, self.window = given, steps, window
        self.state = np.zeros((flights, ALL, runs))
        self.spread = np.zeros((flights, ALL, ALL))
        self.spread[:, :STATES, :STATES] = steps.start
        self.total = np.zeros((flights, 3, runs))
        self.first = 0
        self._clear()
        shape = (flights, runs, epochs)
        self.found = Searched(
            np.full(shape, np.nan),
            np.zeros(shape, np.int64),
            np.full((*shape, 3), np.nan),
            np.full((flights, epochs), np.nan),
            np.full((*shape, 3), np.nan),
        )

    def run(self) -> Searched:
        """Epoch by epoch."""
        given = self.given
        for k in range(given.time_s.size):
            if given.usable[k] and given.begins[k]:
                self._begin(k)
            self._advance(k)
            if given.usable[k]:
                self._update(k)
        return self.found

    def _clear(self) -> None:
        flights, runs = self.state.shape[0], self.state.shape[2]
        self.error = np.zeros((self.window, flights, ALL, 3))
        self.onset = np.full(self.window, -1)
        self.information = np.zeros((self.window, flights, 3, 3))
        self.score = np.zeros((self.window, flights, 3, runs))

    def _begin(self, k: int) -> None:
        """A new piece: the sum starts at 0; its offset is the place with one phase's noise."""
        self.total[:] = 0.0
        self.state[:, OFFSET] = self.state[:, POSITION]
        self.spread[:, OFFSET] = self.spread[:, POSITION]
        self.spread[:, :, OFFSET] = self.spread[:, :, POSITION]
        self.spread[:, OFFSET, OFFSET] += self.given.noise_m2[:, k]
        self.first = k
        self._clear()

    def _advance(self, k: int) -> None:
        ins = slice(0, STATES)
        there, back = self.steps.transition[:, k], np.swapaxes(self.steps.transition[:, k], -1, -2)
        if self.steps.aligned[k]:
            self.state[:, ins] = 0.0
            self.spread[:, ins] = self.spread[:, :, ins] = 0.0
            self.spread[:, ins, ins] = self.steps.start
            return
        bent = self._second_order(k)
        self.state[:, ins] = there @ self.state[:, ins]
        self.state[:, VELOCITY] += bent[0]
        self.state[:, POSITION] += bent[0] * (0.5 * self._length(k))
        self.state[:, ATTITUDE] += bent[1]
        self.spread[:, ins] = there @ self.spread[:, ins]
        self.spread[:, :, ins] = self.spread[:, :, ins] @ back
        self.spread[:, ins, ins] += self.steps.noise[:, k]
        self.error[:, :, ins] = there @ self.error[:, :, ins]

    def _length(self, k: int) -> float:
        return float(self.given.time_s[k] - self.given.time_s[k - 1]) if k else 0.0

    def _second_order(self, k: int) -> tuple[Floats, Floats]:
        """What the linear model leaves out of velocity and attitude: heading errors of a quarter
        of a degree are felt in turns."""
        turned = self.state[:, ATTITUDE]
        gained = self.steps.gained[:, k, :, None]
        pushed = self.steps.transition[:, k, VELOCITY, ACCELEROMETER]
        spun = self.steps.transition[:, k, ATTITUDE, GYRO]
        tilted = 0.5 * _cross(turned, gained) + pushed @ self.state[:, ACCELEROMETER]
        return -_cross(turned, tilted), -0.5 * _cross(turned, spun @ self.state[:, GYRO])

    def _update(self, k: int) -> None:
        noise = self.given.noise_m2[:, k]
        if not self.given.same_set[k] and k > self.first:
            self.spread[:, OFFSET, OFFSET] += noise + self.given.noise_m2[:, k - 1]
        self.total += np.swapaxes(self.given.moved_m[:, :, k], 1, 2)
        across = self.spread[:, :, OFFSET] - self.spread[:, :, POSITION]
        expected = across[:, OFFSET] - across[:, POSITION] + noise
        inverse = np.asarray(np.linalg.inv(expected), np.float64)
        innovation = self.total - (self.state[:, OFFSET] - self.state[:, POSITION])
        gain = across @ inverse
        self._test(k, gain, inverse, innovation)
        self.state += gain @ innovation
        spread = self.spread - gain @ np.swapaxes(across, -1, -2)
        self.spread = 0.5 * (spread + np.swapaxes(spread, -1, -2))

    def _test(self, k: int, gain: Floats, inverse: Floats, innovation: Floats) -> None:
        slot = k % self.window
        self.onset[slot] = k - 1
        self.error[slot], self.information[slot], self.score[slot] = 0.0, 0.0, 0.0
        known = np.flatnonzero(self.onset >= 0)
        length = self.given.time_s[k] - self.given.time_s[self.onset[known]]
        error = self.error[known]
        mark = length[:, None, None, None] * np.eye(3) - (
            error[:, :, OFFSET] - error[:, :, POSITION]
        )
        weighted = np.swapaxes(mark, -1, -2) @ inverse
        self.information[known] += weighted @ mark
        self.score[known] += weighted @ innovation
        self.error[known] = error + gain @ mark
        root = np.linalg.cholesky(inverse)
        self.found.innovation[:, :, k] = np.swapaxes(np.swapaxes(root, -1, -2) @ innovation, 1, 2)
        if k - self.first >= LEAST_EPOCHS:
            self._best(k, known)

    def _best(self, k: int, known: NDArray[np.int64]) -> None:
        variance = np.linalg.inv(self.information[known])
        drag = variance @ self.score[known]
        ratio = (drag * self.score[known]).sum(axis=2)
        best = ratio.argmax(axis=0)
        flight, run = np.indices(best.shape)
        self.found.statistic[:, :, k] = ratio[best, flight, run]
        self.found.onset[:, :, k] = self.onset[known][best]
        self.found.drag_m_s[:, :, k] = drag[best, flight, :, run]
        oldest = int(self.onset[known].argmin())
        self.found.sigma_m_s[:, k] = np.sqrt(np.linalg.eigvalsh(variance[oldest])[:, -1])


def _cross(first: Floats, second: Floats) -> Floats:
    """Cross product along the second axis, (G, 3, M)."""
    x, y, z = first[:, 0], first[:, 1], first[:, 2]
    a, b, c = second[:, 0], second[:, 1], second[:, 2]
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=1)
