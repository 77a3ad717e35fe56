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
        let mut each = planes.iter_mut();
        let mut rows = std::array::from_fn(|_| &mut each.next().unwrap()[block]);
        let values = block * BLOCK * width..(block + 1) * BLOCK * width;
        let sum = total.sum();
        match blocks.samples {
            Samples::Int8(bytes) if (MARGIN..u32::MAX - MARGIN).contains(&(sum[0] as u32)) => {
                let [of_i, of_q] = words(layout);
                let bytes = &bytes[values];
                let sum = if layout.complex {
                    add_words(bytes, &phases, &mut rows, sum, |&[i, q], phase| {
                        times(i, of_i[phase]).wrapping_add(times(q, of_q[phase]))
                    })
                } else {
                    add_words(bytes, &phases, &mut rows, sum, |&[x], phase| {
                        times(x, of_i[phase])
                    })
                };
                *total = sum.into();
            }
            // One loop for each kind of sample, so that nothing is decided inside.
            Samples::Int8(bytes) => {
                let samples = Samples::Int8(&bytes[values]);
                add_mixed(samples, layout, &phases, &mut rows, total);
            }
            Samples::Int16(words) => {
                let samples = Samples::Int16(&words[values]);
                add_mixed(samples, layout, &phases, &mut rows, total);
            }
        }
        oscillator = oscillator.next();
    }
}

/// A block's rows of each plane.
type Rows<'a> = [&'a mut [Sum; ROWS]; LANES];

/// The planes by blocks, from a row on.
#[inline(always)]
fn planes(cells: &mut [Sum], stride: usize, row: usize) -> [&mut [[Sum; ROWS]]; LANES] {
    let mut planes = cells.chunks_exact_mut(stride);
    std::array::from_fn(|_| {
        let plane = planes.next().map(|plane| &mut plane[row..]);
        plane.unwrap_or_default().as_chunks_mut().0
    })
}

/// Bytes of a phase: its cell, and a bit above it that has no meaning.
const PHASES: usize = 2 * CELLS;

/// (Q << 32) + I: what I and Q of a sample are multiplied with, for each byte of phase.
fn words(layout: Layout) -> &'static [[u64; PHASES]; 2] {
    static WORDS: LazyLock<[[[u64; PHASES]; 2]; 2]> = LazyLock::new(|| {
        [false, true].map(|conjugate| {
            let layout = Layout {
                complex: true,
                conjugate,
            };
            [(1, 0), (0, 1)].map(|(i, q)| {
                std::array::from_fn(|phase| {
                    let [re, im] = layout.mix(i, q, WAVE[phase % CELLS]);
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

/// Sums the products of a block's samples, which are words; I of the sum must be a margin away
/// from wrapping.
#[inline(always)]
fn add_words<const WIDTH: usize>(
    bytes: &[u8],
    phases: &[u8; BLOCK],
    rows: &mut Rows<'_>,
    sum: Sum,
    product: impl Fn(&[u8; WIDTH], usize) -> u64,
) -> Sum {
    let mut total = (u64::from(sum[1] as u32) << 32) | u64::from(sum[0] as u32);
    let halves = |word: u64| [word as i32, (word >> 32) as i32];
    let samples: &[[u8; WIDTH]; BLOCK] = bytes.as_chunks().0.first_chunk().unwrap();
    for row in 0..ROWS {
        for (lane, plane) in rows.iter_mut().enumerate() {
            plane[row] = halves(total);
            let k = LANES * row + lane;
            total = total.wrapping_add(product(&samples[k], usize::from(phases[k])));
        }
    }
    halves(total)
}

/// Sums products part by part.
#[inline(always)]
fn add_mixed(
    samples: Samples<'_>,
    layout: Layout,
    phases: &[u8; BLOCK],
    rows: &mut Rows<'_>,
    total: &mut Total,
) {
    let waves = &*WAVE;
    let mut mixed = [[0i32; 2]; BLOCK];
    for (k, (m, &phase)) in mixed.iter_mut().zip(phases).enumerate() {
        *m = samples.mixed(k, layout, waves[usize::from(phase) % CELLS]);
    }
    for (row, eight) in mixed.as_chunks::<LANES>().0.iter().enumerate() {
        for (plane, m) in rows.iter_mut().zip(eight) {
            plane[row] = total.sum();
            total.add(*m);
        }
    }
}
