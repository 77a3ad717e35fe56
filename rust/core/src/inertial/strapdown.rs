//! Strapdown navigation in local axes: north, east, down.
//!
//! D. H. Titterton, J. L. Weston, "Strapdown Inertial Navigation Technology", 2nd ed. (2004),
//! chapters 3 and 11; P. G. Savage (see `coning`). Earth rate, transport rate and gravity are taken
//! at the middle of the interval. Not for use at the poles, where north ends: see `ecef`.

use std::f64::consts::{PI, TAU};

use nalgebra::{UnitQuaternion, Vector3};

use super::coning::{self, History, Motion};
use super::earth::Earth;
use super::{gravity, Increment, NavState};
use crate::nav_math::geodesy::WGS84;

/// What a filter has found to be wrong in a state: what it says minus the truth, in local axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StateError {
    /// North, east, down, m.
    pub position: Vector3<f64>,
    /// m/s.
    pub velocity: Vector3<f64>,
    /// Phi angles, rad: the attitude says (1 - phi x) times the truth.
    pub attitude: Vector3<f64>,
}

/// An inertial navigator: a state, and the increments before, which tell how the next one begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strapdown {
    state: NavState,
    history: History,
}

impl Strapdown {
    /// Starts from a state.
    pub fn new(state: NavState) -> Self {
        Strapdown {
            state,
            history: History::default(),
        }
    }

    /// At the end of the last increment.
    pub fn state(&self) -> &NavState {
        &self.state
    }

    /// Takes another state, and keeps what is known of the motion: re-alignment.
    pub fn restart(&mut self, state: NavState) {
        self.state = state;
    }

    /// Forgets the increments before: after a gap, or where the next one does not follow it.
    pub fn interrupt(&mut self) {
        self.history = History::default();
    }

    /// Moves on by one increment.
    #[inline]
    pub fn advance(&mut self, increment: &Increment) {
        let motion = self.history.motion(increment);
        self.state = step(&self.state, &motion, increment.interval);
    }

    /// Takes off errors that a filter has found: closed loop.
    pub fn correct(&mut self, error: &StateError) {
        self.state = corrected(&self.state, error);
    }

    /// Holds the vertical channel, which drifts away by itself, to a height in m and a velocity
    /// downwards in m/s that something else knows.
    pub fn hold_vertical(&mut self, height: f64, down: f64) {
        self.state.place.height = height;
        self.state.velocity.z = down;
    }
}

/// State without its errors.
pub fn corrected(state: &NavState, error: &StateError) -> NavState {
    let earth = Earth::at(state.place.latitude, state.place.height);
    let mut next = *state;
    let [north, east] = earth.angles(error.position.x, error.position.y);
    next.place.latitude -= north;
    next.place.longitude = wrapped(state.place.longitude - east);
    next.place.height += error.position.z;
    next.velocity -= error.velocity;
    next.attitude = coning::quaternion(&error.attitude) * state.attitude;
    next
}

/// What `state` says minus what `truth` does: the errors that [`corrected`] would take off.
pub fn error_of(state: &NavState, truth: &NavState) -> StateError {
    let earth = Earth::at(truth.place.latitude, truth.place.height);
    StateError {
        position: Vector3::new(
            (state.place.latitude - truth.place.latitude) * earth.meridian,
            wrapped(state.place.longitude - truth.place.longitude) * earth.normal * earth.cos,
            truth.place.height - state.place.height,
        ),
        velocity: state.velocity - truth.velocity,
        attitude: (truth.attitude * state.attitude.inverse()).scaled_axis(),
    }
}

/// One interval, from the motion in it.
#[inline]
fn step(state: &NavState, motion: &Motion, interval: f64) -> NavState {
    let half = interval / 2.0;
    let (place, start) = (&state.place, &state.velocity);
    // The mean radius will do for half an interval: a part of a millimetre at any speed.
    let earth = Earth::at(
        place.latitude + half * start.x / WGS84.a,
        place.height - half * start.z,
    );
    let down = gravity::normal(earth.sin, place.height - half * start.z);
    let pull = Vector3::new(0.0, 0.0, down);
    let felt = state.attitude * motion.velocity;
    let rotation = earth.rotation();
    let coriolis = |v: &Vector3<f64>| (2.0 * rotation + earth.transport(v)).cross(v);
    let unturned = start + 0.5 * felt + half * pull;
    let middle = unturned - half * coriolis(&unturned);
    let turn = interval * (rotation + earth.transport(&middle));
    let push = interval * (pull - coriolis(&middle));
    let velocity = start + felt - 0.5 * turn.cross(&felt) + push;
    let mean = 0.5 * (start + velocity);
    let mut next = *state;
    let [north, east] = earth.angles(interval * mean.x, interval * mean.y);
    next.place.latitude += north;
    next.place.longitude = wrapped(place.longitude + east);
    next.place.height -= interval * mean.z;
    next.velocity = velocity;
    next.attitude = attitude(&state.attitude, &turn, &motion.rotation);
    next
}

/// Body turned against inertial space, local axes turned likewise; the length kept at 1.
#[inline]
pub(super) fn attitude(
    before: &UnitQuaternion<f64>,
    local: &Vector3<f64>,
    body: &Vector3<f64>,
) -> UnitQuaternion<f64> {
    let turned = coning::quaternion(&-local) * before * coning::quaternion(body);
    let q = turned.into_inner();
    UnitQuaternion::new_unchecked(q * (1.5 - 0.5 * q.norm_squared()))
}

#[inline]
fn wrapped(longitude: f64) -> f64 {
    if longitude.abs() <= PI {
        longitude
    } else {
        longitude - TAU * (longitude / TAU).round()
    }
}

#[cfg(test)]
mod tests;
