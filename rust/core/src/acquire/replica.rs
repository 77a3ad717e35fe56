//! Band-limited replicas for the search, and the shape of their correlation peak.

use std::f64::consts::TAU;

use num_complex::Complex32;
use rustfft::FftPlanner;

use crate::dsp::resample::sinc;
use crate::signal::SignalSpec;
use crate::{Result, C64};

/// Rate of the search: a power of two per millisecond, at least twice the first spectral null,
/// so that the main lobes are inside.
pub fn search_rate_hz(spec: &SignalSpec) -> f64 {
    let null_hz = spec.chip_rate_hz * spec.modulation.layers()[0].subchips as f64;
    let per_ms = (2.0 * null_hz / 1e3).ceil() as usize;
    per_ms.next_power_of_two() as f64 * 1e3
}

/// Fourier transform of one chip divided by its duration, at `f` cycles per chip.
///
/// A layer of s sub-chips is the sum of s pulses of alternate sign.
fn chip_spectrum(spec: &SignalSpec, f: f64) -> C64 {
    let mut sum = C64::default();
    for layer in spec.modulation.layers() {
        let width = 1.0 / layer.subchips as f64;
        let pulse = width * sinc(f * width);
        for i in 0..layer.subchips {
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            let turn = C64::from_polar(sign * pulse, -TAU * f * (i as f64 + 0.5) * width);
            sum += C64::new(layer.re, layer.im) * turn;
        }
    }
    sum
}

/// Fourier coefficients of one code period, limited to +-samples/2 harmonics of the period.
///
/// # Errors
/// [`crate::Error::UnknownPrn`].
pub(super) fn code_spectrum(spec: &SignalSpec, prn: u16, samples: usize) -> Result<Vec<C64>> {
    let length = spec.code_length;
    let mut code: Vec<C64> = spec
        .code(prn)?
        .iter()
        .map(|&c| C64::new(f64::from(c), 0.0))
        .collect();
    FftPlanner::new()
        .plan_fft_forward(length)
        .process(&mut code);
    let half = samples as i64 / 2;
    let mut spectrum = vec![C64::default(); samples];
    for m in -half..half {
        let harmonic = code[m.rem_euclid(length as i64) as usize] / length as f64;
        spectrum[m.rem_euclid(samples as i64) as usize] =
            harmonic * chip_spectrum(spec, m as f64 / length as f64);
    }
    Ok(spectrum)
}

/// One code period of `samples` samples, band-limited to the rate that this means.
///
/// # Errors
/// [`crate::Error::UnknownPrn`].
pub fn replica(spec: &SignalSpec, prn: u16, samples: usize) -> Result<Vec<Complex32>> {
    let mut period = code_spectrum(spec, prn, samples)?;
    FftPlanner::new()
        .plan_fft_inverse(samples)
        .process(&mut period);
    Ok(period
        .iter()
        .map(|v| Complex32::new(v.re as f32, v.im as f32))
        .collect())
}

/// The correlation peak of a signal limited to the search band, the same for every PRN.
#[derive(Debug, Clone)]
pub struct PeakShape {
    /// Power density over the band: (cycles per sample, share of the signal's power).
    spectrum: Vec<(f64, f64)>,
    /// Share of the signal's power inside the band.
    pub power_in_band: f64,
}

impl PeakShape {
    /// Shape at the search rate of `spec`.
    pub fn new(spec: &SignalSpec) -> Self {
        const POINTS: usize = 512;
        let chips_per_sample = spec.chip_rate_hz / search_rate_hz(spec);
        let spectrum: Vec<_> = (0..POINTS)
            .map(|i| {
                let f = (i as f64 + 0.5) / POINTS as f64 - 0.5;
                let density = chip_spectrum(spec, f / chips_per_sample).norm_sqr();
                (f, density / chips_per_sample / POINTS as f64)
            })
            .collect();
        let power_in_band = spectrum.iter().map(|p| p.1).sum();
        PeakShape {
            spectrum,
            power_in_band,
        }
    }

    /// Correlation at `delay` samples, 1 at 0.
    pub fn correlation(&self, delay: f64) -> f64 {
        let sum: f64 = self
            .spectrum
            .iter()
            .map(|&(f, p)| p * (TAU * f * delay).cos())
            .sum();
        sum / self.power_in_band
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::SIGNALS;

    #[test]
    fn replica_power_and_shape_agree_with_the_spectrum() {
        for spec in SIGNALS {
            let prn = (spec.prns)()[7];
            let n = (search_rate_hz(spec) * spec.period_s()).round() as usize;
            let r = replica(spec, prn, n).unwrap();
            let shape = PeakShape::new(spec);
            let lag = |d: usize| -> f64 {
                (0..n)
                    .map(|i| (r[(i + d) % n] * r[i].conj()).re as f64)
                    .sum::<f64>()
                    / n as f64
            };
            assert!(
                (lag(0) - shape.power_in_band).abs() < 0.02,
                "{} {}",
                spec.id,
                lag(0)
            );
            for d in 1..4 {
                let got = lag(d) / lag(0);
                assert!(
                    (got - shape.correlation(d as f64)).abs() < 0.07,
                    "{} {d} {got}",
                    spec.id
                );
            }
        }
    }
}
