//! Gaussian noise of correlator taps, correlated between taps as the replica is with itself.

use crate::simd::synth::Loops;
use crate::simd::Level;
use crate::synth::random::{hash, Noise};
use crate::C64;

/// Normal numbers made at once.
const BATCH: usize = 128;

/// Noise of one sideband: a pure function of its key and the number of the slice.
pub(super) struct TapNoise {
    outer: Vec<bool>,
    /// Noise of each tap over that of an inner one.
    gains: Vec<f64>,
    /// Power of an outer tap over an inner one's, beyond the covariance.
    outer_power: f64,
    /// Lower triangle, column by column; its product with its adjoint is the covariance.
    factor: Vec<C64>,
    stream: Noise,
    loops: Loops,
    /// Real numbers of one slice.
    stride: usize,
    batch: [f32; BATCH],
    slice: u64,
}

/// The stream of a satellite's signal.
pub(super) fn key(seed: u64, system: char, prn: u16, signal: &str) -> u64 {
    let names = [u64::from(u32::from(system)), u64::from(prn)];
    let letters = signal.bytes().map(u64::from);
    names.into_iter().chain(letters).fold(seed, hash)
}

impl TapNoise {
    /// Taps, some of them outer ones, of the given covariance (row by row) and one more prompt, the
    /// companion's, of unit variance and independent of them.
    pub fn new(key: u64, outer: Vec<bool>, covariance: &[C64]) -> Self {
        let taps = outer.len();
        let stride = (2 * (taps + 1)).next_power_of_two();
        assert!(stride <= BATCH / 4, "{taps} taps are too many");
        TapNoise {
            gains: vec![1.0; taps],
            outer,
            outer_power: 1.0,
            factor: cholesky(taps, covariance),
            stream: Noise::new(key, 0),
            loops: Loops::new(Level::best()),
            stride,
            batch: [0.0; BATCH],
            slice: 0,
        }
    }

    /// Adds the noise of the next slice, of so much power at unit variance, and `outer_power` times
    /// that in outer taps; gives that of the companion.
    #[inline]
    pub fn add(&mut self, power: f64, outer_power: f64, taps: &mut [C64]) -> C64 {
        if outer_power != self.outer_power {
            self.set_outer(outer_power);
        }
        let at = (self.slice as usize * self.stride) % BATCH;
        if at == 0 {
            let first = self.slice as i64 * self.stride as i64;
            self.stream.fill(self.loops, first, &mut self.batch);
        }
        self.slice += 1;
        let scale = (0.5 * power).sqrt();
        let normal = |i: usize| {
            let [re, im] = [self.batch[at + 2 * i], self.batch[at + 2 * i + 1]];
            C64::new(f64::from(re) * scale, f64::from(im) * scale)
        };
        let mut column = self.factor.as_slice();
        for i in 0..self.gains.len() {
            let gains = &self.gains[i..];
            let (weights, after) = column.split_at(gains.len());
            column = after;
            let here = normal(i);
            let turned = C64::new(-here.im, here.re);
            for ((tap, weight), gain) in taps[i..].iter_mut().zip(weights).zip(gains) {
                *tap += (here * weight.re + turned * weight.im) * gain;
            }
        }
        normal(self.gains.len())
    }

    fn set_outer(&mut self, power: f64) {
        for (gain, _) in self.gains.iter_mut().zip(&self.outer).filter(|g| *g.1) {
            *gain = power.sqrt();
        }
        self.outer_power = power;
    }
}

/// The lower-triangular factor of a positive semi-definite matrix, column by column without the
/// zeros.
fn cholesky(n: usize, matrix: &[C64]) -> Vec<C64> {
    let mut factor = vec![C64::default(); n * n];
    for j in 0..n {
        for i in j..n {
            let known: C64 = (0..j)
                .map(|k| factor[k * n + i] * factor[k * n + j].conj())
                .sum();
            let rest = matrix[i * n + j] - known;
            let pivot = factor[j * n + j].re;
            factor[j * n + i] = if i == j {
                rest.re.max(0.0).sqrt().into()
            } else if pivot > 1e-6 {
                rest / pivot
            } else {
                C64::default() // taps that coincide
            };
        }
    }
    (0..n)
        .flat_map(|j| factor[j * n + j..(j + 1) * n].to_vec())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_covariance() {
        let c = C64::new(0.3, 0.2);
        let one = C64::from(1.0);
        let covariance = [one, c, one, c.conj(), one, c.conj(), one, c, one];
        // The last tap is an outer one, with twice the power.
        let gain = |k: usize| if k == 2 { 2f64.sqrt() } else { 1.0 };
        let mut noise = TapNoise::new(
            key(5, 'C', 20, "B1I"),
            vec![false, false, true],
            &covariance,
        );
        let n = 200_000;
        let mut seen = [C64::default(); 9];
        let mut companion_power = 0.0;
        for _ in 0..n {
            let mut taps = [C64::default(); 3];
            let companion = noise.add(4.0, 2.0, &mut taps);
            for (k, sum) in seen.iter_mut().enumerate() {
                let product = taps[k / 3] * taps[k % 3].conj() / (gain(k / 3) * gain(k % 3));
                *sum += product / (4.0 * f64::from(n));
            }
            companion_power += companion.norm_sqr() / (4.0 * f64::from(n));
        }
        let error = 4.0 / f64::from(n).sqrt();
        for (seen, expected) in seen.iter().zip(covariance) {
            assert!((seen - expected).norm() < error, "{seen} {expected}");
        }
        assert!((companion_power - 1.0).abs() < error);
    }

    #[test]
    fn streams_of_signals_and_seeds_differ() {
        let first = |key| {
            let mut taps = [C64::default()];
            TapNoise::new(key, vec![false], &[C64::from(1.0)]).add(1.0, 1.0, &mut taps);
            taps[0].re
        };
        let mut seen: Vec<f64> = [
            key(1, 'C', 20, "B1I"),
            key(2, 'C', 20, "B1I"),
            key(1, 'C', 21, "B1I"),
            key(1, 'E', 20, "B1I"),
            key(1, 'C', 20, "B1CP"),
        ]
        .map(first)
        .to_vec();
        assert_eq!(first(key(1, 'C', 20, "B1I")), seen[0]);
        seen.sort_by(f64::total_cmp);
        seen.dedup();
        assert_eq!(seen.len(), 5);
    }
}
