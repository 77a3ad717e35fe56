//! From raw bytes to the running sums of every band, piece by piece.

use super::band::{Band, Layout, Samples};
use super::ring::{BLOCK, LONGEST_STEP};
use crate::sample::SampleFormat;
use crate::simd::Level;

/// Fewest samples worth taking at a time: every channel is called once for each piece. Twice as
/// many sums of two bands still fit the cache of a core.
const PIECE: usize = 12_288;

/// What a recording's samples are, and where in it to begin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stream {
    /// Sample format.
    pub format: SampleFormat,
    /// Negate Q.
    pub conjugate: bool,
    /// Factor from float samples to integers.
    pub float_scale: f32,
    /// First sample that will be fed.
    pub start: u64,
}

/// The bands of a recording, fed with raw bytes.
#[derive(Debug)]
pub struct FrontEnd {
    stream: Stream,
    bands: Vec<Band>,
    piece: usize,
    bytes: Vec<u8>,
    words: Vec<i16>,
}

impl FrontEnd {
    /// Bands at the given frequencies (cycles per sample of the recording) that keep at least
    /// `history` samples behind what has been fed.
    pub fn new(stream: Stream, frequencies: &[f64], history: usize, level: Level) -> Self {
        let layout = Layout {
            complex: stream.format.is_complex(),
            conjugate: stream.conjugate,
        };
        // The ring is a power of two; all of it that is not history takes samples.
        let capacity = (history + PIECE + BLOCK).next_power_of_two();
        let band = |&f: &f64| Band::new(f, layout, stream.start, capacity, level);
        FrontEnd {
            bands: frequencies.iter().map(band).collect(),
            piece: (capacity - history - 1) / BLOCK * BLOCK,
            stream,
            bytes: Vec::new(),
            words: Vec::new(),
        }
    }

    /// Samples to be kept for channels whose taps lie up to `reach` samples from the prompt, one
    /// step of the correlator included, and the samples that its edges fall on.
    pub fn history(reach: usize) -> usize {
        2 * reach + LONGEST_STEP + BLOCK
    }

    /// Absorbs raw bytes of whole samples, any number of them; `work` is called whenever channels
    /// must work off what the bands hold.
    ///
    /// # Panics
    /// If the bytes are not those of whole samples.
    pub fn feed(&mut self, bytes: &[u8], mut work: impl FnMut(&[Band])) {
        let Stream {
            format,
            float_scale,
            ..
        } = self.stream;
        let bits = format.bits_per_sample();
        assert!(
            (bytes.len() * 8).is_multiple_of(bits),
            "{} bytes are not whole samples of {bits} bits",
            bytes.len()
        );
        for piece in bytes.chunks(self.piece * bits / 8) {
            let buffers = (&mut self.bytes, &mut self.words);
            let samples: Samples<'_> = format.samples(piece, float_scale, buffers);
            for band in &mut self.bands {
                band.feed(samples);
            }
            work(&self.bands);
        }
    }

    /// The bands.
    pub fn bands(&self) -> &[Band] {
        &self.bands
    }

    /// The bands, to be retuned.
    pub fn bands_mut(&mut self) -> &mut [Band] {
        &mut self.bands
    }
}
