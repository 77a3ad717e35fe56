"""With and without DME, and the two cases in which DME decides."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import decision
from sdr_spoof.aiding.dme.feedback import Feedback
from sdr_spoof.aiding.dme.spoofing import coherent
from sdr_spoof.aiding.dme.statistics import STATISTICS
from sdr_spoof.decision.calibration import threshold_for
from sdr_spoof.reproduce.study import Number, Picture, Section, Table, near

from . import figures, published, trials

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.aiding.dme.geometry import Geometry
    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

DRAG_M_S = 2.0
DRAG_S = 120
CAPTURED = Feedback("velocity", 10.0, noisy=False)
STEP_M = 252.0
"""Displacement along the difference of directions that thirty epochs find."""
ABLATION_M = 15.0
RATES_M_S = (0.5, 1.0, 1.5, 2.0, 3.0, 5.0)
BEARINGS_DEG = np.arange(0.0, 181.0, 15.0)


def section(effort: Effort, stages: Stages) -> Section:
    """Ablation, drags, steps."""
    stages("with and without DME")
    gain = hat_gain()
    ablation = _ablation(effort)
    stages("a captured INS")
    drags = {rate: _drag(rate, along(), effort) for rate in RATES_M_S}
    turned = {float(b): _drag(DRAG_M_S, _bearing(float(b)), effort) for b in BEARINGS_DEG}
    step = _step(effort)
    needed = needed_m()
    return Section(
        "What DME is worth",
        text=(
            "Through equation 13 DME adds nothing: a range of 183 m weighs (3.4 / 183)² against a "
            "pseudorange of 3.4 m. With and without it the fitted values, and the shares found, "
            "are the same.",
            "As a channel of its own, station against station, it is the one measurement that a "
            "spoofer of GNSS does not touch. First case: a coherent drag (all satellites as from "
            "one false trajectory) with an INS that GNSS corrects in position and velocity: "
            "hardly anything is left in Delta and nothing in the parity of the satellites, and "
            "the DME difference finds it. So does a parity vector that has the stations in it, "
            "one channel of which is DME against GNSS. Second case: a displacement that stays, "
            "which thirty epochs find from some 250 m on. Both only along the difference of the "
            "directions to the stations; across it, nothing.",
        ),
        tables=[
            _ablation_table(ablation, gain),
            _drag_table(drags),
            _bearing_table(turned),
            Table(
                "dme_step",
                f"A captured INS that is {STEP_M:g} m off, 30 epochs",
                ("quantity", "value"),
                (
                    ("share found along the difference of directions", step[0]),
                    ("share found across it", step[1]),
                    ("needed at alpha 1e-5 and beta 1e-3, closed form (m)", needed),
                ),
            ),
        ],
        pictures=[
            Picture(
                "dme",
                "Coherent drags with a captured INS",
                figures.dme({r: d["dme-difference"] for r, d in drags.items()}, turned, _one_run()),
                "Left: one run, 2 m/s from 200 s on. Middle: share of runs found by then. Right: "
                "share found within 120 s by the bearing of the drag.",
            )
        ],
        numbers=_numbers(ablation, gain, drags[DRAG_M_S], needed, step, effort),
    )


def along() -> np.ndarray:
    """Level part of the difference of the directions to the stations."""
    design = published.geometry(published.SIGMA_FIGURE6_M).design
    return np.asarray((design[-2, :3] - design[-1, :3]) * (1.0, 1.0, 0.0))


def _bearing(degrees: float) -> np.ndarray:
    return np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees)), 0.0])


def hat_gain() -> float:
    """Largest change of a fitted value's own weight by DME, at 3.4 m."""
    geometry = published.geometry(published.SIGMA_FIGURE5_M)
    with_dme = np.diag(geometry.hat())[: geometry.satellites]
    alone = np.diag(geometry.without_stations().hat())
    return float(np.abs(with_dme - alone).max())


def needed_m() -> float:
    """Displacement that the mean of thirty epochs finds, at alpha 1e-5 and beta 1e-3."""
    from scipy.stats import norm  # noqa: PLC0415

    geometry = published.geometry(published.SIGMA_FIGURE6_M)
    weights = STATISTICS["dme-difference"].weights(geometry)[0]
    direction = along() / np.linalg.norm(along())
    seen = abs(float((weights @ geometry.design[:, :3]) @ direction))
    wanted = float(norm.isf(published.ALPHA / 2.0) + norm.isf(published.BETA))
    return wanted / (seen * float(published.WITHIN_S**0.5))


def _ablation(effort: Effort) -> dict[bool, float]:
    """Share of runs found within 30 s with and without DME, the same noise."""
    found = {}
    rule = decision.find("improved-sprt")
    case = trials.steps(published.SIGMA_FIGURE6_M, ABLATION_M, 1)
    y = case.run(effort.runs, trials.random_of(62)).differences_m
    for stations in (True, False):
        geometry = published.geometry(published.SIGMA_FIGURE6_M, stations)
        z = trials.channels(STATISTICS["fitted"], y[..., : len(geometry.sigma_m)], geometry)
        path = rule.run(z[:, published.ORDER[0]])
        found[stations] = trials.delays_of(path, published.THRESHOLD, published.ONSET_S).within()
    return found


