//! Sample formats: raw bytes of a recording to the internal type, i16 (real, or I/Q interleaved).

mod pack;

use crate::dsp::band::Samples;
use crate::{Error, Result};

/// How one sample is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    I8,
    I16,
    F32,
    /// Sign and magnitude, four values a byte, first value in the low bits:
    /// 0 -> +1, 1 -> +3, 2 -> -1, 3 -> -3.
    Bits2,
}

/// A recording's sample format: real (`r`) or complex (`c`) and the encoding of each value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SampleFormat {
    encoding: Encoding,
    complex: bool,
}

const NAMES: [(&str, Encoding, bool); 8] = [
    ("ri8", Encoding::I8, false),
    ("ci8", Encoding::I8, true),
    ("ri16", Encoding::I16, false),
    ("ci16", Encoding::I16, true),
    ("rf32", Encoding::F32, false),
    ("cf32", Encoding::F32, true),
    ("r2", Encoding::Bits2, false),
    ("c2", Encoding::Bits2, true),
];

impl SampleFormat {
    /// Parses `ri8`, `ci8`, `ri16`, `ci16`, `rf32`, `cf32` (little endian), `r2`, `c2`.
    ///
    /// # Errors
    /// [`Error::UnknownFormat`] names the known ones.
    pub fn parse(name: &str) -> Result<Self> {
        NAMES
            .iter()
            .find(|(n, _, _)| *n == name)
            .map(|&(_, encoding, complex)| SampleFormat { encoding, complex })
            .ok_or_else(|| Error::UnknownFormat {
                name: name.to_owned(),
                known: Self::names().join(", "),
            })
    }

    /// All format names.
    pub fn names() -> Vec<&'static str> {
        NAMES.iter().map(|n| n.0).collect()
    }

    /// Whether samples are I/Q pairs.
    pub fn is_complex(self) -> bool {
        self.complex
    }

    /// Bits per sample (both I and Q of a complex one).
    pub fn bits_per_sample(self) -> usize {
        let bits = match self.encoding {
            Encoding::I8 => 8,
            Encoding::I16 => 16,
            Encoding::F32 => 32,
            Encoding::Bits2 => 2,
        };
        bits * if self.complex { 2 } else { 1 }
    }

    /// The values in `bytes` as the front ends take them, unchanged where they can be read in
    /// place; `buffers` hold what must be unpacked. `scale` is for float formats.
    pub fn samples<'a>(
        self,
        bytes: &'a [u8],
        scale: f32,
        (narrow, wide): (&'a mut Vec<u8>, &'a mut Vec<i16>),
    ) -> Samples<'a> {
        match self.encoding {
            Encoding::I8 => Samples::Int8(bytes),
            Encoding::Bits2 => {
                narrow.clear();
                narrow.extend(
                    bytes
                        .iter()
                        .flat_map(|&b| two_bit_values(b).map(|v| v as u8)),
                );
                Samples::Int8(narrow)
            }
            Encoding::I16 | Encoding::F32 => {
                wide.clear();
                self.unpack(bytes, scale, false, wide);
                Samples::Int16(wide)
            }
        }
    }

    /// Appends the values in `bytes` to `out`: i16, I and Q interleaved if complex.
    ///
    /// `scale` multiplies float values before rounding (saturating; NaN becomes 0). `conjugate`
    /// negates Q (saturating). Bytes that do not fill a value are ignored.
    pub fn unpack(self, bytes: &[u8], scale: f32, conjugate: bool, out: &mut Vec<i16>) {
        let start = out.len();
        match self.encoding {
            Encoding::I8 => out.extend(bytes.iter().map(|&b| i16::from(b as i8))),
            Encoding::I16 => {
                out.extend(
                    bytes
                        .chunks_exact(2)
                        .map(|b| i16::from_le_bytes([b[0], b[1]])),
                );
            }
            Encoding::F32 => out.extend(
                bytes
                    .chunks_exact(4)
                    .map(|b| (f32::from_le_bytes([b[0], b[1], b[2], b[3]]) * scale).round() as i16),
            ),
            Encoding::Bits2 => {
                out.extend(bytes.iter().flat_map(|&b| two_bit_values(b).map(i16::from)));
            }
        }
        if conjugate && self.complex {
            for q in out[start..].iter_mut().skip(1).step_by(2) {
                *q = q.saturating_neg();
            }
        }
    }
}

/// The four values of a byte.
fn two_bit_values(byte: u8) -> [i8; 4] {
    const LEVEL: [i8; 4] = [1, 3, -1, -3];
    [0, 2, 4, 6].map(|s| LEVEL[(byte >> s & 3) as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unpacked(name: &str, bytes: &[u8], conjugate: bool) -> Vec<i16> {
        let mut out = Vec::new();
        SampleFormat::parse(name)
            .unwrap()
            .unpack(bytes, 10.0, conjugate, &mut out);
        out
    }

    #[test]
    fn every_encoding() {
        assert_eq!(unpacked("ri8", &[1, 0x80, 0xff], false), [1, -128, -1]);
        assert_eq!(unpacked("ci16", &[1, 0, 0, 0x80, 9], true), [1, 32767]);
        let mut floats = Vec::new();
        for v in [0.26f32, -1e9, f32::NAN] {
            floats.extend(v.to_le_bytes());
        }
        assert_eq!(unpacked("rf32", &floats, false), [3, -32768, 0]);
        assert_eq!(unpacked("r2", &[0b1110_0100], false), [1, 3, -1, -3]);
    }

    #[test]
    fn unknown_format_names_the_known_ones() {
        assert!(SampleFormat::parse("u8")
            .unwrap_err()
            .to_string()
            .contains("ri8, ci8"));
    }
}
