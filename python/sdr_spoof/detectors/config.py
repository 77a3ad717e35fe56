"""Configuration of the detection stage."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field


class DetectionConfig(BaseModel):
    """What is tested, how often noise may raise an alarm, and what counts as support."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    detectors: tuple[str, ...] = Field(
        (
            "phase_difference_rate",
            "phase_difference_glr",
            "code_difference",
            "code_minus_carrier",
            "delta_metric",
            "delta_metric_variance",
            "ratio_metric",
            "ratio_metric_variance",
            "power",
            "power_difference",
            "second_peak",
        ),
        min_length=1,
        description="Detectors to run, by registry name.",
    )
    rule: str = Field("threshold", description="Decision rule, by registry name.")
    rule_shift_sigmas: float = Field(
        1.5,
        gt=0.0,
        le=20.0,
        description="Shift for which the rule 'cusum' is fastest, in standard deviations of one "
        "independent sample.",
    )
    rule_training_s: float = Field(
        100.0,
        gt=0.0,
        description="First part of each series, taken to be clean, that the rule "
        "'trained-threshold' learns from and does not judge, in s.",
    )
    rule_training_mean: Literal["trained", "zero"] = Field(
        "trained",
        description="Whether that rule learns the mean with the deviation, or it is known to be "
        "zero.",
    )
    false_alarm_probability: float = Field(
        1e-6,
        gt=0.0,
        lt=0.5,
        description="Probability that noise alone crosses the two-sided threshold in one test of "
        "the detectors that state one (phase_difference_rate).",
    )
    threshold_model: Literal["published", "thermal"] = Field(
        "published",
        description="Law that sets the threshold: 'published' (loop jitter of the combo-signal "
        "paper, conservative) or 'thermal' (noise of this receiver's own statistic, sharper).",
    )
    window_s: float = Field(
        1.0, ge=0.1, le=60.0, description="Window of the phase-difference slope, in s."
    )
    published_integration_s: float = Field(
        0.1, gt=0.0, description="Coherent integration time in the published law, in s."
    )
    published_loop_bandwidth_hz: float = Field(
        1.0, gt=0.0, description="Loop noise bandwidth in the published law, in Hz."
    )
    published_fll_factor: Literal[1, 2] = Field(
        1, description="Factor F of the published law: 1 at high C/N0, 2 near threshold."
    )
    min_cn0_dbhz: float = Field(
        28.0,
        description="Windows in which either band has less C/N0 are not tested, in dB-Hz.",
    )
    settle_s: float = Field(
        0.5, ge=0.0, description="Left out after each (re)lock while the loops settle, in s."
    )
    min_tested_s: float = Field(
        2.0,
        ge=0.0,
        description="Tested time below which a quiet satellite is called "
        "'not enough support' instead of 'clean', in s.",
    )
    onset_lookback_s: float = Field(
        5.0, gt=0.0, description="How far before the alarm the onset is searched, in s."
    )
    attribution_fit_s: float = Field(
        2.0,
        gt=0.1,
        description="Signal before the onset from which each band's carrier is extrapolated, in s.",
    )
    false_alarms_per_hour: float = Field(
        1e-3,
        gt=0.0,
        le=1000.0,
        description="Rate of false alarms from noise, per hour and satellite, of all detectors "
        "together that state a rate (all but phase_difference_rate).",
    )
    phase_difference_glr_windows_s: tuple[Annotated[float, Field(gt=0.0, le=60.0)], ...] = Field(
        (0.1, 0.2, 0.5, 1.0, 2.0, 4.0),
        min_length=1,
        description="Windows of the jump and slope of the phase difference, in s.",
    )
    phase_difference_glr_reference_s: float = Field(
        10.0,
        ge=2.0,
        le=600.0,
        description="Signal before a window from which level and noise are measured, in s.",
    )
    phase_difference_glr_drift_hz: float = Field(
        5e-5,
        ge=0.0,
        description="Innocent drift of the phase difference (ionosphere, inter-band bias), in Hz.",
    )
    code_wander_m: float = Field(
        3.0,
        ge=0.0,
        description="Width of the band within which multipath may move a code delay innocently, "
        "in m.",
    )
    code_difference_windows_s: tuple[Annotated[float, Field(gt=0.0, le=300.0)], ...] = Field(
        (1.0, 2.0, 5.0, 10.0, 20.0),
        min_length=1,
        description="Windows of the jump and slope of the code-delay difference, in s.",
    )
    code_difference_reference_s: float = Field(
        30.0,
        ge=5.0,
        le=600.0,
        description="Signal before a window from which level and noise are measured, in s.",
    )
    code_difference_drift_m_s: float = Field(
        0.005,
        ge=0.0,
        description="Innocent drift of the code-delay difference (inter-band bias), in m/s.",
    )
    code_minus_carrier_windows_s: tuple[Annotated[float, Field(gt=0.0, le=300.0)], ...] = Field(
        (2.0, 5.0, 10.0, 20.0),
        min_length=1,
        description="Windows of the jump and slope of code minus carrier, in s.",
    )
    code_minus_carrier_reference_s: float = Field(
        30.0,
        ge=5.0,
        le=600.0,
        description="Signal before a window from which level and noise are measured, in s.",
    )
    code_minus_carrier_drift_m_s: float = Field(
        0.01,
        ge=0.0,
        description="Innocent drift of code minus carrier (twice the ionosphere's), in m/s.",
    )

    # Fusion.
    fusion_together_s: float = Field(
        10.0,
        gt=0.0,
        description="Alarms of one satellite whose onsets are at most this far apart count as one "
        "event when its band is sought, in s.",
    )
    attribution_confidence: float = Field(
        0.95,
        gt=0.5,
        lt=1.0,
        description="A band is named from this probability on that it is the captured one.",
    )
    monitor_lookback_s: float = Field(
        16.0,
        ge=5.0,
        description="Signal that is looked at each second while tracking, in s; by the tests of "
        "code each fourth second, and four times as much.",
    )
    # Signal quality: delta_metric, ratio_metric and their variances.
    quality_window_s: float = Field(
        1.0, ge=0.1, le=60.0, description="Window of the signal-quality metrics, in s."
    )
    quality_settle_s: float = Field(
        2.0, ge=0.0, description="Left out after each (re)lock while the code loop settles, in s."
    )
    quality_reference_s: float = Field(
        10.0,
        ge=0.5,
        description="Signal before the window that their mean and scatter are compared with, in s.",
    )
    # Power.
    power_window_s: float = Field(
        1.0, ge=0.1, le=60.0, description="Window of the power averages, in s."
    )
    power_reference_s: float = Field(
        20.0,
        ge=0.5,
        description="Signal before the window whose largest average a rise is measured from, in s.",
    )
    power_wander_db: float = Field(
        0.5,
        ge=0.0,
        description="Standard deviation of innocent changes of power (multipath, attitude), in dB.",
    )
    power_difference_windows_s: tuple[Annotated[float, Field(gt=0.0, le=60.0)], ...] = Field(
        (0.6, 1.0, 2.0, 4.0),
        min_length=1,
        description="Windows of the jump and slope of the power of one band over the other, in s.",
    )
    power_difference_reference_s: float = Field(
        10.0,
        ge=5.0,
        le=600.0,
        description="Signal before a window from which level and noise are measured, in s.",
    )
    power_difference_drift_db_s: float = Field(
        0.005,
        ge=0.0,
        description="Innocent drift of the power of one band over the other, in dB/s.",
    )
    power_difference_wander_db: float = Field(
        1.0,
        ge=0.0,
        description="Width of the band within which multipath may innocently move the power of "
        "one band over the other, in dB.",
    )
    power_floor_window_s: float = Field(
        5.0,
        ge=0.5,
        le=60.0,
        description="Window of the noise floor of a band, the mean of all its satellites, in s.",
    )
    power_floor_wander_db: float = Field(
        0.05,
        ge=0.0,
        description="Standard deviation of innocent changes of the noise floor of a band "
        "(temperature, antenna), in dB.",
    )
    power_noise_floor: float | None = Field(
        None,
        gt=0.0,
        description="Calibrated noise power per sample of the band, in squared units of the "
        "samples; left out, the noise is compared with itself.",
    )
