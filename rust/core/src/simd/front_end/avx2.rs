//! AVX2.

use super::portable::absorb_inline;
use super::Blocks;
use crate::dsp::ring::Sum;

/// # Safety
/// The processor must have AVX2.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn absorb(blocks: &Blocks<'_>, cells: &mut [Sum], sum: &mut Sum) {
    absorb_inline(blocks, cells, sum);
}
