//! Array operations of the search.

use num_complex::Complex32;

use super::library::forward;
use crate::{Error, Result};

/// Scales to unit power, so that single precision serves any input.
pub(super) fn normalise(samples: &mut [Complex32]) -> Result<()> {
    let power: f64 = samples.iter().map(|v| f64::from(v.norm_sqr())).sum();
    let scale = (samples.len() as f64 / power).sqrt() as f32;
    if !scale.is_normal() {
        return Err(Error::Invalid(
            "nothing to search: the samples are all zero".into(),
        ));
    }
    samples.iter_mut().for_each(|v| *v *= scale);
    Ok(())
}

/// Spectrum of the first `size` samples, zeros after the last.
pub(super) fn padded_spectrum(samples: &[Complex32], size: usize) -> Vec<Complex32> {
    let mut data = samples[..samples.len().min(size)].to_vec();
    data.resize(size, Complex32::default());
    forward(size).process(&mut data);
    data
}

/// Periods per FFT, odd, that need the fewest points for `blocks` periods.
pub(super) fn best_span(blocks: usize) -> usize {
    [1usize, 3, 5]
        .into_iter()
        .min_by_key(|b| blocks.div_ceil(*b) * (b + 1))
        .unwrap_or(1)
}
