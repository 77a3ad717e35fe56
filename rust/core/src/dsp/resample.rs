//! Mixes a band of a recording to 0 Hz and resamples it to a low rate.
//!
//! The ratio of the rates may be any real number: the low-pass (Kaiser-windowed sinc) is tabulated
//! at `PHASES` fractions of an input sample and evaluated at the output instants only. The
//! mixing is folded into the taps (a band-pass), so an input sample is touched only by the
//! outputs that need it. Output `k` is the signal at input instant `first + k * ratio`: the
//! group delay is compensated.

use num_complex::Complex32;
use rayon::prelude::*;

use crate::nco::{phase_from_cycles, step_from_frequency};
use crate::{sample::SampleFormat, Error, Result};

/// Fractions of an input sample; exact for rates of whole kHz against 4.096 MHz up to 2^8.
const PHASES: usize = 256;
/// Half length of the low-pass, in periods of the lower of the two rates.
const HALF_LENGTH: f64 = 8.0;
/// Kaiser shape: 60 dB stop band.
const KAISER_BETA: f64 = 5.65;
/// Outputs computed together.
const CHUNK: usize = 2048;

/// Raw samples of a recording and how to read them.
#[derive(Debug, Clone, Copy)]
pub struct RawSamples<'a> {
    /// Whole samples.
    pub bytes: &'a [u8],
    /// How they are stored.
    pub format: SampleFormat,
    /// Factor of float formats.
    pub scale: f32,
    /// Take I - jQ.
    pub conjugate: bool,
}

/// Band-pass, mixer and resampler for one pair of rates and one intermediate frequency.
#[derive(Debug)]
pub struct Resampler {
    ratio: f64,
    if_cycles: f64,
    half: usize,
    /// Taps of phase p at `[p * 2 * half ..]`; real parts and imaginary parts.
    re: Vec<f32>,
    im: Vec<f32>,
}

impl Resampler {
    /// Plans from `in_rate_hz` to `out_rate_hz`, moving `if_hz` to 0.
    ///
    /// # Errors
    /// [`Error::Invalid`] for rates that are not positive and finite.
    pub fn new(in_rate_hz: f64, out_rate_hz: f64, if_hz: f64) -> Result<Self> {
        let good = |x: f64| x.is_finite() && x > 0.0;
        if !good(in_rate_hz) || !good(out_rate_hz) || !if_hz.is_finite() {
            return Err(Error::Invalid(format!(
                "cannot resample {in_rate_hz} Hz to {out_rate_hz} Hz around {if_hz} Hz: \
                 rates must be positive"
            )));
        }
        let ratio = in_rate_hz / out_rate_hz;
        let cutoff = (1.0 / ratio).min(1.0);
        let half = (HALF_LENGTH / cutoff).ceil() as usize;
        let if_cycles = if_hz / in_rate_hz;
        let (mut re, mut im) = (Vec::new(), Vec::new());
        for p in 0..=PHASES {
            let fraction = p as f64 / PHASES as f64;
            for tap in 0..2 * half {
                // Instant of the input sample relative to the output's.
                let u = tap as f64 - (half - 1) as f64 - fraction;
                let h = cutoff * sinc(cutoff * u) * kaiser(u / half as f64);
                let (s, c) = (-std::f64::consts::TAU * (if_cycles * u).fract()).sin_cos();
                re.push((h * c) as f32);
                im.push((h * s) as f32);
            }
        }
        Ok(Resampler {
            ratio,
            if_cycles,
            half,
            re,
            im,
        })
    }

    /// `count` outputs, the first at input instant `first`; missing input counts as zero.
    pub fn run(&self, raw: RawSamples<'_>, first: f64, count: usize) -> Vec<Complex32> {
        let mut out = vec![Complex32::default(); count];
        out.par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(i, chunk)| {
                self.fill(raw, first, i * CHUNK, chunk);
            });
        out
    }

    /// Outputs `k0..` of the stream, from the bytes they need.
    fn fill(&self, raw: RawSamples<'_>, first: f64, k0: usize, out: &mut [Complex32]) {
        let instant = |k: usize| first + (k0 + k) as f64 * self.ratio;
        let begin = instant(0).floor() as i64 - self.half as i64 + 1;
        let end = instant(out.len() - 1).floor() as i64 + self.half as i64 + 1;
        let (x, y) = window(raw, begin, end);
        let step = step_from_frequency(self.if_cycles * self.ratio);
        let start = phase_from_cycles(self.if_cycles * first);
        for (k, value) in out.iter_mut().enumerate() {
            let t = instant(k);
            let whole = t.floor();
            let phase = ((t - whole) * PHASES as f64).round() as usize;
            let at = (whole as i64 - self.half as i64 + 1 - begin) as usize;
            let taps = phase * 2 * self.half..(phase + 1) * 2 * self.half;
            let (hr, hi) = (&self.re[taps.clone()], &self.im[taps]);
            let xs = &x[at..at + 2 * self.half];
            let mut sum = Complex32::new(dot(xs, hr), dot(xs, hi));
            if !y.is_empty() {
                let ys = &y[at..at + 2 * self.half];
                sum += Complex32::new(-dot(ys, hi), dot(ys, hr));
            }
            let turn = start.wrapping_add(step.wrapping_mul((k0 + k) as u64));
            let (s, c) = (-std::f64::consts::TAU * crate::nco::cycles_from_phase(turn)).sin_cos();
            *value = sum * Complex32::new(c as f32, s as f32);
        }
    }
}

