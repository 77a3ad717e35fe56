//! The inner loop of the search: spectrum times code spectrum, transformed, power added up.
//!
//! N = `rows` * `columns` points are transformed in two passes (W. M. Gentleman, G. Sande, "Fast
//! Fourier transforms for fun and profit", 1966). With f = f1 + rows f2, t = t2 + columns t1 and
//! w_n = exp(2 pi j / n),
//!
//! ```text
//! x[t] = sum over f1 of w_rows^(f1 t1) w_N^(f1 t2)  sum over f2 of w_columns^(f2 t2) X[f]
//! ```
//!
//! The first pass takes sixteen neighbouring f1 at a time, one a lane, multiplies the two spectra
//! on the way in and turns lanes from f1 to t2 on the way out; the second takes sixteen
//! neighbouring t2 and adds the power of its results to the row of lags. Nothing of size N is
//! written but what goes from pass to pass.

mod add_power;
mod butterfly;
mod short;
mod spectrum;

use std::f64::consts::TAU;

use crate::simd::lanes::Complex16;
use crate::simd::Level;
use crate::{Error, Result};
use short::ShortFft;
pub(super) use spectrum::{CodeSpectrum, SampleSpectrum};

/// Width of the transforms.
pub(super) const LANES: usize = 16;

/// So many numbers of the first pass fit into a first-level cache, 32 KB.
const MAX_COLUMNS: usize = 256;

/// Plan of the correlation of `span` + 1 periods of samples with one period of code.
#[derive(Debug)]
pub(super) struct Correlator {
    level: Level,
    period: usize,
    span: usize,
    /// Over f2.
    columns: ShortFft,
    /// Over f1.
    rows: ShortFft,
    /// Where the first pass leaves each t2.
    places: Vec<u32>,
    /// At f1, with i = f1 mod 16: turns by (f1 - i + lane) i / N cycles.
    steps: Vec<Complex16>,
    /// For each sixteenth f1, for each sixteenth t2: turns by (f1 + lane) t2 / N cycles.
    starts: Vec<Complex16>,
}

/// Buffers of one worker.
#[derive(Debug)]
pub(super) struct Scratch {
    column: Vec<Complex16>,
    /// Results of the first pass: for each sixteenth t2, `pitch` numbers, those of f1 first.
    middle: Vec<Complex16>,
    /// Lag at t2 = 0 of each place that the second pass leaves a result at; none where no lag
    /// is wanted.
    lags: Vec<Option<u32>>,
}

impl Correlator {
    /// Plans for a code of `period` samples.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a size that has other factors than 2, 3 and 5, or too few.
    pub fn new(level: Level, period: usize, span: usize) -> Result<Self> {
        let size = (span + 1) * period;
        let columns = (LANES..=MAX_COLUMNS)
            .step_by(LANES)
            .filter(|c| period.is_multiple_of(*c) && (size / c).is_multiple_of(LANES))
            .min_by_key(|c| c.abs_diff(size / c))
            .ok_or_else(|| Error::Invalid(format!("cannot plan a search of {size} points")))?;
        let (columns, rows) = (ShortFft::new(columns)?, ShortFft::new(size / columns)?);
        let turns = |f1: usize, t2: usize| {
            let turn = |lane: usize| (TAU * ((f1 + lane) * t2) as f64 / size as f64).sin_cos();
            let turns: [(f64, f64); LANES] = std::array::from_fn(turn);
            Complex16 {
                re: turns.map(|t| t.1 as f32),
                im: turns.map(|t| t.0 as f32),
            }
        };
        let (mut steps, mut starts) = (Vec::new(), Vec::new());
        for f1 in (0..rows.size()).step_by(LANES) {
            steps.extend((0..LANES).map(|i| turns(f1, i)));
            starts.extend((0..columns.size()).step_by(LANES).map(|t2| turns(f1, t2)));
        }
        Ok(Correlator {
            level,
            period,
            span,
            places: columns.places(),
            columns,
            rows,
            steps,
            starts,
        })
    }

