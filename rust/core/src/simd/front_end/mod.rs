//! Front ends: whole blocks of samples, mixed and summed into a band's ring.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

use super::Level;
use crate::dsp::band::{Layout, Samples};
use crate::dsp::oscillator::{Block, Oscillator};
use crate::dsp::ring::{Geometry, Sum, Total, BLOCK, LANES};

/// Rows that a block fills.
const ROWS: usize = BLOCK / LANES;

/// Whole blocks of samples, and where their sums go.
pub(crate) struct Blocks<'a> {
    pub(crate) samples: Samples<'a>,
    pub(crate) layout: Layout,
    pub(crate) oscillator: &'a Oscillator,
    pub(crate) first: Block,
    pub(crate) geometry: Geometry,
    /// Row of the first sample.
    pub(crate) row: usize,
}

impl Blocks<'_> {
    fn count(&self) -> usize {
        let values = match self.samples {
            Samples::Int8(v) => v.len(),
            Samples::Int16(v) => v.len(),
        };
        values / self.layout.width() / BLOCK
    }
}

/// Stores the sum before each sample, and leaves the total after the last in `total`.
///
/// # Panics
/// If the blocks do not fit behind `row`.
pub(crate) fn absorb(level: Level, blocks: &Blocks<'_>, cells: &mut [Sum], total: &mut Total) {
    blocks.geometry.check(cells.len());
    let room = blocks.geometry.rows.checked_sub(blocks.row);
    assert!(
        room.is_some_and(|rows| blocks.count() <= rows / ROWS),
        "blocks beyond the end of a ring"
    );
    match level.lowered() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has a lowered level; shapes are checked above.
        Level::Avx512 => unsafe { avx512::absorb(blocks, cells, total) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Level::Avx2 => unsafe { avx2::absorb(blocks, cells, total) },
        _ => portable::absorb(blocks, cells, total),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::oscillator::WAVE;
    use crate::dsp::ring::Ring;

    /// First sample of a block.
    const FIRST: u64 = 0x1234_5678_9a80;

    fn bytes(count: usize) -> Vec<u8> {
        let mut z = 12345u32;
        (0..count)
            .map(|k| {
                z = z.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                // Full scale, saturated samples among them.
                if k % 37 < 5 {
                    0x80
                } else {
                    (z >> 24) as u8
                }
            })
            .collect()
    }

    /// Sum before each sample by the definition, one sample at a time.
    fn slow(blocks: &Blocks<'_>, mut total: Total) -> Vec<Sum> {
        let mut sums = Vec::new();
        for k in 0..blocks.count() * BLOCK {
            sums.push(total.sum());
            let block = blocks.oscillator.block(FIRST + k as u64);
            let cell = blocks.oscillator.cell(block.start(), k % BLOCK);
            total.add(blocks.samples.mixed(k, blocks.layout, WAVE[cell]));
        }
        sums.push(total.sum());
        sums
    }

    #[test]
    fn every_level_and_format_sums_what_the_definition_says() {
        // Sums that begin near the ends of their range, and in its middle.
        for start in [[i32::MAX - 1000, i32::MIN + 77], [-1, 0], [i32::MIN, 5]] {
            check(Total::from(start));
        }
    }

    fn check(start: Total) {
        let raw = bytes(2 * 2 * 24 * BLOCK);
        let wide: Vec<i16> = raw
            .chunks_exact(2)
            .map(|b| i16::from_le_bytes([b[0], b[1]]))
            .collect();
        for (complex, conjugate) in [(false, false), (true, false), (true, true)] {
            let layout = Layout { complex, conjugate };
            let values = 24 * BLOCK * layout.width();
            for samples in [
                Samples::Int8(&raw[..values]),
                Samples::Int16(&wide[..values]),
            ] {
                for level in Level::available() {
                    let mut ring = Ring::new(1 << 13);
                    let oscillator = Oscillator::new(0x3123_4567_89ab_cdef, 77, 0xfedc_ba98 << 32);
                    let blocks = Blocks {
                        samples,
                        layout,
                        oscillator: &oscillator,
                        first: oscillator.block(FIRST),
                        geometry: ring.geometry(),
                        row: 3 * ROWS,
                    };
                    let mut total = start;
                    absorb(level, &blocks, ring.cells_mut(), &mut total);
                    let expected = slow(&blocks, start);
                    for (k, e) in expected[..24 * BLOCK].iter().enumerate() {
                        let cell = ring.geometry().cell((3 * BLOCK + k) as u64);
                        assert_eq!(ring.cells()[cell], *e, "{level:?} {layout:?} sample {k}");
                    }
                    assert_eq!(total.sum(), expected[24 * BLOCK], "{level:?} {layout:?}");
                }
            }
        }
    }
}
