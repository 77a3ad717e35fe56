//! The two passes.

use super::butterfly::Complex;
use super::short::{InPlace, Sink};
use super::spectrum::Narrow;
use super::{CodeSpectrum, Correlator, SampleSpectrum, Scratch, LANES};
use crate::simd::lanes::{self, Complex16, Kernel, Lanes};

impl Correlator {
    /// Adds the power of the correlation at each lag to a row.
    ///
    /// The samples' spectrum is moved down by `shift` points, at most the reach it was made for.
    /// Lag l of the p-th period goes to cell l + `offsets[p]`, modulo the period. The row has 16
    /// cells more than a period, which belong to the first 16.
    pub fn add_power(
        &self,
        samples: &SampleSpectrum,
        code: &CodeSpectrum,
        shift: i64,
        offsets: &[usize],
        row: &mut [f32],
        scratch: &mut Scratch,
    ) {
        for (lag, &t1) in scratch.lags.iter_mut().zip(self.rows.order()) {
            let t = t1 as usize * self.columns.size();
            let offset = offsets.get(t / self.period);
            *lag = offset.map(|offset| ((t + offset) % self.period) as u32);
        }
        let plan = self;
        lanes::run(
            self.level,
            AddPower {
                plan,
                samples,
                code,
                shift,
                row,
                scratch,
            },
        );
    }
}

struct AddPower<'a> {
    plan: &'a Correlator,
    samples: &'a SampleSpectrum,
    code: &'a CodeSpectrum,
    shift: i64,
    row: &'a mut [f32],
    scratch: &'a mut Scratch,
}

impl Kernel for AddPower<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        for block in 0..self.plan.rows.size() / LANES {
            self.first_pass::<L>(block);
        }
        for block in 0..self.plan.columns.size() / LANES {
            self.second_pass::<L>(block);
        }
    }
}

impl AddPower<'_> {
    /// Over f2, for sixteen f1.
    #[inline(always)]
    fn first_pass<L: Lanes>(&mut self, block: usize) {
        let (rows, columns) = (self.plan.rows.size(), self.plan.columns.size());
        let f1 = (block * LANES) as i64 + self.shift;
        let (samples, offset) = self.samples.column(f1, rows, columns);
        let code = self.code.column(block, columns);
        let Scratch { column, middle, .. } = &mut *self.scratch;
        product::<L>(samples, offset, code, column);
        self.plan.columns.run::<L>(column, &mut InPlace);

        let steps = &self.plan.steps[block * LANES..][..LANES];
        let starts = &self.plan.starts[block * columns / LANES..][..columns / LANES];
        let places = self.plan.places.chunks_exact(LANES);
        let middle = middle.chunks_exact_mut(self.plan.pitch());
        let mut tile = [Complex16::default(); LANES];
        for ((start, places), middle) in starts.iter().zip(places).zip(middle) {
            for i in 0..LANES {
                let from = &column[places[i] as usize];
                for lane in (0..LANES).step_by(L::N) {
                    let turn = Complex::<L>::load(start, lane).mul(Complex::load(&steps[i], lane));
                    let value = Complex::load(from, lane).mul(turn);
                    value.store(&mut tile[i], lane);
                }
            }
            if let Some(to) = middle[block * LANES..].first_chunk_mut() {
                L::transpose(&tile, to);
            }
        }
    }

    /// Over f1, for sixteen t2.
    #[inline(always)]
    fn second_pass<L: Lanes>(&mut self, block: usize) {
        let plan = self.plan;
        let Scratch { middle, lags, .. } = &mut *self.scratch;
        let values = &mut middle[block * plan.pitch()..][..plan.rows.size()];
        let mut sink = Power {
            row: self.row,
            lags,
            first: block * LANES,
            period: plan.period,
        };
        plan.rows.run::<L>(values, &mut sink);
    }
}

/// Adds the power of results to a row.
struct Power<'a> {
    row: &'a mut [f32],
    /// Lag of each place, to which `first` is added.
    lags: &'a [Option<u32>],
    first: usize,
    period: usize,
}

impl Sink for Power<'_> {
    #[inline(always)]
    fn put<L: Lanes>(&mut self, _: &mut Complex16, place: usize, lane: usize, value: Complex<L>) {
        let Some(lag) = self.lags[place] else { return };
        let lag = lag as usize + self.first;
        let lag = if lag < self.period {
            lag
        } else {
            lag - self.period
        };
        let cells = &mut self.row[lag + lane..];
        L::load(cells).add(value.power()).store(cells);
    }
}

/// Products of the two spectra.
#[inline(always)]
fn product<L: Lanes>(
    samples: &[Narrow<{ 2 * LANES }>],
    offset: usize,
    code: &[Narrow<LANES>],
    to: &mut [Complex16],
) {
    for ((to, code), samples) in to.iter_mut().zip(code).zip(samples) {
        for lane in (0..LANES).step_by(L::N) {
            let sample = Complex {
                re: L::load_i16(&samples.re[offset + lane..]),
                im: L::load_i16(&samples.im[offset + lane..]),
            };
            let code = Complex {
                re: L::load_i16(&code.re[lane..]),
                im: L::load_i16(&code.im[lane..]),
            };
            sample.mul(code).store(to, lane);
        }
    }
}
