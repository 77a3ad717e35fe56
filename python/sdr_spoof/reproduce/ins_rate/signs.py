"""Signs of the biases: what a drag of 0.1 m/s adds to the epochs beyond the printed threshold.

Another simulation has 80.6 % of the dragged epochs from 651 to 750 s beyond 0.1366 m/s and 93.0 %
of the clean ones. A drag can lower the share only where the drift has the other sign, so the signs
are tried: drawn anew for each flight, or the same in all flights, every one of the 64 ways.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.imu.grades import named
from sdr_spoof.reproduce.study import Table

from . import drift, published
from .simulated import RATE_NOISE_M_S, white

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.reproduce.study import Cell

    from .flights import Sampled

    Floats = NDArray[np.float64]

SEED = 20_220_407
DRAWS = 50
NORTH = 1
EPOCHS = slice(651, 750)


def shares(flights: Sampled, signs: Floats) -> tuple[Floats, Floats]:
    """Of the epochs beyond the threshold, clean and dragged, (K,), for signs (K, R, 6) of N1."""
    grade, rng = named("n1"), np.random.default_rng(SEED)
    flown = drift.grow(
        flights, grade.gyro.bias * signs[..., :3], grade.accelerometer.bias * signs[..., 3:]
    )
    rate = -flown.rate_m_s[..., EPOCHS, NORTH]
    rate = rate + white(rng, rate.shape[1:], RATE_NOISE_M_S)[..., NORTH]
    limit = published.RATE_M_S[NORTH]
    beyond = [np.abs(rate + added) > limit for added in (0.0, published.DRAG_M_S)]
    return beyond[0].mean(axis=(1, 2)), beyond[1].mean(axis=(1, 2))


def table(flights: Sampled) -> Table:
    """Both kinds of signs."""
    rng = np.random.default_rng(SEED)
    drawn = rng.choice([-1.0, 1.0], (DRAWS, flights.runs, 6))
    fixed = np.repeat(np.array(list(product([-1.0, 1.0], repeat=6)))[:, None], flights.runs, axis=1)
    rows: list[tuple[Cell, ...]] = []
    for kind, signs in (("drawn for each flight", drawn), ("the same in all flights", fixed)):
        clean, dragged = shares(flights, signs)
        added = 100 * (dragged - clean)
        rows.append(
            (
                kind,
                len(signs),
                100 * float(clean.mean()),
                float(added.mean()),
                float(added.std(ddof=1)),
                float(added.min()),
                float(added.max()),
            )
        )
    return Table(
        "signs",
        "Epochs from 651 to 750 s beyond the printed threshold, north, N1: what the drag adds",
        ("signs of the biases", "ways", "clean (%)", "added (%)", "deviation", "least", "most"),
        rows,
        f"{flights.runs} flights each. The other simulation: 93.0 % clean, the drag adds -12.4 %.",
    )
