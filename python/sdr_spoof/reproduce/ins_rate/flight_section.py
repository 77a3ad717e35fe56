"""One flight with the published attacks, through the detectors (figures 5, 6, 7, 9, 10)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import decision
from sdr_spoof.aiding import detectors, strapdown
from sdr_spoof.aiding.detectors import position_consistency
from sdr_spoof.aiding.detectors.prepared import Prepared, prepare
from sdr_spoof.aiding.imu.simulate import true_states
from sdr_spoof.aiding.rate_config import RateConfig
from sdr_spoof.aiding.simulated import (
    Attack,
    ReceiverNoise,
    fixed,
    hover,
    position_step,
    simulate,
    velocity_drag,
)
from sdr_spoof.config import Config
from sdr_spoof.decision import Decision
from sdr_spoof.reproduce.study import Number, Picture, Section, Table, near
from sdr_spoof.scenario.sky import earth

from . import published
from .drag_runs import CARRIER_M, PERFECT
from .flight_figures import draw_attacked, draw_clean, draw_rates
from .simulated import SKY
from .strapdown_runs import RATE_HZ, imu, recorded

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

SEED = 20_220_406
FLIGHT = 0
TURN_M_S2 = 3.7
HOVER, DRAG, STEP = "hover", "velocity drag", "position step"
CLEAN = "none"
DETECTORS = (
    "rate_drag",
    "rate_consistency",
    "rate_local",
    "rate_satellites",
    "position_consistency",
)


@dataclass(frozen=True)
class Seen:
    """Of one attack: east, north, up of GNSS minus INS."""

    rate_m_s: Floats
    """(E, 3)"""
    position_m: Floats
    """(E, 3)"""


def attacks() -> dict[str, list[Attack]]:
    """The published ones, each alone."""
    return {
        CLEAN: [],
        HOVER: [hover(*published.HOVER_S)],
        DRAG: [velocity_drag((0.0, published.DRAG_M_S, 0.0), *published.DRAG_S)],
        STEP: [position_step((published.STEP_M, 0.0, 0.0), *published.STEP_S)],
    }


def measurements(attack: Sequence[Attack]) -> Measurements:
    """Ten satellites, phases of 5 mm, code of 1 m and multipath, each second."""
    way, _ = recorded(FLIGHT)
    time_s = np.arange(published.DURATION_S + 1)
    sky = fixed(time_s, way.position_m(time_s[:1])[0], SKY)
    noise = ReceiverNoise(carrier_m=CARRIER_M)
    return simulate(way, sky, time_s, noise, None, attack, SEED).run()


def navigated(grade: str) -> InertialStates:
    """A free INS on the flight, by the strapdown computer."""
    way, log = recorded(FLIGHT)
    start = true_states(way, np.zeros(1))
    return strapdown.navigate_runs(log, start, [imu(grade, FLIGHT)], every=RATE_HZ).run(0)


def settings(grade: str) -> Config:
    """Of the detectors; one sample in a mean, as published."""
    rate = RateConfig(grade=grade, carrier_sigma_m=CARRIER_M, samples="one", **PERFECT)
    return Config(rate=rate)


def seen(measured: Measurements, prepared: Prepared, config: Config) -> Seen:
    """Both forms of the statistic."""
    found = prepared.changes
    away, _ = position_consistency.against_ins(measured, prepared, config.rate)
    local = np.einsum("eij,ej->ei", found.axes, away)
    return Seen(found.displacement_m / found.interval_s[:, None], local)


def section(effort: Effort, stages: Stages) -> Section:
    """Pictures of the statistics, and what the detectors say of each attack."""
    grades = published.GRADES[:1] if effort.quick else published.GRADES
    names = DETECTORS[:2] if effort.quick else DETECTORS
    rows: list[tuple[Cell, ...]] = []
    shown: dict[str, Seen] = {}
    with stages("One flight with the published attacks"):
        measured = {name: measurements(attack) for name, attack in attacks().items()}
        for grade in grades:
            states, config = navigated(grade), settings(grade)
            for name, one in measured.items():
                rows += [(grade, name, *row) for row in _decided(one, states, config, names)]
                if grade == "n1":
                    shown[name] = seen(one, prepare(one, states, config.rate), config)
    return Section(
        "One flight (figures 5, 6, 7, 9, 10)",
        text=(
            "A position step shows in the rate as one spike when it comes and one when it goes, "
            "and nothing between; a hover as minus the vehicle's velocity; a drag of 0.1 m/s "
            "stands on the drift of the INS, which is larger from 300 s on. The alarm must latch.",
            "The expected change of phase is that of the displacement over the interval. Compared "
            f"with the velocity at its end, a turn of {TURN_M_S2:g} m/s² would add half of that.",
        ),
        tables=[_table(rows)],
        pictures=_pictures(shown, navigated("n1")),
        numbers=[*_numbers(shown, rows)],
    )


def _decided(
    measured: Measurements, states: InertialStates, config: Config, names: Sequence[str]
) -> Iterator[tuple[Cell, ...]]:
    """First alarm of each detector: name, time, onset, direction."""
    for name in names:
        first: tuple[Cell, ...] = (name, None, None, None)
        for series in detectors.find(name).statistics(measured, states, config):
            decided = decision.decide(series, config.detection)
            sooner = isinstance(decided, Decision) and (
                first[1] is None or decided.alarm_s < float(first[1])
            )
            if sooner and isinstance(decided, Decision):
                which = series.quantity or f"{series.system}{series.prn:02d}"
                first = (name, decided.alarm_s, decided.onset_s, which)
        yield first


def _table(rows: Sequence[Sequence[Cell]]) -> Table:
    return Table(
        "attacks",
        "First alarm of each detector, with the law of the INS's errors",
        ("INS", "attack", "detector", "alarm (s)", "onset (s)", "direction"),
        rows,
        "Hover 25 to 50 s, drag 650 to 750 s, step 1500 to 1550 s. Detectors of a free INS widen "
        "their thresholds with its age, instead of raising false alarms.",
    )


def _pictures(shown: dict[str, Seen], states: InertialStates) -> list[Picture]:
    place = states.position_m
    moved = np.diff(place, axis=0, prepend=np.full((1, 3), np.nan))
    speed = np.einsum("eij,ej->ei", earth.enu_axes(place), moved)
    clean = shown[CLEAN]
    return [
        Picture(
            "figure5",
            "Velocity by carrier phase and by the INS",
            draw_rates(speed + clean.rate_m_s, speed),
            "Without an attack: east, north and up velocity over each second, N1. In the "
            "publication they cannot be told apart; a free INS of N1 is 3 m/s off at the end.",
        ),
        Picture(
            "figure6",
            "Rate statistic without an attack",
            draw_clean(clean.rate_m_s, published.RATE_M_S, "m/s"),
            "GNSS minus INS, N1, free since 0 s; dashed: printed thresholds. The drift alone "
            "leaves them after some 300 s.",
        ),
        Picture(
            "figure7",
            "Position statistic without an attack",
            draw_clean(clean.position_m, published.POSITION_M, "m"),
            "The same flight in the position form; dashed: printed thresholds.",
        ),
        Picture(
            "figure9",
            "Rate statistic under the published attacks",
            draw_attacked([shown[k].rate_m_s for k in (CLEAN, HOVER, DRAG, STEP)], "m/s"),
            "Attacked in colour over clean in grey; dashed: printed thresholds. The end of the "
            "drag (a jump of -10 m) is cut off.",
        ),
        Picture(
            "figure10",
            "Position statistic under the published attacks",
            draw_attacked([shown[k].position_m for k in (CLEAN, HOVER, DRAG, STEP)], "m"),
            "The same in the position form.",
        ),
    ]


def end_velocity_error(across_m_s2: float = TURN_M_S2, speed_m_s: float = 40.0) -> float:
    """Mean size of displacement over 1 s minus velocity at its end, in a steady turn, m/s."""
    time_s = np.arange(0.0, 101.0)
    rate = across_m_s2 / speed_m_s
    place = speed_m_s / rate * np.stack([np.cos(rate * time_s), np.sin(rate * time_s)], axis=-1)
    velocity = speed_m_s * np.stack([-np.sin(rate * time_s), np.cos(rate * time_s)], axis=-1)
    return float(np.linalg.norm(np.diff(place, axis=0) - velocity[1:], axis=1).mean())


def _numbers(shown: dict[str, Seen], rows: Sequence[Sequence[Cell]]) -> Iterator[Number]:
    step = shown[STEP].rate_m_s[:, 0]
    step = step - shown[CLEAN].rate_m_s[:, 0]
    first, last = (round(s) for s in published.STEP_S)
    what = "what the step adds to the rate statistic"
    yield near("step_begins", f"{what} where it comes", float(step[first]), 99.8, 1.0, "m/s")
    yield near("step_ends", f"{what} where it goes", float(step[last]), -100.0, 1.0, "m/s")
    between = step[first + 1 : last]
    what = f"{what} between, at most"
    yield Number("step_between", what, float(np.abs(between).max()), 0.0, 0.01, "m/s")
    still = slice(round(published.HOVER_S[0]) + 1, round(published.HOVER_S[1]))
    yield near(
        "hover",
        "rate statistic during the hover, east",
        float(shown[HOVER].rate_m_s[still, 0].mean()),
        -40.0,
        0.5,
        "m/s",
    )
    what = "error of the velocity at the end of the interval, turn of 3.7 m/s²"
    yield near("end_velocity", what, end_velocity_error(), 1.9, 0.06, "m/s")
    for grade, attack, detector, alarm_s, *_ in rows:
        if detector != "rate_drag":
            continue
        label = f"alarm_{grade}_{str(attack).replace(' ', '_')}"
        what = f"rate_drag, {str(grade).upper()}, attack: {attack}"
        if attack == CLEAN:
            count = float(alarm_s is not None)
            yield Number(label, f"{what}: alarms", count, 0.0, 0.0)
            continue
        start = {HOVER: published.HOVER_S, DRAG: published.DRAG_S, STEP: published.STEP_S}
        delay = float("inf") if alarm_s is None else float(alarm_s) - start[str(attack)][0]
        yield Number(label, f"{what}: delay", delay, 0.0, 3.0, "s")
