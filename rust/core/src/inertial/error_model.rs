//! How errors of an INS grow: phi-angle model in local axes, 15 states.
//!
//! D. H. Titterton, J. L. Weston, "Strapdown Inertial Navigation Technology", 2nd ed. (2004),
//! section 12.3. Errors are what the INS says minus the truth: position (north, east, down, m),
//! velocity (m/s), attitude phi (rad; the INS says (1 - phi x) times the truth), what gyros (rad/s)
//! and accelerometers (m/s^2) still sense too much, in body axes.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::earth::{Earth, ROTATION_RATE};
use super::{gravity, NavState};

/// Number of error states.
pub const STATES: usize = 15;
/// First of the three position errors.
pub const POSITION: usize = 0;
/// First of the three velocity errors.
pub const VELOCITY: usize = 3;
/// First of the three attitude errors.
pub const ATTITUDE: usize = 6;
/// First of the three gyro biases.
pub const GYRO: usize = 9;
/// First of the three accelerometer biases.
pub const ACCELEROMETER: usize = 12;

/// Square matrix over the error states.
pub type Square = SMatrix<f64, STATES, STATES>;

/// F of d(error)/dt = F error, at a state and a specific force in body axes, m/s^2. The biases are
/// taken as constant: a filter adds -1/tau on the diagonal for Gauss-Markov ones.
pub fn dynamics(state: &NavState, specific_force: &Vector3<f64>) -> Square {
    let earth = Earth::at(state.place.latitude, state.place.height);
    let axes = state.attitude.to_rotation_matrix().into_inner();
    let force = axes * specific_force;
    let v = &state.velocity;
    let (rotation, transport) = (earth.rotation(), earth.transport(v));
    let by_position = turn_by_position(&earth, v);
    let by_velocity = turn_by_velocity(&earth);
    let earth_by_position = earth_turn_by_position(&earth);

    let mut f = Square::zeros();
    let mut set = |row, column, block: Matrix3<f64>| {
        f.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
    };
    set(POSITION, POSITION, position_by_position(&earth, v));
    set(POSITION, VELOCITY, Matrix3::identity());
    let cross_v = v.cross_matrix();
    let mut pull = cross_v * (2.0 * earth_by_position + by_position);
    pull[(2, 0)] += gravity::along_meridian(earth.sin, earth.cos) / earth.meridian;
    pull[(2, 2)] += 2.0 * gravity::normal(earth.sin, state.place.height) / earth.mean();
    set(VELOCITY, POSITION, pull);
    let coriolis = (2.0 * rotation + transport).cross_matrix();
    set(VELOCITY, VELOCITY, cross_v * by_velocity - coriolis);
    set(VELOCITY, ATTITUDE, force.cross_matrix());
    set(VELOCITY, ACCELEROMETER, axes);
    set(ATTITUDE, POSITION, earth_by_position + by_position);
    set(ATTITUDE, VELOCITY, by_velocity);
    set(ATTITUDE, ATTITUDE, -(rotation + transport).cross_matrix());
    set(ATTITUDE, GYRO, -axes);
    f
}

/// exp(F interval) to second order: good to a part in 1e6 over a second.
pub fn transition(f: &Square, interval: f64) -> Square {
    let step = f * interval;
    Square::identity() + step + 0.5 * step * step
}

/// Latitude and longitude errors in metres grow as the radii and the cosine change on the way.
fn position_by_position(earth: &Earth, v: &Vector3<f64>) -> Matrix3<f64> {
    let (m, n, tan) = (earth.meridian, earth.normal, earth.sin / earth.cos);
    Matrix3::new(
        -v.z / m,
        0.0,
        v.x / m,
        v.y * tan / m,
        -v.z / n - v.x * tan / m,
        v.y / n,
        0.0,
        0.0,
        0.0,
    )
}

/// Of the transport rate.
fn turn_by_position(earth: &Earth, v: &Vector3<f64>) -> Matrix3<f64> {
    let (m, n, tan) = (earth.meridian, earth.normal, earth.sin / earth.cos);
    Matrix3::new(
        0.0,
        0.0,
        v.y / (n * n),
        0.0,
        0.0,
        -v.x / (m * m),
        -v.y / (m * n * earth.cos * earth.cos),
        0.0,
        -v.y * tan / (n * n),
    )
}

/// Of the transport rate.
fn turn_by_velocity(earth: &Earth) -> Matrix3<f64> {
    let (m, n, tan) = (earth.meridian, earth.normal, earth.sin / earth.cos);
    Matrix3::new(0.0, 1.0 / n, 0.0, -1.0 / m, 0.0, 0.0, 0.0, -tan / n, 0.0)
}

fn earth_turn_by_position(earth: &Earth) -> Matrix3<f64> {
    let mut turn = Matrix3::zeros();
    turn[(0, 0)] = -ROTATION_RATE * earth.sin / earth.meridian;
    turn[(2, 0)] = -ROTATION_RATE * earth.cos / earth.meridian;
    turn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::closed_form;
    use crate::inertial::strapdown::{corrected, error_of, StateError, Strapdown};
    use nalgebra::SVector;

    type Errors = SVector<f64, STATES>;

    fn part(errors: &Errors, first: usize) -> Vector3<f64> {
        errors.fixed_rows::<3>(first).into_owned()
    }

    /// Errors after 60 s by the model, and by two navigators of which one is spoiled.
    fn grown(start: &Errors) -> (Errors, Errors) {
        let path = closed_form::aircraft();
        let opposite = StateError {
            position: -part(start, POSITION),
            velocity: -part(start, VELOCITY),
            attitude: -part(start, ATTITUDE),
        };
        let truth = path.state(0.0);
        let mut ideal = Strapdown::new(truth);
        let mut spoiled = Strapdown::new(corrected(&truth, &opposite));
        let mut model = *start;
        for k in 0..6000 {
            let t = f64::from(k) * 0.01;
            let f = dynamics(&path.state(t + 0.005), &path.felt(t + 0.005).1);
            model = transition(&f, 0.01) * model;
            let mut increment = path.increment(t, 0.01);
            ideal.advance(&increment);
            increment.rotation += part(start, GYRO) * 0.01;
            increment.velocity += part(start, ACCELEROMETER) * 0.01;
            spoiled.advance(&increment);
        }
        let found = error_of(spoiled.state(), ideal.state());
        let mut errors = *start;
        for (first, value) in [
            (POSITION, found.position),
            (VELOCITY, found.velocity),
            (ATTITUDE, found.attitude),
        ] {
            errors.fixed_rows_mut::<3>(first).copy_from(&value);
        }
        (model, errors)
    }

    #[test]
    fn each_error_grows_as_two_navigators_do() {
        let sizes = [100.0, 1.0, 1e-3, 1e-6, 1e-3];
        for state in 0..STATES {
            let mut start = Errors::zeros();
            start[state] = sizes[state / 3];
            let (model, found) = grown(&start);
            for first in [POSITION, VELOCITY, ATTITUDE] {
                let (want, got) = (part(&found, first), part(&model, first));
                let floor = 1e-3 * sizes[first / 3] * 1e-3;
                assert!(
                    (want - got).norm() < 5e-3 * want.norm() + floor,
                    "{state} {first}: {want} {got}"
                );
            }
        }
    }
}
