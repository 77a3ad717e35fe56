//! Where tracking starts, what one integration gives, and what is measured in it.

use crate::dsp::replica::SLICE_S;
use crate::C64;

/// Where a signal was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seed {
    /// Sample at which the values hold.
    pub sample: u64,
    /// Carrier Doppler.
    pub doppler_hz: f64,
    /// From that sample to the first following start of a code period.
    pub code_delay_s: f64,
}

/// A coherent integration, secondary code wiped where it is known.
#[derive(Debug, Clone)]
pub struct Epoch {
    /// Sum per tap.
    pub taps: Vec<C64>,
    /// Prompt of the companion signal; 0 without one.
    pub companion: C64,
    /// Coherent time in slices.
    pub slices: usize,
    /// First sample and number of samples.
    pub first: u64,
    /// Number of samples.
    pub samples: u64,
    /// Replica's carrier phase at the middle, cycles beyond the nominal carrier.
    pub carrier_cycles: f64,
    /// Replica's code phase at the middle, chips since the channel's start.
    pub code_chips: f64,
}

impl Epoch {
    /// Coherent time.
    pub fn interval_s(&self) -> f64 {
        self.slices as f64 * SLICE_S
    }

    /// Middle of the integration in samples.
    pub fn middle(&self) -> f64 {
        self.first as f64 + 0.5 * (self.samples as f64 - 1.0)
    }

    /// One past the last sample.
    pub fn end(&self) -> u64 {
        self.first + self.samples
    }
}

/// What the discriminators say of an epoch.
#[derive(Debug, Clone, Copy)]
pub struct Measured {
    /// Received minus replica carrier phase, cycles.
    pub phase_error: f64,
    /// Received minus replica code phase, chips.
    pub code_error_chips: f64,
    /// Measured carrier phase, cycles beyond the nominal carrier; grows as range grows.
    pub phase_cycles: f64,
    /// Measured code phase, chips since the channel's start.
    pub code_chips: f64,
}
