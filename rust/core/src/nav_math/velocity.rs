//! Velocity and clock drift from Doppler.

use nalgebra::{DMatrix, DVector, Matrix4, Vector3};

use super::least_squares::inverse_normal;
use super::measurement::{geometry, range_rate, Measurement};
use super::SPEED_OF_LIGHT_M_S;

/// Velocity in the Earth-fixed frame and drift of the receiver's clock.
#[derive(Debug, Clone)]
pub struct Velocity {
    /// m/s.
    pub velocity: Vector3<f64>,
    /// Rate of the receiver's clock offset, m/s.
    pub drift_m_s: f64,
    /// Of both.
    pub covariance: Matrix4<f64>,
}

/// Weighted least squares of the rates of those measurements whose column is in `columns` and that
/// have one; `None` where fewer than four satellites do.
pub fn solve(
    measurements: &[Measurement],
    columns: &[usize],
    place: Vector3<f64>,
) -> Option<Velocity> {
    let used: Vec<_> = measurements
        .iter()
        .filter(|m| m.rate_m_s.is_finite() && columns.contains(&m.column))
        .collect();
    let satellites: Vec<_> = used.iter().map(|m| m.satellite).collect();
    if super::least_squares::distinct(&satellites) < 4 {
        return None;
    }
    let weights = DVector::from_iterator(used.len(), used.iter().map(|m| 1.0 / m.rate_variance));
    let mut design = DMatrix::zeros(used.len(), 4);
    let mut values = DVector::zeros(used.len());
    for (row, m) in used.iter().enumerate() {
        let (slopes, still) = rate_model(m, place);
        design.row_mut(row).copy_from(&slopes);
        values[row] = m.rate_m_s - still;
    }
    let covariance = inverse_normal(&design, &weights)?;
    let found = &covariance * design.tr_mul(&weights.component_mul(&values));
    Some(Velocity {
        velocity: Vector3::new(found[0], found[1], found[2]),
        drift_m_s: found[3],
        covariance: covariance.fixed_view::<4, 4>(0, 0).into_owned(),
    })
}

/// Derivatives of a measured rate by velocity and drift, and the rate at rest. It is linear in
/// both: a receiver clock that runs fast sees the range change less in each of its seconds.
pub fn rate_model(m: &Measurement, place: Vector3<f64>) -> (nalgebra::RowVector4<f64>, f64) {
    let (_, unit, _) = geometry(&m.state, place);
    let still = range_rate(&m.state, place, Vector3::zeros());
    let along = range_rate(&m.state, place, unit) - still;
    let slopes = unit * along;
    let drift = 1.0 - m.rate_m_s / SPEED_OF_LIGHT_M_S;
    let sent = SPEED_OF_LIGHT_M_S * m.state.clock_drift;
    (
        nalgebra::RowVector4::new(slopes.x, slopes.y, slopes.z, drift),
        still - sent,
    )
}
