//! A conversion that the compiler vectorises.

/// The integer part of a number; one out of range gives some number near the end of the range.
///
/// `as`, which gives the very end, costs a branch for each number.
#[allow(clippy::manual_clamp)] // which keeps NaN
#[inline(always)]
pub(crate) fn truncate(x: f32) -> i32 {
    const LIMIT: f32 = 2_147_483_520.0; // the largest below 2^31
    let bounded = x.max(-LIMIT).min(LIMIT);
    // SAFETY: within i32, and not NaN: `max` of NaN and a number is the number.
    unsafe { bounded.to_int_unchecked() }
}

#[cfg(test)]
mod tests {
    use super::truncate;

    #[test]
    fn integer_parts() {
        for x in [0.0, -0.0, 0.99, -0.99, 1.0, -1.5, 8_388_609.0, 1e9, -2e9] {
            assert_eq!(truncate(x), x as i32);
        }
        for (x, end) in [(3e9, i32::MAX), (-3e9, i32::MIN), (f32::INFINITY, i32::MAX)] {
            assert!(truncate(x).abs_diff(end) <= 128, "{x}");
        }
        truncate(f32::NAN);
    }
}
