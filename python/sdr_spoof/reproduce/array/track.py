"""Figures 6 and 7: the statistic and its curves along the published track, and better forms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.array import motion
from sdr_spoof.aiding.array.simulate import towards
from sdr_spoof.reproduce.study import Number, Picture, Section, Table, near

from . import published
from .figures import draw_roc, draw_statistic
from .shares import drawn

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.aiding.array.config import Form
    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

SEED = 20_170_002
STEPS = 5
"""Epochs between two published ones in the denser track."""
DENSE = (0.138, 0.927, 1.000, 1.000, 1.000)
MATCHED = (0.105, 0.599, 0.984, 1.000, 1.000)
"""Detection probabilities that an independent simulation found, 10 000 runs."""


def section(effort: Effort, stages: Stages) -> Section:
    """Laws in closed form, the draws that check them, and the forms that use the displacement."""
    displacement, spoofer, satellite = published.scenario()
    unit = towards(spoofer, displacement)
    noncentral = published.noncentrality(unit[0], unit[1:])
    with stages("Published track"):
        draws = {
            name: _draws(place, displacement, effort.draws, seed)
            for seed, (name, place) in enumerate((("satellite", satellite), ("spoofer", spoofer)))
        }
        dense = _dense(displacement, spoofer, satellite, effort.draws)
    rates = {
        (name, form): [
            float(np.mean(values[form][k] > motion.threshold(form, k + 2, published.PFA)))
            for k in range(5)
        ]
        for name, values in draws.items()
        for form in motion.FORMS
    }
    moved = np.linalg.norm(displacement, axis=1)[1:]
    away = np.linalg.norm(spoofer - displacement, axis=1)[1:]
    rows: list[Sequence[Cell]] = [
        (
            f"t{k + 1}",
            *(float(v) for v in (moved[k], away[k], noncentral[k], published.area(noncentral[k]))),
            float(published.detected(noncentral[k])),
            *(rates["spoofer", form][k] for form in motion.FORMS),
            *(rates["satellite", form][k] for form in motion.FORMS),
        )
        for k in range(5)
    ]
    columns = (
        *("epoch", "moved (m)", "distance (m)", "noncentrality", "AUC", "Pd by the law"),
        *(f"Pd, {form}" for form in motion.FORMS),
        *(f"Pfa, {form}" for form in motion.FORMS),
    )
    table = Table(
        "track",
        "The published track: law and draws",
        columns,
        rows,
        f"{effort.draws} runs; nominal Pfa {published.PFA:g}; pair: last epoch against first, as "
        "published; the others use all epochs so far.",
    )
    numbers = [
        *_law_numbers(noncentral),
        *_drawn_numbers(rates, effort.draws, noncentral),
        *_dense_numbers(dense, effort.draws),
    ]
    return Section(
        "Figures 6 and 7: the published track",
        text=(
            "The vehicle passes a spoofer at 1.8 to 1.6 km. With the recovered coordinates the "
            "published test has the law that equation 17 gives, and Figures 6 and 7 follow. It "
            "does not use that the INS knows the way gone: a source that stands still near by "
            "must move across the sky in one direction. The matched test asks for that alone, one "
            "degree of freedom, one-sided.",
        ),
        tables=[table, _dense_table(dense)],
        pictures=[
            Picture(
                "figure6",
                "Statistic along the track",
                draw_statistic(moved, draws),
                "Mean and central 98 % of the runs; nu of a satellite has the mean of its law, 2.",
            ),
            Picture(
                "figure7",
                "ROC along the track",
                draw_roc(
                    [(f"t{k + 1}, {moved[k]:.0f} m", noncentral[k]) for k in range(5)],
                    {f"t{k + 1}": draws["spoofer"]["matched"][k] for k in range(3)},
                ),
                "Lines: the published test by its law; dots: the matched test, drawn.",
            ),
        ],
        numbers=numbers,
    )


def _draws(place: Floats, displacement: Floats, runs: int, seed: int) -> dict[Form, list[Floats]]:
    """Statistics of every form at t1 to t5, each from the epochs so far."""
    rng = np.random.default_rng((SEED, seed))
    unit = np.broadcast_to(towards(place, displacement), (runs, *displacement.shape))
    phases = published.measured(unit, displacement, rng)
    return {
        form: [
            motion.statistic(published.ARRAY, phases.at(list(range(k + 1))), form)
            for k in range(1, len(displacement))
        ]
        for form in motion.FORMS
    }


def _dense(
    displacement: Floats, spoofer: Floats, satellite: Floats, runs: int
) -> dict[str, list[float]]:
    """Rates of the matched test with 26 epochs along the track, at t1 to t5."""
    legs = np.arange(0.0, len(displacement) - 1 + 0.5 / STEPS, 1 / STEPS)
    way = np.stack(
        [np.interp(legs, np.arange(len(displacement)), column) for column in displacement.T], axis=1
    )
    found: dict[str, list[float]] = {}
    for seed, (name, place) in enumerate((("satellite", satellite), ("spoofer", spoofer))):
        rng = np.random.default_rng((SEED, 7, seed))
        unit = np.broadcast_to(towards(place, way), (runs, *way.shape))
        phases = published.measured(unit, way, rng)
        found[name] = []
        for k in range(1, len(displacement)):
            epochs = k * STEPS + 1
            values = motion.statistic(published.ARRAY, phases.at(list(range(epochs))), "matched")
            found[name].append(
                float(np.mean(values > motion.threshold("matched", epochs, published.PFA)))
            )
    return found


def _dense_table(dense: dict[str, list[float]]) -> Table:
    rows = [
        (f"t{k + 1}", dense["spoofer"][k], DENSE[k], dense["satellite"][k])
        for k in range(len(DENSE))
    ]
    return Table(
        "dense",
        "Matched test with 26 epochs along the track",
        ("epoch", "Pd", "another simulation", "Pfa"),
        rows,
    )


def _law_numbers(noncentral: Floats) -> list[Number]:
    numbers = []
    for k, value in enumerate(noncentral):
        at = f"at t{k + 1}"
        law = float(published.detected(value))
        area = float(published.area(value))
        numbers += [
            near(f"lambda_t{k + 1}", f"noncentrality {at}", value, published.LAMBDA[k], 1e-3),
            near(f"auc_t{k + 1}", f"area under the curve {at}", area, published.AUC[k], 1e-4),
            near(f"pd_t{k + 1}", f"Pd of the published test {at}", law, published.PD[k], 1e-3),
        ]
    strict = float(published.detected(noncentral[2], 1e-3))
    numbers.append(near("pd_t3_pfa_1e-3", "Pd at t3 at a Pfa of 0.1 %", strict, 0.733, 1e-3))
    for pd, reference in ((0.5, 8.19), (0.9, 17.43), (0.95, 20.65), (0.99, 27.41)):
        what = f"noncentrality for a Pd of {pd:g}"
        numbers.append(near(f"lambda_for_{pd:g}", what, published.needed(pd), reference, 0.01))
    return numbers


def _drawn_numbers(
    rates: dict[tuple[str, Form], list[float]], runs: int, noncentral: Floats
) -> list[Number]:
    numbers = []
    for k, law in enumerate(published.detected(noncentral)):
        name, what = f"drawn_pd_t{k + 1}", f"Pd of the published test at t{k + 1}, drawn"
        numbers.append(drawn(name, what, rates["spoofer", "pair"][k], float(law), runs))
    for k, reference in enumerate(MATCHED[:3]):
        name, what = f"matched_pd_t{k + 1}", f"Pd of the matched test at t{k + 1}"
        numbers.append(
            drawn(name, what, rates["spoofer", "matched"][k], reference, runs, other_runs=1e4)
        )
    for form in motion.FORMS:
        for k in range(5):
            name, what = f"pfa_{form}_t{k + 1}", f"Pfa of the test '{form}' at t{k + 1}"
            numbers.append(drawn(name, what, rates["satellite", form][k], published.PFA, runs))
    return numbers


def _dense_numbers(dense: dict[str, list[float]], runs: int) -> list[Number]:
    numbers = []
    for k, reference in enumerate(DENSE[:2]):
        what = f"Pd of the matched test with all epochs to t{k + 1} of 26"
        numbers.append(
            drawn(f"dense_pd_t{k + 1}", what, dense["spoofer"][k], reference, runs, other_runs=1e4)
        )
    for k, value in enumerate(dense["satellite"]):
        what = f"Pfa of the matched test with all epochs to t{k + 1} of 26"
        numbers.append(drawn(f"dense_pfa_t{k + 1}", what, value, published.PFA, runs))
    return numbers
