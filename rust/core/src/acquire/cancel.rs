//! Takes known signals out of the samples, so that their cross-correlation with other codes does
//! not pass for satellites (successive interference cancellation by projection).

use num_complex::Complex32;
use rustfft::{Fft, FftPlanner};
use std::f64::consts::TAU;
use std::sync::Arc;

use super::replica::{code_spectrum, search_rate_hz};
use crate::signal::SignalSpec;
use crate::{Result, C64};

/// A signal to take out, as the search estimated it.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// Satellite.
    pub prn: u16,
    /// Doppler.
    pub doppler_hz: f64,
    /// From the first sample to the first following start of a code period.
    pub code_delay_s: f64,
}

/// Removes from each received code period of `known` its projection on the replica: the complex
/// amplitude is free from period to period, so data and secondary code need not be known.
///
/// # Errors
/// [`crate::Error::UnknownPrn`].
pub(super) fn cancel(
    spec: &SignalSpec,
    period: usize,
    known: &Known,
    samples: &mut [Complex32],
) -> Result<()> {
    let spectrum = code_spectrum(spec, known.prn, period)?;
    let inverse = FftPlanner::new().plan_fft_inverse(period);
    let rate = search_rate_hz(spec);
    let step = period as f64 * (1.0 - known.doppler_hz / spec.carrier_hz);
    let mut start = known.code_delay_s * rate - step;
    while start < samples.len() as f64 {
        let replica = delayed(&spectrum, &inverse, start - start.floor());
        project_out(
            samples,
            start.floor() as i64,
            &replica,
            known.doppler_hz / rate,
        );
        start += step;
    }
    Ok(())
}

/// One period of replica, `delay` samples late.
fn delayed(spectrum: &[C64], inverse: &Arc<dyn Fft<f64>>, delay: f64) -> Vec<C64> {
    let n = spectrum.len();
    let mut period: Vec<C64> = (0..n)
        .map(|i| {
            let m = if i < n / 2 {
                i as f64
            } else {
                i as f64 - n as f64
            };
            spectrum[i] * C64::from_polar(1.0, -TAU * m * delay / n as f64)
        })
        .collect();
    inverse.process(&mut period);
    period
}

/// Subtracts the projection of the samples from `start` on on the replica at a Doppler.
fn project_out(samples: &mut [Complex32], start: i64, replica: &[C64], cycles_per_sample: f64) {
    let (from, to) = (
        start.max(0),
        (start + replica.len() as i64).min(samples.len() as i64),
    );
    if from >= to {
        return;
    }
    let here = &mut samples[from as usize..to as usize];
    let replica = &replica[(from - start) as usize..(to - start) as usize];
    let turned: Vec<C64> = replica
        .iter()
        .enumerate()
        .map(|(i, r)| r * C64::from_polar(1.0, TAU * cycles_per_sample * i as f64))
        .collect();
    let wide = |v: &Complex32| C64::new(f64::from(v.re), f64::from(v.im));
    let energy: f64 = turned.iter().map(|r| r.norm_sqr()).sum();
    let product: C64 = here
        .iter()
        .zip(&turned)
        .map(|(x, r)| wide(x) * r.conj())
        .sum();
    if energy > 0.0 {
        let amplitude = product / energy;
        for (x, r) in here.iter_mut().zip(&turned) {
            let y = wide(x) - amplitude * r;
            *x = Complex32::new(y.re as f32, y.im as f32);
        }
    }
}
