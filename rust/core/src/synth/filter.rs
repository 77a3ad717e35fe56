//! The front-end filter: a linear-phase FIR band-pass, windowed sinc.
//!
//! Its centre tap belongs to the output sample, so it delays nothing.

use std::f64::consts::PI;

use crate::simd::synth::Loops;
use crate::simd::Level;
use crate::{Error, Result, C64};

/// Kaiser window for about 60 dB of stop-band attenuation (Oppenheim and Schafer, eq. 7.75).
const BETA: f64 = 5.653;
/// Taps up to this are rounding errors of zeros: every other one where the centre is a quarter of
/// the sample rate.
const NEGLIGIBLE: f64 = 1e-12;
/// Samples worked on at once: accumulators that fit the registers.
const TILE: usize = 64;

/// A band-pass around `centre` of width `width` (6 dB points), both in cycles per sample.
#[derive(Debug, Clone)]
pub struct Filter {
    /// Real part of the taps 0 (centre) to `reach`; tap -k is its conjugate.
    even: Vec<f32>,
    /// Imaginary part of the taps; empty where all are zero.
    odd: Vec<f32>,
}

/// Modified Bessel function of the first kind and order 0.
fn bessel_i0(x: f64) -> f64 {
    let mut term = 1.0;
    (1..60).fold(1.0, |sum, k| {
        term *= (0.5 * x / f64::from(k)).powi(2);
        sum + term
    })
}

impl Filter {
    /// Designs the filter; `complex` is whether samples are.
    ///
    /// # Errors
    /// [`Error::Invalid`] where the pass band is not inside the sampled band.
    pub fn new(centre: f64, width: f64, taps: usize, complex: bool) -> Result<Self> {
        let lowest = if complex { -0.5 } else { 0.0 };
        let inside = centre - 0.5 * width >= lowest && centre + 0.5 * width <= 0.5;
        if !(width > 0.0 && inside && taps % 2 == 1) {
            return Err(Error::Invalid(format!(
                "front-end band of {width} around {centre} cycles per sample is not inside the \
                 sampled band ({lowest} to 0.5), or its {taps} taps are not an odd number"
            )));
        }
        let reach = taps / 2;
        let low_pass: Vec<f64> = (0..=reach)
            .map(|k| {
                let x = k as f64 / (reach as f64 + 1.0);
                let window = bessel_i0(BETA * (1.0 - x * x).sqrt()) / bessel_i0(BETA);
                let sinc = match k {
                    0 => width,
                    _ => (PI * width * k as f64).sin() / (PI * k as f64),
                };
                sinc * window
            })
            .collect();
        // Unit gain at zero frequency before the shift to the centre.
        let gain = low_pass[0] + 2.0 * low_pass[1..].iter().sum::<f64>();
        let turn = |k: usize| 2.0 * PI * centre * k as f64;
        let shifted = |f: fn(f64) -> f64, factor: f64| -> Vec<f32> {
            let tap = |(k, h): (usize, &f64)| factor * h / gain * f(turn(k));
            let significant = |h: f64| if h.abs() > NEGLIGIBLE { h as f32 } else { 0.0 };
            low_pass
                .iter()
                .enumerate()
                .map(tap)
                .map(significant)
                .collect()
        };
        Ok(if complex {
            let odd = if centre == 0.0 {
                vec![]
            } else {
                shifted(f64::sin, 1.0)
            };
            Filter {
                even: shifted(f64::cos, 1.0),
                odd,
            }
        } else {
            Filter {
                even: shifted(f64::cos, 2.0),
                odd: vec![],
            }
        })
    }

    /// Samples needed before and after those wanted.
    pub fn reach(&self) -> usize {
        self.even.len() - 1
    }

    /// Tap `k`, from -reach to reach.
    pub fn tap(&self, k: i64) -> C64 {
        let at = k.unsigned_abs() as usize;
        let odd = self.odd.get(at).copied().unwrap_or(0.0);
        let odd = if k < 0 { -odd } else { odd };
        C64::new(f64::from(self.even[at]), f64::from(odd))
    }

