//! The sine table, and the mixing of a band to its intermediate frequency.

use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Integer value of one standard deviation of the noise in the bands' sums.
pub(super) const UNIT: f64 = (1u64 << 20) as f64;

const BITS: u32 = 11;
const LEN: usize = 1 << BITS;

static TABLE: LazyLock<Box<[[f32; 2]; LEN]>> = LazyLock::new(|| {
    let mut table = Box::new([[0.0; 2]; LEN]);
    for (k, entry) in table.iter_mut().enumerate() {
        let (sin, cos) = (k as f64 / LEN as f64 * TAU).sin_cos();
        *entry = [cos as f32, sin as f32];
    }
    table
});

/// Table index nearest to a phase.
#[inline(always)]
fn nearest(phase: u64) -> usize {
    (phase.wrapping_add(1 << (63 - BITS)) >> (64 - BITS)) as usize
}

/// exp(j 2 pi phase), phase in 2^-64 cycles; error below 2e-6 (first-order interpolation).
#[inline]
pub(super) fn phasor(phase: u64) -> [f32; 2] {
    let k = nearest(phase);
    let rest = phase.wrapping_sub((k as u64) << (64 - BITS)) as i64;
    let angle = (rest as f64 * (TAU / 18_446_744_073_709_551_616.0)) as f32;
    let [c, s] = TABLE[k];
    [c - s * angle, s + c * angle]
}

/// Takes the running sum of a difference array, mixes it with exp(j 2 pi phase) and adds it to
/// `re` (and `im`, unless empty). The array is zero afterwards.
///
/// Phases are those nearest in a table of 2048: spurs 60 dB below the (already weak) signals.
pub(super) fn mix(diff: &mut [i64], phase: u64, step: u64, re: &mut [f32], im: &mut [f32]) {
    let table = &**TABLE;
    let mut sum = 0i64;
    let mut phase = phase;
    let mut next = |d: &mut i64| {
        sum = sum.wrapping_add(std::mem::take(d));
        let i = sum as i32;
        let q = (sum.wrapping_sub(i64::from(i)) >> 32) as i32;
        let wave = table[nearest(phase)];
        phase = phase.wrapping_add(step);
        (
            i as f32 * (1.0 / UNIT as f32),
            q as f32 * (1.0 / UNIT as f32),
            wave,
        )
    };
    if im.is_empty() {
        for (d, re) in diff.iter_mut().zip(re) {
            let (i, q, [c, s]) = next(d);
            *re += i * c - q * s;
        }
    } else {
        for ((d, re), im) in diff.iter_mut().zip(re).zip(im) {
            let (i, q, [c, s]) = next(d);
            *re += i * c - q * s;
            *im += i * s + q * c;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nco::phase_from_cycles;

    #[test]
    fn phasor_is_accurate() {
        for k in 0..10_000 {
            let cycles = f64::from(k) * 0.000_237_1;
            let (s, c) = (cycles * TAU).sin_cos();
            let [re, im] = phasor(phase_from_cycles(cycles));
            assert!((f64::from(re) - c).abs() < 2e-6 && (f64::from(im) - s).abs() < 2e-6);
        }
    }
}
