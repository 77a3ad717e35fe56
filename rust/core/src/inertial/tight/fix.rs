//! Position and clock, or velocity and drift, from GNSS alone, minus those of the INS.

use nalgebra::{Matrix4, Vector4};

use super::measure::Sight;

/// Sum of the squared dilutions beyond which there is no fix.
const FAIR: f64 = 1e3;

/// Least squares of what satellites deviate from the INS (predicted minus measured, NaN: none),
/// without those in `flagged`, and the sum of the squared dilutions; NaN without a fix.
pub fn solve(
    deviations: &[f64],
    sight: &[Sight],
    flagged: impl Fn(usize) -> bool,
) -> ([f64; 4], f64) {
    let (mut normal, mut sums) = (Matrix4::zeros(), Vector4::zeros());
    for (k, value) in deviations.iter().enumerate() {
        if value.is_finite() && !flagged(k) {
            let row = (-sight[k].towards).push(1.0);
            normal += row * row.transpose();
            sums += row * *value;
        }
    }
    match normal.try_inverse() {
        Some(inverse) if inverse.trace() < FAIR && inverse.trace() > 0.0 => {
            let x = -(inverse * sums);
            (x.into(), inverse.trace())
        }
        _ => ([f64::NAN; 4], f64::NAN),
    }
}
