//! What the smoother has to know of a run: motion, measurements that were used, covariance.
//!
//! Transitions are not kept but formed again from the motion. With n states and m measurements an
//! epoch takes 8 (17 + m) n bytes, about 100 m for the rows, and 0.3 kB.

use std::ops::Range;

use nalgebra::Vector3;

use super::covariance::{Row, Square, Transition, WORK_ROWS};
use super::filter::{ErrorFilter, Layout};
use super::motion::Motion;
use super::settings::Settings;
use super::{ATTITUDE, NAV, POSITION, VELOCITY};
use crate::inertial::strapdown::{corrected, StateError};
use crate::inertial::NavState;

/// Times that differ by less are the same, s.
const SAME: f64 = 1e-6;
/// Most columns of a row that are not 0, but for offsets of systems.
const COLUMNS: usize = 8;

/// What of the states begins anew at an epoch: nothing later says anything of what they were before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anew {
    /// No state.
    Nothing,
    /// All states behind those of navigation.
    Behind,
    /// All states.
    Everything,
}

/// An epoch after its last correction.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Its row.
    pub epoch: usize,
    /// s.
    pub time: f64,
    /// What the navigator says.
    pub state: NavState,
    /// Which states are not those of the epoch before.
    pub anew: Anew,
    legs: usize,
    used: usize,
}

/// A scalar measurement that moved the states.
#[derive(Debug, Clone, Copy)]
pub struct Used<'a> {
    /// Columns of its row that are not 0.
    pub columns: &'a [u16],
    /// What stands there.
    pub values: &'a [f64],
    /// Covariance before times the row.
    pub gain: &'a [f64],
    /// Variance of the innovation, as it was weighed.
    pub s: f64,
    /// Predicted minus measured.
    pub innovation: f64,
}

/// The record of a run; what has happened since the last epoch belongs to the next one.
#[derive(Debug, Clone)]
pub struct Tape {
    settings: Settings,
    /// Where the states are.
    pub layout: Layout,
    first: Square,
    start: f64,
    anew: Anew,
    entries: Vec<Entry>,
    legs: Vec<(Motion, NavState)>,
    /// Variance, innovation, and where the columns of each measurement end.
    used: Vec<(f64, f64, usize)>,
    gains: Vec<f64>,
    columns: Vec<u16>,
    values: Vec<f64>,
    /// Of the navigation states of each epoch, NAV x n.
    rows: Vec<f64>,
}

impl Tape {
    /// Empty, before the first epoch; with room for so many epochs and measurements, so that no
    /// memory is taken twice.
    pub fn new(
        settings: &Settings,
        filter: &ErrorFilter,
        start: f64,
        epochs: usize,
        measurements: usize,
    ) -> Self {
        let n = filter.layout.count;
        Tape {
            settings: settings.clone(),
            layout: filter.layout,
            first: filter.navigation(),
            start,
            anew: Anew::Nothing,
            entries: Vec::with_capacity(epochs),
            legs: Vec::with_capacity(epochs),
            used: Vec::with_capacity(measurements),
            gains: Vec::with_capacity(measurements * n),
            columns: Vec::with_capacity(measurements * COLUMNS),
            values: Vec::with_capacity(measurements * COLUMNS),
            rows: Vec::with_capacity(epochs * NAV * n),
        }
    }

    /// The filter goes on by this motion, at whose end the navigator is in this state.
    pub fn moved(&mut self, motion: Motion, state: &NavState) {
        self.legs.push((motion, *state));
    }

    /// The filter has used a measurement.
    pub fn used(&mut self, row: &Row, gain: &[f64], s: f64, innovation: f64) {
        for (column, value) in row.entries() {
            self.columns.push(column as u16);
            self.values.push(value);
        }
        self.gains.extend_from_slice(gain);
        self.used.push((s, innovation, self.columns.len()));
    }

    /// An epoch ends: its row, time, state, and the covariance of all states.
    pub fn close(&mut self, epoch: usize, time: f64, state: NavState, p: &[f64]) {
        self.rows.extend_from_slice(&p[..NAV * self.layout.count]);
        self.entries.push(Entry {
            epoch,
            time,
            state,
            anew: std::mem::replace(&mut self.anew, Anew::Nothing),
            legs: self.legs.len(),
            used: self.used.len(),
        });
    }