    /// Gain of white noise, as a ratio of standard deviations.
    pub fn noise_gain(&self) -> f64 {
        let power = |taps: &[f32]| -> f64 {
            let squares = taps.iter().map(|&h| f64::from(h).powi(2));
            squares
                .enumerate()
                .map(|(k, p)| if k == 0 { p } else { 2.0 * p })
                .sum()
        };
        (power(&self.even) + power(&self.odd)).sqrt()
    }

    /// Complex gain at a frequency in cycles per sample (it is real: the phase is linear).
    pub fn gain(&self, frequency: f64) -> f64 {
        let turn = |k: usize| 2.0 * PI * frequency * k as f64;
        let even = self.even.iter().enumerate();
        let odd = self.odd.iter().enumerate();
        even.map(|(k, &h)| f64::from(h) * turn(k).cos() * if k == 0 { 1.0 } else { 2.0 })
            .chain(odd.map(|(k, &h)| 2.0 * f64::from(h) * turn(k).sin()))
            .sum()
    }

    /// Filters real samples; `x` has `reach` samples more than `out` on either side.
    ///
    /// Every level gives the same bits.
    pub fn apply_real(&self, level: Level, x: &[f32], out: &mut [f32]) {
        Loops::new(level).convolve_even(&self.even, x, out);
    }

    /// Filters complex samples, like [`Self::apply_real`].
    pub fn apply_complex(
        &self,
        level: Level,
        x: [&[f32]; 2],
        out: [&mut [f32]; 2],
        scratch: &mut [f32],
    ) {
        let loops = Loops::new(level);
        let [re, im] = out;
        loops.convolve_even(&self.even, x[0], re);
        loops.convolve_even(&self.even, x[1], im);
        if !self.odd.is_empty() {
            // (even + j odd) * (x0 + j x1)
            loops.convolve_odd(&self.odd, x[1], scratch);
            re.iter_mut().zip(&*scratch).for_each(|(o, s)| *o -= s);
            loops.convolve_odd(&self.odd, x[0], scratch);
            im.iter_mut().zip(&*scratch).for_each(|(o, s)| *o += s);
        }
    }
}

/// `out[n] = h[0] x[n] + sum over k of h[k] (x[n - k] + x[n + k])`, x counted from `reach`.
#[inline(always)]
pub(crate) fn convolve_even(h: &[f32], x: &[f32], out: &mut [f32]) {
    convolve(h, x, out, |before, after| before + after);
}

/// `out[n] = h[0] x[n] + sum over k of h[k] (x[n - k] - x[n + k])`, x counted from `reach`.
#[inline(always)]
pub(crate) fn convolve_odd(h: &[f32], x: &[f32], out: &mut [f32]) {
    convolve(h, x, out, |before, after| before - after);
}

#[inline(always)]
fn convolve(h: &[f32], x: &[f32], out: &mut [f32], fold: impl Fn(f32, f32) -> f32) {
    let reach = h.len() - 1;
    assert!(x.len() >= out.len() + 2 * reach);
    let (tiles, rest) = out.as_chunks_mut::<TILE>();
    let done = tiles.len() * TILE;
    for (tile, out) in tiles.iter_mut().enumerate() {
        *out = convolve_tile(h, &x[tile * TILE..], &fold);
    }
    for (n, out) in rest.iter_mut().enumerate() {
        [*out] = convolve_tile(h, &x[done + n..], &fold);
    }
}

/// The order of the sum is fixed and nothing is fused: the same bits on every machine.
#[inline(always)]
fn convolve_tile<const N: usize>(
    h: &[f32],
    x: &[f32],
    fold: &impl Fn(f32, f32) -> f32,
) -> [f32; N] {
    let reach = h.len() - 1;
    // The samples reach that far; a panic here would keep the sums out of registers.
    let window = |at: usize| x.get(at..).and_then(|x| x.first_chunk::<N>());
    let mut sum = [0.0; N];
    if let Some(centre) = window(reach) {
        (0..N).for_each(|n| sum[n] = h[0] * centre[n]);
    }
    let taps = h.iter().enumerate().skip(1);
    for (k, &h) in taps.filter(|(_, &h)| h != 0.0) {
        if let (Some(before), Some(after)) = (window(reach - k), window(reach + k)) {
            (0..N).for_each(|n| sum[n] += h * fold(before[n], after[n]));
        }
    }
    sum
}
