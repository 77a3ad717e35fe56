//! The local oscillator of a band: fixed point, defined by the absolute sample index alone.
//!
//! A phase has 128 cells. The cell of a sample comes from 15-bit phases, that of the first sample
//! of its block of 128 plus that of its place in the block, so that a vector unit can add them in
//! 16 bits and every form of the front end finds the same cell. What lies between two cells goes
//! to either in proportion, by a dither from block to block: without it a frequency of a simple
//! ratio to the sample rate would always find the same cells, and be off by up to half of one.

use std::sync::LazyLock;

use super::ring::BLOCK;

/// Amplitude of the oscillator.
pub(crate) const AMPLITUDE: i32 = 127;
/// Cells of a cycle.
pub(crate) const CELLS: usize = 128;

/// cos at each cell; -sin is a quarter of a cycle further on.
pub(crate) static COSINE: LazyLock<[i8; CELLS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let angle = std::f64::consts::TAU * i as f64 / CELLS as f64;
        (f64::from(AMPLITUDE) * angle.cos()).round() as i8
    })
});

/// A quarter of a cycle in cells.
pub(crate) const QUARTER: usize = CELLS / 4;

/// exp(-j 2 pi phase) at each cell, scaled.
pub(crate) static WAVE: LazyLock<[[i32; 2]; CELLS]> = LazyLock::new(|| {
    let cosine = |i: usize| i32::from(COSINE[i % CELLS]);
    std::array::from_fn(|i| [cosine(i), cosine(i + QUARTER)])
});

/// The oscillator at the first sample of a block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    phase: u64,
    /// Per block.
    step: u64,
    number: u64,
}

impl Block {
    /// Dithered 15-bit phase. The dither is below one cell, and as even as can be over any few
    /// blocks (multiples of the golden ratio).
    #[inline(always)]
    pub(crate) fn start(self) -> u16 {
        let dither = self.number.wrapping_mul(159) & 0xff;
        ((self.phase >> 49) as u16).wrapping_add(dither as u16)
    }

    /// The next block.
    #[inline(always)]
    pub(crate) fn next(self) -> Self {
        Block {
            phase: self.phase.wrapping_add(self.step),
            number: self.number.wrapping_add(1),
            ..self
        }
    }
}

/// A number for each place in a block, aligned for vector units.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
pub(crate) struct Places(pub(crate) [i8; BLOCK]);

/// An oscillator of constant frequency.
#[derive(Debug, Clone)]
pub(crate) struct Oscillator {
    /// Phase per sample, 2^-64 cycles.
    step: u64,
    /// Sample at which `phase` holds.
    origin: u64,
    phase: u64,
    /// 15-bit phase of each place in a block.
    pub(crate) places: [u16; BLOCK],
    /// What these have beyond whole cells, less half a cell so that it is a signed byte.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    pub(crate) fractions: Places,
    /// For processors that cannot look up 128 cells at once: cos at each place of a block, for
    /// each cell that its first sample may have. Where the fractions of block and place make up a
    /// cell, the next row holds.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    pub(crate) waves: Box<[Places; CELLS]>,
}

impl Oscillator {
    /// An oscillator with the given phase (2^-64 cycles) at sample `origin`.
    pub(crate) fn new(step: u64, origin: u64, phase: u64) -> Self {
        let places = std::array::from_fn(|k| (step.wrapping_mul(k as u64) >> 49) as u16);
        let cells = places.map(|place| usize::from(place >> 8));
        let cosine = &*COSINE;
        let wave = |first| Places(cells.map(|cell| cosine[(first + cell) % CELLS]));
        Oscillator {
            step,
            origin,
            phase,
            places,
            fractions: Places(places.map(|place| (place as u8 ^ 0x80) as i8)),
            waves: Box::new(std::array::from_fn(wave)),
        }
    }

    /// Phase at a sample, 2^-64 cycles.
    pub(crate) fn phase(&self, sample: u64) -> u64 {
        let ahead = sample.wrapping_sub(self.origin);
        self.phase.wrapping_add(self.step.wrapping_mul(ahead))
    }

    /// The block that `sample` is in.
    pub(crate) fn block(&self, sample: u64) -> Block {
        Block {
            phase: self.phase(sample & !(BLOCK as u64 - 1)),
            step: self.step.wrapping_mul(BLOCK as u64),
            number: sample / BLOCK as u64,
        }
    }

    /// Cell of a sample, from its block's [`Block::start`].
    #[inline(always)]
    pub(crate) fn cell(&self, block: u16, place: usize) -> usize {
        (block.wrapping_add(self.places[place]) >> 8) as usize & (CELLS - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_waves_and_fractions_are_cells() {
        let oscillator = Oscillator::new(0x3123_4567_89ab_cdef, 0, 0);
        for start in 0..=u16::MAX {
            let most = (!start as u8 ^ 0x80) as i8;
            for place in 0..BLOCK {
                let carry = usize::from(oscillator.fractions.0[place] > most);
                let row = (usize::from(start >> 8) + carry) % CELLS;
                let cell = oscillator.cell(start, place);
                assert_eq!(oscillator.waves[row].0[place], COSINE[cell]);
            }
        }
    }
}
