"""Configuration of the rate-consistency detectors: table ``[rate]``."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class RateConfig(BaseModel):
    """What the phases may do innocently, what must be found, and how good the INS is."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    # Noise of the measurements.
    carrier_sigma_m: float = Field(
        0.005,
        gt=0.0,
        le=1.0,
        description="Noise of one carrier phase at 45 dB-Hz and more, multipath with it, in m; it "
        "grows with falling C/N0.",
    )
    code_sigma_m: float = Field(
        1.0, gt=0.0, description="Noise of one pseudorange at 45 dB-Hz and more, in m."
    )
    min_cn0_dbhz: float = Field(28.0, description="Satellites with less are left out, in dB-Hz.")
    max_gap_s: float = Field(
        2.0, gt=0.0, description="Longest distance of two epochs that is still one piece, in s."
    )

    # What is to be found.
    drag_m_s: float = Field(
        0.1, gt=0.0, description="Drag that must be found with detection_probability, in m/s."
    )
    detection_probability: float = Field(
        0.9, gt=0.5, lt=1.0, description="Smallest probability of detection; more samples if less."
    )
    false_alarm_probability: float = Field(
        1e-6, gt=0.0, lt=0.5, description="Of one epoch, in all directions together."
    )
    false_alarms_per_hour: float = Field(
        0.01, gt=0.0, description="Of rate_drag, in all directions together."
    )
    samples: Literal["fewest", "one"] = Field(
        "fewest",
        description="Epochs in a mean of rate_consistency: 'one', or the 'fewest' that find "
        "drag_m_s with detection_probability.",
    )
    most_samples: int = Field(
        60, ge=2, le=600, description="Most epochs that a mean is taken over; beyond, no judgement."
    )
    mean_s: float = Field(10.0, ge=1.0, description="Mean of the local test, in s.")
    baseline_s: float = Field(
        60.0, ge=5.0, description="Signal before it, through which a line is laid, in s."
    )
    onset_window_s: float = Field(
        20.0, ge=3.0, le=120.0, description="Drags that began so long ago are looked for, in s."
    )

    # The INS.
    grade: str = Field(
        "navigation",
        description="Quality of the IMU, by name: navigation, tactical, industrial, mems, n1, n2, "
        "ship-a, ship-b.",
    )
    bias_wander: float = Field(
        0.1,
        ge=0.0,
        description="How far biases walk away in 1000 s beyond what the grade says, in parts of "
        "themselves.",
    )
    align_velocity_m_s: float = Field(
        0.005, ge=0.0, description="Velocity error that alignment leaves, in m/s."
    )
    align_position_m: float = Field(
        3.0, ge=0.0, description="Position error that alignment leaves, in m."
    )
    align_level_deg: float = Field(
        0.002, ge=0.0, description="Error of roll and pitch after alignment, in degrees."
    )
    align_heading_deg: float = Field(
        0.05, ge=0.0, description="Error of heading after alignment, in degrees."
    )
