//! Attitude of a moving body from an IMU and velocities that something else has measured.
//!
//! M. Wu, Y. Wu, X. Hu, D. Hu, "Optimization-based alignment for inertial navigation systems",
//! Aerospace Science and Technology 15 (2011) 1: with axes frozen against inertial space at the
//! first epoch, the integral of the specific force in body axes and what velocities and gravity say
//! of it in local axes are the same vectors, turned by the attitude sought. Vectors are taken less
//! their mean, so that an error of the first velocity does not matter, and fitted by least squares
//! (Wahba's problem, by singular values).

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use rayon::prelude::*;

use super::coning::{self, History, Motion};
use super::earth::Earth;
use super::{gravity, Increment};
use crate::nav_math::geodesy::Geodetic;

/// Place and velocity (local axes, m/s) at a time since the first increment's start, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Epoch {
    /// s.
    pub time: f64,
    /// WGS 84.
    pub place: Geodetic,
    /// North, east, down, m/s.
    pub velocity: Vector3<f64>,
}

/// A guess at how the increments are to be read: matrices (axes swapped, signs, units) and biases
/// (rad/s, m/s^2), taken off after them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Of the gyros.
    pub gyro: Matrix3<f64>,
    /// Of the accelerometers.
    pub accelerometer: Matrix3<f64>,
    /// rad/s.
    pub gyro_bias: Vector3<f64>,
    /// m/s^2.
    pub accelerometer_bias: Vector3<f64>,
}

impl Default for Reading {
    fn default() -> Self {
        Reading {
            gyro: Matrix3::identity(),
            accelerometer: Matrix3::identity(),
            gyro_bias: Vector3::zeros(),
            accelerometer_bias: Vector3::zeros(),
        }
    }
}

impl Reading {
    fn of(&self, increment: &Increment) -> Increment {
        let t = increment.interval;
        Increment {
            rotation: self.gyro * increment.rotation - self.gyro_bias * t,
            velocity: self.accelerometer * increment.velocity - self.accelerometer_bias * t,
            interval: t,
        }
    }
}

/// The attitude that fits best, and how well it does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// From body to local axes at the last epoch.
    pub attitude: UnitQuaternion<f64>,
    /// What is left of each component of the vectors, root of the mean square, m/s.
    pub scatter: f64,
    /// Length of the measured vectors over that of the IMU's: 1 where units agree.
    pub scale: f64,
    /// Inverse covariance of the attitude about local axes for vectors of 1 m/s noise, (m/s)^2.
    pub information: Matrix3<f64>,
}

/// Fits each reading; parallel over them. Epochs, two or more, ascend and lie within the increments.
pub fn fit_all(increments: &[Increment], epochs: &[Epoch], readings: &[Reading]) -> Vec<Fit> {
    let (measured, turned) = measured(epochs);
    let one = |reading: &Reading| {
        let (felt, body) = felt(increments, epochs, reading);
        fitted(&felt, &measured, &turned, &body)
    };
    readings.par_iter().map(one).collect()
}

/// Integrals of the specific force by velocities and gravity, in the local axes of the first epoch,
/// and how the local axes have turned against them by the last.
fn measured(epochs: &[Epoch]) -> (Vec<Vector3<f64>>, UnitQuaternion<f64>) {
    let mut vectors = vec![Vector3::zeros()];
    let mut axes = UnitQuaternion::identity();
    let mut sum = Vector3::zeros();
    for pair in epochs.windows(2) {
        let half = (pair[1].time - pair[0].time) / 2.0;
        sum += half * (axes * pull(&pair[0]));
        axes *= coning::quaternion(&(half * (turning(&pair[0]) + turning(&pair[1]))));
        sum += half * (axes * pull(&pair[1]));
        vectors.push(axes * pair[1].velocity - epochs[0].velocity + sum);
    }
    (vectors, axes)
}

/// Rate of the local axes against inertial space.
fn turning(epoch: &Epoch) -> Vector3<f64> {
    let earth = Earth::at(epoch.place.latitude, epoch.place.height);
    earth.rotation() + earth.transport(&epoch.velocity)
}

/// What velocities do not show of the specific force.
fn pull(epoch: &Epoch) -> Vector3<f64> {
    let earth = Earth::at(epoch.place.latitude, epoch.place.height);
    let down = gravity::normal(earth.sin, epoch.place.height);
    earth.rotation().cross(&epoch.velocity) - Vector3::new(0.0, 0.0, down)
}

/// The same integrals by the IMU, in the body axes of the first epoch, and how the body has turned
/// against them by the last.
fn felt(
    increments: &[Increment],
    epochs: &[Epoch],
    reading: &Reading,
) -> (Vec<Vector3<f64>>, UnitQuaternion<f64>) {
    let mut history = History::default();
    let mut body = Felt::default();
    let (mut time, mut waiting) = (0.0, epochs.iter().peekable());
    let mut passed = Vec::with_capacity(epochs.len());
    for increment in increments {
        let motion = history.motion(&reading.of(increment));
        let share = |epoch: &Epoch| (epoch.time - time) / increment.interval;
        while let Some(epoch) = waiting.next_if(|epoch| share(epoch) <= 1.0 + 1e-9) {
            passed.push(body.moved(&motion, share(epoch)));
        }
        body = body.moved(&motion, 1.0);
        time += increment.interval;
    }
    passed.resize(epochs.len(), body);
    let into = passed[0].axes.inverse();
    let since = |felt: &Felt| into * (felt.sum - passed[0].sum);
    let turned = into * passed[epochs.len() - 1].axes;
    (passed.iter().map(since).collect(), turned)
}

