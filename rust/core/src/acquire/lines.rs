//! Limits spectral lines (clock spurs, continuous-wave interference), which every code correlates
//! with and which would pass for weak satellites.

use num_complex::Complex32;
use rayon::prelude::*;

use super::library::{forward, inverse};

/// Bands in which the noise level is estimated.
const BANDS: usize = 64;
/// Largest power of a spectral bin, in noise means: in noise one in e^16 = 9 million is larger.
const LIMIT: f32 = 16.0;

/// Scales bins of the spectrum of all samples down to [`LIMIT`] times the local noise.
///
/// Limiting, not zeroing: a very strong signal whose own lines stand out keeps most of its power.
pub(super) fn limit_lines(samples: &mut [Complex32]) {
    forward(samples.len()).process(samples);
    samples
        .par_chunks_mut(samples.len().div_ceil(BANDS))
        .for_each(|band| {
            let limit = LIMIT * noise_mean(band);
            for bin in band.iter_mut().filter(|b| b.norm_sqr() > limit) {
                *bin *= (limit / bin.norm_sqr()).sqrt();
            }
        });
    inverse(samples.len()).process(samples);
    let scale = 1.0 / samples.len() as f32;
    samples.iter_mut().for_each(|v| *v *= scale);
}

/// Mean power of noise, from the median, which lines do not move: ln 2 of it for Gaussian noise.
fn noise_mean(bins: &[Complex32]) -> f32 {
    let mut power: Vec<f32> = bins.iter().map(|b| b.norm_sqr()).collect();
    let middle = power.len() / 2;
    let (_, median, _) = power.select_nth_unstable_by(middle, f32::total_cmp);
    *median / std::f32::consts::LN_2
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    /// Reproducible noise of unit power (sum of twelve uniform numbers per component).
    fn noise(n: usize) -> Vec<Complex32> {
        let mut state = 1u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 40) as f32 / (1u64 << 24) as f32 - 0.5
        };
        let mut normal = || (0..12).map(|_| uniform()).sum::<f32>() / 2f32.sqrt();
        (0..n).map(|_| Complex32::new(normal(), normal())).collect()
    }

    #[test]
    fn a_line_goes_and_noise_stays() {
        let clean = noise(16_384);
        let mut with_line: Vec<_> = clean
            .iter()
            .enumerate()
            .map(|(k, v)| v + Complex32::from_polar(1.0, TAU * (0.1237 * k as f32).fract()))
            .collect();
        limit_lines(&mut with_line);
        let rest: f32 = clean
            .iter()
            .zip(&with_line)
            .map(|(a, b)| (a - b).norm_sqr())
            .sum();
        // The line had the power of the noise; what is below the limit stays.
        assert!(rest / 16_384.0 < 0.05, "{rest}");
        let mut again = clean.clone();
        limit_lines(&mut again);
        let change: f32 = clean
            .iter()
            .zip(&again)
            .map(|(a, b)| (a - b).norm_sqr())
            .sum();
        assert!(change / 16_384.0 < 1e-6, "{change}");
    }
}
