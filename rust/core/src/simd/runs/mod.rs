//! Correlation by runs of equal chips: alternating sums over a band's running sums, turned by the
//! residual carrier.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

use std::sync::LazyLock;

use super::Level;
use crate::dsp::ring::{Geometry, Sum, LANES};

/// Edges that a kernel takes at a time.
pub(crate) const UNIT: usize = 8;
/// Fraction bits of code positions.
pub(crate) const FRACTION: u32 = 40;

const TURN_BITS: u32 = 9;
/// Amplitude of the turning phasor.
pub(crate) const TURN_AMPLITUDE: f64 = 16384.0;

/// cos and sin at the middle of each cell, scaled.
static TURN: LazyLock<[[i32; 2]; 1 << TURN_BITS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let angle = std::f64::consts::TAU * (i as f64 + 0.5) / f64::from(1 << TURN_BITS);
        let (s, c) = angle.sin_cos();
        [c, s].map(|v| (TURN_AMPLITUDE * v).round() as i32)
    })
});

/// Correlation of eight taps, 8 samples apart: real and imaginary parts.
pub(crate) type Sums = [[i64; LANES]; 2];

/// A stretch of a code on a band's running sums. Runs alternate in sign, the first counts plus.
pub(crate) struct Runs<'a> {
    pub(crate) cells: &'a [Sum],
    pub(crate) geometry: Geometry,
    /// Where runs begin, in sub-chips; the last edge ends the last run. 1 more than a multiple of
    /// the runs per turn.
    pub(crate) edges: &'a [u16],
    /// Position of sub-chip 0 after `base`, and sub-chip length, 2^-40 samples.
    pub(crate) fraction: u64,
    pub(crate) step: u64,
    /// Absolute sample from which positions count.
    pub(crate) base: u64,
    /// Only edges at most so many samples after `base` are there.
    pub(crate) limit: i64,
    /// Residual carrier at `base` and per sample, 2^-64 cycles.
    pub(crate) phase: u64,
    pub(crate) phase_step: u64,
    /// Runs that are summed before they are turned: 2, 4, or a multiple of [`UNIT`].
    pub(crate) runs_per_turn: usize,
}

impl Runs<'_> {
    /// First sample at or after an edge, counted from `base`.
    #[inline(always)]
    fn position(&self, edge: usize) -> u64 {
        let chips = u64::from(self.edges[edge]).wrapping_mul(self.step);
        self.rounding().wrapping_add(chips) >> FRACTION
    }

    /// What makes the shift round up.
    #[inline(always)]
    fn rounding(&self) -> u64 {
        self.fraction + (1 << FRACTION) - 1
    }

    /// Phasor at the middle of the samples from `first` to before `last`, counted from `base`.
    #[inline(always)]
    fn turn(&self, table: &[[i32; 2]; 1 << TURN_BITS], first: u64, last: u64) -> [i32; 2] {
        // Half a step times twice the middle.
        let half = (self.phase_step as i64 >> 1) as u64;
        let ahead = half.wrapping_mul(first.wrapping_add(last).wrapping_sub(1));
        table[(self.phase.wrapping_add(ahead) >> (64 - TURN_BITS)) as usize]
    }
}

/// Adds to `sums` what each group of taps, the first of which is `taps` samples late, correlates
/// to; as many whole turns as there are samples for. Returns the edges passed.
///
/// # Panics
/// If the runs are malformed.
pub(crate) fn correlate(level: Level, runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    runs.geometry.check(runs.cells.len());
    let per_turn = runs.runs_per_turn.max(UNIT);
    assert!(runs.edges.len() % per_turn == 1 && taps.len() == sums.len());
    assert!(matches!(runs.runs_per_turn, 2 | 4) || runs.runs_per_turn.is_multiple_of(UNIT));
    match level.lowered() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has a lowered level; shapes are checked above.
        Level::Avx512 => unsafe { avx512::correlate(runs, taps, sums) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Level::Avx2 => unsafe { avx2::correlate(runs, taps, sums) },
        _ => portable::correlate(runs, taps, sums),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::ring::Ring;

    fn lanes([re, im]: &mut Sums) -> impl Iterator<Item = (usize, (&mut i64, &mut i64))> {
        re.iter_mut().zip(im).enumerate()
    }

    /// By the definition: every run by itself, every tap by itself.
    fn slow(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
        let mut done = 0;
        while done + 1 < runs.edges.len() {
            let to = done + runs.runs_per_turn.max(UNIT);
            if runs.position(to) as i64 > runs.limit {
                break;
            }
            for first in (done..to).step_by(runs.runs_per_turn) {
                let last = first + runs.runs_per_turn;
                let [c, s] = runs.turn(&TURN, runs.position(first), runs.position(last));
                for (tap, sums) in taps.iter().zip(&mut *sums) {
                    for (lane, (re, im)) in lanes(sums) {
                        let at = |edge: usize| {
                            let k = runs.base.wrapping_add(runs.position(edge));
                            let k = k.wrapping_add_signed(tap + (lane * LANES) as i64);
                            runs.cells[runs.geometry.cell(k)]
                        };
                        let mut total = [0i32; 2];
                        for run in first..last {
                            let (a, b) = (at(run), at(run + 1));
                            for k in 0..2 {
                                let d = b[k].wrapping_sub(a[k]);
                                total[k] = if run % 2 == 0 {
                                    total[k].wrapping_add(d)
                                } else {
                                    total[k].wrapping_sub(d)
                                };
                            }
                        }
                        let [i, q] = total.map(i64::from);
                        let (c, s) = (i64::from(c), i64::from(s));
                        *re += i * c + q * s;
                        *im += q * c - i * s;
                    }
                }
            }
            done = to;
        }
        done
    }

    #[test]
    fn every_level_sums_what_the_definition_says() {
        let mut ring = Ring::new(1 << 13);
        let mut z = 1u64;
        let mut random = || {
            z = z.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(99);
            (z >> 33) as u32
        };
        for k in 0..ring.capacity() as u64 {
            // Any 32 bits: the sums wrap.
            ring.store(k, [random() as i32, (random() << 1) as i32]);
        }
        let edges: Vec<u16> = std::iter::once(0)
            .chain((0..128).scan(0u16, |at, _| {
                *at += (random() % 4) as u16;
                Some(*at)
            }))
            .collect();
        for runs_per_turn in [2, 4, 8, 16, 64] {
            for (taps, limit) in [
                (vec![-16], 9999),
                (vec![-24, 3, -700], 2500),
                (vec![5; 7], 9999),
            ] {
                let runs = Runs {
                    cells: ring.cells(),
                    geometry: ring.geometry(),
                    edges: &edges,
                    fraction: 0x5a_1234_5678,
                    step: (13.7 * (1u64 << FRACTION) as f64) as u64,
                    base: (1 << 40) + 8000,
                    limit,
                    phase: 0x89ab_cdef_0123_4567,
                    phase_step: 0x0001_2345_6789_abcd_u64.wrapping_neg(),
                    runs_per_turn,
                };
                let mut expected = vec![[[3; LANES]; 2]; taps.len()];
                let done = slow(&runs, &taps, &mut expected);
                assert!(done > 0 && (done == 128) == (limit == 9999));
                for level in Level::available() {
                    let mut sums = vec![[[3; LANES]; 2]; taps.len()];
                    let passed = correlate(level, &runs, &taps, &mut sums);
                    assert_eq!(passed, done, "{level:?} {runs_per_turn} {taps:?}");
                    assert_eq!(sums, expected, "{level:?} {runs_per_turn} {taps:?}");
                }
            }
        }
    }
}
