//! AVX2.

use std::arch::x86_64::*;

use super::{Complex16, Kernel, Lanes};

/// # Safety
/// The processor must have AVX2.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn run<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}

/// Eight lanes. Named only by [`run`], so that what uses it has the instructions.
#[derive(Clone, Copy)]
struct Avx2(__m256);

impl Lanes for Avx2 {
    const N: usize = 8;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: the type is used under `run` only.
        Avx2(unsafe { _mm256_set1_ps(value) })
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let from = &from[..Self::N];
        // SAFETY: as in `splat`; the slice is long enough.
        Avx2(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn load_i16(from: &[i16]) -> Self {
        let from = &from[..Self::N];
        // SAFETY: as in `splat`; the slice is long enough.
        Avx2(unsafe {
            let narrow = _mm_loadu_si128(from.as_ptr().cast());
            _mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(narrow))
        })
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let to = &mut to[..Self::N];
        // SAFETY: as in `splat`; the slice is long enough.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: as in `splat`.
        Avx2(unsafe { _mm256_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: as in `splat`.
        Avx2(unsafe { _mm256_sub_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: as in `splat`.
        Avx2(unsafe { _mm256_mul_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn transpose(from: &[Complex16; 16], to: &mut [Complex16; 16]) {
        for (row, column) in [(0, 0), (0, 8), (8, 0), (8, 8)] {
            let mut re = [Self::load(&from[column].re[row..]).0; 8];
            let mut im = [Self::load(&from[column].im[row..]).0; 8];
            for i in 1..8 {
                re[i] = Self::load(&from[column + i].re[row..]).0;
                im[i] = Self::load(&from[column + i].im[row..]).0;
            }
            // SAFETY: as in `splat`.
            let (re, im) = unsafe { (transpose_8(re), transpose_8(im)) };
            for i in 0..8 {
                Avx2(re[i]).store(&mut to[row + i].re[column..]);
                Avx2(im[i]).store(&mut to[row + i].im[column..]);
            }
        }
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn transpose_8(mut r: [__m256; 8]) -> [__m256; 8] {
    for i in [0, 2, 4, 6] {
        let (a, b) = (r[i], r[i + 1]);
        r[i] = _mm256_blend_ps::<0b1010_1010>(a, _mm256_moveldup_ps(b));
        r[i + 1] = _mm256_blend_ps::<0b1010_1010>(_mm256_movehdup_ps(a), b);
    }
    for i in [0, 1, 4, 5] {
        let (a, b) = (r[i], r[i + 2]);
        r[i] = _mm256_shuffle_ps::<0b01_00_01_00>(a, b);
        r[i + 2] = _mm256_shuffle_ps::<0b11_10_11_10>(a, b);
    }
    for i in 0..4 {
        let (a, b) = (r[i], r[i + 4]);
        r[i] = _mm256_permute2f128_ps::<0x20>(a, b);
        r[i + 4] = _mm256_permute2f128_ps::<0x31>(a, b);
    }
    r
}
