//! Raw samples of a recording as floats.

use crate::sample::SampleFormat;

/// Raw samples of a recording and how to read them.
#[derive(Debug, Clone, Copy)]
pub struct RawSamples<'a> {
    /// Whole samples.
    pub bytes: &'a [u8],
    /// How they are stored.
    pub format: SampleFormat,
    /// Factor of float formats.
    pub scale: f32,
    /// Take I - jQ.
    pub conjugate: bool,
}

impl RawSamples<'_> {
    /// Samples `begin..end` as floats, I and Q, zeros outside the recording; no Q if real.
    #[inline(always)]
    pub(crate) fn window(self, begin: i64, end: i64) -> [Vec<f32>; 2] {
        let bits = self.format.bits_per_sample();
        let per_byte = (8 / bits).max(1) as i64;
        let total = (self.bytes.len() * 8 / bits) as i64;
        let from = begin.clamp(0, total) / per_byte * per_byte;
        let to = end.clamp(from, total);
        let byte = |sample: i64| (sample as usize * bits).div_ceil(8);
        let bytes = &self.bytes[byte(from)..byte(to)];
        let mut values = Vec::new();
        self.format
            .unpack(bytes, self.scale, self.conjugate, &mut values);
        let width = if self.format.is_complex() { 2 } else { 1 };
        let held = &values[..((to - from) as usize * width).min(values.len())];
        // Samples of the first byte that lie before the window, and places before the recording.
        let skipped = (begin - from).clamp(0, to - from) as usize;
        let missing = (from - begin).clamp(0, end - begin) as usize;
        let held = &held[skipped * width..];
        let mut parts = [Vec::new(), Vec::new()];
        for (component, part) in parts.iter_mut().take(width).enumerate() {
            part.resize((end - begin) as usize, 0.0);
            let places = part[missing..].iter_mut();
            if width == 1 {
                places.zip(held).for_each(|(p, &v)| *p = f32::from(v));
            } else {
                let pairs = held.chunks_exact(2);
                places
                    .zip(pairs)
                    .for_each(|(p, v)| *p = f32::from(v[component]));
            }
        }
        parts
    }
}
