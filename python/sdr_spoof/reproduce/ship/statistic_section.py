"""What the published statistic sees: one channel of white noise, in three readings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.reproduce.study import Number, Section, Table, near

from . import published

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

LENGTH = 10
CALIBRATION = 2000
"""Epochs without interference whose largest value is the divisor: it grows with their number."""
AFTER = 200
SEED = 20_260_041
BIASES = (1.0, 2.0, 3.0, 4.0, 6.0, 10.0)
FORMS = ("mean square", "lag-1 product", "coherent")
NEVER = float("inf")


def forms(deviations: Floats) -> Floats:
    """The three readings over windows of the last axis; their axis comes first."""
    square = _moving(deviations**2, LENGTH) / LENGTH
    lagged = _moving(deviations[..., 1:] * deviations[..., :-1], LENGTH - 1) / (LENGTH - 1)
    coherent = (_moving(deviations, LENGTH) / LENGTH) ** 2
    return np.stack([square, lagged, coherent])


def _moving(values: Floats, length: int) -> Floats:
    """Sums over windows of the last axis."""
    sums = np.cumsum(values, axis=-1)
    before = np.concatenate([np.zeros_like(sums[..., :1]), sums[..., :-length]], axis=-1)
    return np.asarray(sums[..., length - 1 :] - before)


def delays(bias: float, draws: int) -> Floats:
    """Median epochs until R > 1: printed and self-normalised, by form (2, 3)."""
    rng = np.random.default_rng([SEED, round(10 * bias)])
    noise = rng.standard_normal((draws, CALIBRATION + AFTER))
    clean = noise[:, :CALIBRATION]
    printed = np.broadcast_to(np.abs(clean).max(axis=1) ** 2, (3, draws))
    own = forms(clean).max(axis=-1)
    attacked = noise[:, CALIBRATION - LENGTH + 1 :].copy()
    attacked[:, LENGTH - 1 :] += bias
    value = forms(attacked)
    return np.array([np.median(_first(value > d[..., None]), axis=-1) for d in (printed, own)])


def _first(over: NDArray[np.bool_]) -> Floats:
    return np.where(over.any(axis=-1), over.argmax(axis=-1) + 1.0, NEVER)


def glitches(draws: int) -> Floats:
    """Share in which one glitch of 12 sigma alarms, by form; printed divisors."""
    rng = np.random.default_rng([SEED, 1])
    clean = rng.standard_normal((draws, CALIBRATION))
    noise = rng.standard_normal((draws, 2 * LENGTH - 1))
    noise[:, LENGTH - 1] += 12.0
    divisor = np.abs(clean).max(axis=1) ** 2
    return np.asarray((forms(noise) > divisor[:, None]).any(axis=-1).mean(axis=-1))


def section(effort: Effort, stages: Stages) -> Section:
    """Delays and glitches."""
    draws = max(500, 10 * effort.runs)
    with stages("R statistic"):
        found = {bias: delays(bias, draws) for bias in BIASES}
        alarms = glitches(draws)
    return Section(
        "The R statistic on white noise",
        text=(
            "The publication accumulates normalised deviations of GNSS from the INS over L points; "
            "its formulas are lost. Three readings are formed: mean square, lag-1 product, "
            "coherent square. Divided by the square of the largest deviation without interference "
            "(as printed, 0 <= R <= 1 when clean), the test is deaf below three sigma. Divided by "
            "its own largest clean value it is not.",
            f"One channel, L = {LENGTH}; the clean maximum is taken over {CALIBRATION} epochs, "
            f"since it depends on their number; medians of {draws} draws.",
        ),
        tables=[_table(found), _glitch_table(alarms)],
        numbers=_numbers(found, alarms),
    )


def _epochs(value: float) -> Cell:
    return "never" if np.isinf(value) else float(value)


def _table(found: dict[float, Floats]) -> Table:
    columns = ["bias (sigma)"]
    columns += [f"{form}, {how}" for how in ("printed", "self-normalised") for form in FORMS]
    rows: list[Sequence[Cell]] = [
        [bias, *(_epochs(v) for v in values.ravel())] for bias, values in found.items()
    ]
    return Table("statistic_delays", "Epochs until R > 1", columns, rows)


def _glitch_table(alarms: Floats) -> Table:
    rows: list[Sequence[Cell]] = [
        [form, float(share)] for form, share in zip(FORMS, alarms, strict=True)
    ]
    title = "One glitch of 12 sigma: share of draws with an alarm, divided as printed"
    return Table("statistic_glitch", title, ("form", "share"), rows)


def _numbers(found: dict[float, Floats], alarms: Floats) -> Sequence[Number]:
    numbers = []
    for bias, delay in published.LITERAL_DELAY.items():
        what = f"delay of R as printed at {bias} sigma"
        value = float(found[bias][0, 0])
        numbers.append(near(f"literal_delay_{bias}", what, value, delay, 0.5, "epochs"))
    never = float(np.isinf(found[2.0][0, 0]))
    numbers.append(near("literal_deaf_2", "R as printed never sees 2 sigma", never, 1.0, 0.0))
    for bias, delay in published.SELF_DELAY.items():
        what = f"delay of self-normalised R at {bias} sigma"
        value = float(found[bias][1, 0])
        numbers.append(near(f"self_delay_{bias}", what, value, delay, 1.0, "epochs"))
    what = "one 12-sigma glitch alarms the mean square"
    numbers.append(near("glitch_mean_square", what, float(alarms[0]), published.GLITCH, 0.1))
    what = "one 12-sigma glitch alarms the lag-1 product"
    numbers.append(near("glitch_lag_1", what, float(alarms[1]), 0.0, 0.01))
    return numbers
