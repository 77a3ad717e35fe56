//! Four lanes, in plain Rust.

use super::{Complex16, Lanes};

/// Four lanes, which every processor of interest has.
#[derive(Clone, Copy)]
pub(super) struct Portable([f32; 4]);

impl Lanes for Portable {
    const N: usize = 4;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Portable([value; 4])
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        Portable([from[0], from[1], from[2], from[3]])
    }

    #[inline(always)]
    fn load_i16(from: &[i16]) -> Self {
        let wide = |i: usize| f32::from(from[i]);
        Portable([wide(0), wide(1), wide(2), wide(3)])
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[..4].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Portable([a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]])
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Portable([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]])
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Portable([a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]])
    }

    #[inline(always)]
    fn transpose(from: &[Complex16; 16], to: &mut [Complex16; 16]) {
        for (i, to) in to.iter_mut().enumerate() {
            for (j, from) in from.iter().enumerate() {
                (to.re[j], to.im[j]) = (from.re[i], from.im[i]);
            }
        }
    }
}
