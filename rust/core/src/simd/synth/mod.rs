//! The loops of the synthesis, compiled once for each level.
//!
//! The loops stand with their subjects in `synth` and `sample`, as inlined functions that the
//! compiler vectorises for the level; only the running sum is written out. Nothing is fused or
//! reordered, so every level gives the same bits.

mod convert;
mod scan;

use super::Level;
use crate::sample::SampleFormat;
use crate::synth::random::{self, Batch};
use crate::synth::wave::{self, Rotation};
use crate::synth::{filter, render};

pub(crate) use convert::truncate;

/// The loops at one level, which this processor has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Loops(Level);

impl Loops {
    /// The loops at `level`, or at the best lower one that this processor has.
    pub(crate) fn new(level: Level) -> Loops {
        Loops(level.lowered())
    }

    /// Replaces each word by the sum of all words up to it, wrapping.
    pub(crate) fn running_sum(self, words: &mut [i64]) {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `new` lets only levels pass that the processor has.
            Level::Avx512 => unsafe { scan::avx512(words) },
            _ => scan::portable(0, words),
        }
    }
}

/// Methods of [`Loops`] that run an inlined function, compiled for the level.
macro_rules! compiled {
    ($(fn $name:ident($($arg:ident: $type:ty),* $(,)?) = $body:path;)*) => {
        impl Loops {
            $(
                #[doc = concat!("See `", stringify!($body), "`.")]
                pub(crate) fn $name(self, $($arg: $type),*) {
                    #[cfg(target_arch = "x86_64")]
                    {
                        #[target_feature(enable = "avx2")]
                        fn avx2($($arg: $type),*) {
                            $body($($arg),*);
                        }
                        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
                        fn avx512($($arg: $type),*) {
                            $body($($arg),*);
                        }
                        match self.0 {
                            Level::Portable => {}
                            // SAFETY: `new` lets only levels pass that the processor has.
                            Level::Avx2 => return unsafe { avx2($($arg),*) },
                            // SAFETY: as above.
                            Level::Avx512 => return unsafe { avx512($($arg),*) },
                        }
                    }
                    $body($($arg),*);
                }
            )*
        }
    };
}

compiled! {
    fn noise(key: u64, pair: u64, table: &random::Table, out: &mut Batch) = random::fill_batch;

    fn unit_vectors(table: &wave::Table, rotation: Rotation, re: &mut [f32], im: &mut [f32])
        = wave::interpolate;

    fn add_words(weight: [f32; 2], signs: &[i8], phasors: (&[f32], &[f32]), words: &mut [i64])
        = render::add_words;

    fn mix_real(table: &wave::Table, rotation: Rotation, words: &mut [i64], re: &mut [f32])
        = wave::mix_real;

    fn mix_complex(
        table: &wave::Table,
        rotation: Rotation,
        words: &mut [i64],
        re: &mut [f32],
        im: &mut [f32],
    ) = wave::mix_complex;

    fn convolve_even(h: &[f32], x: &[f32], out: &mut [f32]) = filter::convolve_even;

    fn convolve_odd(h: &[f32], x: &[f32], out: &mut [f32]) = filter::convolve_odd;

    fn pack(format: SampleFormat, values: &[f32], gain: f32, out: &mut [u8]) = SampleFormat::pack;
}
