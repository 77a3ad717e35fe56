//! The tracking loops on correlator outputs that are made up, without samples: the fast way to
//! many hours of signal.
//!
//! For each slice of 1 ms and each emitter of the satellite's signal: amplitude times the code's
//! correlation at every tap's delay, times the carrier's phase error, its loss over the slice and
//! the sign of secondary code and data; and noise, correlated between taps. The loops are those
//! of [`crate::track`] and see no difference ([`crate::track::source`]).
//!
//! Other signals than the satellite's own count as noise, by their spectra (`others`). Left out: the sampling of the
//! code, the quantiser, the carrier's turn between a tap and the prompt, and the correlation of a
//! tap's noise with that of another tap in the next slice.

mod emission;
mod front_end;
mod lags;
mod noise;
mod others;
mod pulse;
mod separation;
mod simulated;
mod simulator;

use front_end::FrontEnd;
pub(crate) use simulated::Simulated;
pub use simulator::Simulator;

use crate::synth::{Drive, Filter};

/// What is simulated, apart from who transmits.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Samples per second, which place the taps.
    pub sample_rate_hz: f64,
    /// Radio frequency that becomes frequency 0; only the filter knows it.
    pub lo_hz: f64,
    /// Front-end filter, if any.
    pub filter: Option<Filter>,
    /// Noise power of a sample behind the filter (I and Q together), which sets the unit of all
    /// outputs.
    pub noise_power: f64,
    /// Seed of noise and search errors.
    pub seed: u64,
    /// Where samples are missing from the recording.
    pub gaps: Vec<Gap>,
    /// Level of the noise, and gain; saturation is left out.
    pub drive: Drive,
}

/// Samples that a recording lacks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Time since the first sample that is there, by those that are there.
    pub at_s: f64,
    /// How much is missing.
    pub missing_s: f64,
}

/// What is missing up to a time of the recording, s.
fn missing_s(gaps: &[Gap], time_s: f64) -> f64 {
    let before = gaps.iter().take_while(|g| g.at_s <= time_s);
    before.map(|g| g.missing_s).sum()
}
