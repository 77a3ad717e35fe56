//! Plain loops.
//!
//! Bytes are mixed with both parts of the oscillator in one multiplication: a word holds I in its
//! low half and Q in its high half. That is exact as long as the low half does not wrap, which the
//! sums of a block can only do when they begin near its ends.

use std::sync::LazyLock;

use super::{Blocks, ROWS};
use crate::dsp::band::{Layout, Samples};
use crate::dsp::oscillator::{CELLS, WAVE};
use crate::dsp::ring::{Sum, Total, BLOCK, LANES};

/// Farther than the sums of a block can move.
const MARGIN: u32 = 1 << 23;

pub(super) fn absorb(blocks: &Blocks<'_>, cells: &mut [Sum], total: &mut Total) {
    absorb_inline(blocks, cells, total);
}

/// The same for every level that has no form of its own.
#[inline(always)]
pub(super) fn absorb_inline(blocks: &Blocks<'_>, cells: &mut [Sum], total: &mut Total) {
    let layout = blocks.layout;
    let width = layout.width();
    let mut oscillator = blocks.first;
    let mut planes = planes(cells, blocks.geometry.stride, blocks.row);
    for block in 0..blocks.count() {
        let start = oscillator.start();
        // By itself, this loop is vectorised.
        let mut phases = [0u8; BLOCK];
        for (phase, &place) in phases.iter_mut().zip(&blocks.oscillator.places) {
            *phase = (start.wrapping_add(place) >> 8) as u8;
        }
        let oscillator_cells = || phases.iter().map(|&phase| usize::from(phase) % CELLS);
        let row = block * ROWS;
        let values = block * BLOCK * width..(block + 1) * BLOCK * width;
        let mut sum = total.sum();
        match blocks.samples {
            Samples::Int8(bytes) if (MARGIN..u32::MAX - MARGIN).contains(&(sum[0] as u32)) => {
                let bytes = &bytes[values];
                if layout.complex {
                    let [of_i, of_q] = words(layout);
                    let pairs = bytes.chunks_exact(2).zip(oscillator_cells());
                    let product = |(v, cell): (&[u8], usize)| {
                        times(v[0], of_i[cell]).wrapping_add(times(v[1], of_q[cell]))
                    };
                    add_words(pairs.map(product), &mut planes, row, &mut sum);
                } else {
                    let [table, _] = words(layout);
                    let values = bytes.iter().zip(oscillator_cells());
                    let product = |(&v, cell): (&u8, usize)| times(v, table[cell]);
                    add_words(values.map(product), &mut planes, row, &mut sum);
                }
                *total = sum.into();
            }
            // One loop for each kind of sample, so that nothing is decided inside.
            Samples::Int8(bytes) => {
                let samples = Samples::Int8(&bytes[values]);
                add_mixed(samples, layout, oscillator_cells(), &mut planes, row, total);
            }
            Samples::Int16(words) => {
                let samples = Samples::Int16(&words[values]);
                add_mixed(samples, layout, oscillator_cells(), &mut planes, row, total);
            }
        }
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

/// (Q << 32) + I: what I and Q of a sample are multiplied with, for each cell.
fn words(layout: Layout) -> &'static [[u64; CELLS]; 2] {
    static WORDS: LazyLock<[[[u64; CELLS]; 2]; 2]> = LazyLock::new(|| {
        [false, true].map(|conjugate| {
            let layout = Layout {
                complex: true,
                conjugate,
            };
            [(1, 0), (0, 1)].map(|(i, q)| {
                WAVE.map(|wave| {
                    let [re, im] = layout.mix(i, q, wave);
                    ((im as u64) << 32).wrapping_add(re as u64)
                })
            })
        })
    });
    &WORDS[usize::from(layout.conjugate)]
}

#[inline(always)]
fn times(value: u8, word: u64) -> u64 {
    (i64::from(value as i8) as u64).wrapping_mul(word)
}

/// Sums products that are words; I of the sum must be a margin away from wrapping.
#[inline(always)]
fn add_words(
    mut products: impl Iterator<Item = u64>,
    planes: &mut [&mut [Sum]; LANES],
    row: usize,
    sum: &mut Sum,
) {
    let mut total = (u64::from(sum[1] as u32) << 32) | u64::from(sum[0] as u32);
    let halves = |word: u64| [word as i32, (word >> 32) as i32];
    for row in row..row + ROWS {
        for plane in planes.iter_mut() {
            plane[row] = halves(total);
            total = total.wrapping_add(products.next().unwrap_or(0));
        }
    }
    *sum = halves(total);
}

/// Sums products part by part.
#[inline(always)]
fn add_mixed(
    samples: Samples<'_>,
    layout: Layout,
    cells: impl Iterator<Item = usize>,
    planes: &mut [&mut [Sum]; LANES],
    row: usize,
    total: &mut Total,
) {
    let mut mixed = [[0i32; 2]; BLOCK];
    for (k, (m, cell)) in mixed.iter_mut().zip(cells).enumerate() {
        *m = samples.mixed(k, layout, WAVE[cell]);
    }
    for (r, eight) in mixed.chunks_exact(LANES).enumerate() {
        for (plane, m) in planes.iter_mut().zip(eight) {
            plane[row + r] = total.sum();
            total.add(*m);
        }
    }
}
