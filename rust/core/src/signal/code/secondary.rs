//! Short secondary codes given as bits.

use super::chip;

/// Neumann-Hoffman code of 20 bits on B1I D1 (BDS-SIS-ICD-B1I-3.0 section 5.2.3).
pub const NH20: u128 = 0b0000_0100_1101_0100_1110;

/// The `length` low bits of `bits`, most significant first, as chips.
pub fn from_bits(bits: u128, length: usize) -> Vec<i8> {
    (0..length)
        .rev()
        .map(|i| chip((bits >> i & 1) as u8))
        .collect()
}
