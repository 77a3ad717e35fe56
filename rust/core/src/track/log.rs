//! What tracking records: one row per integration, column by column.

use num_complex::Complex;

/// State of a sideband; the numbers are those of the log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum State {
    /// Not tracked.
    Lost = 0,
    /// 1 ms integrations: frequency from blocks of prompts, then the phase loop.
    PullIn = 1,
    /// Phase and code locked, symbol edges or secondary code not yet known.
    Tracking = 2,
    /// Symbol edges or secondary code known, long integrations.
    Synced = 3,
    /// Tracked jointly with the satellite's other sideband.
    Combo = 4,
    /// As [`State::Synced`], but marked as captured: never tracked jointly. In the rows of a pair:
    /// one of the two is.
    Captured = 5,
}

/// Rows of one signal. Times and phases are at the middle of the integration.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct SignalRows {
    /// Seconds since the first sample of the recording.
    pub time_s: Vec<f64>,
    /// Coherent integration.
    pub integration_s: Vec<f64>,
    /// [`State`] as a number.
    pub state: Vec<u8>,
    /// Measured carrier phase, growing with range.
    pub carrier_phase_cycles: Vec<f64>,
    /// Carrier oscillator beyond the nominal carrier.
    pub doppler_hz: Vec<f64>,
    /// Measured received code phase since the channel's start.
    pub code_phase_chips: Vec<f64>,
    /// Carrier discriminator.
    pub phase_error_cycles: Vec<f64>,
    /// Code discriminator.
    pub code_error_chips: Vec<f64>,
    /// C/N0 estimate.
    pub cn0_dbhz: Vec<f64>,
    /// Phase-lock indicator.
    pub phase_lock: Vec<f64>,
    /// Noise power per sample as the noise tap sees it, input units squared.
    pub noise_power: Vec<f64>,
    /// Correlator outputs, row after row.
    pub taps: Vec<Complex<f32>>,
    /// Prompt of the data component beside its pilot; 0 where it is not received.
    pub data_prompt: Vec<Complex<f32>>,
}

impl SignalRows {
    /// Hands out what was recorded since the last call.
    pub fn take(&mut self) -> Self {
        std::mem::take(self)
    }
}

/// Rows of a satellite's pair of sidebands.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct ComboRows {
    /// Seconds since the first sample of the recording (upper sideband's).
    pub time_s: Vec<f64>,
    /// Coherent integration.
    pub integration_s: Vec<f64>,
    /// [`State`] as a number.
    pub state: Vec<u8>,
    /// Measured carrier phase of the lower sideband, brought to the upper one's instant.
    pub phase_lower_cycles: Vec<f64>,
    /// Measured carrier phase of the upper sideband.
    pub phase_upper_cycles: Vec<f64>,
    /// C/N0 of the lower sideband.
    pub cn0_lower_dbhz: Vec<f64>,
    /// C/N0 of the upper sideband.
    pub cn0_upper_dbhz: Vec<f64>,
    /// Half the sum of the sidebands' phases.
    pub main_phase_cycles: Vec<f64>,
    /// Half the difference of the sidebands' phases, upper minus lower.
    pub subcarrier_phase_cycles: Vec<f64>,
    /// Pseudorange from the subcarrier's phase; NaN while its ambiguity is not resolved, and where
    /// both carriers are the same.
    pub subcarrier_range_m: Vec<f64>,
    /// Measured code delay of the lower sideband, brought to the upper one's instant.
    pub code_delay_lower_s: Vec<f64>,
    /// Measured code delay of the upper sideband.
    pub code_delay_upper_s: Vec<f64>,
    /// Code delay, upper minus lower.
    pub code_difference_s: Vec<f64>,
    /// Subcarrier-lock indicator.
    pub subcarrier_lock: Vec<f64>,
}

impl ComboRows {
    /// Hands out what was recorded since the last call.
    pub fn take(&mut self) -> Self {
        std::mem::take(self)
    }
}
