//! Sixteen floats at a time: kernels written once, compiled for each [`Level`].
//!
//! A kernel works on rows of sixteen floats, [`Lanes::N`] of them in a register, with sums,
//! differences and products only, each rounded by itself: the same bits at every level.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

use super::Level;

/// Sixteen complex numbers side by side, two cache lines.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C, align(64))]
pub(crate) struct Complex16 {
    pub re: [f32; 16],
    pub im: [f32; 16],
}

/// A vector register of floats.
pub(crate) trait Lanes: Copy {
    /// Floats in the register, a divisor of 16.
    const N: usize;

    /// The same number in every lane.
    fn splat(value: f32) -> Self;
    /// The first `N` numbers of a slice.
    ///
    /// # Panics
    /// If there are fewer.
    fn load(from: &[f32]) -> Self;
    /// The first `N` integers of a slice.
    ///
    /// # Panics
    /// If there are fewer.
    fn load_i16(from: &[i16]) -> Self;
    /// Writes the first `N` numbers of a slice.
    ///
    /// # Panics
    /// If there are fewer.
    fn store(self, to: &mut [f32]);
    /// Lane by lane.
    fn add(self, other: Self) -> Self;
    /// Lane by lane.
    fn sub(self, other: Self) -> Self;
    /// Lane by lane.
    fn mul(self, other: Self) -> Self;
    /// Turns rows into columns.
    fn transpose(from: &[Complex16; 16], to: &mut [Complex16; 16]);
}

/// Work that is compiled for each level. `run` and all that it calls must be `inline(always)`.
pub(crate) trait Kernel {
    /// What it returns.
    type Output;
    /// Does it with registers `L`.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Runs a kernel as compiled for `level`, or for the best one below that the processor has.
pub(crate) fn run<K: Kernel>(level: Level, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    match level.lowered() {
        // SAFETY: the processor has the level's instructions.
        Level::Avx512 => return unsafe { avx512::run(kernel) },
        // SAFETY: as above.
        Level::Avx2 => return unsafe { avx2::run(kernel) },
        Level::Portable => {}
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = level;
    kernel.run::<portable::Portable>()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Check;

    impl Kernel for Check {
        type Output = ([Complex16; 16], Vec<f32>);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let tile: [Complex16; 16] = std::array::from_fn(|i| Complex16 {
                re: std::array::from_fn(|j| (16 * i + j) as f32),
                im: std::array::from_fn(|j| -((16 * i + j) as f32)),
            });
            let mut turned = tile;
            L::transpose(&tile, &mut turned);
            let mut out = vec![0.0; 16];
            let whole = INTEGERS;
            for i in (0..16).step_by(L::N) {
                let (a, b) = (L::load(&tile[3].re[i..]), L::load(&tile[5].re[i..]));
                let sum = a.mul(b).sub(a).add(L::splat(0.1));
                sum.add(L::load_i16(&whole[i..])).store(&mut out[i..]);
            }
            (turned, out)
        }
    }

    const INTEGERS: [i16; 16] = [
        0, 1, -1, 3, 32767, -32768, 7, 8, 9, 10, -11, 12, 13, 14, 15, 16,
    ];

    #[test]
    fn every_level_does_the_same() {
        for level in Level::available() {
            let (turned, out) = run(level, Check);
            for i in 0..16 {
                let want = |j: usize| (16 * j + i) as f32;
                assert!((0..16).all(|j| turned[i].re[j] == want(j)), "{level:?}");
                assert!((0..16).all(|j| turned[i].im[j] == -want(j)), "{level:?}");
                let (a, b) = ((48 + i) as f32, (80 + i) as f32);
                assert_eq!(
                    out[i],
                    a * b - a + 0.1 + f32::from(INTEGERS[i]),
                    "{level:?}"
                );
            }
        }
    }
}
