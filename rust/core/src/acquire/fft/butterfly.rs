//! Discrete Fourier transforms of two to eight points, in registers.
//!
//! All are inverse (exponent +j) and not normalised. They add, subtract and multiply in one fixed
//! order, so that every width of register gives the same bits.

use std::f32::consts::FRAC_1_SQRT_2;

use crate::simd::lanes::{Complex16, Lanes};

/// Complex numbers, one a lane.
#[derive(Clone, Copy)]
pub(super) struct Complex<L> {
    pub re: L,
    pub im: L,
}

impl<L: Lanes> Complex<L> {
    /// Lanes from `lane` on.
    #[inline(always)]
    pub fn load(from: &Complex16, lane: usize) -> Self {
        Complex {
            re: L::load(&from.re[lane..]),
            im: L::load(&from.im[lane..]),
        }
    }

    /// Lanes from `lane` on.
    #[inline(always)]
    pub fn store(self, to: &mut Complex16, lane: usize) {
        self.re.store(&mut to.re[lane..]);
        self.im.store(&mut to.im[lane..]);
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Complex {
            re: self.re.add(other.re),
            im: self.im.add(other.im),
        }
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Complex {
            re: self.re.sub(other.re),
            im: self.im.sub(other.im),
        }
    }

    /// `self + j other`.
    #[inline(always)]
    fn add_j(self, other: Self) -> Self {
        Complex {
            re: self.re.sub(other.im),
            im: self.im.add(other.re),
        }
    }

    /// `self - j other`.
    #[inline(always)]
    fn sub_j(self, other: Self) -> Self {
        Complex {
            re: self.re.add(other.im),
            im: self.im.sub(other.re),
        }
    }

    #[inline(always)]
    pub fn mul(self, other: Self) -> Self {
        Complex {
            re: self.re.mul(other.re).sub(self.im.mul(other.im)),
            im: self.re.mul(other.im).add(self.im.mul(other.re)),
        }
    }

    #[inline(always)]
    fn scale(self, factor: f32) -> Self {
        let factor = L::splat(factor);
        Complex {
            re: self.re.mul(factor),
            im: self.im.mul(factor),
        }
    }

    #[inline(always)]
    pub fn power(self) -> L {
        self.re.mul(self.re).add(self.im.mul(self.im))
    }
}

/// A transform of `R` points.
pub(super) trait Radix<const R: usize> {
    fn transform<L: Lanes>(x: [Complex<L>; R]) -> [Complex<L>; R];
}

/// The transforms there are.
pub(super) struct Inverse;

impl Radix<2> for Inverse {
    #[inline(always)]
    fn transform<L: Lanes>([a, b]: [Complex<L>; 2]) -> [Complex<L>; 2] {
        [a.add(b), a.sub(b)]
    }
}

impl Radix<3> for Inverse {
    #[inline(always)]
    fn transform<L: Lanes>([a, b, c]: [Complex<L>; 3]) -> [Complex<L>; 3] {
        const SIN_60: f32 = 0.866_025_4;
        let sum = b.add(c);
        let middle = a.sub(sum.scale(0.5));
        let turned = b.sub(c).scale(SIN_60);
        [a.add(sum), middle.add_j(turned), middle.sub_j(turned)]
    }
}

impl Radix<4> for Inverse {
    #[inline(always)]
    fn transform<L: Lanes>([a, b, c, d]: [Complex<L>; 4]) -> [Complex<L>; 4] {
        let (even, odd) = (a.add(c), b.add(d));
        let (even_less, odd_less) = (a.sub(c), b.sub(d));
        [
            even.add(odd),
            even_less.add_j(odd_less),
            even.sub(odd),
            even_less.sub_j(odd_less),
        ]
    }
}

impl Radix<5> for Inverse {
    #[inline(always)]
    fn transform<L: Lanes>([a, b, c, d, e]: [Complex<L>; 5]) -> [Complex<L>; 5] {
        const COS_72: f32 = 0.309_017;
        const COS_144: f32 = -0.809_017;
        const SIN_72: f32 = 0.951_056_5;
        const SIN_144: f32 = 0.587_785_25;
        let (outer, inner) = (b.add(e), c.add(d));
        let (outer_less, inner_less) = (b.sub(e), c.sub(d));
        let first = a.add(outer.scale(COS_72)).add(inner.scale(COS_144));
        let second = a.add(outer.scale(COS_144)).add(inner.scale(COS_72));
        let first_turned = outer_less.scale(SIN_72).add(inner_less.scale(SIN_144));
        let second_turned = outer_less.scale(SIN_144).sub(inner_less.scale(SIN_72));
        [
            a.add(outer).add(inner),
            first.add_j(first_turned),
            second.add_j(second_turned),
            second.sub_j(second_turned),
            first.sub_j(first_turned),
        ]
    }
}

impl Radix<8> for Inverse {
    #[inline(always)]
    fn transform<L: Lanes>(x: [Complex<L>; 8]) -> [Complex<L>; 8] {
        let [e0, e1, e2, e3] = Self::transform([x[0], x[2], x[4], x[6]]);
        let [o0, o1, o2, o3] = Self::transform([x[1], x[3], x[5], x[7]]);
        let zero = Complex {
            re: L::splat(0.0),
            im: L::splat(0.0),
        };
        // Turned by an eighth and by three eighths of a cycle.
        let o1 = o1.add_j(o1).scale(FRAC_1_SQRT_2);
        let o3 = zero.add_j(o3).sub(o3).scale(FRAC_1_SQRT_2);
        [
            e0.add(o0),
            e1.add(o1),
            e2.add_j(o2),
            e3.add(o3),
            e0.sub(o0),
            e1.sub(o1),
            e2.sub_j(o2),
            e3.sub(o3),
        ]
    }
}
