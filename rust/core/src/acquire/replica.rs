//! Band-limited replicas for the search, and the shape of their correlation peak.

use std::f64::consts::{PI, TAU};

use num_complex::Complex32;
use rayon::prelude::*;

use super::library::{forward, inverse};
use crate::dsp::low_pass::sinc;
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
        let half = C64::from_polar(1.0, -PI * f * width);
        let mut turn = half * pulse;
        for _ in 0..layer.subchips {
            sum += C64::new(layer.re, layer.im) * turn;
            turn *= -half * half;
        }
    }
    sum
}

/// Makes the replicas of a signal: one code period of `period` samples, band-limited to the rate
/// that this means.
pub(super) struct Replicas {
    spec: &'static SignalSpec,
    /// Fourier transform of a chip at the harmonics of the code period, 0 and up, then the
    /// negative ones.
    chip: Vec<Complex32>,
}

impl Replicas {
    pub fn new(spec: &'static SignalSpec, period: usize) -> Self {
        let harmonic = |i: usize| {
            let m = if i < period / 2 {
                i as f64
            } else {
                i as f64 - period as f64
            };
            let value = chip_spectrum(spec, m / spec.code_length as f64) / spec.code_length as f64;
            Complex32::new(value.re as f32, value.im as f32)
        };
        let chip = (0..period).into_par_iter().map(harmonic).collect();
        Replicas { spec, chip }
    }

    /// Fourier coefficients of one period.
    ///
    /// # Errors
    /// [`crate::Error::UnknownPrn`].
    pub fn spectrum(&self, prn: u16) -> Result<Vec<Complex32>> {
        let (length, period) = (self.spec.code_length, self.chip.len());
        let code = self.spec.code(prn)?;
        let mut code: Vec<Complex32> = code.iter().map(|&c| f32::from(c).into()).collect();
        forward(length).process(&mut code);
        // Harmonics repeat after one per chip, counted from 0 on both sides.
        let negative = length - (period - period / 2) % length;
        let above = code.iter().cycle();
        let below = code.iter().cycle().skip(negative);
        let codes = above.take(period / 2).chain(below);
        Ok(self.chip.iter().zip(codes).map(|(c, v)| c * v).collect())
    }

    /// Samples of one period.
    ///
    /// # Errors
    /// [`crate::Error::UnknownPrn`].
    pub fn samples(&self, prn: u16) -> Result<Vec<Complex32>> {
        let mut period = self.spectrum(prn)?;
        inverse(period.len()).process(&mut period);
        Ok(period)
    }
}

/// The correlation peak of a signal limited to the search band, the same for every PRN.
#[derive(Debug, Clone)]
pub struct PeakShape {
    /// Power density at both signs of a frequency: (cycles per sample, share of the signal's power).
    spectrum: Vec<(f64, f64)>,
    /// Share of the signal's power inside the band.
    pub power_in_band: f64,
}

impl PeakShape {
    /// Shape at the search rate of `spec`.
    pub fn new(spec: &SignalSpec) -> Self {
        const POINTS: usize = 256;
        let chips_per_sample = spec.chip_rate_hz / search_rate_hz(spec);
        let density = |f: f64| chip_spectrum(spec, f / chips_per_sample).norm_sqr();
        let spectrum: Vec<_> = (0..POINTS)
            .map(|i| {
                let f = 0.5 * (i as f64 + 0.5) / POINTS as f64;
                let width = 0.5 / POINTS as f64 / chips_per_sample;
                (f, (density(f) + density(-f)) * width)
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
            let r = Replicas::new(spec, n).samples(prn).unwrap();
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
