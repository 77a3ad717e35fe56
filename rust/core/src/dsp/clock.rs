//! Code and carrier oscillators of a replica, in fixed point: exact however long they run.

use std::ops::RangeInclusive;

use super::band::LAST_SAMPLE;
use super::replica::SUBCHIPS;
use super::ring::LONGEST_STEP;
use crate::nco;
use crate::simd::runs::{FRACTION, UNIT};

/// A code position of one sample.
const ONE: f64 = (1u64 << FRACTION) as f64;
/// Samples per chip that can be correlated: a step of the runs of eight chips is the longest.
pub const SAMPLES_PER_CHIP: RangeInclusive<f64> = 0.25..=(LONGEST_STEP / UNIT) as f64;

/// Where a replica stands between two slices, and how fast it moves.
#[derive(Debug, Clone, Default)]
pub struct Clock {
    /// Whole sample and 2^-40 fraction of the slice's start.
    pub(crate) base: u64,
    pub(crate) fraction: u64,
    /// Samples per chip, 2^-40 units, a multiple of all sub-chips.
    pub(crate) chip_step: u64,
    /// Carrier beyond the band's nominal frequency at sample `base`: 2^-64 cycles, unwrapped.
    pub(crate) carrier: i128,
    pub(crate) carrier_step: i64,
}

impl Clock {
    /// A clock without rates; the first slice starts at `start` samples.
    ///
    /// # Panics
    /// If `start` is not within 0 and [`LAST_SAMPLE`].
    pub fn new(start: f64) -> Self {
        assert!(
            (0.0..=LAST_SAMPLE as f64).contains(&start),
            "a channel cannot start at sample {start}"
        );
        let base = start.floor();
        Clock {
            base: base as u64,
            fraction: ((start - base) * ONE) as u64,
            ..Clock::default()
        }
    }

    /// Sets the rates for the slices to come: carrier beyond the band's nominal frequency in
    /// cycles per sample (wrapping at half a cycle), and samples per chip.
    ///
    /// # Panics
    /// If the carrier is not finite, or for samples per chip out of [`SAMPLES_PER_CHIP`].
    pub fn set_rates(&mut self, carrier: f64, samples_per_chip: f64) {
        assert!(
            carrier.is_finite() && SAMPLES_PER_CHIP.contains(&samples_per_chip),
            "cannot correlate at {carrier} cycles per sample and {samples_per_chip} samples per chip"
        );
        self.carrier_step = nco::step_from_frequency(carrier) as i64;
        self.chip_step = (samples_per_chip * ONE / SUBCHIPS as f64).round() as u64 * SUBCHIPS;
    }

    /// Adds to the carrier phase (cycles).
    ///
    /// # Panics
    /// For more cycles than [`LAST_SAMPLE`].
    pub fn shift_carrier(&mut self, cycles: f64) {
        assert!(
            cycles.abs() <= LAST_SAMPLE as f64,
            "cannot turn a carrier by {cycles} cycles"
        );
        self.carrier += (cycles * nco::CYCLE) as i128;
    }

    /// Moves the replica by this many samples (positive = later).
    ///
    /// # Panics
    /// To a sample that is not within 0 and [`LAST_SAMPLE`].
    pub fn shift_code(&mut self, samples: f64) {
        let here = (i128::from(self.base) << FRACTION) | i128::from(self.fraction);
        let there = here.saturating_add((samples * ONE).round() as i128);
        assert!(
            !samples.is_nan() && (0..=i128::from(LAST_SAMPLE) << FRACTION).contains(&there),
            "cannot move a replica at sample {} by {samples}",
            self.base
        );
        let base = (there >> FRACTION) as u64;
        self.carrier += i128::from(self.carrier_step) * (i128::from(base) - i128::from(self.base));
        self.base = base;
        self.fraction = there as u64 & ((1 << FRACTION) - 1);
    }

    /// Moves on by a number of chips; gives the whole samples passed.
    pub fn pass(&mut self, chips: u64) -> u64 {
        let end = self.fraction + chips * self.chip_step;
        let whole = end >> FRACTION;
        self.base += whole;
        self.fraction = end & ((1 << FRACTION) - 1);
        self.carrier += i128::from(self.carrier_step) * i128::from(whole);
        whole
    }

    /// Start of the present slice in samples.
    pub fn start(&self) -> f64 {
        self.base as f64 + self.fraction()
    }

    /// Fraction of a sample between [`Clock::base`] and the present slice's start.
    pub fn fraction(&self) -> f64 {
        self.fraction as f64 / ONE
    }

    /// Samples per chip of the replica.
    pub fn samples_per_chip(&self) -> f64 {
        self.chip_step as f64 / ONE
    }

    /// Carrier phase beyond the band's nominal frequency at [`Clock::base`], cycles, unwrapped.
    pub fn carrier_cycles(&self) -> f64 {
        self.carrier as f64 / nco::CYCLE
    }

    /// The same at the very start of the present slice.
    pub fn carrier_at_start(&self) -> f64 {
        let (whole, rest) = ((self.carrier >> 64) as i64, self.carrier as u64);
        let frequency = nco::frequency_from_step(self.carrier_step as u64);
        whole as f64 + rest as f64 / nco::CYCLE + self.fraction() * frequency
    }

    /// Whole sample at or before the present slice's start.
    pub fn base(&self) -> u64 {
        self.base
    }
}
