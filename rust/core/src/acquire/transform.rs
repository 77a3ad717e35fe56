//! Array operations of the search.

use std::sync::Arc;

use num_complex::Complex32;
use rustfft::Fft;

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
pub(super) fn padded_spectrum(
    forward: &Arc<dyn Fft<f32>>,
    samples: &[Complex32],
    size: usize,
) -> Vec<Complex32> {
    let mut data = samples[..samples.len().min(size)].to_vec();
    data.resize(size, Complex32::default());
    forward.process(&mut data);
    data
}

pub(super) fn multiply(out: &mut [Complex32], a: &[Complex32], b: &[Complex32]) {
    for ((o, x), y) in out.iter_mut().zip(a).zip(b) {
        *o = x * y;
    }
}

/// Adds the power at `lags[i + drift]`, wrapped, to `row[i]`.
pub(super) fn add_power(row: &mut [f32], lags: &[Complex32], drift: i64) {
    let shift = drift.rem_euclid(lags.len() as i64) as usize;
    let (head, tail) = row.split_at_mut(lags.len() - shift);
    let add = |r: &mut [f32], l: &[Complex32]| {
        r.iter_mut().zip(l).for_each(|(p, v)| *p += v.norm_sqr());
    };
    add(head, &lags[shift..]);
    add(tail, &lags[..shift]);
}

/// Periods per FFT, odd, that need the fewest points for `blocks` periods.
pub(super) fn best_span(blocks: usize) -> usize {
    [1usize, 3, 5]
        .into_iter()
        .min_by_key(|b| blocks.div_ceil(*b) * (b + 1))
        .unwrap_or(1)
}
