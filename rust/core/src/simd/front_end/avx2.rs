//! AVX2: bytes are mixed and summed by pairs in one instruction.
//!
//! A block of 128 samples is two halves of 8 groups of 8, one group in each 32-bit lane. A product
//! of two signed bytes is that of |x| with the oscillator's sign flipped where x < 0 (|-128| = 128
//! fits an unsigned byte). `vpmaddubsw` adds two of them, which 16 bits hold; from such pairs come
//! the sums inside a group. One scan over the groups of a half joins them.
//!
//! Lanes hold groups 0 1 4 5 2 3 6 7: interleaving I and Q gives consecutive rows then.
//!
//! To look up one of 128 cells takes a dozen instructions here. Rows of [`Oscillator::waves`] are
//! loaded instead, which makes the whole 1.7 times as fast.

use std::arch::x86_64::*;

use super::portable::absorb_inline;
use super::Blocks;
use crate::dsp::band::Samples;
use crate::dsp::oscillator::{Oscillator, CELLS, QUARTER};
use crate::dsp::ring::{Sum, Total, BLOCK, LANES};

/// Rows that half a block fills.
const HALF: usize = 8;
/// Rows in a vector.
const ROWS: usize = 4;

/// Sums over the first one to four samples behind a sum, of each group.
type Four = [__m256i; 4];

/// # Safety
/// The processor must have AVX2, and the caller have checked that the blocks fit the ring.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn absorb(blocks: &Blocks<'_>, cells: &mut [Sum], total: &mut Total) {
    let Samples::Int8(bytes) = blocks.samples else {
        absorb_inline(blocks, cells, total);
        return;
    };
    let mut sums = Sums::new(cells, blocks, total.sum());
    // SAFETY: handed on.
    unsafe {
        match (blocks.layout.complex, blocks.layout.conjugate) {
            (false, _) => real(blocks, bytes, &mut sums),
            (true, false) => complex::<false>(blocks, bytes, &mut sums),
            (true, true) => complex::<true>(blocks, bytes, &mut sums),
        }
    }
    *total = sums.carry().into();
}

/// # Safety
/// As [`absorb`]; `bytes` holds whole blocks.
#[target_feature(enable = "avx2")]
unsafe fn real(blocks: &Blocks<'_>, bytes: &[u8], sums: &mut Sums) {
    let mut oscillator = blocks.first;
    for block in bytes.chunks_exact(BLOCK) {
        let wave = Wave::new(blocks.oscillator, oscillator.start());
        oscillator = oscillator.next();
        for at in (0..BLOCK).step_by(HALF * LANES) {
            let groups = [at, at + 32];
            let x = fours(groups.map(|k| load(block, k)));
            let cos = fours(groups.map(|k| wave.load(0, k)));
            let turned = fours(groups.map(|k| wave.load(1, k)));
            // SAFETY: the block's rows lie within each plane (caller).
            unsafe { sums.put(real_sums(x, cos), real_sums(x, turned)) };
        }
    }
}

