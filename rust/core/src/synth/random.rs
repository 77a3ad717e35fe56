//! White Gaussian noise as a pure function of (seed, stream, sample index).

use std::sync::LazyLock;

use super::pair;
use super::quantile::normal_quantile;
use crate::simd::synth::Loops;

/// Weyl increment of SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number
/// generators"): 2^64 over the golden ratio.
const WEYL: u64 = 0x9e37_79b9_7f4a_7c15;

/// Bins of equal probability of the inverse normal distribution.
const BINS: usize = 1 << BIN_BITS;
const BIN_BITS: u32 = 11;
const FRACTION_BITS: u32 = 32 - BIN_BITS;
/// Bins at either end where linear interpolation would not do; they are evaluated exactly.
const TAIL: usize = 4;

/// SplitMix64's output function.
#[inline(always)]
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// 64 random bits from a key and a counter: element `counter` of the key's SplitMix64 sequence.
#[inline(always)]
pub(crate) fn hash(key: u64, counter: u64) -> u64 {
    mix(key.wrapping_add(counter.wrapping_add(1).wrapping_mul(WEYL)))
}

/// Lower edge and slope (per unit of the fraction) of each bin; infinity marks the outer bins.
pub(crate) type Table = [u64; BINS];

/// Samples made at once, from an even one on.
pub(crate) type Batch = [f32; BATCH];
const BATCH: usize = 128;
/// Samples that are searched for outer bins at once.
const GROUP: usize = 16;

static TABLE: LazyLock<Box<Table>> = LazyLock::new(|| {
    let edge = |k: usize| normal_quantile(k as f64 / BINS as f64);
    let mut table = Box::new([pair::join([f32::INFINITY, 0.0]); BINS]);
    for (k, bin) in table.iter_mut().enumerate().take(BINS - TAIL).skip(TAIL) {
        let slope = (edge(k + 1) - edge(k)) / f64::from(1u32 << FRACTION_BITS);
        *bin = pair::join([edge(k) as f32, slope as f32]);
    }
    table
});

/// One stream of unit-variance white Gaussian noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    key: u64,
}

impl Noise {
    /// Stream number `stream` of a seed; streams are independent.
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        Noise {
            key: mix(hash(seed, stream)),
        }
    }

    /// Writes the noise of samples `start..start + out.len()`.
    pub(crate) fn fill(&self, loops: Loops, start: i64, out: &mut [f32]) {
        let (head, body) = out.split_at_mut(((start & 1) as usize).min(out.len()));
        let mut batch = [0.0; BATCH];
        if let [first] = head {
            self.batch(loops, start >> 1, &mut batch);
            *first = batch[1];
        }
        let mut pair = (start + 1) >> 1;
        let mut whole = body.chunks_exact_mut(BATCH);
        for chunk in &mut whole {
            if let Ok(chunk) = chunk.try_into() {
                self.batch(loops, pair, chunk);
            }
            pair += BATCH as i64 / 2;
        }
        let rest = whole.into_remainder();
        if !rest.is_empty() {
            self.batch(loops, pair, &mut batch);
            rest.copy_from_slice(&batch[..rest.len()]);
        }
    }

    /// The noise of samples from `2 pair` on.
    fn batch(&self, loops: Loops, pair: i64, out: &mut Batch) {
        loops.noise(self.key, pair as u64, &TABLE, out);
        for (k, group) in out.chunks_exact_mut(GROUP).enumerate() {
            if group.iter().fold(false, |any, v| any | v.is_infinite()) {
                for (j, v) in group.iter_mut().enumerate() {
                    let sample = k * GROUP + j;
                    if v.is_infinite() {
                        *v = self.tail(pair + sample as i64 / 2, sample as u32 % 2);
                    }
                }
            }
        }
    }

    /// The outer bins: the exact quantile, with 32 more random bits.
    #[cold]
    fn tail(&self, pair: i64, half: u32) -> f32 {
        const CYCLE: f64 = 4_294_967_296.0;
        let bits = |key| (hash(key, pair as u64) >> (32 * half)) as u32;
        let u = bits(self.key);
        let below = (f64::from(bits(!self.key)) + 0.5) / CYCLE;
        if u < 1 << 31 {
            normal_quantile((f64::from(u) + below) / CYCLE) as f32
        } else {
            -normal_quantile((f64::from(!u) + below) / CYCLE) as f32
        }
    }
}

