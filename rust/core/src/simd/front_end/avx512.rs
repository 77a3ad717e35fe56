//! AVX-512 with VNNI and VBMI: bytes are mixed and summed by fours in one instruction.
//!
//! A block of 128 samples is 16 groups of 8, one group in each 32-bit lane. A product of two
//! signed bytes is that of |x| with the oscillator's sign flipped where x < 0 (|-128| = 128 fits
//! an unsigned byte). `vpdpbusd` adds four products to a lane; with some bytes masked it gives the
//! sums inside a group. One scan over the 16 lanes per block joins the groups.
//!
//! Lanes are in the order in which `unpack` interleaves I and Q into consecutive rows: lane 4a + b
//! holds group 2a + b for b < 2, and 8 + 2a + b - 2 else.

use std::arch::x86_64::*;
use std::array;

use super::portable::absorb_inline;
use super::Blocks;
use crate::dsp::band::{Layout, Samples};
use crate::dsp::oscillator::{Oscillator, COSINE, QUARTER};
use crate::dsp::ring::{Sum, Total, BLOCK, LANES};

/// Group of 8 samples that a lane holds.
const fn group(lane: usize) -> usize {
    let (a, b) = (lane / 4, lane % 4);
    if b < 2 {
        2 * a + b
    } else {
        8 + 2 * a + b - 2
    }
}

/// Lane that holds a group.
const LANE: [usize; 16] = {
    let mut lanes = [0; 16];
    let mut lane = 0;
    while lane < 16 {
        lanes[group(lane)] = lane;
        lane += 1;
    }
    lanes
};

/// # Safety
/// The processor must have the level, and the caller have checked that the blocks fit the ring.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512vbmi,avx512vnni")]
pub(super) unsafe fn absorb(blocks: &Blocks<'_>, cells: &mut [Sum], total: &mut Total) {
    let Samples::Int8(bytes) = blocks.samples else {
        absorb_inline(blocks, cells, total);
        return;
    };
    let mut sum = total.sum();
    // SAFETY: handed on.
    unsafe {
        if blocks.layout.complex {
            complex(blocks, bytes, cells, &mut sum);
        } else {
            real(blocks, bytes, cells, &mut sum);
        }
    }
    *total = sum.into();
}

/// What both kinds of samples share: the cosine table, the scan, and where sums go.
struct Shared {
    cosine: [__m512i; 2],
    scan: [(__mmask16, __m512i); 4],
    last: __m512i,
    stride: usize,
}

/// Running sums of I and Q, in every lane.
struct Carry {
    i: __m512i,
    q: __m512i,
}

/// A constant of 16 numbers, from the lane.
macro_rules! lanes {
    ($lane:ident => $value:expr) => {{
        let mut numbers = [0; 16];
        let mut $lane = 0;
        while $lane < 16 {
            numbers[$lane] = $value;
            $lane += 1;
        }
        numbers
    }};
}

/// Lanes to fetch from, and which fetch at all, to add the totals of the group so far before.
const SCAN: [(__mmask16, [i32; 16]); 4] = [before(1), before(2), before(4), before(8)];

const fn before(distance: usize) -> (__mmask16, [i32; 16]) {
    let mut mask = 0;
    let mut lane = 0;
    while lane < 16 {
        mask |= ((group(lane) >= distance) as u16) << lane;
        lane += 1;
    }
    let from = lanes!(lane => if group(lane) >= distance { LANE[group(lane) - distance] as i32 } else { 0 });
    (mask, from)
}

/// First and second four bytes of each group, from two vectors of samples.
const HALVES: [[i32; 16]; 2] = [
    lanes!(lane => 2 * group(lane) as i32),
    lanes!(lane => 2 * group(lane) as i32 + 1),
];

/// High bytes of the words of two vectors.
const HIGH: [i32; 16] = lanes!(lane => {
    let byte = 8 * lane as u8 + 1;
    i32::from_le_bytes([byte, byte + 2, byte + 4, byte + 6])
});