/// First and last four bytes of each group.
#[inline]
#[target_feature(enable = "avx2")]
fn fours([a, b]: [__m256i; 2]) -> [__m256i; 2] {
    let (a, b) = (_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
    [
        _mm256_castps_si256(_mm256_shuffle_ps::<0b10_00_10_00>(a, b)),
        _mm256_castps_si256(_mm256_shuffle_ps::<0b11_01_11_01>(a, b)),
    ]
}

/// Sums of samples times one part of the oscillator.
#[inline]
#[target_feature(enable = "avx2")]
fn real_sums(x: [__m256i; 2], wave: [__m256i; 2]) -> [Four; 2] {
    [0, 1].map(|h| {
        let (size, wave) = (_mm256_abs_epi8(x[h]), _mm256_sign_epi8(wave[h], x[h]));
        let pairs = _mm256_maddubs_epi16(size, wave);
        let even = _mm256_and_si256(size, _mm256_set1_epi16(0xff));
        let evens = _mm256_maddubs_epi16(even, wave);
        let two = first(pairs);
        let three = _mm256_add_epi32(two, _mm256_srai_epi32::<16>(evens));
        [first(evens), two, three, both(pairs)]
    })
}

/// # Safety
/// As [`absorb`]; `bytes` holds whole blocks.
#[target_feature(enable = "avx2")]
unsafe fn complex<const CONJUGATE: bool>(blocks: &Blocks<'_>, bytes: &[u8], sums: &mut Sums) {
    let mut oscillator = blocks.first;
    for block in bytes.chunks_exact(2 * BLOCK) {
        let wave = Wave::new(blocks.oscillator, oscillator.start());
        oscillator = oscillator.next();
        for at in (0..BLOCK).step_by(HALF * LANES) {
            let [a, b, c, d] = [0, 32, 64, 96].map(|byte| load(block, 2 * at + byte));
            // Groups 0 2, 1 3, 4 6, 5 7, as interleaving leaves the oscillator's.
            let x = [
                _mm256_permute2x128_si256::<0x20>(a, b),
                _mm256_permute2x128_si256::<0x31>(a, b),
                _mm256_permute2x128_si256::<0x20>(c, d),
                _mm256_permute2x128_si256::<0x31>(c, d),
            ];
            // With c = cos and s = -sin = c turned by one quarter: (i + jq)(c + js) is
            // ic - qs, is + qc; and (i - jq)(c + js) is ic + qs, is - qc.
            let (re, im) = if CONJUGATE {
                (wave.pairs::<0, 1>(at), wave.pairs::<1, 2>(at))
            } else {
                (wave.pairs::<0, 3>(at), wave.pairs::<1, 0>(at))
            };
            // SAFETY: the block's rows lie within each plane (caller).
            unsafe { sums.put(complex_sums(x, re), complex_sums(x, im)) };
        }
    }
}

/// Sums of one part of the products.
#[inline]
#[target_feature(enable = "avx2")]
fn complex_sums(x: [__m256i; 4], wave: [__m256i; 4]) -> [Four; 2] {
    let parts = [0, 1, 2, 3].map(|n| {
        let (size, wave) = (_mm256_abs_epi8(x[n]), _mm256_sign_epi8(wave[n], x[n]));
        _mm256_maddubs_epi16(size, wave)
    });
    let [a, b, c, d] = transposed(parts);
    [[a, b], [c, d]].map(|[a, b]| {
        let two = both(a);
        let [three, four] = [first(b), both(b)].map(|more| _mm256_add_epi32(two, more));
        [first(a), two, three, four]
    })
}

/// Transposes 4 x 4 lanes within the parts of 128 bits.
#[inline]
#[target_feature(enable = "avx2")]
fn transposed([a, b, c, d]: [__m256i; 4]) -> [__m256i; 4] {
    let (ab, cd) = (_mm256_unpacklo_epi32(a, b), _mm256_unpacklo_epi32(c, d));
    let (ab2, cd2) = (_mm256_unpackhi_epi32(a, b), _mm256_unpackhi_epi32(c, d));
    [
        _mm256_unpacklo_epi64(ab, cd),
        _mm256_unpackhi_epi64(ab, cd),
        _mm256_unpacklo_epi64(ab2, cd2),
        _mm256_unpackhi_epi64(ab2, cd2),
    ]
}

/// The lower 16 bits of each lane.
#[inline]
#[target_feature(enable = "avx2")]
fn first(pairs: __m256i) -> __m256i {
    _mm256_madd_epi16(pairs, _mm256_set1_epi32(1))
}

/// The sum of both halves of each lane.
#[inline]
#[target_feature(enable = "avx2")]
fn both(pairs: __m256i) -> __m256i {
    _mm256_madd_epi16(pairs, _mm256_set1_epi16(1))
}

/// 32 bytes, signed or not.
#[inline]
#[target_feature(enable = "avx2")]
fn load<T>(bytes: &[T], at: usize) -> __m256i {
    const { assert!(size_of::<T>() == 1) };
    let bytes = &bytes[at..at + 32];
    // SAFETY: 32 bytes are read from a slice of that length.
    unsafe { _mm256_loadu_si256(bytes.as_ptr().cast()) }
}

/// The oscillator in a block.
struct Wave<'a> {
    oscillator: &'a Oscillator,
    /// Of its first sample.
    cell: usize,
    /// The largest fraction of a place that does not make up a cell with that of the block.
    most: __m256i,
}

impl<'a> Wave<'a> {
    #[inline]
    #[target_feature(enable = "avx2")]
    fn new(oscillator: &'a Oscillator, start: u16) -> Self {
        Wave {
            oscillator,
            cell: usize::from(start >> 8),
            most: _mm256_set1_epi8((!start as u8 ^ 0x80) as i8),
        }
    }

