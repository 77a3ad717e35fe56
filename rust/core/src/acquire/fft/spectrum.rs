//! Spectra as 16-bit integers, in the order in which the first pass reads them.
//!
//! The rounding noise is 77 dB below the spectrum; half of the memory traffic is saved, and
//! a misaligned row of samples does not straddle cache lines.

use num_complex::Complex32;

use super::{Correlator, LANES};

/// Spectrum of samples: for each sixteen f1, for each f2, these sixteen and the next, so that a
/// shift is an offset.
#[derive(Debug)]
pub(in super::super) struct SampleSpectrum {
    values: Vec<Narrow<{ 2 * LANES }>>,
    /// Values of f2 more at both ends.
    margin: usize,
}

/// Conjugate spectrum of a code: for each sixteen f1, for each f2.
#[derive(Debug)]
pub(in super::super) struct CodeSpectrum(Vec<Narrow<LANES>>);

/// Neighbours.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Narrow<const N: usize> {
    pub re: [i16; N],
    pub im: [i16; N],
}

impl<const N: usize> Narrow<N> {
    fn new(scale: f32, values: impl Fn(usize) -> Complex32) -> Self {
        let mut narrow = Narrow {
            re: [0; N],
            im: [0; N],
        };
        for i in 0..N {
            let value = values(i) * scale;
            (narrow.re[i], narrow.im[i]) = (round(value.re), round(value.im));
        }
        narrow
    }
}

/// Nearest integer, saturating.
fn round(value: f32) -> i16 {
    /// Adding this leaves a float rounded in the low bits of the mantissa.
    const ROUND: f32 = 12_582_912.0; // 1.5 * 2^23
    (value.clamp(-32_767.0, 32_767.0) + ROUND).to_bits() as i16
}

impl Correlator {
    /// Keeps a spectrum times `scale` for shifts of up to `reach` points, up or down.
    pub fn sample_spectrum(
        &self,
        spectrum: &[Complex32],
        reach: usize,
        scale: f32,
    ) -> SampleSpectrum {
        let (rows, size) = (self.rows.size(), self.size());
        let margin = reach.div_ceil(rows);
        let from = size - margin * rows;
        let mut values = Vec::with_capacity(size / LANES + 2 * margin * rows / LANES);
        for f1 in (0..rows).step_by(LANES) {
            for f2 in 0..self.columns.size() + 2 * margin {
                let at = from + f2 * rows + f1;
                values.push(Narrow::new(scale, |i| spectrum[(at + i) % size]));
            }
        }
        SampleSpectrum { values, margin }
    }

    /// Keeps the conjugate of a spectrum times `scale`.
    pub fn code_spectrum(&self, spectrum: &[Complex32], scale: f32) -> CodeSpectrum {
        let rows = self.rows.size();
        let mut values = Vec::with_capacity(self.size() / LANES);
        for f1 in (0..rows).step_by(LANES) {
            for f2 in 0..self.columns.size() {
                let from = &spectrum[f2 * rows + f1..][..LANES];
                values.push(Narrow::new(scale, |i| from[i].conj()));
            }
        }
        CodeSpectrum(values)
    }
}

impl SampleSpectrum {
    /// Sixteen f1 from `f1` on, less a shift, for each of `columns` f2: in the rows given, from
    /// the lane given on.
    #[inline(always)]
    pub(super) fn column(
        &self,
        f1: i64,
        rows: usize,
        columns: usize,
    ) -> (&[Narrow<{ 2 * LANES }>], usize) {
        let f1 = (f1 + (self.margin * rows) as i64) as usize;
        let height = columns + 2 * self.margin;
        let from = f1 % rows / LANES * height + f1 / rows;
        (&self.values[from..][..columns], f1 % LANES)
    }
}

impl CodeSpectrum {
    /// The `block`-th sixteen f1, for each of `columns` f2.
    #[inline(always)]
    pub(super) fn column(&self, block: usize, columns: usize) -> &[Narrow<LANES>] {
        &self.0[block * columns..][..columns]
    }
}
