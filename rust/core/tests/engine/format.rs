//! Sample formats, and recordings in them.

use sdr_spoof_core::dsp::front_end::Stream;
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::C64;

/// Float samples are scaled by this.
const FLOAT_SCALE: f32 = 100.0;

/// Deterministic noise in [-1, 1).
pub fn noise(index: u64) -> f64 {
    let mut z = index
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(0x1234_5678);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A sample format, and what suits it.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    pub name: &'static str,
    pub conjugate: bool,
    /// Amplitudes of a signal well above the quantiser's noise.
    pub signal: f64,
    pub noise: f64,
}

pub const FORMATS: [Format; 11] = {
    const fn format(name: &'static str, conjugate: bool, signal: f64, noise: f64) -> Format {
        Format {
            name,
            conjugate,
            signal,
            noise,
        }
    }
    [
        format("ri8", false, 20.0, 30.0),
        format("ci8", false, 20.0, 30.0),
        format("ci8", true, 20.0, 30.0),
        format("ri16", false, 2000.0, 3000.0),
        format("ci16", false, 3.0, 4.5),
        format("ci16", true, 2000.0, 3000.0),
        format("r2", false, 1.5, 3.0),
        format("c2", false, 1.5, 3.0),
        format("c2", true, 1.5, 3.0),
        format("rf32", false, 0.2, 0.3),
        format("cf32", true, 0.2, 0.3),
    ]
};

impl Format {
    pub fn parsed(self) -> SampleFormat {
        SampleFormat::parse(self.name).unwrap()
    }

    pub fn stream(self, start: u64) -> Stream {
        Stream {
            format: self.parsed(),
            conjugate: self.conjugate,
            float_scale: FLOAT_SCALE,
            start,
        }
    }

    /// `samples` (of I + jQ) as the bytes of a file.
    pub fn bytes(self, samples: impl Iterator<Item = C64>) -> Vec<u8> {
        let format = self.parsed();
        let width = 1 + usize::from(format.is_complex());
        let q = if self.conjugate { -1.0 } else { 1.0 };
        let values: Vec<f32> = samples
            .flat_map(|v| [v.re as f32, (q * v.im) as f32].into_iter().take(width))
            .collect();
        let mut bytes = vec![0; values.len() * format.bits_per_sample() / width / 8];
        format.pack(&values, 1.0, &mut bytes);
        bytes
    }

    /// The samples in the bytes of a file.
    pub fn samples(self, bytes: &[u8]) -> Vec<C64> {
        let format = self.parsed();
        let mut values = Vec::new();
        format.unpack(bytes, FLOAT_SCALE, self.conjugate, &mut values);
        let values: Vec<f64> = values.into_iter().map(f64::from).collect();
        if format.is_complex() {
            values
                .chunks_exact(2)
                .map(|v| C64::new(v[0], v[1]))
                .collect()
        } else {
            values.into_iter().map(|v| C64::new(v, 0.0)).collect()
        }
    }
}