/// Sum of the specific force and turn of the body, in the body axes of the beginning.
#[derive(Debug, Clone, Copy, Default)]
struct Felt {
    sum: Vector3<f64>,
    axes: UnitQuaternion<f64>,
}

impl Felt {
    /// After a share of an interval.
    fn moved(&self, motion: &Motion, share: f64) -> Felt {
        Felt {
            sum: self.sum + self.axes * (share * motion.velocity),
            axes: self.axes * coning::quaternion(&(share * motion.rotation)),
        }
    }
}

fn mean(vectors: &[Vector3<f64>]) -> Vector3<f64> {
    vectors.iter().sum::<Vector3<f64>>() / vectors.len() as f64
}

fn fitted(
    felt: &[Vector3<f64>],
    measured: &[Vector3<f64>],
    local: &UnitQuaternion<f64>,
    body: &UnitQuaternion<f64>,
) -> Fit {
    let (felt_mean, measured_mean) = (mean(felt), mean(measured));
    let pairs = || {
        let both = felt.iter().zip(measured);
        both.map(|(f, m)| (f - felt_mean, m - measured_mean))
    };
    let profile: Matrix3<f64> = pairs().map(|(f, m)| m * f.transpose()).sum();
    let rotation = nearest(&profile);
    let count = 3.0 * felt.len() as f64;
    let left: f64 = pairs()
        .map(|(f, m)| (m - rotation * f).norm_squared())
        .sum();
    let long: f64 = pairs().map(|(_, m)| m.norm_squared()).sum();
    let short: f64 = pairs().map(|(f, _)| f.norm_squared()).sum();
    let into = local.inverse();
    let information: Matrix3<f64> = pairs()
        .map(|(f, _)| into * (rotation * f))
        .map(|v| Matrix3::identity() * v.norm_squared() - v * v.transpose())
        .sum();
    Fit {
        attitude: into * UnitQuaternion::from_rotation_matrix(&rotation) * body,
        scatter: (left / count).sqrt(),
        scale: (long / short).sqrt(),
        information,
    }
}

/// Rotation that turns the vectors of a profile (sum of measured x felt) best.
fn nearest(profile: &Matrix3<f64>) -> Rotation3<f64> {
    let svd = profile.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Rotation3::identity();
    };
    let mut signs = Vector3::repeat(1.0);
    let smallest = svd.singular_values.imin();
    signs[smallest] = (u.determinant() * v_t.determinant()).signum();
    Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&signs) * v_t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::closed_form::{self, Path};

    fn increments(path: &Path, seconds: u32) -> Vec<Increment> {
        let step = |k| path.increment(f64::from(k) * 0.01, 0.01);
        (0..100 * seconds).map(step).collect()
    }

    fn epochs(path: &Path, seconds: u32, offset: f64) -> Vec<Epoch> {
        let epoch = |k| {
            let time = f64::from(k) + offset;
            let state = path.state(time);
            Epoch {
                time,
                place: state.place,
                velocity: state.velocity,
            }
        };
        (0..seconds).map(epoch).collect()
    }

    #[test]
    fn it_finds_the_attitude_of_ideal_increments() {
        for path in [closed_form::vehicle(), closed_form::aircraft()] {
            for offset in [0.0, 0.0037, 0.5] {
                let epochs = epochs(&path, 60, offset);
                let fit = fit_all(&increments(&path, 60), &epochs, &[Reading::default()])[0];
                let truth = path.state(epochs[59].time).attitude;
                assert!(fit.attitude.angle_to(&truth) < 1e-4, "{offset}");
                assert!(fit.scatter < 2e-3, "{}", fit.scatter);
                assert!((fit.scale - 1.0).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn it_does_not_fit_gyros_with_a_wrong_sign() {
        let path = closed_form::vehicle();
        let mirrored = Reading {
            gyro: Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0)),
            ..Reading::default()
        };
        let readings = [Reading::default(), mirrored];
        let fits = fit_all(&increments(&path, 30), &epochs(&path, 30, 0.0), &readings);
        assert!(fits[1].scatter > 100.0 * fits[0].scatter);
    }

    /// The spread over velocities with noise is what the information says.
    #[test]
    fn information_is_that_of_the_fit() {
        use crate::inertial::draws::Draws;
        let path = closed_form::vehicle();
        let (increments, clean) = (increments(&path, 20), epochs(&path, 20, 0.0));
        let truth = path.state(19.0).attitude;
        let (runs, sigma) = (100, 0.1);
        let mut squares = Vector3::zeros();
        let mut expected = Vector3::zeros();
        for run in 0..runs {
            let mut draws = Draws::new(1, run);
            let mut noisy = clean.clone();
            for epoch in &mut noisy {
                epoch.velocity += sigma * draws.six()[0];
            }
            let fit = fit_all(&increments, &noisy, &[Reading::default()])[0];
            let error = (truth * fit.attitude.inverse()).scaled_axis();
            squares += error.component_mul(&error) / runs as f64;
            if let Some(covariance) = fit.information.try_inverse() {
                expected = sigma * sigma * covariance.diagonal();
            }
        }
        for axis in 0..3 {
            let ratio = squares[axis] / expected[axis];
            assert!(
                (ratio - 1.0).abs() < 4.0 * (2.0 / runs as f64).sqrt(),
                "{ratio}"
            );
        }
    }
}
