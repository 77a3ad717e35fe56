"""What the IMU of a scenario reads, and the truth about it.

``imu`` beside a recording holds what the IMU is (``grade``, ``rate_hz``, ``lever_arm_m``,
``clock_offset_s``), its constant errors in SI units (``errors``), and at the times of the truth's
table, which are by the receiver's clock: Earth-fixed ``position_m`` and
``velocity_m_s`` of the IMU, ``attitude_deg`` (yaw, pitch, roll), ``gyro_bias_rad_s`` and
``accelerometer_bias_m_s2`` (constant and wandering parts together). ``start`` is its state at the
first increment's beginning, to start a navigation from; its ``time_s`` is GNSS time since the
sky's start.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.aiding.imu import errors, simulate
from sdr_spoof.aiding.imu.readers import table as table_reader
from sdr_spoof.errors import ConfigError

from .sky.clock import FIRST_S, STEP_S
from .sky.trajectory import Trajectory

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.imu.errors import ImuErrors, Readings
    from sdr_spoof.aiding.records import ImuLog

    from .imu_table import ImuTable
    from .model import Scenario
    from .sky import Sky

_RESTS_M_S = 1e-3


@dataclass(frozen=True)
class ScenarioImu:
    """An IMU at work."""

    table: ImuTable
    sky: Sky
    errors: ImuErrors
    readings: Readings
    """Times by GNSS time since the sky's start."""

    @property
    def log(self) -> ImuLog:
        """What it says, with the times of its own clock."""
        log = self.readings.log
        return replace(log, time_s=log.time_s + self.table.clock_offset_s)

    def csv(self) -> str:
        """Its file."""
        return table_reader.text(self.log, self.sky.trajectory.lever_arm_m)

    def truth(self, time_s: NDArray[np.float64]) -> dict[str, Any]:
        """JSON-ready.

        Args:
            time_s: Times of the truth's table, multiples of 0.1 s.
        """
        at = np.round((time_s - FIRST_S) / STEP_S).astype(np.int64)
        system_s = self.sky.system_s[at]
        log = self.readings.log
        row = np.searchsorted(log.time_s, system_s).clip(0, log.time_s.size - 1)
        begin_s = log.time_s[:1] - log.interval_s
        first = {name: values[0] for name, values in self._states(begin_s).items()}
        return {
            "definitions": __doc__,
            "grade": self.table.grade,
            "rate_hz": self.table.rate_hz,
            "lever_arm_m": list(self.sky.trajectory.lever_arm_m),
            "clock_offset_s": self.table.clock_offset_s,
            "errors": _finite(asdict(self.errors)),
            "start": {"time_s": float(begin_s[0])} | first,
            **self._states(system_s),
            "gyro_bias_rad_s": self.readings.gyro_bias_rad_s[row].tolist(),
            "accelerometer_bias_m_s2": self.readings.accelerometer_bias_m_s2[row].tolist(),
        }

    def _states(self, system_s: NDArray[np.float64]) -> dict[str, list[Any]]:
        states = simulate.true_states(self.sky.trajectory, np.maximum(system_s, 0.0))
        return {
            "position_m": np.round(states.position_m, 5).tolist(),
            "velocity_m_s": np.round(states.velocity_m_s, 7).tolist(),
            "attitude_deg": np.round(np.degrees(states.attitude_rad), 8).tolist(),
        }


def imu_of(scenario: Scenario, *, duration_s: float | None = None) -> ScenarioImu | None:
    """The IMU of a scenario, where it has one.

    Args:
        scenario: What happens.
        duration_s: Of the recording, if it is shorter than planned.

    Raises:
        ConfigError: the trajectory's attitude jumps, or it does not stand still where it has to.
    """
    sky = scenario.sky_model()
    if scenario.imu is None or sky is None:
        return None
    length_s = scenario.recording.duration_s if duration_s is None else duration_s
    ideal = _ideal(scenario.imu, sky, length_s)
    own = scenario.imu.errors(scenario.recording.seed)
    return ScenarioImu(scenario.imu, sky, own, errors.read(ideal, own))


def _ideal(table: ImuTable, sky: Sky, length_s: float) -> ImuLog:
    """Of a perfect IMU, from its beginning on."""
    moving = simulate.ideal_increments(
        sky.trajectory,
        length_s - table.start_s,
        table.rate_hz,
        start_s=table.start_s,
        reference=sky.start,
    )
    if not table.still_s:
        return moving
    still = simulate.ideal_increments(
        _standing(sky.trajectory), table.still_s, table.rate_hz, start_s=-table.still_s
    )
    parts = (still, moving)
    return replace(
        moving,
        time_s=np.concatenate([p.time_s for p in parts]),
        rotation_rad=np.concatenate([p.rotation_rad for p in parts]),
        velocity_m_s=np.concatenate([p.velocity_m_s for p in parts]),
    )


def _standing(trajectory: Trajectory) -> Trajectory:
    """A body that stays where, and turned as, another is at 0 s."""
    zero = np.zeros(1)
    speed = float(np.linalg.norm(trajectory.body_velocity_m_s(zero)))
    if speed > _RESTS_M_S:
        raise ConfigError(
            f"[imu] still_s: the receiver moves at {speed:.2g} m/s at 0 s; let it stand there, or "
            "leave still_s out"
        )
    place, looks = trajectory.body(zero), trajectory.attitude_rad(zero)
    return Trajectory(
        lambda time_s: np.broadcast_to(place, (time_s.size, 3)),
        lambda time_s: np.broadcast_to(looks, (time_s.size, 3)),
    )


def _finite(values: Any) -> Any:
    """Without infinities, which JSON does not know."""
    if isinstance(values, dict):
        return {k: _finite(v) for k, v in values.items()}
    if isinstance(values, float) and not np.isfinite(values):
        return None
    return values
