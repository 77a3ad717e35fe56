//! Strapdown navigation in Earth-fixed axes: everywhere, the poles included, and an independent
//! check of the one in local axes.
//!
//! P. D. Groves, "Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems",
//! 2nd ed. (2013), section 5.3, with the increments of `coning`.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::coning::History;
use super::earth::ROTATION_RATE;
use super::strapdown::{self, StateError};
use super::{gravity, Increment, NavState};
use crate::nav_math::geodesy::{enu, Geodetic, WGS84};

/// An inertial navigator that reckons in Earth-fixed axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EarthFixed {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
    history: History,
}

impl EarthFixed {
    /// Starts from a state.
    pub fn new(state: NavState) -> Self {
        let axes = to_earth(state.place);
        EarthFixed {
            position: WGS84.ecef(state.place),
            velocity: axes * state.velocity,
            attitude: axes * state.attitude,
            history: History::default(),
        }
    }

    /// At the end of the last increment, in local axes.
    pub fn state(&self) -> NavState {
        let place = WGS84.geodetic(self.position);
        let axes = to_earth(place).inverse();
        NavState {
            place,
            velocity: axes * self.velocity,
            attitude: axes * self.attitude,
        }
    }

    /// Takes another state, and keeps what is known of the motion: re-alignment.
    pub fn restart(&mut self, state: NavState) {
        let history = self.history;
        *self = EarthFixed::new(state);
        self.history = history;
    }

    /// Takes off errors that a filter has found, in local axes: closed loop.
    pub fn correct(&mut self, error: &StateError) {
        self.restart(strapdown::corrected(&self.state(), error));
    }

    /// Moves on by one increment.
    pub fn advance(&mut self, increment: &Increment) {
        let (motion, interval) = (self.history.motion(increment), increment.interval);
        let half = interval / 2.0;
        let rotation = Vector3::new(0.0, 0.0, ROTATION_RATE);
        let pull = pull(&(self.position + half * self.velocity));
        let felt = self.attitude * motion.velocity;
        let unturned = self.velocity + 0.5 * felt + half * pull;
        let middle = unturned - interval * rotation.cross(&unturned);
        let turn = interval * rotation;
        let push = interval * (pull - 2.0 * rotation.cross(&middle));
        let velocity = self.velocity + felt - 0.5 * turn.cross(&felt) + push;
        self.position += half * (self.velocity + velocity);
        self.velocity = velocity;
        self.attitude = strapdown::attitude(&self.attitude, &turn, &motion.rotation);
    }
}

/// Normal gravity in Earth-fixed axes, m/s^2.
fn pull(position: &Vector3<f64>) -> Vector3<f64> {
    let place = WGS84.geodetic(*position);
    let (sin, cos) = place.latitude.sin_cos();
    let (sin_l, cos_l) = place.longitude.sin_cos();
    -gravity::normal(sin, place.height) * Vector3::new(cos * cos_l, cos * sin_l, sin)
}

/// From local (north, east, down) to Earth-fixed axes.
pub fn to_earth(place: Geodetic) -> UnitQuaternion<f64> {
    let axes = enu(place);
    let (east, north, up) = (axes.row(0), axes.row(1), axes.row(2));
    let columns = Matrix3::from_rows(&[north.into(), east.into(), -up]).transpose();
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(columns))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::closed_form::{self, Path};
    use crate::inertial::strapdown::{error_of, Strapdown};

    /// Both ways through the same increments, spoiled as a real IMU's are.
    fn agree(path: &Path) {
        let (mut local, mut fixed) = (
            Strapdown::new(path.state(0.0)),
            EarthFixed::new(path.state(0.0)),
        );
        for k in 0..60_000 {
            let mut increment = path.increment(f64::from(k) * 0.01, 0.01);
            increment.rotation += Vector3::new(5e-9, -5e-9, 5e-9);
            increment.velocity += Vector3::new(-1e-5, 1e-5, 1e-5);
            local.advance(&increment);
            fixed.advance(&increment);
        }
        let error = error_of(&fixed.state(), local.state());
        assert!(error.position.norm() < 1e-3, "{error:?}");
        assert!(error.velocity.norm() < 1e-6, "{error:?}");
        assert!(error.attitude.norm() < 1e-9, "{error:?}");
    }

    #[test]
    fn both_mechanisations_agree() {
        agree(&closed_form::vehicle());
        agree(&closed_form::aircraft());
        agree(&closed_form::ship());
    }

    #[test]
    fn it_closes_too() {
        let path = closed_form::aircraft();
        let mut ins = EarthFixed::new(path.state(0.0));
        for k in 0..175_000 {
            ins.advance(&path.increment(f64::from(k) * 0.01, 0.01));
        }
        let error = error_of(&ins.state(), &path.state(1750.0));
        assert!(error.velocity.norm() < 1e-4, "{error:?}");
        assert!(error.position.norm() < 0.05, "{error:?}");
    }

    #[test]
    fn a_state_comes_back() {
        let state = closed_form::aircraft().state(50.0);
        let mut ins = EarthFixed::new(state);
        let error = StateError {
            position: Vector3::new(1.0, 2.0, 3.0),
            ..StateError::default()
        };
        let back = error_of(&ins.state(), &state);
        assert!(back.position.norm() < 1e-6 && back.attitude.norm() < 1e-12);
        ins.correct(&error);
        let moved = error_of(&ins.state(), &state);
        assert!((moved.position + error.position).norm() < 1e-5);
    }
}
