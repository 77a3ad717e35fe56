"""Settings of the tightly coupled filter: table ``[tight]``."""

from __future__ import annotations

import math
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

DEG = math.radians(1.0)
DEG_HOUR = DEG / 3600.0
DEG_ROOT_HOUR = DEG / 60.0
MICRO_G = 9.80665e-6


class TightConfig(BaseModel):
    """What the filter believes of its sensors, how it tests them and what it then does."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    states: Literal[17, 11] = Field(
        17,
        description="17: with the biases of gyros and accelerometers; 11: as published, without.",
    )
    exclusion: Literal["robust", "printed", "off"] = Field(
        "robust",
        description="'robust': trusted copies, exclusion, re-admission; 'printed': whatever has "
        "R > 1 is left out of the epoch, as published; 'off': all satellites are used.",
    )
    gyro_bias_deg_h: float = Field(
        0.1, ge=0.0, description="Bias of the gyros at the start, standard deviation, in deg/h."
    )
    gyro_walk_deg_sqrt_h: float = Field(
        0.01, ge=0.0, description="Angle random walk of the gyros, in deg/sqrt(h)."
    )
    gyro_bias_drift_deg_h_sqrt_h: float = Field(
        0.0, ge=0.0, description="Random walk of the gyros' biases, in deg/h/sqrt(h)."
    )
    accelerometer_bias_ug: float = Field(
        50.0, ge=0.0, description="Bias of the accelerometers at the start, in ug."
    )
    accelerometer_walk_ug_sqrt_hz: float = Field(
        10.0, ge=0.0, description="Velocity random walk of the accelerometers, in ug/sqrt(Hz)."
    )
    accelerometer_bias_drift_ug_sqrt_h: float = Field(
        0.0, ge=0.0, description="Random walk of the accelerometers' biases, in ug/sqrt(h)."
    )
    start_position_m: float = Field(3.0, gt=0.0, description="Of the start, each axis, in m.")
    start_velocity_m_s: float = Field(0.1, gt=0.0, description="Of the start, each axis, in m/s.")
    start_level_deg: float = Field(0.02, gt=0.0, description="Of roll and pitch, in degrees.")
    start_heading_deg: float = Field(0.2, gt=0.0, description="Of heading, in degrees.")
    code_noise_m: float = Field(
        1.0, gt=0.0, description="White noise of a pseudorange at each epoch, in m."
    )
    code_wander_m: float = Field(
        1.5,
        ge=0.0,
        description="Coloured error of a pseudorange (multipath, ionosphere), a state of each "
        "satellite, in m; 0: none is modelled.",
    )
    code_wander_s: float = Field(200.0, gt=0.0, description="Its correlation time, in s.")
    rate_noise_m_s: float = Field(0.05, gt=0.0, description="Noise of a range rate, in m/s.")
    carrier_noise_m: float = Field(
        0.0,
        ge=0.0,
        description="Noise of carrier phase, in m (about 0.003); its changes from epoch to epoch "
        "are used if it is not 0.",
    )
    reference_cn0_dbhz: float = Field(
        35.0, ge=0.0, description="Below this C/N0 the variances grow with its loss, in dB-Hz."
    )
    clock_m2_s: float = Field(0.01, ge=0.0, description="Random walk of the clock, in m^2/s.")
    clock_drift_m2_s3: float = Field(
        0.04,
        ge=0.0,
        description="Random walk of its drift, in (m/s)^2/s: 0.04 for an ordinary TCXO (2 pi^2 "
        "h-2 c^2 of h-2 = 2e-20), 0.0004 for a good one.",
    )
    robust_sigma: float = Field(
        4.0,
        ge=0.0,
        description="Innovations beyond so many standard deviations weigh less; 0: all alike.",
    )
    settle_s: float = Field(60.0, ge=0.0, description="No test before so long after the start.")
    threshold_rate: float = Field(
        4.8, gt=0.0, description="Of sums of rate innovations, as a normal deviate."
    )
    threshold_change: float = Field(
        4.8, gt=0.0, description="Of sums of innovations of carrier phase."
    )
    threshold_code: float = Field(4.8, gt=0.0, description="Of sums of code innovations.")
    threshold_separation: float = Field(
        4.1, gt=0.0, description="Of the separation from trusted copies."
    )
    threshold_clock: float = Field(
        4.7, gt=0.0, description="Of the separation of the clock from trusted copies."
    )
    threshold_power_db: float = Field(
        5.0, gt=0.0, description="Rise of C/N0 of three satellites that counts as an attack."
    )
    separation_slack: float = Field(
        0.05,
        ge=0.0,
        description="Part of the filter's own covariance that a separation may have besides.",
    )
    most_excluded: int = Field(
        3, ge=0, le=4, description="Largest set of satellites that is left out by name."
    )
    heed_receiver: bool = Field(
        True, description="Leave out what the receiver's own detectors call spoofed."
    )
    dwell_s: float = Field(
        40.0, gt=0.0, description="All agree so long after an alarm: it was a false one."
    )
    pardon_s: float = Field(
        600.0, gt=0.0, description="So long after an alarm it may turn out to be a false one."
    )
    dwell_after_step_s: float = Field(
        20.0, gt=0.0, description="All agree so long after they stepped back: they are used again."
    )
    dwell_satellite_s: float = Field(
        20.0, gt=0.0, description="An excluded satellite agrees so long: it is used again."
    )
    outages_s: tuple[tuple[float, float], ...] = Field(
        (), description="Times (beginning, end) without GNSS on purpose, in the log's time."
    )
    bridge_s: float = Field(
        0.5, ge=0.0, description="Longer gaps of the IMU make the motion four times as uncertain."
    )
    one_wrong: bool = Field(
        False,
        description="Run a filter without each satellite beside the whole one: protection levels "
        "that hold whichever one satellite is wrong and not yet found out.",
    )
    smooth: bool = Field(
        False,
        description="Estimate every epoch from what was measured after it as well, once the run is "
        "over; takes about 40 MB an hour of 1 Hz epochs with ten satellites.",
    )
    statistic_length: int = Field(
        10, ge=2, le=1000, description="Epochs of the published R statistics."
    )
    statistic_form: Literal["mean-square", "lag-1", "coherent"] = Field(
        "mean-square", description="Reading of the published R statistics that the verdict asks."
    )
    divisors: tuple[float, float, float, float] = Field(
        (49.0, 0.02, 64.0, 0.04),
        description="What R of position, velocity, pseudorange and rate are divided by, in m^2 and "
        "(m/s)^2: the largest without interference, over a fixed length.",
    )

    def core(self) -> dict[str, Any]:
        """As the core takes them, in SI units."""
        biases = self.states == 17
        hour = math.sqrt(3600.0)
        return {
            "imu": [
                self.gyro_walk_deg_sqrt_h * DEG_ROOT_HOUR,
                self.accelerometer_walk_ug_sqrt_hz * MICRO_G,
                biases * self.gyro_bias_drift_deg_h_sqrt_h * DEG_HOUR / hour,
                biases * self.accelerometer_bias_drift_ug_sqrt_h * MICRO_G / hour,
            ],
            "receiver": [
                self.code_noise_m,
                self.code_wander_m,
                self.code_wander_s,
                self.rate_noise_m_s,
                self.carrier_noise_m,
                self.reference_cn0_dbhz,
                self.clock_m2_s,
                self.clock_drift_m2_s3,
            ],
            "start": [
                self.start_position_m,
                self.start_velocity_m_s,
                self.start_level_deg * DEG,
                self.start_heading_deg * DEG,
                biases * self.gyro_bias_deg_h * DEG_HOUR,
                biases * self.accelerometer_bias_ug * MICRO_G,
                30.0,
                10.0,
            ],
            "length": self.statistic_length,
            "form": self.statistic_form,
            "divisors": list(self.divisors),
            "exclusion": self.exclusion,
            "thresholds": [
                self.threshold_rate,
                self.threshold_change,
                self.threshold_code,
                self.threshold_separation,
                self.threshold_clock,
            ],
            "power_rise_db": self.threshold_power_db,
            "robust": self.robust_sigma,
            "slack": self.separation_slack,
            "most_excluded": self.most_excluded,
            "heed_receiver": self.heed_receiver,
            "outages": list(self.outages_s),
            "bridge_s": self.bridge_s,
            "smooth": self.smooth,
            "subsets": self.one_wrong,
            "settle_s": self.settle_s,
            "pardon_s": self.pardon_s,
            "dwell_s": self.dwell_s,
            "dwell_after_step_s": self.dwell_after_step_s,
            "dwell_satellite_s": self.dwell_satellite_s,
        }


def as_published(states: Literal[17, 11] = 11, **other: Any) -> TightConfig:
    """White noise of 3 m and 0.07 m/s, no robust weights, exclusion where R > 1.

    With 11 states process noise has to stand for the biases: random walks of 150 ug/sqrt(Hz) and
    0.04 deg/sqrt(h) are for biases of 50 ug and 0.1 deg/h.
    """
    published: dict[str, Any] = {
        "states": states,
        "exclusion": "printed",
        "code_noise_m": 3.0,
        "code_wander_m": 0.0,
        "rate_noise_m_s": 0.07,
        "robust_sigma": 0.0,
        "reference_cn0_dbhz": 0.0,
        "clock_drift_m2_s3": 0.0004,
    }
    if states == 11:
        published |= {"accelerometer_walk_ug_sqrt_hz": 150.0, "gyro_walk_deg_sqrt_h": 0.04}
    return TightConfig(**(published | other))