    /// The navigator goes back to the copy that parted from it at `born`: since then nothing was
    /// measured, and the way is that of the copy.
    pub fn take_back(&mut self, born: f64) {
        let kept = match born <= self.start + SAME {
            true => 0,
            false => self.entries.partition_point(|e| e.time <= born + SAME),
        };
        let (mut apart, mut covariance) = ([0.0; NAV], self.navigation(kept));
        let mut work = vec![0.0; WORK_ROWS * NAV];
        for k in kept..self.entries.len() {
            for step in self.steps(k) {
                step.carry(&mut apart);
                step.spread(covariance.as_flattened_mut(), NAV, &mut work);
            }
            for one in self.measurements(k) {
                for (a, g) in apart.iter_mut().zip(one.gain) {
                    *a -= g * one.innovation / one.s;
                }
            }
            self.entries[k].state = without(&self.entries[k].state, &apart);
            self.write(k, &covariance);
        }
        self.forget_since(kept);
        self.anew = Anew::Behind;
    }

    /// At the next epoch the navigator has gone over to an estimate that does not come from its own.
    pub fn begin_anew(&mut self) {
        self.anew = Anew::Everything;
    }

    /// How many epochs there are.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// One epoch.
    pub fn entry(&self, k: usize) -> &Entry {
        &self.entries[k]
    }

    /// Covariance of its navigation states with all states, NAV x n.
    pub fn rows(&self, k: usize) -> &[f64] {
        let length = NAV * self.layout.count;
        &self.rows[k * length..(k + 1) * length]
    }

    /// Transitions from the epoch before to this one.
    pub fn steps(&self, k: usize) -> impl DoubleEndedIterator<Item = Transition> + '_ {
        let legs = &self.legs[self.since(k, |e| e.legs)];
        legs.iter()
            .map(|(motion, state)| motion.transition(state, &self.settings))
    }

    /// What was measured at an epoch, in the order of use.
    pub fn measurements(&self, k: usize) -> impl DoubleEndedIterator<Item = Used<'_>> + '_ {
        self.since(k, |e| e.used).map(|m| self.measurement(m))
    }

    /// How far coloured errors of codes have faded after `interval`.
    pub fn fading(&self, interval: f64) -> f64 {
        (-interval / self.settings.receiver.wander_time).exp()
    }

    fn since(&self, k: usize, end: impl Fn(&Entry) -> usize) -> Range<usize> {
        let before = k.checked_sub(1).map_or(0, |b| end(&self.entries[b]));
        before..end(&self.entries[k])
    }

    fn measurement(&self, m: usize) -> Used<'_> {
        let (s, innovation, end) = self.used[m];
        let begin = m.checked_sub(1).map_or(0, |b| self.used[b].2);
        let n = self.layout.count;
        Used {
            columns: &self.columns[begin..end],
            values: &self.values[begin..end],
            gain: &self.gains[m * n..(m + 1) * n],
            s,
            innovation,
        }
    }

    /// Covariance of the navigation states when so many epochs were over.
    fn navigation(&self, epochs: usize) -> Square {
        let n = self.layout.count;
        match epochs {
            0 => self.first,
            k => std::array::from_fn(|r| std::array::from_fn(|c| self.rows(k - 1)[r * n + c])),
        }
    }

    /// Another covariance, independent of the states behind.
    fn write(&mut self, k: usize, covariance: &Square) {
        let n = self.layout.count;
        let rows = &mut self.rows[k * NAV * n..(k + 1) * NAV * n];
        for (row, values) in rows.chunks_exact_mut(n).zip(covariance) {
            row.fill(0.0);
            row[..NAV].copy_from_slice(values);
        }
    }

    /// Drops all measurements but those of so many epochs.
    fn forget_since(&mut self, kept: usize) {
        let used = kept.checked_sub(1).map_or(0, |b| self.entries[b].used);
        let columns = used.checked_sub(1).map_or(0, |m| self.used[m].2);
        self.used.truncate(used);
        self.gains.truncate(used * self.layout.count);
        self.columns.truncate(columns);
        self.values.truncate(columns);
        for entry in &mut self.entries[kept..] {
            entry.used = used;
        }
    }
}

/// A state without these errors.
pub fn without(state: &NavState, errors: &[f64; NAV]) -> NavState {
    let three = |first: usize| Vector3::new(errors[first], errors[first + 1], errors[first + 2]);
    let found = StateError {
        position: three(POSITION),
        velocity: three(VELOCITY),
        attitude: three(ATTITUDE),
    };
    corrected(state, &found)
}
