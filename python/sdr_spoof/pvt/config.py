"""Configuration of positioning."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class PvtConfig(BaseModel):
    """What is used for a position, how it is weighed and how it is checked."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    filter: Literal["least-squares", "ekf"] = Field(
        "least-squares",
        description="'least-squares' (each epoch by itself) or 'ekf' (Kalman filter of position, "
        "velocity and clock).",
    )
    signals: tuple[str, ...] = Field(
        (), description="Signals used, by registry name; empty: all that are observed."
    )
    subcarrier: bool = Field(
        False, description="Whether the subcarrier range of B1I and B1C is used too."
    )
    elevation_mask_deg: float = Field(
        5.0, ge=0.0, lt=90.0, description="Satellites below are left out, in degrees."
    )
    min_cn0_dbhz: float = Field(28.0, description="Signals with less C/N0 are left out, in dB-Hz.")
    weights: Literal["cn0-elevation", "cn0", "elevation", "equal"] = Field(
        "cn0-elevation", description="What the assumed noise of a pseudorange depends on."
    )
    code_sigma_m: float = Field(
        0.4,
        gt=0.0,
        description="Noise of a B1I pseudorange at 45 dB-Hz, in m; twice that for L1CA, half of it "
        "for B1C.",
    )
    subcarrier_sigma_m: float = Field(
        0.03, gt=0.0, description="Noise of a subcarrier range at 45 dB-Hz, in m."
    )
    zenith_sigma_m: float = Field(
        0.3,
        ge=0.0,
        description="Error left by the models of the atmosphere and by multipath at the zenith, in "
        "m; grows with the cosecant of elevation.",
    )
    doppler_sigma_m_s: float = Field(
        0.05, gt=0.0, description="Noise of a Doppler at 45 dB-Hz, in m/s."
    )
    ionosphere: Literal["auto", "klobuchar", "bdgim", "none"] = Field(
        "auto",
        description="Model of the ionosphere; 'auto': each system's own where it was received "
        "(BDGIM before Klobuchar), the other system's otherwise, none if there is none.",
    )
    troposphere: Literal["saastamoinen", "none"] = Field(
        "saastamoinen", description="Model of the troposphere."
    )
    inter_signal_bias: bool = Field(
        True,
        description="Whether a delay of B1C against B1I in the receiver is estimated, if both are "
        "used.",
    )
    smoothing_s: float = Field(
        0.0,
        ge=0.0,
        description="Time constant of the smoothing of code by carrier (Hatch), in s; 0: none.",
    )
    raim_false_alarm: float = Field(
        1e-4,
        gt=0.0,
        lt=0.5,
        description="Probability that noise alone makes an epoch's residuals suspect.",
    )
    raim_exclusions: int = Field(
        1, ge=0, le=10, description="Most satellites that RAIM leaves out of an epoch."
    )
    suspects: Literal["leave-out", "use"] = Field(
        "leave-out",
        description="Satellites under suspicion, from the first that is called spoofed on: "
        "'leave-out' (of every epoch that has a fix without them; other fixes are flagged) or "
        "'use' (such fixes are flagged).",
    )
    max_pdop: float = Field(50.0, gt=1.0, description="Geometries worse than this give no fix.")
    acceleration_m_s2: float = Field(
        1.0,
        gt=0.0,
        description="Filter: white acceleration on each axis, in (m/s^2)/sqrt(Hz).",
    )
    clock_m_s: float = Field(
        0.1, gt=0.0, description="Filter: white frequency noise of the clock, in (m/s)/sqrt(Hz)."
    )
    clock_drift_m_s2: float = Field(
        0.03, gt=0.0, description="Filter: random walk of the clock's drift, in (m/s^2)/sqrt(Hz)."
    )
    bias_m_s: float = Field(
        1e-3,
        ge=0.0,
        description="Filter: random walk between systems and signals, in (m/s)/sqrt(Hz).",
    )
    coast_s: float = Field(
        5.0,
        gt=0.0,
        description="Filter: longest time without enough agreeing satellites before it begins "
        "anew, in s.",
    )
    place_uncertainty_m: float = Field(
        100e3,
        gt=0.0,
        le=200e3,
        description="Snapshot: how far off the given place may be, in m.",
    )
    time_uncertainty_s: float = Field(
        60.0,
        gt=0.0,
        le=300.0,
        description="Snapshot: how far off the given time may be, in s.",
    )
