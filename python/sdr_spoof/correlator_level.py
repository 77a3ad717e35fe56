"""Tracking without samples: the receiver's own loops on correlator outputs that are made up.

A second of signal takes a fraction of a millisecond, so that thousands of runs of a scenario, or
days of signal, become affordable. The scenario is the one that :func:`sdr_spoof.synthesize` takes;
what it makes at IF level and what is made here have the same statistics (docs/design.md,
"Correlator level", says what is left out).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _core
from .acquisition import NOT_BY_DEFAULT
from .errors import ConfigError
from .isolation import isolation_marks
from .records import ComboTrack, SignalTrack, TrackLog
from .row_store import RowStore
from .scenario import transmissions
from .scenario.front_end import gain_control, gain_log, noise_knots
from .sources import RecordingFormat
from .tracking import TrackingConfig, breaks_of, core_settings, watched

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .isolation import Isolation
    from .monitor import Monitor
    from .scenario import RecordingPlan, Scenario, Transmission

_ROWS_S = 10.0
"""Rows are taken out of the core so often."""


def simulate(
    scenario: Scenario,
    config: TrackingConfig | None = None,
    *,
    isolations: Sequence[Isolation] = (),
    monitor: Monitor | None = None,
    gaps: Sequence[tuple[float, float]] = (),
    seed: int | None = None,
    threads: int = 1,
    rows_in: Path | None = None,
) -> TrackLog:
    """Track a scenario at correlator level, from its start to its end.

    Every signal of the scenario is tracked (of a composite signal, what the receiver searches for
    by default), from where a search at 0 s would have found it. Signals that are lost are found
    again at whole seconds, where the strongest of their emitters is; a search misses none that
    reaches ``cn0_min_dbhz``.

    Args:
        scenario: what is on the air, and the sample rate, band and filter that the receiver has.
        config: loop settings.
        isolations: signals that are not to be trusted, and when.
        monitor: asked at each whole second which signals are captured (``config.fallback``).
        gaps: where samples are missing, and how many: time in the recording and length, s.
        seed: of noise and all random choices; replaces ``scenario.recording.seed``.
        threads: worker threads; the result does not depend on it.
        rows_in: folder for a temporary file that holds the rows, as in :func:`sdr_spoof.track`.

    Returns:
        The tracks that :func:`sdr_spoof.track` would give of the scenario's recording.

    Raises:
        ConfigError: a setting is out of range.
        OutputError: the rows cannot be written to ``rows_in``.
    """
    if seed is not None:
        plan = scenario.recording.model_copy(update={"seed": seed})
        scenario = scenario.model_copy(update={"recording": plan})
    plan = scenario.recording
    simulator = core_simulator(scenario, config or TrackingConfig(), threads, gaps)
    rows = RowStore(rows_in)
    config, rate = config or TrackingConfig(), plan.sample_rate_hz
    step = max(1, round((_ROWS_S if monitor is None else 1.0) * rate))
    marks = isolation_marks(isolations, plan.sample_rate_hz)
    count = plan.sample_count - round(sum(missing_s for _, missing_s in gaps) * rate)
    ends = {*range(step, count, step), *(at for at, _ in marks), count}
    for end in sorted(end for end in ends if end <= count):
        simulator.advance(end)
        while marks and marks[0][0] <= end:
            marks.pop(0)[1](simulator)
        rows.append(SignalTrack, simulator.take_signals())
        rows.append(ComboTrack, simulator.take_combos())
        for isolation in watched(monitor, config, rows, rate, end) if end % step == 0 else ():
            isolation.begin(simulator)
    return TrackLog(
        recording=scenario.title or "simulated",
        sample_rate_hz=plan.sample_rate_hz,
        duration_s=simulator.position() / plan.sample_rate_hz,
        partial=False,
        signals=rows.tracks(SignalTrack),
        combos=rows.tracks(ComboTrack),
        breaks=breaks_of(simulator),
        gain=gain_log(scenario),
    )


def core_simulator(
    scenario: Scenario,
    config: TrackingConfig,
    threads: int,
    gaps: Sequence[tuple[float, float]] = (),
) -> _core.Simulator:
    """The core's part, which runs as far as it is told to and hands its rows out."""
    plan, on_air = scenario.recording, transmissions(scenario)
    emitters = [t.emitter for t in on_air]
    try:
        return _core.Simulator(
            plan.sample_rate_hz,
            plan.lo_hz,
            core_settings(config, _format(plan)),
            emitters,
            _targets(on_air),
            noise_power=plan.rms_lsb**2 * (2 if plan.is_complex else 1),
            seed=plan.seed,
            complex_samples=plan.is_complex,
            bandwidth_hz=plan.bandwidth_hz,
            centre_hz=plan.front_end_centre_hz,
            filter_taps=plan.filter_taps,
            reacquire=config.reacquire,
            threads=threads,
            gaps=sorted(gaps),
            noise_db=noise_knots(plan),
            gain=gain_control(plan, emitters),
        )
    except ValueError as error:
        raise ConfigError(str(error)) from error


def _format(plan: RecordingPlan) -> RecordingFormat:
    shared = {"sample_format", "sample_rate_hz", "lo_hz", "bandwidth_hz"}
    return RecordingFormat.model_validate(plan.model_dump(include=shared))


def _targets(on_air: list[Transmission]) -> list[tuple[str, int]]:
    """Signals and PRNs to track, each once."""
    names = ((t.signal, t.prn) for t in on_air if t.signal not in NOT_BY_DEFAULT)
    return list(dict.fromkeys(names))
