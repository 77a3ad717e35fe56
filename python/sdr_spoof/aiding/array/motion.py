"""Whether a source stands still in the sky while the vehicle moves: time-differenced phases.

H0: the direction, freed from attitude, is that of a satellite at all epochs. A near spoofer's moves
as the vehicle passes by. All forms come from one generalised least-squares fit of a constant
direction, without and with a motion:

- ``pair``: last epoch against first, chi-square with 2 degrees of freedom (paper, equation 15),
- ``all``: every epoch against the constant, 2 (E - 1),
- ``slope``: a motion in proportion to the way gone, 2,
- ``matched``: a motion as the displacement asks of a source at some distance; its size alone is
  free and cannot be negative: a one-sided normal law.

Unknown whole cycles (about 11 pairs are possible at sides of two wavelengths) take the side of the
satellite: an alarm is one with all of them that leave it possible.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtrc, chdtri, ndtr, ndtri

from .config import Form
from .directions import directions, whole_cycles

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .directions import Directions
    from .geometry import AntennaArray
    from .phases import ArrayPhases

    Floats = NDArray[np.float64]

FORMS: tuple[Form, ...] = ("pair", "all", "slope", "matched")
_HOPELESS = 1e-4
"""Whole cycles whose best fit of a satellite is as unlikely as this explain none."""


def freedom(form: Form, epochs: int) -> int:
    """Degrees of freedom of a form's chi-square; of ``matched`` 1, one-sided."""
    return {"pair": 2, "all": 2 * (epochs - 1), "slope": 2, "matched": 1}[form]


def statistic(array: AntennaArray, phases: ArrayPhases, form: Form = "matched") -> Floats:
    """The form's statistic for every run (...); NaN where no whole cycles give a direction.

    Chi-square with :func:`freedom` under H0; of ``matched`` a standard normal number, of which
    only large positive ones are meant.
    """
    if form == "pair":
        phases = phases.at([0, phases.time_s.size - 1])
    fits = [_fit(array, phases, form, n) for n in whole_cycles(array, phases)]
    still = np.stack([f[0] for f in fits])
    least = still.min(axis=0)
    if form == "matched":
        found = _least_score(still, np.stack([f[1] for f in fits]), phases.time_s.size)
    elif form == "slope":
        found = least - np.stack([f[1] for f in fits]).min(axis=0)
    else:
        found = least
    return np.where(np.isfinite(least), found, np.nan)


def _least_score(still: Floats, scores: Floats, epochs: int) -> Floats:
    """Least of the scores of those whole cycles with which the source may be a satellite at all.

    Where there is none, the score is that of the best fit of a satellite.
    """
    freedom_of_fit = freedom("all", epochs)
    may = still <= chdtri(freedom_of_fit, _HOPELESS)
    least = np.where(may, scores, np.inf).min(axis=0)
    hopeless = normal_score(still.min(axis=0), "all", epochs)
    return np.where(np.isfinite(least), least, hopeless)


def _fit(array: AntennaArray, phases: ArrayPhases, form: Form, n: Floats) -> tuple[Floats, Floats]:
    """Squares about a constant direction, and what the form makes of a motion; infinite if none."""
    found = directions(array, phases, n)
    still, second = _residuals(found, phases, form)
    if phases.known_cycles:
        return still, second
    allowed = found.admissible
    return np.where(allowed, still, np.inf), np.where(allowed, second, np.inf)


def threshold(form: Form, epochs: int, pfa: float) -> float:
    """What the statistic exceeds with a probability under H0."""
    if form == "matched":
        return float(-ndtri(pfa))
    return float(chdtri(freedom(form, epochs), pfa))


def normal_threshold(pfa: float) -> float:
    """What a normal score exceeds with a probability under H0."""
    return float(-ndtri(pfa))


def normal_score(values: Floats, form: Form, epochs: int) -> Floats:
    """The statistic as a standard normal number with the same one-sided significance."""
    if form == "matched":
        return values
    return np.asarray(-ndtri(np.maximum(chdtrc(freedom(form, epochs), values), 1e-300)))


def p_value(values: Floats, form: Form, epochs: int) -> Floats:
    """Probability under H0 of so large a statistic."""
    if form == "matched":
        return np.asarray(ndtr(-values))
    return np.asarray(chdtrc(freedom(form, epochs), values))


def family(p_values: Floats, pfa: float) -> NDArray[np.bool_]:
    """Which satellites are spoofed with one false alarm in 1/pfa for all of them together.

    Holm's steps (Scandinavian Journal of Statistics 6 (1979) 65) over the last axis; NaN is none.
    """
    order = np.argsort(p_values, axis=-1)
    ascending = np.take_along_axis(p_values, order, axis=-1)
    left = np.sum(np.isfinite(p_values), axis=-1, keepdims=True) - np.arange(p_values.shape[-1])
    with np.errstate(invalid="ignore"):
        passed = np.logical_and.accumulate(ascending * left <= pfa, axis=-1)
    found = np.zeros(p_values.shape, bool)
    np.put_along_axis(found, order, passed, axis=-1)
    return found


def _residuals(found: Directions, phases: ArrayPhases, form: Form) -> tuple[Floats, Floats]:
    """Weighted squares about a constant, and about a moving direction (``matched``: its score)."""
    epochs = phases.time_s.size
    lead = found.level.shape[:-2]
    columns = [
        found.level.reshape(*lead, 2 * epochs, 1),
        np.broadcast_to(np.tile(np.eye(2), (epochs, 1)), (*lead, 2 * epochs, 2)),
    ]
    if form in ("slope", "matched"):
        columns.append(_motion(found, phases, form))
    white = np.linalg.solve(np.linalg.cholesky(found.covariance), np.concatenate(columns, axis=-1))
    gram = np.swapaxes(white, -1, -2) @ white
    kept = [0, *range(3, gram.shape[-1])]
    cross = gram[..., 1:3, kept]
    free = gram[..., kept, :][..., kept] - np.swapaxes(cross, -1, -2) @ np.linalg.solve(
        gram[..., 1:3, 1:3], cross
    )
    still = free[..., 0, 0]
    if form in ("pair", "all"):
        return still, still
    towards, size = free[..., 1:, 0], free[..., 1:, 1:]
    if form == "matched":
        return still, towards[..., 0] / np.sqrt(size[..., 0, 0])
    gain = np.einsum("...i,...i->...", towards, np.linalg.solve(size, towards[..., None])[..., 0])
    return still, still - gain


def _motion(found: Directions, phases: ArrayPhases, form: Form) -> Floats:
    """Regressors of the motion: in proportion to the way, or as of a source at unit distance."""
    gone = phases.displacement_m
    lead = found.level.shape[:-2]
    epochs = phases.time_s.size
    if form == "slope":
        way = np.linalg.norm(gone, axis=1)
        free = np.kron(way[:, None], np.eye(2))
        return np.broadcast_to(free, (*lead, 2 * epochs, 2))
    mean = found.unit.mean(axis=-2)
    mean /= np.linalg.norm(mean, axis=-1, keepdims=True)
    across = -(gone - (mean @ gone.T)[..., None] * mean[..., None, :])
    return np.asarray(across[..., :2].reshape(*lead, 2 * epochs, 1))