/// High byte of each word, twice, within four lanes.
const BOTH: [i32; 16] = lanes!(lane => {
    let byte = (lane % 4 * 4) as u8;
    i32::from_le_bytes([byte + 1, byte + 1, byte + 3, byte + 3])
});

#[inline]
#[target_feature(enable = "avx512f")]
fn vector(numbers: &[i32; 16]) -> __m512i {
    // SAFETY: 64 bytes are read from an array of that size.
    unsafe { _mm512_loadu_si512(numbers.as_ptr().cast()) }
}

#[inline]
#[target_feature(enable = "avx512f")]
fn words(f: impl Fn(usize) -> u16) -> __m512i {
    let words: [u16; 32] = array::from_fn(f);
    // SAFETY: 64 bytes are read from an array of that size.
    unsafe { _mm512_loadu_si512(words.as_ptr().cast()) }
}

impl Shared {
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn new(stride: usize) -> Self {
        let (low, high) = COSINE.split_at(64);
        Shared {
            // SAFETY: 64 bytes are read from slices of that length.
            cosine: unsafe {
                [
                    _mm512_loadu_si512(low.as_ptr().cast()),
                    _mm512_loadu_si512(high.as_ptr().cast()),
                ]
            },
            scan: SCAN.map(|(mask, from)| (mask, vector(&from))),
            last: _mm512_set1_epi32(LANE[15] as i32),
            stride,
        }
    }

    /// The oscillator at some cells, its sign flipped where the sample is negative.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512vbmi")]
    fn wave(&self, cells: __m512i, negative: __mmask64) -> __m512i {
        let wave = _mm512_permutex2var_epi8(self.cosine[0], cells, self.cosine[1]);
        _mm512_mask_sub_epi8(wave, negative, _mm512_setzero_si512(), wave)
    }

    /// Sum before each group, from the groups' totals.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn exclusive(&self, totals: __m512i, carry: &mut __m512i) -> __m512i {
        let mut v = totals;
        for (mask, from) in self.scan {
            v = _mm512_add_epi32(v, _mm512_maskz_permutexvar_epi32(mask, from, v));
        }
        let before = _mm512_add_epi32(_mm512_sub_epi32(v, totals), *carry);
        *carry = _mm512_add_epi32(*carry, _mm512_permutexvar_epi32(self.last, v));
        before
    }

    /// Stores 16 rows of plane `PLANE`.
    ///
    /// # Safety
    /// `at + PLANE * stride` must begin 16 cells.
    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn put<const PLANE: usize>(&self, at: *mut Sum, i: __m512i, q: __m512i) {
        // SAFETY: by the caller.
        unsafe {
            let to = at.add(PLANE * self.stride);
            _mm512_storeu_si512(to.cast(), _mm512_unpacklo_epi32(i, q));
            _mm512_storeu_si512(to.add(LANES).cast(), _mm512_unpackhi_epi32(i, q));
        }
    }
}

impl Carry {
    #[target_feature(enable = "avx512f")]
    fn new(sum: &Sum) -> Self {
        Carry {
            i: _mm512_set1_epi32(sum[0]),
            q: _mm512_set1_epi32(sum[1]),
        }
    }

    #[target_feature(enable = "avx512f")]
    fn sum(&self) -> Sum {
        [_mm512_cvtsi512_si32(self.i), _mm512_cvtsi512_si32(self.q)]
    }
}

/// Cells of the oscillator for 64 bytes, real samples: bytes of two vectors of 15-bit phases.
#[target_feature(enable = "avx512f")]
fn real_places(oscillator: &Oscillator, half: usize) -> [__m512i; 2] {
    let place = |byte: usize| oscillator.places[8 * group(byte / 4) + 4 * half + byte % 4];
    [words(place), words(|k| place(32 + k))]
}

