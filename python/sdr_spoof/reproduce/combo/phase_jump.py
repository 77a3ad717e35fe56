"""Figure 2 of the publication from samples: jump and slope of the phase difference."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.detectors import combo_model as model
from sdr_spoof.detectors.phase_difference import scaled_difference
from sdr_spoof.detectors.slips import repair_slips
from sdr_spoof.reproduce.study import Number, Picture, Section, Table, near
from sdr_spoof.scenario import Scenario
from sdr_spoof.scenario.live import LiveRecording
from sdr_spoof.signals import signal_spec
from sdr_spoof.tracking import track

from . import published
from .phase_jump_figure import draw_jump
from .receiver import BANDS, IF_RATE_HZ, PRN, seeds

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    Floats = NDArray[np.float64]

SEED = 20_180_002
CN0_DBHZ = 45.0
START_S, END_S = 3.0, 7.0
DRAG_HZ = 1.0
OFFSET_CYCLES = 0.2
"""Phase of the spoofer against the authentic signal when it comes on the air."""
SETTLE_S = 0.5
"""Of the joint loops, left out."""
SLIP_ROWS = 100
"""A cycle slip stands alone within so many epochs."""
JUMP_S = (0.05, 0.15)
"""After the start: the loops' transient is over, the drag has hardly begun."""


@dataclass(frozen=True)
class Difference:
    """The scaled phase difference of one recording, in the sense that grows with approach."""

    time_s: Floats
    cycles: Floats
    """About its mean before the attack."""


def scenario() -> Scenario:
    """One satellite; the spoofer of B1C comes at full power, with a phase offset and a drag."""
    wavelength_m = 299_792_458.0 / signal_spec("B1CP").carrier_hz
    power_db = float(20.0 * np.log10(published.ETA))
    return Scenario.model_validate(
        {
            "title": "Figure 2",
            "recording": {
                "duration_s": END_S,
                "sample_rate_hz": IF_RATE_HZ,
                "lo_hz": 1568.259e6,
                "sample_format": "ci8",
                "seed": SEED,
            },
            "satellite": [
                {
                    "prn": PRN,
                    "signals": list(BANDS),
                    "cn0_dbhz": CN0_DBHZ,
                    "range_rate_m_s": 317.0,
                    "delay_ms": 74.263,
                }
            ],
            "attack": [
                {
                    "prn": PRN,
                    "signals": ["B1CP"],
                    "start_s": START_S,
                    "power_start_db": power_db,
                    "power_db": power_db,
                    "power_ramp_s": 0.0,
                    "drag_start_s": START_S,
                    "drag_rate_m_s": -DRAG_HZ * wavelength_m,
                    "drag_ramp_s": 0.0,
                    "carrier_phase_cycles": OFFSET_CYCLES,
                }
            ],
        }
    )


def difference(threads: int) -> Difference:
    """Synthesise, track both bands together, take the carrier-scaled difference."""
    plan = scenario()
    log = track(LiveRecording(plan, threads), seeds(plan), threads=threads)
    (combo,) = log.combos
    found = scaled_difference(combo, SETTLE_S, partial(repair_slips, window_rows=SLIP_ROWS))
    used = np.isfinite(found.cycles)
    time_s, cycles = combo.time_s[used], -found.cycles[used]
    return Difference(time_s, cycles - cycles[time_s < START_S].mean())


def sum_phase(time_s: Floats) -> Floats:
    """Phase of the sum of both signals, from the start of the attack, in cycles."""
    beat = OFFSET_CYCLES + DRAG_HZ * (time_s - START_S)
    return np.asarray(np.unwrap(model.capture_phase_cycles(beat, published.ETA), period=1.0))


def section(effort: Effort, stages: Stages) -> Section:
    """The figure, with the jump and the slopes measured against both capture models."""
    with stages("Figure 2, from samples"):
        got = difference(effort.threads)
    after = got.time_s >= START_S
    png = draw_jump(got.time_s, got.cycles, START_S, sum_phase(got.time_s[after]), _published(got))
    rows = list(zip(got.time_s.tolist(), got.cycles.tolist(), strict=True))
    names = ("time (s)", "scaled difference (cycles at B1C)")
    return Section(
        "Jump and slope of the phase difference (Figure 2)",
        text=(
            f"From samples: both bands at {CN0_DBHZ:g} dB-Hz, a spoofer of B1C at eta "
            f"{published.ETA:g} comes on the air at {START_S:g} s with its phase "
            f"{OFFSET_CYCLES:g} cycle off and drags by {DRAG_HZ:g} Hz. The publication's axis says "
            '"300 ns", which is neither seconds nor samples; here it is seconds, and the '
            "difference is scaled by the carriers (phi_u - f_u / f_l phi_l).",
        ),
        tables=[
            _table(got),
            Table("figure2", "Scaled phase difference", names, rows, shown=False),
        ],
        pictures=[
            Picture(
                "figure2",
                "Phase difference under attack",
                png,
                "Figure 2 of the publication with axes of its own: the difference jumps to the "
                "phase of the sum of both signals and then turns with the drag and a beat.",
            )
        ],
        numbers=_numbers(got),
    )


def _published(got: Difference) -> Floats:
    """The small-angle line from the start of the attack, in cycles."""
    beat = OFFSET_CYCLES + DRAG_HZ * (got.time_s[got.time_s >= START_S] - START_S)
    return model.capture_phase_small_angle_cycles(beat, published.ETA)


def _measured(got: Difference) -> tuple[float, float]:
    """Mean phase right after the transient against that before, and slope over whole beats."""
    since = got.time_s - START_S
    jump = float(got.cycles[(since >= JUMP_S[0]) & (since < JUMP_S[1])].mean())
    late = got.time_s >= END_S - 2.0
    slope = float(np.polyfit(got.time_s[late], got.cycles[late], 1)[0])
    return jump, slope


def _expected(got: Difference) -> tuple[float, float]:
    """The same two of the phase of the sum."""
    model_phase = np.zeros(got.time_s.size)
    after = got.time_s >= START_S
    model_phase[after] = sum_phase(got.time_s[after])
    return _measured(Difference(got.time_s, model_phase))


def _table(got: Difference) -> Table:
    (jump, slope), (jump_sum, slope_sum) = _measured(got), _expected(got)
    small = float(model.capture_rate_small_angle_hz(1.0, published.ETA))
    jump_small = small * (OFFSET_CYCLES + DRAG_HZ * float(np.mean(JUMP_S)))
    rows: list[tuple[Cell, ...]] = [
        ("measured", jump, 360.0 * jump, slope),
        ("phase of the sum (beat model)", jump_sum, 360.0 * jump_sum, slope_sum),
        ("small angle, as published", jump_small, 360.0 * jump_small, small * DRAG_HZ),
    ]
    names = ("", "jump (cycles)", "jump (degrees)", "slope of the last 2 s (Hz)")
    note = f"The jump is the mean from {JUMP_S[0]:g} to {JUMP_S[1]:g} s after the start."
    return Table("figure2_numbers", "Jump and slope", names, rows, note)


def _numbers(got: Difference) -> list[Number]:
    (jump, slope), (jump_sum, slope_sum) = _measured(got), _expected(got)
    return [
        near("figure2_jump_cycles", "jump of the difference", jump, jump_sum, 0.03, "cycles"),
        near("figure2_slope_hz", "slope of the difference", slope, slope_sum, 0.03, "Hz"),
    ]
