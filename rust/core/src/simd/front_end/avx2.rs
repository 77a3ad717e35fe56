//! AVX2.

use super::portable::absorb_inline;
use super::Blocks;
use crate::dsp::ring::{Sum, Total};

/// # Safety
/// The processor must have AVX2.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn absorb(blocks: &Blocks<'_>, cells: &mut [Sum], total: &mut Total) {
    absorb_inline(blocks, cells, total);
}
