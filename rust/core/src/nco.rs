//! Fixed-point phase accumulators, exact and independent of chunking.
//!
//! A phase is an unsigned 64-bit fraction of a cycle (2^64 = one cycle); arithmetic wraps.

/// One cycle as a float.
pub(crate) const CYCLE: f64 = 18_446_744_073_709_551_616.0; // 2^64

/// Phase in cycles (any real number) to the 64-bit fraction of a cycle.
#[inline]
pub fn phase_from_cycles(cycles: f64) -> u64 {
    ((cycles - cycles.floor()) * CYCLE) as u64
}

/// 64-bit fraction of a cycle to cycles in [0, 1).
#[inline]
pub fn cycles_from_phase(phase: u64) -> f64 {
    phase as f64 / CYCLE
}

/// Frequency in cycles per sample to the (wrapping) phase step per sample.
#[inline]
pub fn step_from_frequency(cycles_per_sample: f64) -> u64 {
    // Through i128 so that negative frequencies wrap.
    ((cycles_per_sample * CYCLE).round() as i128) as u64
}

/// The frequency in cycles per sample that a phase step really makes, in [-0.5, 0.5).
#[inline]
pub fn frequency_from_step(step: u64) -> f64 {
    step as i64 as f64 / CYCLE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phase_after_many_steps_is_exact() {
        let step = step_from_frequency(22.839e6 / 120e6);
        let n = 1_000_000_007u64;
        let mut acc = 0u64;
        for _ in 0..1000 {
            acc = acc.wrapping_add(step.wrapping_mul(n));
        }
        assert_eq!(acc, step.wrapping_mul(n.wrapping_mul(1000)));
    }

    #[test]
    fn negative_frequencies_wrap() {
        let f = -0.123_456_789;
        assert!((frequency_from_step(step_from_frequency(f)) - f).abs() < 1e-15);
        assert!((cycles_from_phase(phase_from_cycles(-0.25)) - 0.75).abs() < 1e-15);
    }
}
