//! Mixes a band of a recording to 0 Hz and resamples it to a low rate.
//!
//! The ratio of the rates may be any real number: the low-pass (Kaiser-windowed sinc) is tabulated
//! at fractions of an input sample and evaluated at the output instants only. The mixing is
//! folded into the taps (a band-pass), so an input sample is touched only by the outputs that
//! need it. Output `k` is the signal at input instant `first + k * ratio`: the group delay is
//! compensated.

use std::f64::consts::TAU;

use num_complex::Complex32;
use rayon::prelude::*;

use super::low_pass::low_pass;
use super::raw::RawSamples;
use crate::nco::{cycles_from_phase, step_from_frequency};
use crate::simd::lanes::{self, Kernel, Lanes};
use crate::simd::Level;
use crate::{Error, Result, C64};

/// Fractions of a period of the lower of the two rates at which the low-pass is tabulated. Only
/// the envelope is taken at the nearest of them, not the carrier: noise of -60 dB at the band's
/// edge.
const FRACTIONS: f64 = 512.0;
/// Half length of the low-pass, in periods of the lower of the two rates.
const HALF_LENGTH: f64 = 8.0;
/// Outputs computed together.
const CHUNK: usize = 512;
/// Products added up side by side.
const WIDTH: usize = 32;

/// Band-pass, mixer and resampler for one pair of rates and one intermediate frequency.
#[derive(Debug)]
pub struct Resampler {
    level: Level,
    ratio: f64,
    /// Mixer, in 2^-64 cycles per input sample.
    step: u64,
    half: usize,
    /// Fractions of an input sample that are tabulated.
    phases: usize,
    /// Taps of one phase: `2 * half`, and zeros up to a multiple of [`WIDTH`].
    length: usize,
    /// Taps of phase p at `[p * length ..]`; real parts and imaginary parts.
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
        let length = (2 * half).next_multiple_of(WIDTH);
        let phases = (FRACTIONS * cutoff).ceil() as usize;
        let response = low_pass(cutoff, half, phases);
        let step = step_from_frequency(if_hz / in_rate_hz);
        // From the input sample at or before an output's instant.
        let mixer: Vec<C64> = (0..2 * half)
            .map(|tap| mixer(step, tap as i64 - (half as i64 - 1)))
            .collect();
        let size = (phases + 1) * length;
        let (mut re, mut im) = (vec![0.0; size], vec![0.0; size]);
        for p in 0..=phases {
            for (tap, m) in mixer.iter().enumerate() {
                // Instant of the input sample relative to the output's, in phases.
                let u = (tap * phases).abs_diff((half - 1) * phases + p);
                let value = response[u] * m;
                re[p * length + tap] = value.re as f32;
                im[p * length + tap] = value.im as f32;
            }
        }
        Ok(Resampler {
            level: Level::best(),
            ratio,
            step,
            half,
            phases,
            length,
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
                let fill = Fill {
                    plan: self,
                    raw,
                    first: first + (i * CHUNK) as f64 * self.ratio,
                    out: chunk,
                };
                lanes::run(self.level, fill);
            });
        out
    }
}

/// Some outputs of the stream, from the bytes that they need.
struct Fill<'a> {
    plan: &'a Resampler,
    raw: RawSamples<'a>,
    /// Input instant of the first output.
    first: f64,
    out: &'a mut [Complex32],
}

impl Kernel for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let plan = self.plan;
        let begin = self.first.floor() as i64 - plan.half as i64 + 1;
        let last = self.first + (self.out.len() - 1) as f64 * plan.ratio;
        let end = last.floor() as i64 - plan.half as i64 + 1 + plan.length as i64;
        let [x, y] = self.raw.window(begin, end);
        // From one output to the next it is a number of samples or one more; rounding may make two.
        let (mut at, mut turn) = (
            self.first.floor(),
            mixer(plan.step, self.first.floor() as i64),
        );
        let least = plan.ratio.floor();
        let turns = [0, 1, 2].map(|more| mixer(plan.step, least as i64 + more));
        for (k, value) in self.out.iter_mut().enumerate() {
            let instant = self.first + k as f64 * plan.ratio;
            let whole = instant.floor();
            if k > 0 {
                turn *= turns[(whole - at - least) as usize];
                at = whole;
            }
            let phase = ((instant - whole) * plan.phases as f64).round() as usize;
            let from = (whole as i64 - plan.half as i64 + 1 - begin) as usize;
            let re = &plan.re[phase * plan.length..][..plan.length];
            let im = &plan.im[phase * plan.length..][..plan.length];
            let mut sum = product(&x[from..], re, im);
            if !y.is_empty() {
                let quadrature = product(&y[from..], re, im);
                sum += Complex32::new(-quadrature.im, quadrature.re);
            }
            *value = sum * Complex32::new(turn.re as f32, turn.im as f32);
        }
    }
}

/// The mixer at a sample.
fn mixer(step: u64, sample: i64) -> C64 {
    let phase = step.wrapping_mul(sample as u64);
    C64::from_polar(1.0, -TAU * cycles_from_phase(phase))
}

/// Sum of products with the taps, in a fixed order that vectorises.
#[inline(always)]
fn product(x: &[f32], re: &[f32], im: &[f32]) -> Complex32 {
    let (mut sums_re, mut sums_im) = ([0f32; WIDTH], [0f32; WIDTH]);
    let taps = re.chunks_exact(WIDTH).zip(im.chunks_exact(WIDTH));
    for (x, (re, im)) in x.chunks_exact(WIDTH).zip(taps) {
        for i in 0..WIDTH {
            sums_re[i] += x[i] * re[i];
            sums_im[i] += x[i] * im[i];
        }
    }
    Complex32::new(sum(sums_re), sum(sums_im))
}

/// By halves.
#[inline(always)]
fn sum(mut values: [f32; WIDTH]) -> f32 {
    let mut half = WIDTH / 2;
    while half > 0 {
        for i in 0..half {
            values[i] += values[i + half];
        }
        half /= 2;
    }
    values[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::SampleFormat;

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
    fn every_level_gives_the_same_bits() {
        for (format, rate) in [("ri8", 120e6), ("ci8", 5e6)] {
            let bytes = tone(format, 30_000, 0.19);
            let raw = RawSamples {
                bytes: &bytes,
                format: SampleFormat::parse(format).unwrap(),
                scale: 1.0,
                conjugate: true,
            };
            let mut plan = Resampler::new(rate, 4.096e6, 0.19 * rate).unwrap();
            let runs = Level::available().into_iter().map(|level| {
                plan.level = level;
                plan.run(raw, 3.0, 1000)
            });
            let runs: Vec<_> = runs.collect();
            assert!(runs[0][500].norm() > 10.0);
            assert!(runs.windows(2).all(|w| w[0] == w[1]));
        }
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
