//! Plain loops; the compiler vectorises the mixing where the level allows.

use super::{Blocks, ROWS};
use crate::dsp::band::Samples;
use crate::dsp::oscillator::WAVE;
use crate::dsp::ring::{Sum, BLOCK, LANES};

pub(super) fn absorb(blocks: &Blocks<'_>, cells: &mut [Sum], sum: &mut Sum) {
    absorb_inline(blocks, cells, sum);
}

/// The same for every level that has no form of its own.
#[inline(always)]
pub(super) fn absorb_inline(blocks: &Blocks<'_>, cells: &mut [Sum], sum: &mut Sum) {
    let width = blocks.layout.width();
    let mut oscillator = blocks.first;
    let mut planes = planes(cells, blocks.geometry.stride, blocks.row);
    for block in 0..blocks.count() {
        let mut waves = [[0i32; 2]; BLOCK];
        let start = oscillator.start();
        for (k, wave) in waves.iter_mut().enumerate() {
            *wave = WAVE[blocks.oscillator.cell(start, k)];
        }
        let mut mixed = [[0i32; 2]; BLOCK];
        let values = block * BLOCK * width..(block + 1) * BLOCK * width;
        // One loop for each kind of sample, so that nothing is decided inside.
        match blocks.samples {
            Samples::Int8(v) => mix(Samples::Int8(&v[values]), blocks, &waves, &mut mixed),
            Samples::Int16(v) => mix(Samples::Int16(&v[values]), blocks, &waves, &mut mixed),
        }
        let mut total = *sum;
        for row in 0..ROWS {
            for (plane, m) in planes.iter_mut().zip(&mixed[row * LANES..]) {
                plane[block * ROWS + row] = total;
                total = [total[0].wrapping_add(m[0]), total[1].wrapping_add(m[1])];
            }
        }
        *sum = total;
        oscillator = oscillator.next();
    }
}

/// The planes from a row on.
#[inline(always)]
fn planes(cells: &mut [Sum], stride: usize, row: usize) -> [&mut [Sum]; LANES] {
    let mut rest = cells;
    std::array::from_fn(|_| {
        let (plane, after) = std::mem::take(&mut rest).split_at_mut(stride);
        rest = after;
        &mut plane[row..]
    })
}

#[inline(always)]
fn mix(
    samples: Samples<'_>,
    blocks: &Blocks<'_>,
    waves: &[[i32; 2]; BLOCK],
    mixed: &mut [Sum; BLOCK],
) {
    for (k, (m, wave)) in mixed.iter_mut().zip(waves).enumerate() {
        *m = samples.mixed(k, blocks.layout, *wave);
    }
}
