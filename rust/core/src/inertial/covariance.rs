//! How uncertain an INS is, by the time since its alignment: the covariance of its errors.
//!
//! The 15 states of `error_model` with constant biases, and six biases that wander (first-order
//! Gauss-Markov) beside them. Scale factors and misalignments are not in it.

use nalgebra::{SMatrix, Vector3};

use super::error_model::{self, ACCELEROMETER, ATTITUDE, GYRO, POSITION, STATES, VELOCITY};
use super::{Increment, NavState, Strapdown};

/// Error states, the wandering biases included: gyros, then accelerometers, at the end.
pub const ALL: usize = STATES + 6;

/// Covariance of all error states.
pub type Covariance = SMatrix<f64, ALL, ALL>;

/// Longest step over which the motion is taken as constant, s.
const STEP: f64 = 0.1;

/// Three gyros (u = rad/s) or three accelerometers (u = m/s^2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorNoise {
    /// Standard deviation of the constant bias, u.
    pub bias: f64,
    /// Of the bias that wanders, u.
    pub wander: f64,
    /// Its correlation time, s.
    pub wander_time: f64,
    /// White noise, u sqrt(s).
    pub density: f64,
}

/// What is uncertain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Gyros.
    pub gyro: SensorNoise,
    /// Accelerometers.
    pub accelerometer: SensorNoise,
    /// Standard deviations at the alignment: position (north, east, down, m), velocity (m/s),
    /// attitude (phi, rad).
    pub alignment: [Vector3<f64>; 3],
}

impl Uncertainty {
    fn at_start(&self) -> Covariance {
        let [gyro, accelerometer] = [self.gyro, self.accelerometer];
        let biases = [
            gyro.bias,
            accelerometer.bias,
            gyro.wander,
            accelerometer.wander,
        ];
        let sigma = self
            .alignment
            .into_iter()
            .chain(biases.map(Vector3::repeat))
            .flat_map(<[f64; 3]>::from);
        let mut diagonal = Covariance::zeros();
        for (k, s) in sigma.enumerate() {
            diagonal[(k, k)] = s * s;
        }
        diagonal
    }

    /// Transition and added covariance over an interval.
    fn step(&self, state: &NavState, force: &Vector3<f64>, interval: f64) -> [Covariance; 2] {
        let f = error_model::dynamics(state, force);
        let mut transition = Covariance::identity();
        transition
            .fixed_view_mut::<STATES, STATES>(0, 0)
            .copy_from(&error_model::transition(&f, interval));
        let mut added = Covariance::zeros();
        let sensors = [
            (self.gyro, GYRO, ATTITUDE, STATES),
            (self.accelerometer, ACCELEROMETER, VELOCITY, STATES + 3),
        ];
        for (sensor, bias, driven, wander) in sensors {
            let keeps = (-interval / sensor.wander_time).exp();
            for axis in 0..3 {
                for row in 0..STATES {
                    transition[(row, wander + axis)] = transition[(row, bias + axis)];
                }
                transition[(bias + axis, wander + axis)] = 0.0;
                transition[(wander + axis, wander + axis)] = keeps;
                let fresh = sensor.wander * sensor.wander * (1.0 - keeps * keeps);
                added[(wander + axis, wander + axis)] = fresh;
                added[(driven + axis, driven + axis)] = sensor.density.powi(2) * interval;
            }
        }
        [transition, added]
    }
}

/// Hands the covariance to `write`: at the start, and after each `every` increments of an ideal IMU.
pub fn propagate(
    increments: &[Increment],
    start: NavState,
    uncertainty: &Uncertainty,
    every: usize,
    mut write: impl FnMut(&Covariance),
) {
    let mut ins = Strapdown::new(start);
    let mut covariance = uncertainty.at_start();
    write(&covariance);
    for rows in increments.chunks_exact(every) {
        let per_step = (STEP / rows[0].interval).ceil().max(1.0) as usize;
        for step in rows.chunks(per_step) {
            let (middle, force, interval) = passed(&mut ins, step);
            let [transition, added] = uncertainty.step(&middle, &force, interval);
            covariance = transition * covariance * transition.transpose() + added;
        }
        covariance = 0.5 * (covariance + covariance.transpose());
        write(&covariance);
    }
}

/// State in the middle of a few increments, their mean specific force, and their length.
fn passed(ins: &mut Strapdown, step: &[Increment]) -> (NavState, Vector3<f64>, f64) {
    let mut middle = *ins.state();
    let (mut force, mut interval) = (Vector3::zeros(), 0.0);
    for (k, increment) in step.iter().enumerate() {
        ins.advance(increment);
        force += increment.velocity;
        interval += increment.interval;
        if k == step.len() / 2 {
            middle = *ins.state();
        }
    }
    (middle, force / interval, interval)
}

/// The first nine standard deviations: position, velocity, attitude.
pub fn sigmas(covariance: &Covariance) -> [f64; 9] {
    std::array::from_fn(|k| covariance[(POSITION + k, POSITION + k)].max(0.0).sqrt())
}

#[cfg(test)]
mod tests;