/// # Safety
/// As [`absorb`]; `bytes` holds whole blocks.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512vbmi,avx512vnni")]
unsafe fn real(blocks: &Blocks<'_>, bytes: &[u8], cells: &mut [Sum], sum: &mut Sum) {
    let shared = Shared::new(blocks.geometry.stride);
    let places = [0, 1].map(|h| real_places(blocks.oscillator, h));
    let high = vector(&HIGH);
    let quarter = _mm512_set1_epi8(QUARTER as i8);
    let halves = HALVES.map(|h| vector(&h));
    let mut oscillator = blocks.first;
    let mut carry = Carry::new(sum);
    let zero = _mm512_setzero_si512();
    let dot = |a, x, w| _mm512_dpbusd_epi32(a, x, w);
    for (n, block) in bytes.chunks_exact(BLOCK).enumerate() {
        // SAFETY: a block is two vectors, and its 16 rows lie within each plane (caller).
        unsafe {
            let at = cells.as_mut_ptr().add(blocks.row + 16 * n);
            let raw = [0, 1].map(|h| _mm512_loadu_si512(block.as_ptr().add(64 * h).cast()));
            let start = _mm512_set1_epi16(oscillator.start() as i16);
            oscillator = oscillator.next();
            let [(xa, ca, sa), (xb, cb, sb)] = [0, 1].map(|h| {
                let v = _mm512_permutex2var_epi32(raw[0], halves[h], raw[1]);
                let [low, up] = places[h].map(|p| _mm512_add_epi16(p, start));
                let cell = _mm512_permutex2var_epi8(low, high, up);
                let negative = _mm512_movepi8_mask(v);
                let c = shared.wave(cell, negative);
                let s = shared.wave(_mm512_add_epi8(cell, quarter), negative);
                (_mm512_abs_epi8(v), c, s)
            });
            let ei = shared.exclusive(dot(dot(zero, xa, ca), xb, cb), &mut carry.i);
            let eq = shared.exclusive(dot(dot(zero, xa, sa), xb, sb), &mut carry.q);
            let (fi, fq) = (dot(ei, xa, ca), dot(eq, xa, sa));
            shared.put::<0>(at, ei, eq);
            shared.put::<4>(at, fi, fq);
            macro_rules! inner {
                ($first:literal, $second:literal, $mask:literal) => {
                    let a = _mm512_maskz_mov_epi8($mask, xa);
                    let b = _mm512_maskz_mov_epi8($mask, xb);
                    shared.put::<$first>(at, dot(ei, a, ca), dot(eq, a, sa));
                    shared.put::<$second>(at, dot(fi, b, cb), dot(fq, b, sb));
                };
            }
            inner!(1, 5, 0x1111_1111_1111_1111);
            inner!(2, 6, 0x3333_3333_3333_3333);
            inner!(3, 7, 0x7777_7777_7777_7777);
        }
    }
    *sum = carry.sum();
}

/// Quarter-turns to be added to the cells of (I, Q) bytes: for the real part of the product, and
/// for the imaginary part.
fn turns(layout: Layout) -> [[u8; 2]; 2] {
    // With c = cos and s = -sin = c turned by one quarter: (i + jq)(c + js) or (i - jq)(c + js).
    if layout.conjugate {
        [[0, 1], [1, 2]] // ic + qs, is - qc
    } else {
        [[0, 3], [1, 0]] // ic - qs, is + qc
    }
}