def _drag(rate_m_s: float, direction: np.ndarray, effort: Effort) -> dict[str, trials.Delays]:
    """By statistic: delays of a coherent drag with a captured INS."""
    geometry = published.geometry(published.SIGMA_FIGURE6_M)
    spoofing = coherent(direction, rate_m_s, published.ONSET_S)
    case = trials.Case(geometry, spoofing, CAPTURED, DRAG_S)
    rule = decision.find(published.DEFAULT_RULE)
    threshold = threshold_for(rule, published.PER_HOUR)
    random = trials.random_of(8, rate_m_s, float(direction[0]))
    late: dict[str, list[np.ndarray]] = {}
    for runs in trials.blocks(effort.runs):
        y = case.run(runs, random).differences_m
        for key, (name, of) in _channels(geometry).items():
            z = trials.channels(STATISTICS[name], y[..., : len(of.sigma_m)], of)
            d = trials.delays_of(rule.run(z), threshold, published.ONSET_S)
            late.setdefault(key, []).append(d.values_s)
    return {name: trials.Delays(np.concatenate(parts)) for name, parts in late.items()}


def _channels(geometry: Geometry) -> dict[str, tuple[str, Geometry]]:
    """Statistics that are compared, with what they see."""
    return {
        "dme-difference": ("dme-difference", geometry),
        "parity": ("parity", geometry),
        "fitted": ("fitted", geometry),
        "satellites": ("parity", geometry.without_stations()),
    }


def _step(effort: Effort) -> tuple[float, float]:
    """Share found of an INS that is off along, and across, within thirty epochs."""
    geometry = published.geometry(published.SIGMA_FIGURE6_M)
    rule, random = decision.find(published.DEFAULT_RULE), trials.random_of(9)
    threshold = published.THRESHOLD
    east, north, _ = along() / np.linalg.norm(along())
    found = []
    for direction in ((east, north, 0.0), (-north, east, 0.0)):
        error = STEP_M * np.array(direction)
        y = random.standard_normal((effort.runs, 60, len(geometry.sigma_m))) * geometry.sigma_m
        y[:, 30:] += geometry.design[:, :3] @ error
        z = trials.channels(STATISTICS["dme-difference"], y, geometry)
        found.append(trials.delays_of(rule.run(z), threshold, 30).within())
    return found[0], found[1]


def _one_run() -> tuple[np.ndarray, np.ndarray, float]:
    """Epochs, statistic and threshold of one run."""
    geometry = published.geometry(published.SIGMA_FIGURE6_M)
    case = trials.Case(geometry, coherent(along(), DRAG_M_S, published.ONSET_S), CAPTURED, DRAG_S)
    run = case.run(1, trials.random_of(10))
    rule = decision.find(published.DEFAULT_RULE)
    z = trials.channels(STATISTICS["dme-difference"], run.differences_m, geometry)
    return run.time_s, rule.run(z)[0, 0], threshold_for(rule, published.PER_HOUR)


def _ablation_table(ablation: dict[bool, float], gain: float) -> Table:
    rows: list[Sequence[Cell]] = [
        ("share found, with DME", ablation[True], 0.581),
        ("share found, without", ablation[False], 0.581),
        ("largest change of a diagonal of H, noise 3.4 m", gain, 1.9e-4),
    ]
    title = f"Fitted value, {ABLATION_M:g} m on the third satellite, noise 10 m, improved test"
    return Table("dme_ablation", title, ("quantity", "here", "reference"), rows)


def _drag_table(drags: dict[float, dict[str, trials.Delays]]) -> Table:
    rows = [
        (
            rate,
            *(found[name].within(DRAG_S) for name in found),
            found["dme-difference"].mean_s,
        )
        for rate, found in drags.items()
    ]
    columns = (
        "drag (m/s)",
        "DME difference",
        "parity with DME",
        "Delta, any satellite",
        "parity without DME",
        "mean delay by DME (s)",
    )
    title = "Coherent drag with a captured INS: share found within 120 s at 1 % an hour"
    return Table("dme_drag", title, columns, rows)


def _bearing_table(turned: dict[float, dict[str, trials.Delays]]) -> Table:
    rows = [(b, found["dme-difference"].within(DRAG_S)) for b, found in turned.items()]
    title = "2 m/s by bearing: share found within 120 s by the DME difference"
    return Table("dme_bearing", title, ("bearing (deg)", "share"), rows, shown=False)


def _numbers(
    ablation: dict[bool, float],
    gain: float,
    drag: dict[str, trials.Delays],
    needed: float,
    step: tuple[float, float],
    effort: Effort,
) -> Sequence[Number]:
    error = trials.ERRORS / effort.runs**0.5
    found = drag["dme-difference"].within(DRAG_S)
    return (
        trials.share_number(
            "ablation_with", "share found with DME", ablation[True], effort.runs, 0.581
        ),
        near(
            "ablation_difference",
            "share found with DME less that without",
            ablation[True] - ablation[False],
            0.0,
            0.01 + (0.0 if not effort.quick else error / 4.0),
        ),
        near("hat_gain", "largest change of H by DME", gain, 1.9e-4, 3e-5),
        Number(
            "dme_drag_found",
            "2 m/s coherent drag, captured INS, share found by DME within 120 s at 1 % an hour",
            found,
            0.95 - (error / 4.0 if effort.quick else 0.0),
            1.0,
        ),
        Number(
            "parity_drag_found",
            "the same by the parity of the satellites alone",
            drag["satellites"].within(DRAG_S),
            0.0,
            0.01 + error / 4.0,
        ),
        Number(
            "delta_drag_found",
            "the same by Delta, any satellite",
            drag["fitted"].within(DRAG_S),
            0.0,
            0.08 + error / 2.0,
            "",
            0.08,
        ),
        near("dme_needed_m", "displacement that thirty epochs find", needed, 252.0, 2.0, "m"),
        Number(
            "dme_step_across", "share found across the difference", step[1], 0.0, 0.01 + error / 4.0
        ),
    )
