//! Chips to band-base signal: each code edge is one addition to a difference array.
//!
//! A component's complex envelope is constant between code edges, but for the Doppler, which turns
//! it by well under 0.01 cycle in a chip. So a chip costs one phasor, shared by the components that
//! move as one, and one addition per edge, whatever the sample rate. The running sum of the
//! differences, taken once per band, is the sum of all its components. Everything is integer
//! arithmetic: exact in any order.

use super::composite::Composite;
use super::motion::{Motion, FRACTION};
use super::wave::{unit_vectors, UNIT};
use crate::simd::synth::{truncate, Loops};

/// Buffers hold whole numbers of so many chips.
const LANES: usize = 16;

/// Buffers for the chips of one composite.
#[derive(Default)]
pub(super) struct Chips {
    /// The carrier at the middle of each chip.
    re: Vec<f32>,
    im: Vec<f32>,
    signs: Vec<i8>,
    /// Envelope in the first sub-chip, I and Q in one word, (Q << 32) + I: sums of words are words
    /// of sums. One number of sub-chips after the other.
    words: Vec<i64>,
}

/// Where chips lie, in 2^-FRACTION samples from the first sample wanted, rounded up.
#[derive(Clone, Copy)]
struct Raster {
    start: i64,
    length: i64,
    /// Samples wanted; edges outside land on the ends.
    samples: i64,
}

impl Composite {
    /// Adds samples `from..to` of a segment (counted from its start) to a difference array whose
    /// entry 0 is sample `from`; the array has one entry more than samples.
    pub(super) fn render(
        &self,
        loops: Loops,
        motion: &Motion,
        (from, to): (i64, i64),
        chips: &mut Chips,
        out: &mut [i64],
    ) {
        let (lo, hi) = (from.max(motion.on), to.min(motion.off));
        if lo >= hi || motion.gain <= 0.0 {
            return;
        }
        let skip = ((lo << FRACTION) - motion.position).div_euclid(motion.chip_length);
        let start = motion.position + skip * motion.chip_length - (lo << FRACTION);
        let raster = Raster {
            start: start + (1 << FRACTION) - 1,
            length: motion.chip_length,
            samples: hi - lo,
        };
        let count = (((hi - lo) << FRACTION) - start - 1) / motion.chip_length + 1;
        let padded = (count as usize).next_multiple_of(LANES);
        self.envelopes(loops, motion, skip, padded, chips);
        let out = &mut out[(lo - from) as usize..=(hi - from) as usize];
        let words = |shape: usize| &chips.words[shape * padded..][..count as usize];
        // Constants, so that the loop over the edges of a chip is unrolled.
        match self.subchips[..] {
            [1] => raster.add([(1, words(0))], out),
            [2] => raster.add([(2, words(0))], out),
            [2, 12] => raster.add([(2, words(0)), (12, words(1))], out),
            _ => {
                let shapes = self.subchips.iter().enumerate();
                shapes.for_each(|(shape, &n)| raster.add([(n, words(shape))], out));
            }
        }
    }

    /// Works out the envelopes of `count` chips, the first `skip` chips after the motion's.
    fn envelopes(&self, loops: Loops, motion: &Motion, skip: i64, count: usize, chips: &mut Chips) {
        let Chips {
            re,
            im,
            signs,
            words,
        } = chips;
        re.resize(count, 0.0);
        im.resize(count, 0.0);
        signs.resize(count, 0);
        words.clear();
        words.resize(count * self.subchips.len(), 0);
        unit_vectors(loops, motion.carrier.after(skip), re, im);
        for component in &self.components {
            component.signs(motion.first_chip + skip, signs);
            for layer in &component.layers {
                let amplitude = (layer.amplitude * motion.gain * UNIT) as f32;
                let weight = layer.direction.map(|d| d * amplitude);
                let words = &mut words[layer.shape * count..][..count];
                loops.add_words(weight, signs, (re, im), words);
            }
        }
    }
}

/// Adds phasors times a weight and signs to words; the caller bounds the sum of all amplitudes.
///
/// In steps of [`LANES`], what is left over is left out.
#[inline(always)]
pub(crate) fn add_words(
    [wr, wi]: [f32; 2],
    signs: &[i8],
    (re, im): (&[f32], &[f32]),
    words: &mut [i64],
) {
    let (words, _) = words.as_chunks_mut::<LANES>();
    let (signs, _) = signs.as_chunks::<LANES>();
    let ((re, _), (im, _)) = (re.as_chunks::<LANES>(), im.as_chunks::<LANES>());
    for (((words, signs), re), im) in words.iter_mut().zip(signs).zip(re).zip(im) {
        for k in 0..LANES {
            let sign = f32::from(signs[k]);
            let i = truncate((re[k] * wr - im[k] * wi) * sign);
            let q = truncate((re[k] * wi + im[k] * wr) * sign);
            let word = (i64::from(q) << 32).wrapping_add(i64::from(i));
            words[k] = words[k].wrapping_add(word);
        }
    }
}

impl Raster {
    /// Adds the edges of chips, given as numbers of sub-chips and envelopes in the first of them.
    #[inline(always)]
    fn add<const N: usize>(self, shapes: [(i64, &[i64]); N], out: &mut [i64]) {
        let count = shapes[0].1.len();
        let mut edges = Edges {
            shapes: shapes.map(|(n, words)| (n, self.length / n, &words[..count])),
            last: 0,
            out,
        };
        let clamped = |position: i64| (position >> FRACTION).clamp(0, self.samples) as usize;
        let inside = |position: i64| (position >> FRACTION) as usize;
        edges.add(0, self.start, clamped);
        let mut position = self.start;
        for k in 1..count - 1 {
            position += self.length;
            edges.add(k, position, inside);
        }
        if count > 1 {
            edges.add(count - 1, position + self.length, clamped);
        }
        edges.change(self.samples as usize, edges.last.wrapping_neg());
    }
}

/// Adds the edges of one chip after the other.
struct Edges<'a, const N: usize> {
    /// Number and length of sub-chips, and envelopes in the first sub-chip of each chip.
    shapes: [(i64, i64, &'a [i64]); N],
    /// Envelope at the end of the chip before.
    last: i64,
    out: &'a mut [i64],
}

impl<const N: usize> Edges<'_, N> {
    #[inline(always)]
    fn change(&mut self, at: usize, by: i64) {
        self.out[at] = self.out[at].wrapping_add(by);
    }

    /// Adds the edges of a chip; `sample` gives the first sample at or after a position.
    #[inline(always)]
    fn add(&mut self, chip: usize, position: i64, sample: impl Fn(i64) -> usize) {
        let mut start = self.last.wrapping_neg();
        self.last = 0;
        for (subchips, length, words) in self.shapes {
            let mut word = words[chip];
            start = start.wrapping_add(word);
            for m in 1..subchips {
                self.change(sample(position + m * length), word.wrapping_mul(-2));
                word = word.wrapping_neg();
            }
            self.last = self.last.wrapping_add(word);
        }
        self.change(sample(position), start);
    }
}