    /// Instructions that its kernels use.
    pub fn level(&self) -> Level {
        self.level
    }

    /// Points of the transform.
    pub fn size(&self) -> usize {
        (self.span + 1) * self.period
    }

    /// Buffers for one worker.
    pub fn scratch(&self) -> Scratch {
        let blocks = self.columns.size() / LANES;
        Scratch {
            column: vec![Complex16::default(); self.columns.size()],
            middle: vec![Complex16::default(); blocks * self.pitch()],
            lags: vec![None; self.rows.size()],
        }
    }

    /// Distance of two blocks of the intermediate results; odd, lest they share cache sets.
    fn pitch(&self) -> usize {
        self.rows.size() + 1
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex32;
    use rustfft::FftPlanner;

    use super::*;

    /// Reproducible numbers of about unit size.
    fn numbers(count: usize, seed: u32) -> Vec<Complex32> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1u32 << 23) as f32 - 1.0
        };
        (0..count).map(|_| Complex32::new(next(), next())).collect()
    }

    /// Shift, periods wanted and their offsets.
    const CASES: [(i64, &[usize]); 4] = [
        (0, &[0, 0, 0]),
        (7, &[5, 1]),
        (-300, &[2047, 3, 17]),
        (299, &[1]),
    ];

    fn row(plan: &Correlator, spectra: &[Vec<Complex32>; 2], case: (i64, &[usize])) -> Vec<f32> {
        let samples = plan.sample_spectrum(&spectra[0], 300, 1000.0);
        let code = plan.code_spectrum(&spectra[1], 1000.0);
        let mut row = vec![1.0; plan.period + LANES];
        plan.add_power(
            &samples,
            &code,
            case.0,
            case.1,
            &mut row,
            &mut plan.scratch(),
        );
        row
    }

    /// The same from a library transform.
    fn expected(
        plan: &Correlator,
        spectra: &[Vec<Complex32>; 2],
        case: (i64, &[usize]),
    ) -> Vec<f32> {
        let size = plan.size() as i64;
        let product = |f: i64| {
            let shifted = (f + case.0).rem_euclid(size) as usize;
            spectra[0][shifted] * spectra[1][f as usize].conj() * 1e6
        };
        let mut lags: Vec<Complex32> = (0..size).map(product).collect();
        FftPlanner::new()
            .plan_fft_inverse(plan.size())
            .process(&mut lags);
        let mut row = vec![1.0; plan.period];
        for (p, offset) in case.1.iter().enumerate() {
            for l in 0..plan.period {
                row[(l + offset) % plan.period] += lags[p * plan.period + l].norm_sqr();
            }
        }
        row
    }

    #[test]
    fn power_is_that_of_a_library_transform() {
        for (period, span) in [(2048, 3), (4096, 5), (5120, 5), (2048, 1)] {
            let plan = Correlator::new(Level::best(), period, span).unwrap();
            let spectra = [numbers(plan.size(), 1), numbers(plan.size(), 2)];
            for case in CASES.into_iter().filter(|c| c.1.len() <= span) {
                let mut got = row(&plan, &spectra, case);
                for i in 0..LANES {
                    got[i] += got[period + i] - 1.0;
                }
                let want = expected(&plan, &spectra, case);
                let mean = want.iter().sum::<f32>() / period as f32;
                for (g, w) in got.iter().zip(&want) {
                    assert!(
                        (g - w).abs() < 0.01 * mean,
                        "{period} {span} {case:?} {g} {w}"
                    );
                }
            }
        }
    }

    #[test]
    fn every_level_gives_the_same_bits() {
        for (period, span) in [(2048, 3), (5120, 5)] {
            let rows = Level::available().into_iter().map(|level| {
                let plan = Correlator::new(level, period, span).unwrap();
                row(
                    &plan,
                    &[numbers(plan.size(), 1), numbers(plan.size(), 2)],
                    CASES[2],
                )
            });
            let rows: Vec<Vec<f32>> = rows.collect();
            assert!(rows.windows(2).all(|w| w[0] == w[1]));
        }
    }
}
