//! Generators of spreading codes; chips are +1 (ICD bit 0) and -1 (ICD bit 1).

pub mod gold;
pub mod secondary;
pub mod weil;

/// ICD bit to chip.
#[inline]
pub(crate) fn chip(bit: u8) -> i8 {
    1 - 2 * (bit & 1) as i8
}
