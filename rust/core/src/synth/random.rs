//! White Gaussian noise as a pure function of (seed, stream, sample index).

use std::sync::LazyLock;

use super::quantile::normal_quantile;

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
#[inline]
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// 64 random bits from a key and a counter: element `counter` of the key's SplitMix64 sequence.
#[inline]
pub(super) fn hash(key: u64, counter: u64) -> u64 {
    mix(key.wrapping_add(counter.wrapping_add(1).wrapping_mul(WEYL)))
}

/// Lower edge and slope (per unit of the fraction) of each bin.
static TABLE: LazyLock<Vec<[f32; 2]>> = LazyLock::new(|| {
    let edge = |k: usize| normal_quantile(k as f64 / BINS as f64);
    (0..BINS)
        .map(|k| {
            if (TAIL..BINS - TAIL).contains(&k) {
                let width = edge(k + 1) - edge(k);
                [
                    edge(k) as f32,
                    (width / f64::from(1u32 << FRACTION_BITS)) as f32,
                ]
            } else {
                [0.0, 0.0]
            }
        })
        .collect()
});

/// One stream of unit-variance white Gaussian noise.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    key: u64,
}

impl Noise {
    /// Stream number `stream` of a seed; streams are independent.
    pub fn new(seed: u64, stream: u64) -> Self {
        Noise {
            key: mix(hash(seed, stream)),
        }
    }

    /// Writes the noise of samples `start..start + out.len()`.
    pub fn fill(&self, start: i64, out: &mut [f32]) {
        let table: &[[f32; 2]; BINS] = match TABLE.as_slice().try_into() {
            Ok(table) => table,
            Err(_) => return, // the table has BINS entries
        };
        // A 64-bit hash serves the samples 2k and 2k + 1.
        let odd = (start & 1) as usize;
        let (head, body) = out.split_at_mut(odd.min(out.len()));
        for o in head {
            *o = self.gauss(table, start >> 1, 1);
        }
        let mut pair = (start + 1) >> 1;
        let mut chunks = body.chunks_exact_mut(2);
        for o in &mut chunks {
            let bits = hash(self.key, pair as u64);
            o[0] = self.gauss_from(table, bits as u32, pair, 0);
            o[1] = self.gauss_from(table, (bits >> 32) as u32, pair, 1);
            pair += 1;
        }
        for o in chunks.into_remainder() {
            *o = self.gauss(table, pair, 0);
        }
    }

    fn gauss(&self, table: &[[f32; 2]; BINS], pair: i64, half: u32) -> f32 {
        let bits = hash(self.key, pair as u64) >> (32 * half);
        self.gauss_from(table, bits as u32, pair, half)
    }

    #[inline(always)]
    fn gauss_from(&self, table: &[[f32; 2]; BINS], u: u32, pair: i64, half: u32) -> f32 {
        let bin = (u >> FRACTION_BITS) as usize;
        if bin.wrapping_sub(TAIL) < BINS - 2 * TAIL {
            let [edge, slope] = table[bin];
            edge + slope * (u & ((1 << FRACTION_BITS) - 1)) as f32
        } else {
            self.tail(u, pair, half)
        }
    }

    /// The outer bins: the exact quantile, with 32 more random bits below `u`.
    #[cold]
    fn tail(&self, u: u32, pair: i64, half: u32) -> f32 {
        const CYCLE: f64 = 4_294_967_296.0;
        let more = hash(!self.key, pair as u64) >> (32 * half) as u64 & 0xffff_ffff;
        let below = (more as f64 + 0.5) / CYCLE;
        if u < 1 << 31 {
            normal_quantile((f64::from(u) + below) / CYCLE) as f32
        } else {
            -normal_quantile((f64::from(!u) + below) / CYCLE) as f32
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 4_000_000;

    fn noise(stream: u64) -> Vec<f64> {
        let mut out = vec![0.0; N];
        Noise::new(7, stream).fill(0, &mut out);
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
    fn any_cut_gives_the_same_samples() {
        let noise = Noise::new(3, 2);
        for origin in [-37, 1 << 35] {
            let mut whole = vec![0.0; 500];
            noise.fill(origin, &mut whole);
            for (a, b) in [(0, 1), (1, 2), (3, 17), (4, 100), (99, 500), (7, 7)] {
                let mut part = vec![0.0; b - a];
                noise.fill(origin + a as i64, &mut part);
                assert_eq!(part, whole[a..b]);
            }
        }
    }
}
