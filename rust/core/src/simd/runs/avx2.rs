//! AVX2: two vectors hold the eight taps.

use super::portable::correlate_inline;
use super::{Runs, Sums};

/// # Safety
/// The processor must have AVX2.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn correlate(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    correlate_inline(runs, taps, sums)
}