/// Noise by the table; a 64-bit hash serves the samples `2 pair` and `2 pair + 1`.
#[inline(always)]
pub(crate) fn fill_batch(key: u64, pair: u64, table: &Table, out: &mut Batch) {
    let mut bits = [0u32; BATCH];
    for (k, two) in bits.chunks_exact_mut(2).enumerate() {
        let hash = hash(key, pair.wrapping_add(k as u64));
        two[0] = hash as u32;
        two[1] = (hash >> 32) as u32;
    }
    for (o, u) in out.iter_mut().zip(bits) {
        let [edge, slope] = pair::split(table[(u >> FRACTION_BITS) as usize]);
        // Through i32, which every level converts at once; the value has 21 bits.
        *o = edge + slope * (u & ((1 << FRACTION_BITS) - 1)) as i32 as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Level;

    const N: usize = 4_000_000;

    fn noise(stream: u64) -> Vec<f64> {
        let mut out = vec![0.0; N];
        Noise::new(7, stream).fill(Loops::new(Level::best()), 0, &mut out);
        out.iter().map(|&v| f64::from(v)).collect()
    }

    /// Standard errors of mean, variance, third and fourth moment of N normal samples, times 4.
    #[test]
    fn moments() {
        let x = noise(0);
        let moment = |p: i32| x.iter().map(|v| v.powi(p)).sum::<f64>() / N as f64;
        let n = N as f64;
        assert!(moment(1).abs() < 4.0 / n.sqrt());
        assert!((moment(2) - 1.0).abs() < 4.0 * (2.0 / n).sqrt());
        assert!(moment(3).abs() < 4.0 * (15.0 / n).sqrt());
        assert!((moment(4) - 3.0).abs() < 4.0 * (96.0 / n).sqrt());
    }

    #[test]
    fn tails() {
        let x = noise(1);
        for k in [2.0, 2.5, 3.0, 3.5, 4.0, 4.5] {
            let p = 2.0 * crate::synth::quantile::tests::normal_tail(k);
            let expected = p * N as f64;
            let seen = x.iter().filter(|v| v.abs() > k).count() as f64;
            assert!(
                (seen - expected).abs() < 4.0 * expected.sqrt(),
                "{k}: {seen} {expected}"
            );
        }
    }

    #[test]
    fn white_and_streams_independent() {
        let (x, y) = (noise(0), noise(1));
        let limit = 4.0 / (N as f64).sqrt();
        for lag in 1..40 {
            let r: f64 = x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum();
            assert!((r / N as f64).abs() < limit, "lag {lag}");
        }
        // Squares would show a dependence that leaves the values uncorrelated.
        let r: f64 = x
            .iter()
            .zip(&x[1..])
            .map(|(a, b)| (a * a - 1.0) * (b * b - 1.0))
            .sum();
        assert!((r / N as f64).abs() < 2.0 * limit);
        let r: f64 = x.iter().zip(&y).map(|(a, b)| a * b).sum();
        assert!((r / N as f64).abs() < limit);
    }

    #[test]
    fn any_cut_and_level_gives_the_same_samples() {
        let noise = Noise::new(3, 2);
        for origin in [-37, 1 << 35] {
            let mut whole = vec![0.0; 500];
            noise.fill(Loops::new(Level::Portable), origin, &mut whole);
            for loops in Level::available().into_iter().map(Loops::new) {
                for (a, b) in [(0, 1), (1, 2), (3, 17), (4, 100), (99, 500), (7, 7)] {
                    let mut part = vec![0.0; b - a];
                    noise.fill(loops, origin + a as i64, &mut part);
                    assert_eq!(part, whole[a..b]);
                }
            }
        }
    }
}
