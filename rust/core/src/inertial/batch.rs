//! Many runs over the same motion, each with the errors of its own IMU; parallel over the runs.

use rayon::prelude::*;

use super::ecef::{to_earth, EarthFixed};
use super::errors::{ErrorStream, ImuErrors};
use super::strapdown::{corrected, StateError, Strapdown};
use super::{Increment, NavState};
use crate::nav_math::geodesy::WGS84;

/// Numbers of a row of the output: Earth-fixed position, velocity, and yaw, pitch, roll.
pub const COLUMNS: usize = 9;

/// Axes in which is reckoned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mechanisation {
    /// North, east, down.
    Local,
    /// Earth-fixed.
    EarthFixed,
}

/// A new alignment in the course of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reset {
    /// Number of increments that have passed.
    pub after: usize,
    /// The truth then.
    pub state: NavState,
    /// Increments are missing before the next one: the row of output after the last one is not
    /// touched, and the next one does not follow from it.
    pub gap: bool,
}

/// A height in m and a velocity downwards in m/s that an altimeter knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertical {
    /// Above the ellipsoid.
    pub height: f64,
    /// m/s.
    pub down: f64,
}

/// What all runs share.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Of an ideal IMU.
    pub increments: &'a [Increment],
    /// The truth at the beginning.
    pub start: NavState,
    /// Ascending.
    pub resets: &'a [Reset],
    /// After each increment; none: the vertical channel runs free.
    pub vertical: Option<&'a [Vertical]>,
    /// A row of output each so many increments.
    pub every: usize,
    /// Local axes are the faster ones.
    pub mechanisation: Mechanisation,
}

/// One run.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// Errors of its IMU and the number of the run that seeds them; none: the increments are taken
    /// as they are.
    pub errors: Option<(ImuErrors, u64)>,
    /// Errors of the alignments: at the start, and at each reset. Shorter: none.
    pub alignments: &'a [StateError],
}

impl Plan<'_> {
    /// Rows of output of a run: the start, and after each `every` increments.
    pub fn rows(&self) -> usize {
        1 + self.increments.len() / self.every
    }
}

/// Either navigator.
enum Navigator {
    Local(Strapdown),
    EarthFixed(EarthFixed),
}

impl Navigator {
    fn new(mechanisation: Mechanisation, state: NavState) -> Self {
        match mechanisation {
            Mechanisation::Local => Navigator::Local(Strapdown::new(state)),
            Mechanisation::EarthFixed => Navigator::EarthFixed(EarthFixed::new(state)),
        }
    }

    #[inline]
    fn advance(&mut self, increment: &Increment) {
        match self {
            Navigator::Local(ins) => ins.advance(increment),
            Navigator::EarthFixed(ins) => ins.advance(increment),
        }
    }

    fn state(&self) -> NavState {
        match self {
            Navigator::Local(ins) => *ins.state(),
            Navigator::EarthFixed(ins) => ins.state(),
        }
    }

    fn restart(&mut self, state: NavState, gap: bool) {
        match self {
            _ if gap => *self = self.fresh(state),
            Navigator::Local(ins) => ins.restart(state),
            Navigator::EarthFixed(ins) => ins.restart(state),
        }
    }

    fn fresh(&self, state: NavState) -> Self {
        match self {
            Navigator::Local(_) => Navigator::Local(Strapdown::new(state)),
            Navigator::EarthFixed(_) => Navigator::EarthFixed(EarthFixed::new(state)),
        }
    }

    fn hold(&mut self, vertical: Vertical) {
        match self {
            Navigator::Local(ins) => ins.hold_vertical(vertical.height, vertical.down),
            Navigator::EarthFixed(ins) => {
                let mut state = ins.state();
                state.place.height = vertical.height;
                state.velocity.z = vertical.down;
                ins.restart(state);
            }
        }
    }
}

/// Runs all; `out` holds `COLUMNS` times `plan.rows()` numbers for each run.
pub fn navigate(plan: &Plan<'_>, runs: &[Run<'_>], out: &mut [f64]) {
    out.par_chunks_mut(COLUMNS * plan.rows())
        .zip(runs)
        .for_each(|(rows, run)| one(plan, run, rows));
}

fn one(plan: &Plan<'_>, run: &Run<'_>, out: &mut [f64]) {
    let mut errors = run
        .errors
        .map(|(errors, number)| ErrorStream::new(&errors, number));
    let mut ins = Navigator::new(plan.mechanisation, aligned(&plan.start, run, 0));
    let mut resets = plan.resets.iter().enumerate().peekable();
    let mut rows = out.chunks_exact_mut(COLUMNS);
    write(&ins, rows.next());
    for (k, ideal) in plan.increments.iter().enumerate() {
        let mut increment = *ideal;
        if let Some(errors) = &mut errors {
            errors.apply(&mut increment);
        }
        ins.advance(&increment);
        if let Some(vertical) = plan.vertical {
            ins.hold(vertical[k]);
        }
        let gap = resets.peek().is_some_and(|(_, reset)| reset.gap);
        if gap && (k + 1) % plan.every == 0 {
            write(&ins, rows.next());
        }
        while let Some((number, reset)) = resets.next_if(|(_, reset)| reset.after <= k + 1) {
            let state = aligned(&reset.state, run, number + 1);
            ins.restart(state, reset.gap);
        }
        if !gap && (k + 1) % plan.every == 0 {
            write(&ins, rows.next());
        }
    }
}

/// The truth with the errors of an alignment.
fn aligned(truth: &NavState, run: &Run<'_>, number: usize) -> NavState {
    let Some(error) = run.alignments.get(number) else {
        return *truth;
    };
    let opposite = StateError {
        position: -error.position,
        velocity: -error.velocity,
        attitude: -error.attitude,
    };
    corrected(truth, &opposite)
}

fn write(ins: &Navigator, row: Option<&mut [f64]>) {
    let state = ins.state();
    let (roll, pitch, yaw) = state.attitude.euler_angles();
    let position = WGS84.ecef(state.place);
    let velocity = to_earth(state.place) * state.velocity;
    if let Some(row) = row {
        row[..3].copy_from_slice(position.as_slice());
        row[3..6].copy_from_slice(velocity.as_slice());
        row[6..].copy_from_slice(&[yaw, pitch, roll]);
    }
}

#[cfg(test)]
mod tests;
