//! Transforms of any size, and phasors.

use std::f64::consts::TAU;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

use num_complex::Complex32;
use rustfft::{Fft, FftPlanner};

/// Plans take longer than many of their transforms; the planner keeps them for the next search.
fn planner() -> MutexGuard<'static, FftPlanner<f32>> {
    static PLANNER: LazyLock<Mutex<FftPlanner<f32>>> =
        LazyLock::new(|| Mutex::new(FftPlanner::new()));
    PLANNER.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(super) fn forward(size: usize) -> Arc<dyn Fft<f32>> {
    planner().plan_fft_forward(size)
}

/// Not normalised.
pub(super) fn inverse(size: usize) -> Arc<dyn Fft<f32>> {
    planner().plan_fft_inverse(size)
}

/// `exp(2 pi j (start + k step))` for k from 0 on, both in cycles.
pub(super) fn phasors(start: f64, step: f64, count: usize) -> Vec<Complex32> {
    const BLOCK: usize = 64;
    let phasor = |cycles: f64| {
        let (s, c) = (TAU * cycles.fract()).sin_cos();
        Complex32::new(c as f32, s as f32)
    };
    let within: [Complex32; BLOCK] = std::array::from_fn(|i| phasor(i as f64 * step));
    (0..count)
        .step_by(BLOCK)
        .flat_map(|k| {
            let first = phasor(start + k as f64 * step);
            within.iter().map(move |w| first * w)
        })
        .take(count)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phasors_are_exact_far_out() {
        let all = phasors(0.3, -0.123_456_789, 10_000);
        assert_eq!(all.len(), 10_000);
        for (k, got) in all.iter().enumerate() {
            let angle = TAU * (0.3 - 0.123_456_789 * k as f64);
            let want = Complex32::new(angle.cos() as f32, angle.sin() as f32);
            assert!((got - want).norm() < 1e-6, "{k}");
        }
    }
}
