//! Rows of the grid: all lags of one Doppler bin, and what is kept of them.

use super::estimate::{DELAY_REACH, WIDTH};
use super::fft::{CodeSpectrum, Correlator, Scratch, LANES};
use super::zone::{Common, Zone};
use crate::simd::lanes::{self, Kernel, Lanes};

/// Powers around a peak in one row.
pub(super) type Cells = [f64; WIDTH];

/// What is correlated with what.
#[derive(Clone, Copy)]
pub(super) struct Pair<'a> {
    pub common: &'a Common,
    pub plan: &'a Correlator,
    pub zone: &'a Zone,
    pub code: &'a CodeSpectrum,
}

/// Buffers of one worker.
pub(super) struct Worker {
    scratch: Scratch,
    row: Row,
    previous: Row,
}

/// All lags of one Doppler bin, at the start of a cache line, and [`LANES`] more cells.
struct Row {
    cells: Vec<f32>,
    start: usize,
}

impl Row {
    fn new(period: usize) -> Self {
        let cells = vec![0.0; period + 2 * LANES];
        let start = cells.as_ptr().align_offset(64) % LANES;
        Row { cells, start }
    }

    /// With the cells more.
    fn all(&mut self, period: usize) -> &mut [f32] {
        &mut self.cells[self.start..][..period + LANES]
    }

    fn lags(&self, period: usize) -> &[f32] {
        &self.cells[self.start..][..period]
    }
}

/// What is kept of some Doppler bins in a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Summary {
    /// Power of all cells.
    pub total: f64,
    /// Power of the largest cell.
    pub top: f32,
    /// Where it is.
    pub bin: i64,
    /// Where it is.
    pub lag: usize,
    /// Powers around it in the bins below, at and above it, where these were looked at.
    pub near: [Option<Cells>; 3],
}

impl Worker {
    pub fn new(plan: &Correlator, period: usize) -> Self {
        Worker {
            scratch: plan.scratch(),
            row: Row::new(period),
            previous: Row::new(period),
        }
    }

    /// Power of all blocks at every lag of one Doppler bin.
    pub fn fill_row(&mut self, pair: Pair<'_>, bin: i64) -> &[f32] {
        let Pair {
            common,
            plan,
            zone,
            code,
        } = pair;
        let shift = zone.shift(common, bin);
        let mut offsets = Vec::with_capacity(common.span);
        let row = self.row.all(common.period);
        row.fill(0.0);
        for (g, samples) in zone.spectra.iter().enumerate() {
            let blocks = g * common.span..((g + 1) * common.span).min(common.blocks);
            let offset = |k| -zone.drift(common, bin, k).round() as i64;
            offsets.clear();
            offsets.extend(blocks.map(|k| offset(k).rem_euclid(common.period as i64) as usize));
            plan.add_power(samples, code, shift, &offsets, row, &mut self.scratch);
        }
        let (row, wrapped) = row.split_at_mut(common.period);
        for (cell, more) in row.iter_mut().zip(wrapped) {
            *cell += *more;
        }
        row
    }

    /// Powers around a lag in one Doppler bin.
    pub fn cells(&mut self, pair: Pair<'_>, bin: i64, lag: usize) -> Cells {
        around(self.fill_row(pair, bin), lag)
    }

    /// Goes through the bins from `low` to `high`.
    pub fn summarise(&mut self, pair: Pair<'_>, low: i64, high: i64) -> Summary {
        let mut summary = Summary {
            total: 0.0,
            top: f32::NEG_INFINITY,
            bin: low,
            lag: 0,
            near: [None; 3],
        };
        for bin in low..=high {
            std::mem::swap(&mut self.row, &mut self.previous);
            self.fill_row(pair, bin);
            let row = self.row.lags(pair.common.period);
            let (total, top) = lanes::run(pair.plan.level(), Extent(row));
            summary.total += total;
            if bin == summary.bin + 1 {
                summary.near[2] = Some(around(row, summary.lag));
            }
            if top > summary.top {
                let lag = row.iter().position(|&p| p == top).unwrap_or(0);
                let below = self.previous.lags(pair.common.period);
                summary.near[0] = (bin > low).then(|| around(below, lag));
                summary.near[1] = Some(around(row, lag));
                summary.near[2] = None;
                (summary.top, summary.bin, summary.lag) = (top, bin, lag);
            }
        }
        summary
    }
}

impl Summary {
    /// Of both, of which `other` is further up.
    pub fn joined(self, other: Summary) -> Summary {
        let larger = if other.top > self.top { other } else { self };
        Summary {
            total: self.total + other.total,
            ..larger
        }
    }
}

fn around(row: &[f32], lag: usize) -> Cells {
    std::array::from_fn(|l| f64::from(row[(lag + row.len() + l - DELAY_REACH) % row.len()]))
}

/// Sum and largest of a row's powers.
struct Extent<'a>(&'a [f32]);

impl Kernel for Extent<'_> {
    type Output = (f64, f32);

    #[inline(always)]
    fn run<L: Lanes>(self) -> (f64, f32) {
        let mut total = 0.0;
        let mut largest = [0f32; LANES];
        for part in self.0.chunks(64 * LANES) {
            let mut sums = [0f32; LANES];
            for cells in part.chunks_exact(LANES) {
                for i in 0..LANES {
                    sums[i] += cells[i];
                    largest[i] = if cells[i] > largest[i] {
                        cells[i]
                    } else {
                        largest[i]
                    };
                }
            }
            total += sums.iter().map(|&s| f64::from(s)).sum::<f64>();
        }
        (total, largest.into_iter().fold(0.0, f32::max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Level;

    #[test]
    fn every_level_adds_up_a_row_the_same() {
        let row: Vec<f32> = (0..5120u32)
            .map(|i| (i.wrapping_mul(2_654_435_761) >> 8) as f32 * 1e-5)
            .collect();
        let exact: f64 = row.iter().map(|&p| f64::from(p)).sum();
        let largest = row.iter().copied().fold(0.0, f32::max);
        let extents = Level::available()
            .into_iter()
            .map(|level| lanes::run(level, Extent(&row)));
        let extents: Vec<(f64, f32)> = extents.collect();
        assert!((extents[0].0 / exact - 1.0).abs() < 1e-6);
        assert_eq!(extents[0].1, largest);
        assert!(extents.windows(2).all(|w| w[0] == w[1]));
    }
}
