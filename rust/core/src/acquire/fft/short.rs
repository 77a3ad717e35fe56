//! Transforms of a few hundred points, sixteen side by side.

use std::f64::consts::TAU;

use super::butterfly::{Complex, Inverse, Radix};
use crate::simd::lanes::{Complex16, Lanes};
use crate::{Error, Result};

/// One pass: transforms of `radix` points that lie `stride` apart.
#[derive(Debug)]
struct Pass {
    radix: usize,
    stride: usize,
    /// For each point below the stride, turns of the results 1 to radix - 1.
    turns: Vec<[f32; 2]>,
}

/// An inverse transform by decimation in frequency, not normalised.
#[derive(Debug)]
pub(super) struct ShortFft {
    size: usize,
    passes: Vec<Pass>,
    /// Index of the result at each place of the buffer after the last pass.
    order: Vec<u32>,
}

impl ShortFft {
    /// Plans `size` points.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a prime factor is larger than 5, or for less than two factors.
    pub fn new(size: usize) -> Result<Self> {
        let radices = radices(size).ok_or_else(|| {
            Error::Invalid(format!("a transform of {size} points cannot be planned"))
        })?;
        let (mut passes, mut order) = (Vec::new(), vec![0u32; size]);
        let (mut length, mut weight) = (size, 1);
        for radix in radices {
            let stride = length / radix;
            let turn = |j: usize, k: usize| {
                let (s, c) = (TAU * (j * k) as f64 / length as f64).sin_cos();
                [c as f32, s as f32]
            };
            let turns = (0..stride)
                .flat_map(|j| (1..radix).map(move |k| turn(j, k)))
                .collect();
            passes.push(Pass {
                radix,
                stride,
                turns,
            });
            for (place, index) in order.iter_mut().enumerate() {
                *index += (weight * (place / stride % radix)) as u32;
            }
            (length, weight) = (stride, weight * radix);
        }
        Ok(ShortFft {
            size,
            passes,
            order,
        })
    }

    /// Points.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Which result is left at each place.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Where each result is left.
    pub fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.size];
        for (place, &index) in self.order.iter().enumerate() {
            places[index as usize] = place as u32;
        }
        places
    }

    /// Transforms `points`; the results go to `sink`.
    #[inline(always)]
    pub fn run<L: Lanes>(&self, points: &mut [Complex16], sink: &mut impl Sink) {
        let Some((last, passes)) = self.passes.split_last() else {
            return;
        };
        for pass in passes {
            match pass.radix {
                8 => pass.run::<L, 8>(points),
                5 => pass.run::<L, 5>(points),
                4 => pass.run::<L, 4>(points),
                3 => pass.run::<L, 3>(points),
                _ => pass.run::<L, 2>(points),
            }
        }
        match last.radix {
            8 => end::<L, 8>(points, sink),
            5 => end::<L, 5>(points, sink),
            4 => end::<L, 4>(points, sink),
            3 => end::<L, 3>(points, sink),
            _ => end::<L, 2>(points, sink),
        }
    }
}

/// Where results go.
pub(super) trait Sink {
    /// Takes lanes from `lane` on of the result whose place is number `place`.
    fn put<L: Lanes>(&mut self, at: &mut Complex16, place: usize, lane: usize, value: Complex<L>);
}

/// Leaves each result at its place.
pub(super) struct InPlace;

impl Sink for InPlace {
    #[inline(always)]
    fn put<L: Lanes>(&mut self, at: &mut Complex16, _: usize, lane: usize, value: Complex<L>) {
        value.store(at, lane);
    }
}

impl Pass {
    #[inline(always)]
    fn run<L: Lanes, const R: usize>(&self, points: &mut [Complex16])
    where
        Inverse: Radix<R>,
    {
        let stride = self.stride;
        for block in points.chunks_exact_mut(R * stride) {
            for (j, turns) in self.turns.chunks_exact(R - 1).enumerate() {
                for lane in (0..16).step_by(L::N) {
                    let mut x = [Complex::<L>::load(&block[j], lane); R];
                    for q in 1..R {
                        x[q] = Complex::load(&block[j + q * stride], lane);
                    }
                    let y = turned(Inverse::transform(x), turns);
                    for k in 0..R {
                        y[k].store(&mut block[j + k * stride], lane);
                    }
                }
            }
        }
    }
}

/// The last pass: the points are neighbours, the results need no turn.
#[inline(always)]
fn end<L: Lanes, const R: usize>(points: &mut [Complex16], sink: &mut impl Sink)
where
    Inverse: Radix<R>,
{
    for (b, block) in points.chunks_exact_mut(R).enumerate() {
        for lane in (0..16).step_by(L::N) {
            let mut x = [Complex::<L>::load(&block[0], lane); R];
            for q in 1..R {
                x[q] = Complex::load(&block[q], lane);
            }
            let y = Inverse::transform(x);
            for k in 0..R {
                sink.put(&mut block[k], b * R + k, lane, y[k]);
            }
        }
    }
}

#[inline(always)]
fn turned<L: Lanes, const R: usize>(mut y: [Complex<L>; R], turns: &[[f32; 2]]) -> [Complex<L>; R] {
    for k in 1..R {
        let [re, im] = turns[k - 1];
        y[k] = y[k].mul(Complex {
            re: L::splat(re),
            im: L::splat(im),
        });
    }
    y
}

/// At least two factors, large ones first; None if there are none.
fn radices(size: usize) -> Option<Vec<usize>> {
    let (mut rest, mut found) = (size, Vec::new());
    for radix in [8, 5, 4, 3, 2] {
        while rest > 1 && rest % radix == 0 {
            found.push(radix);
            rest /= radix;
        }
    }
    (rest == 1 && found.len() > 1).then_some(found)
}
