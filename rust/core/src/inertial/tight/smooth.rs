//! Every epoch from all measurements, those after it as well: fixed-interval smoothing.
//!
//! In closed loop each epoch's errors are those of the navigator as it was corrected then, and
//! their expectation is 0. What was taken off is known, so that `adjoint`, which only carries what
//! innovations say, needs no account of it; the smoothed errors are taken off once more. Where the
//! guard went back to a trusted copy the record is the copy's way (see `tape`), and the smoother
//! leads from the last epoch that was trusted to the first one after the coasting. Where it went
//! over to the shadow, whose way was not recorded, the record breaks: either side is smoothed alone.

use super::adjoint::Adjoint;
use super::tape::{without, Anew, Tape};
use super::{ATTITUDE, NAV, POSITION, VELOCITY};
use crate::inertial::NavState;

/// Columns of all epochs, as those of `Output`; NaN without an IMU.
#[derive(Debug, Clone, Default)]
pub struct Smoothed {
    /// Latitude, longitude in rad, height in m.
    pub place: Vec<[f64; 3]>,
    /// North, east, down, m/s.
    pub velocity: Vec<[f64; 3]>,
    /// Yaw, pitch, roll, rad.
    pub attitude: Vec<[f64; 3]>,
    /// Of position, velocity and attitude: 3 x 3 each.
    pub covariance: Vec<[f64; 27]>,
}

impl Smoothed {
    fn unknown(epochs: usize) -> Self {
        Smoothed {
            place: vec![[f64::NAN; 3]; epochs],
            velocity: vec![[f64::NAN; 3]; epochs],
            attitude: vec![[f64::NAN; 3]; epochs],
            covariance: vec![[f64::NAN; 27]; epochs],
        }
    }

    fn put(&mut self, epoch: usize, state: &NavState, covariance: &[[f64; 9]; 3]) {
        let (roll, pitch, yaw) = state.attitude.euler_angles();
        let place = &state.place;
        self.place[epoch] = [place.latitude, place.longitude, place.height];
        self.velocity[epoch] = state.velocity.into();
        self.attitude[epoch] = [yaw, pitch, roll];
        self.covariance[epoch].copy_from_slice(covariance.as_flattened());
    }
}

/// Goes back over a record, to a row for each of so many epochs.
pub fn smooth(tape: &Tape, epochs: usize) -> Smoothed {
    let mut made = Smoothed::unknown(epochs);
    let layout = tape.layout;
    let coloured = layout
        .wander
        .map_or(NAV..NAV, |first| first..layout.systems);
    let mut back = Adjoint::new(layout.count);
    for k in (0..tape.len()).rev() {
        let (entry, rows) = (tape.entry(k), tape.rows(k));
        let state = without(&entry.state, &back.errors(rows));
        let covariance = back.covariance(rows, [POSITION, VELOCITY, ATTITUDE]);
        made.put(entry.epoch, &state, &covariance);
        match entry.anew {
            Anew::Nothing => (),
            Anew::Behind => back.began_anew(),
            Anew::Everything => back = Adjoint::new(layout.count),
        }
        if let Some(past) = layout.past {
            back.remembered(past);
        }
        tape.measurements(k).rev().for_each(|one| back.used(&one));
        for step in tape.steps(k).rev() {
            let keeps = tape.fading(step.interval);
            back.moved(&step, coloured.clone(), keeps);
        }
    }
    made
}

#[cfg(test)]
mod tests;