/// # Safety
/// As [`absorb`]; `bytes` holds whole blocks.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512vbmi,avx512vnni")]
unsafe fn complex(blocks: &Blocks<'_>, bytes: &[u8], cells: &mut [Sum], sum: &mut Sum) {
    let shared = Shared::new(blocks.geometry.stride);
    // Pair j of the samples of a group, in each lane.
    let places: [__m512i; 4] =
        array::from_fn(|j| words(|k| blocks.oscillator.places[8 * group(k / 2) + 2 * j + k % 2]));
    // The cell of a sample is for both its bytes.
    let both = vector(&BOTH);
    let [re, im] =
        turns(blocks.layout).map(|t| words(|_| u16::from_le_bytes(t.map(|n| n * QUARTER as u8))));
    let mut oscillator = blocks.first;
    let mut carry = Carry::new(sum);
    let zero = _mm512_setzero_si512();
    let dot = |a, x, w| _mm512_dpbusd_epi32(a, x, w);
    for (n, block) in bytes.chunks_exact(2 * BLOCK).enumerate() {
        // SAFETY: a block is four vectors, and its 16 rows lie within each plane (caller).
        unsafe {
            let at = cells.as_mut_ptr().add(blocks.row + 16 * n);
            let raw: [__m512i; 4] =
                array::from_fn(|j| _mm512_loadu_si512(block.as_ptr().add(64 * j).cast()));
            let pairs = transposed(raw);
            let start = _mm512_set1_epi16(oscillator.start() as i16);
            oscillator = oscillator.next();
            let parts: [(__m512i, __m512i, __m512i); 4] = array::from_fn(|j| {
                let cell = _mm512_shuffle_epi8(_mm512_add_epi16(places[j], start), both);
                let negative = _mm512_movepi8_mask(pairs[j]);
                let c = shared.wave(_mm512_add_epi8(cell, re), negative);
                let s = shared.wave(_mm512_add_epi8(cell, im), negative);
                (_mm512_abs_epi8(pairs[j]), c, s)
            });
            let total = |which: fn(&(__m512i, __m512i, __m512i)) -> __m512i| {
                let sum_of = |j: usize, a| dot(a, parts[j].0, which(&parts[j]));
                _mm512_add_epi32(sum_of(1, sum_of(0, zero)), sum_of(3, sum_of(2, zero)))
            };
            let mut i = shared.exclusive(total(|p| p.1), &mut carry.i);
            let mut q = shared.exclusive(total(|p| p.2), &mut carry.q);
            macro_rules! pair {
                ($j:literal, $first:literal, $second:literal) => {
                    let (x, c, s) = parts[$j];
                    let one = _mm512_maskz_mov_epi8(0x3333_3333_3333_3333, x);
                    shared.put::<$first>(at, i, q);
                    shared.put::<$second>(at, dot(i, one, c), dot(q, one, s));
                    (i, q) = (dot(i, x, c), dot(q, x, s));
                };
            }
            pair!(0, 0, 1);
            pair!(1, 2, 3);
            pair!(2, 4, 5);
            pair!(3, 6, 7);
            let _ = (i, q);
        }
    }
    *sum = carry.sum();
}

/// From 128 complex samples in order to four vectors: pair j of each group, groups in the lanes'
/// order.
#[inline]
#[target_feature(enable = "avx512f")]
fn transposed([a, b, c, d]: [__m512i; 4]) -> [__m512i; 4] {
    // A 128-bit part holds a group; collect groups 0 2 4 6, 1 3 5 7, 8 10 12 14, 9 11 13 15.
    let even = |x, y| _mm512_shuffle_i32x4::<0b10_00_10_00>(x, y);
    let odd = |x, y| _mm512_shuffle_i32x4::<0b11_01_11_01>(x, y);
    let [p, q, r, s] = [even(a, b), odd(a, b), even(c, d), odd(c, d)];
    // And transpose 4 x 4 lanes within the parts.
    let (pq, rs) = (_mm512_unpacklo_epi32(p, q), _mm512_unpacklo_epi32(r, s));
    let (pq2, rs2) = (_mm512_unpackhi_epi32(p, q), _mm512_unpackhi_epi32(r, s));
    [
        _mm512_unpacklo_epi64(pq, rs),
        _mm512_unpackhi_epi64(pq, rs),
        _mm512_unpacklo_epi64(pq2, rs2),
        _mm512_unpackhi_epi64(pq2, rs2),
    ]
}