/// Samples `begin..end` as floats, zeros outside the recording; the second empty if real.
fn window(raw: RawSamples<'_>, begin: i64, end: i64) -> (Vec<f32>, Vec<f32>) {
    let bits = raw.format.bits_per_sample();
    let per_byte = (8 / bits).max(1) as i64;
    let total = (raw.bytes.len() * 8 / bits) as i64;
    let from = begin.clamp(0, total) / per_byte * per_byte;
    let to = end.clamp(from, total);
    let byte = |sample: i64| (sample as usize * bits).div_ceil(8);
    let mut values = Vec::new();
    raw.format.unpack(
        &raw.bytes[byte(from)..byte(to)],
        raw.scale,
        raw.conjugate,
        &mut values,
    );
    let width = if raw.format.is_complex() { 2 } else { 1 };
    let component = |c: usize| -> Vec<f32> {
        (begin..end)
            .map(|n| match usize::try_from(n - from) {
                Ok(i) if n < to => values.get(i * width + c).map_or(0.0, |&v| f32::from(v)),
                _ => 0.0,
            })
            .collect()
    };
    (
        component(0),
        if width == 2 { component(1) } else { Vec::new() },
    )
}

/// Sum of products in eight lanes, a fixed order that vectorises.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0f32; 8];
    let (ac, bc) = (a.chunks_exact(8), b.chunks_exact(8));
    let tail: f32 = ac
        .remainder()
        .iter()
        .zip(bc.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in ac.zip(bc) {
        for i in 0..8 {
            lanes[i] += x[i] * y[i];
        }
    }
    lanes.iter().sum::<f32>() + tail
}

/// sin(pi x) / (pi x).
pub(crate) fn sinc(x: f64) -> f64 {
    let y = std::f64::consts::PI * x;
    if y.abs() < 1e-9 {
        1.0
    } else {
        y.sin() / y
    }
}

/// Kaiser window at `x` in [-1, 1].
fn kaiser(x: f64) -> f64 {
    bessel_i0(KAISER_BETA * (1.0 - x * x).max(0.0).sqrt()) / bessel_i0(KAISER_BETA)
}

/// Modified Bessel function of the first kind, order 0, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..40 {
        term *= (x / (2.0 * f64::from(k))).powi(2);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(format: &str, n: usize, cycles: f64) -> Vec<u8> {
        let complex = format.starts_with('c');
        (0..n)
            .flat_map(|k| {
                let (s, c) = (std::f64::consts::TAU * cycles * k as f64).sin_cos();
                let iq = [
                    (100.0 * c).round() as i8 as u8,
                    (100.0 * s).round() as i8 as u8,
                ];
                iq.into_iter().take(if complex { 2 } else { 1 })
            })
            .collect()
    }

    fn resampled(format: &str, rate: f64, if_hz: f64, offset_hz: f64) -> Vec<Complex32> {
        let bytes = tone(format, (rate * 0.002) as usize, (if_hz + offset_hz) / rate);
        let format = SampleFormat::parse(format).unwrap();
        let raw = RawSamples {
            bytes: &bytes,
            format,
            scale: 1.0,
            conjugate: false,
        };
        Resampler::new(rate, 4.096e6, if_hz)
            .unwrap()
            .run(raw, 0.0, 8192)
    }

    /// A tone keeps its amplitude, frequency and phase (group delay compensated).
    fn check(format: &str, rate: f64, if_hz: f64, amplitude: f32) {
        let offset_hz = 600e3;
        for (k, v) in resampled(format, rate, if_hz, offset_hz)
            .iter()
            .enumerate()
            .skip(20)
        {
            if k > 8192 - 20 {
                break;
            }
            let a = std::f64::consts::TAU * offset_hz * k as f64 / 4.096e6;
            let want = Complex32::new(a.cos() as f32, a.sin() as f32) * amplitude;
            assert!(
                (v - want).norm() < 0.02 * amplitude,
                "{format} {rate} {k}: {v} {want}"
            );
        }
    }

    #[test]
    fn tones_survive_any_rate() {
        check("ri8", 120e6, 22.839e6, 50.0);
        check("ri8", 12e6, 3e6, 50.0);
        check("ci8", 4e6, 0.0, 100.0);
        check("ci8", 16.367_667e6, -3.1e6, 100.0);
        check("ri8", 38.192e6, 9.55e6, 50.0);
    }

    #[test]
    fn stop_band_is_deep() {
        let out = resampled("ci8", 16.368e6, 0.0, 4.5e6);
        let power: f32 = out.iter().skip(20).map(|v| v.norm_sqr()).sum::<f32>() / 8000.0;
        assert!(10.0 * (power / 1e4).log10() < -50.0, "{power}");
    }

    #[test]
    fn a_later_start_gives_the_same_instants() {
        let bytes = tone("ri8", 40_000, 0.21);
        let format = SampleFormat::parse("ri8").unwrap();
        let raw = RawSamples {
            bytes: &bytes,
            format,
            scale: 1.0,
            conjugate: false,
        };
        let plan = Resampler::new(12e6, 4.096e6, 2.5e6).unwrap();
        let all = plan.run(raw, 0.0, 9000);
        let later = plan.run(raw, 375.0, 4000);
        for (a, b) in all[128..].iter().zip(&later) {
            assert!((a - b).norm() < 1e-2);
        }
    }
}
