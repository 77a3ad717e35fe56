//! Correlator taps: very early, early, prompt, late, very late, and one far off for noise.

use super::discriminator::{autocorrelation, early_late_slope};
use crate::dsp::ring::LANES;
use crate::signal::Modulation;

/// The taps of a sideband, in whole samples.
#[derive(Debug, Clone)]
pub struct Taps {
    /// Replica delay of each tap, samples; positive = late.
    pub offsets: Vec<i64>,
    /// Index of the noise tap; the others come in order of delay around [`Taps::prompt`].
    pub noise: usize,
    /// Index of the prompt tap.
    pub prompt: usize,
    /// Slope of early minus late per chip.
    pub slope: f64,
    /// Variance of the code discriminator, chips squared, times signal-to-noise ratio.
    pub code_variance: f64,
}

impl Taps {
    /// Taps for a modulation at a sampling density; `code` chooses where noise is measured.
    pub fn new(modulation: Modulation, code: &[i8], samples_per_chip: f64) -> Self {
        // Half the early-late spacing in chips: on the straight flank of the main peak; and where
        // the outer taps look for another peak.
        let (half, outer) = match modulation {
            Modulation::Bpsk => (0.25, 0.4),
            Modulation::Boc11 => (0.1, 0.5),
            // BOC(6,1) bends the flank at 1/12 chip.
            Modulation::Qmboc => (0.06, 0.5),
        };
        let near = on_raster(half * samples_per_chip).max(1);
        let far = on_raster(outer * samples_per_chip).max(near + 1);
        let noise = -(quiet_lag(code) * samples_per_chip).round() as i64;
        let half = near as f64 / samples_per_chip;
        let slope = early_late_slope(modulation, half);
        Taps {
            offsets: vec![-far, -near, 0, near, far, noise],
            noise: 5,
            prompt: 2,
            slope,
            code_variance: (1.0 - autocorrelation(modulation, 2.0 * half)) / (slope * slope),
        }
    }

    /// Which taps are off the main peak.
    pub fn outer(&self) -> Vec<bool> {
        (0..self.offsets.len())
            .map(|tap| tap.abs_diff(self.prompt) > 1)
            .collect()
    }

    /// Largest distance of a tap from the prompt, samples.
    pub fn reach(&self) -> i64 {
        self.offsets.iter().map(|o| o.abs()).max().unwrap_or(0)
    }
}

/// A distance in whole samples: a multiple of [`LANES`], which correlates faster, where one is near
/// enough.
fn on_raster(samples: f64) -> i64 {
    let lanes = LANES as f64;
    let raster = (samples / lanes).round() * lanes;
    if (raster - samples).abs() <= 0.35 * samples {
        raster as i64
    } else {
        samples.round() as i64
    }
}

/// A lag of a few chips, half-way between two whole ones, where the code's own autocorrelation
/// leaks least into the noise tap.
fn quiet_lag(code: &[i8]) -> f64 {
    let n = code.len();
    let sidelobe = |lag: usize| {
        (0..n)
            .map(|i| i64::from(code[i]) * i64::from(code[(i + lag) % n]))
            .sum::<i64>()
            .abs()
    };
    (3..16)
        .min_by_key(|&lag| sidelobe(lag) + sidelobe(lag + 1))
        .map_or(3.5, |lag| lag as f64 + 0.5)
}
