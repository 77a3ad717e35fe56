//! Error control of the navigation messages, one file per code.
//!
//! Bits are bytes of 0 and 1, first one sent first. Soft values are positive for bit 0, as the
//! chips of a received symbol are.

pub mod bch15;
pub mod bch_b1c;
pub mod beidou_subframe;
pub mod cnav1;
pub mod crc24q;
mod doubt;
mod gf64;
pub mod interleaver;
pub mod ldpc64;
mod ldpc64_check;
mod ldpc64_tables;
mod noise;

pub use doubt::doubt;
pub use noise::{estimate as estimate_noise, Level};

/// A soft value's bit.
pub(crate) fn hard(value: f32) -> u8 {
    u8::from(value < 0.0)
}

/// The number that bits spell, first one most significant.
pub(crate) fn number(bits: &[u8]) -> u32 {
    bits.iter().fold(0, |n, &b| n << 1 | u32::from(b & 1))
}

#[cfg(test)]
pub(crate) mod test_noise {
    //! Normal numbers for tests: a linear congruential generator and Box and Muller.

    pub struct Normal(u64);

    impl Normal {
        pub fn new(seed: u64) -> Self {
            Self(seed)
        }

        pub fn uniform(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
        }

        pub fn next(&mut self) -> f32 {
            let (u, v) = (self.uniform(), self.uniform());
            ((-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()) as f32
        }
    }
}
