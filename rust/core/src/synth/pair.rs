//! Two floats in one word: tables of pairs are looked up with one load.

/// The bits of both, the first in the low half.
pub(super) fn join([first, second]: [f32; 2]) -> u64 {
    u64::from(first.to_bits()) | u64::from(second.to_bits()) << 32
}

/// The inverse of [`join`].
#[inline(always)]
pub(super) fn split(word: u64) -> [f32; 2] {
    [
        f32::from_bits(word as u32),
        f32::from_bits((word >> 32) as u32),
    ]
}
