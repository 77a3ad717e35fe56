//! Until when the count of a synchronised signal's code periods is known to be right.

use super::watch::{Step, Watch};
use crate::dsp::replica::SLICE_S;
use crate::C64;

/// The count of code periods of a signal that goes on broke between two instants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Break {
    /// When it was right for the last time, seconds since the first sample.
    pub from_s: f64,
    /// When it was found to be wrong.
    pub until_s: f64,
}

/// The count of one signal, and the watch over it.
#[derive(Debug, Clone)]
pub struct PeriodCount {
    watch: Watch,
    /// Slices in a code period.
    period: usize,
    /// Code periods after which symbol or secondary code begins again.
    places: usize,
    /// Samples at which the last two looks found it right. The end of what the last one looked at
    /// may be wrong already.
    right: [u64; 2],
    wrong: bool,
}

impl PeriodCount {
    /// Of a signal with `symbol` code periods a symbol, none for a pilot.
    pub fn new(overlay: &[i8], symbol: Option<usize>, period_s: f64) -> Self {
        PeriodCount {
            watch: Watch::new(overlay, symbol, period_s),
            period: (period_s / SLICE_S).round() as usize,
            places: overlay.len().max(symbol.unwrap_or(1)),
            right: [0; 2],
            wrong: false,
        }
    }

    /// Begins with a count found at a sample.
    pub fn begin(&mut self, sample: u64) {
        self.watch.restart();
        (self.right, self.wrong) = ([sample; 2], false);
    }

    /// Takes the prompt of a slice, nothing wiped, which ends at a sample; `position` is the count
    /// of slices after it.
    pub fn pass(&mut self, prompt: C64, position: usize, end: u64) {
        self.watch.add_slice(prompt);
        if !position.is_multiple_of(self.period) {
            return;
        }
        let place = (position / self.period + self.places - 1) % self.places;
        match self.watch.end_period(place) {
            Step::Open => {}
            Step::In => self.right = [self.right[1], end],
            Step::Out => self.wrong = true,
        }
    }

    /// Whether it was found to be wrong.
    pub fn wrong(&self) -> bool {
        self.wrong
    }

    /// Until when it surely was right.
    pub fn right_until(&self) -> u64 {
        self.right[0]
    }
}
