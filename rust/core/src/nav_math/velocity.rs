//! Velocity and clock drift from Doppler.

use nalgebra::{DMatrix, DVector, Matrix4, Vector3};

use super::least_squares::{distinct, inverse_normal};
use super::measurement::{geometry, range_rate, Measurement, Settings};
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

/// Residuals may be so many times what the assumed noise makes likely: the noise of Doppler depends
/// on loops and dynamics, and only gross errors are to be found.
const GROSS: f64 = 25.0;

/// Weighted least squares of the rates of those measurements whose column is in `columns` and that
/// have one. One satellite whose rate is grossly off is left out if the other five or more agree;
/// `None` where fewer than four satellites have rates, or they contradict one another.
pub fn solve(
    measurements: &[Measurement],
    columns: &[usize],
    place: Vector3<f64>,
    settings: &Settings,
) -> Option<Velocity> {
    let usable = |m: &&Measurement| m.rate_m_s.is_finite() && columns.contains(&m.column);
    let used: Vec<_> = measurements.iter().filter(usable).collect();
    let fit = Fit::of(&used, place)?;
    if fit.agrees(settings) {
        return Some(fit.velocity);
    }
    let satellites: Vec<_> = used.iter().map(|m| m.satellite).collect();
    if distinct(&satellites) < 6 {
        return None;
    }
    let without = |satellite: &usize| {
        let rest: Vec<_> = used
            .iter()
            .filter(|m| m.satellite != *satellite)
            .copied()
            .collect();
        Fit::of(&rest, place)
    };
    let fits = satellites.iter().filter_map(without);
    let best = fits.min_by(|a, b| a.square_sum.total_cmp(&b.square_sum))?;
    best.agrees(settings).then_some(best.velocity)
}

/// A velocity and how well the rates agree with it.
struct Fit {
    velocity: Velocity,
    square_sum: f64,
    freedom: usize,
}

impl Fit {
    fn of(used: &[&Measurement], place: Vector3<f64>) -> Option<Self> {
        let satellites: Vec<_> = used.iter().map(|m| m.satellite).collect();
        if distinct(&satellites) < 4 {
            return None;
        }
        let weights =
            DVector::from_iterator(used.len(), used.iter().map(|m| 1.0 / m.rate_variance));
        let mut design = DMatrix::zeros(used.len(), 4);
        let mut values = DVector::zeros(used.len());
        for (row, m) in used.iter().enumerate() {
            let (slopes, still) = rate_model(m, place);
            design.row_mut(row).copy_from(&slopes);
            values[row] = m.rate_m_s - still;
        }
        let covariance = inverse_normal(&design, &weights)?;
        let found = &covariance * design.tr_mul(&weights.component_mul(&values));
        let left = values - &design * &found;
        Some(Self {
            velocity: Velocity {
                velocity: Vector3::new(found[0], found[1], found[2]),
                drift_m_s: found[3],
                covariance: covariance.fixed_view::<4, 4>(0, 0).into_owned(),
            },
            square_sum: left.iter().zip(&weights).map(|(r, w)| r * r * w).sum(),
            freedom: used.len() - 4,
        })
    }

    fn agrees(&self, settings: &Settings) -> bool {
        self.freedom == 0 || self.square_sum <= GROSS * settings.threshold(self.freedom)
    }
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
