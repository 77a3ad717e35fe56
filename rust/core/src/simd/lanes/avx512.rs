//! AVX-512.

use std::arch::x86_64::*;

use super::{Complex16, Kernel, Lanes};

/// # Safety
/// The processor must have AVX-512 F, BW, DQ and VL.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
pub(super) unsafe fn run<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx512>()
}

/// Sixteen lanes. Named only by [`run`], so that what uses it has the instructions.
#[derive(Clone, Copy)]
struct Avx512(__m512);

impl Lanes for Avx512 {
    const N: usize = 16;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: the type is used under `run` only.
        Avx512(unsafe { _mm512_set1_ps(value) })
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let from = &from[..Self::N];
        // SAFETY: as in `splat`; the slice is long enough.
        Avx512(unsafe { _mm512_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn load_i16(from: &[i16]) -> Self {
        let from = &from[..Self::N];
        // SAFETY: as in `splat`; the slice is long enough.
        Avx512(unsafe {
            let narrow = _mm256_loadu_si256(from.as_ptr().cast());
            _mm512_cvtepi32_ps(_mm512_cvtepi16_epi32(narrow))
        })
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let to = &mut to[..Self::N];
        // SAFETY: as in `splat`; the slice is long enough.
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: as in `splat`.
        Avx512(unsafe { _mm512_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: as in `splat`.
        Avx512(unsafe { _mm512_sub_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: as in `splat`.
        Avx512(unsafe { _mm512_mul_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn transpose(from: &[Complex16; 16], to: &mut [Complex16; 16]) {
        let mut r = [Self::load(&from[0].re).0; 16];
        for i in 1..16 {
            r[i] = Self::load(&from[i].re).0;
        }
        // SAFETY: as in `splat`.
        unsafe { transpose_16(&mut r) };
        for i in 0..16 {
            Avx512(r[i]).store(&mut to[i].re);
        }
        for i in 0..16 {
            r[i] = Self::load(&from[i].im).0;
        }
        // SAFETY: as in `splat`.
        unsafe { transpose_16(&mut r) };
        for i in 0..16 {
            Avx512(r[i]).store(&mut to[i].im);
        }
    }
}

#[inline]
#[target_feature(enable = "avx512f")]
fn transpose_16(r: &mut [__m512; 16]) {
    trade::<1>(r);
    trade::<2>(r);
    trade::<4>(r);
    trade::<8>(r);
}

/// For a permutation of two rows that trades their off-diagonal blocks: what the upper
/// (`bit` 0) or the lower row (`bit` 1) becomes, lanes of the second counted from 16 on.
const fn traded(block: usize, bit: usize) -> [i32; 16] {
    let mut pick = [0; 16];
    let mut i = 0;
    while i < 16 {
        pick[i] = match (bit, i & block != 0) {
            (0, false) => i,
            (0, true) => 16 + i - block,
            (_, false) => i + block,
            (_, true) => 16 + i,
        } as i32;
        i += 1;
    }
    pick
}

#[inline]
#[target_feature(enable = "avx512f")]
fn trade<const BLOCK: usize>(r: &mut [__m512; 16]) {
    let [upper, lower] = const { [traded(BLOCK, 0), traded(BLOCK, 1)] };
    // SAFETY: the arrays are as long as the registers.
    let (upper, lower) = unsafe {
        (
            _mm512_loadu_si512(upper.as_ptr().cast()),
            _mm512_loadu_si512(lower.as_ptr().cast()),
        )
    };
    for i in 0..16 {
        if i & BLOCK == 0 {
            let (a, b) = (r[i], r[i + BLOCK]);
            r[i] = _mm512_permutex2var_ps(a, upper, b);
            r[i + BLOCK] = _mm512_permutex2var_ps(a, lower, b);
        }
    }
}