    /// cos, some quarters of a cycle further on, at 32 samples.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn load(&self, quarters: usize, at: usize) -> __m256i {
        let cell = self.cell + quarters * QUARTER;
        let row = |cell: usize| load(&self.oscillator.waves[cell % CELLS].0, at);
        let carries = _mm256_cmpgt_epi8(load(&self.oscillator.fractions.0, at), self.most);
        _mm256_blendv_epi8(row(cell), row(cell + 1), carries)
    }

    /// cos, `I` and `Q` quarters further on, by turns, at half a block: groups 0 2, 1 3, 4 6, 5 7.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn pairs<const I: usize, const Q: usize>(&self, at: usize) -> [__m256i; 4] {
        let [a, b] = [at, at + 32].map(|k| [I, Q].map(|n| self.load(n, k)));
        [
            _mm256_unpacklo_epi8(a[0], a[1]),
            _mm256_unpackhi_epi8(a[0], a[1]),
            _mm256_unpacklo_epi8(b[0], b[1]),
            _mm256_unpackhi_epi8(b[0], b[1]),
        ]
    }
}

/// Where sums go.
struct Sums {
    at: *mut Sum,
    stride: usize,
    /// I and Q by turns.
    carry: __m256i,
}

impl Sums {
    #[inline]
    #[target_feature(enable = "avx2")]
    fn new(cells: &mut [Sum], blocks: &Blocks<'_>, [i, q]: Sum) -> Self {
        Sums {
            at: cells[blocks.row..].as_mut_ptr(),
            stride: blocks.geometry.stride,
            carry: _mm256_set_epi32(q, i, q, i, q, i, q, i),
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn carry(&self) -> Sum {
        let (i, q) = (self.carry, _mm256_srli_epi64::<32>(self.carry));
        [_mm256_cvtsi256_si32(i), _mm256_cvtsi256_si32(q)]
    }

    /// Sums before each of four rows, from the rows' totals.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn exclusive(&mut self, totals: __m256i) -> __m256i {
        let up = _mm256_slli_si256::<8>(totals);
        let two = _mm256_add_epi32(totals, up);
        let two = _mm256_unpackhi_epi64(two, two);
        // The first two rows before the last two.
        let lower = _mm256_permute2x128_si256::<0x08>(two, two);
        let before = _mm256_add_epi32(_mm256_add_epi32(up, lower), self.carry);
        let swapped = _mm256_permute2x128_si256::<0x01>(two, two);
        self.carry = _mm256_add_epi32(self.carry, _mm256_add_epi32(two, swapped));
        before
    }

    /// Stores half a block, from I and Q of the sums inside the halves of its groups.
    ///
    /// # Safety
    /// At `at` must begin 8 rows in each plane.
    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn put(&mut self, i: [Four; 2], q: [Four; 2]) {
        let add = |a, b| _mm256_add_epi32(a, b);
        let total = |parts: &[Four; 2]| add(parts[0][3], parts[1][3]);
        let (ti, tq) = (total(&i), total(&q));
        let mut base = [
            self.exclusive(_mm256_unpacklo_epi32(ti, tq)),
            self.exclusive(_mm256_unpackhi_epi32(ti, tq)),
        ];
        for n in 0..i.len() {
            let to = self.at.wrapping_add(n * LANES / 2 * self.stride);
            // SAFETY: by the caller.
            unsafe { store(to, base) };
            for k in 0..4 {
                let next = [
                    add(base[0], _mm256_unpacklo_epi32(i[n][k], q[n][k])),
                    add(base[1], _mm256_unpackhi_epi32(i[n][k], q[n][k])),
                ];
                if k == 3 {
                    base = next;
                } else {
                    // SAFETY: by the caller.
                    unsafe { store(to.wrapping_add((k + 1) * self.stride), next) };
                }
            }
        }
        self.at = self.at.wrapping_add(HALF);
    }
}

/// # Safety
/// At `to` must begin 8 cells.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn store(to: *mut Sum, rows: [__m256i; 2]) {
    // SAFETY: by the caller.
    unsafe {
        _mm256_storeu_si256(to.cast(), rows[0]);
        _mm256_storeu_si256(to.add(ROWS).cast(), rows[1]);
    }
}
