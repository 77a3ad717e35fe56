//! After an alarm: the filter that goes on with all satellites, to see whether the alarm was right.
//!
//! The navigator has gone back to a trusted copy and coasts. The shadow is what it would have been:
//! an open-loop filter whose errors are those of the coasting navigator. Under an attack the tests
//! that alarmed go on growing in it, and it parts from the copy; after a false alarm they do not.

use super::covariance::{Square, Transition};
use super::epoch::{Deviations, Epoch, Kind};
use super::filter::ErrorFilter;
use super::navigator::Navigator;
use super::windows::{deviate, Windows};
use super::{NAV, POSITION, VELOCITY};

/// The filter, its windows, and whether it runs.
pub struct Shadow {
    /// Its errors are what it finds the navigator's to be.
    pub filter: ErrorFilter,
    /// Taken over from the navigator.
    pub windows: [Windows; 3],
    /// Whether it runs.
    pub active: bool,
    innovations: Vec<f64>,
}

impl Shadow {
    /// Asleep.
    pub fn new(filter: &ErrorFilter, windows: &[Windows; 3], satellites: usize) -> Self {
        Shadow {
            filter: filter.clone(),
            windows: windows.clone(),
            active: false,
            innovations: vec![f64::NAN; satellites],
        }
    }

    /// Moves on in time.
    pub fn predict(&mut self, step: &Transition) {
        if self.active {
            self.filter.predict(step);
        }
    }

    /// Uses all satellites of an epoch but those `without`; gives the largest deviate of each kind
    /// of window.
    pub fn epoch(
        &mut self,
        navigator: &Navigator,
        epoch: &Epoch<'_>,
        dev: &Deviations,
        without: impl Fn(usize) -> bool,
        robust: f64,
        clip: f64,
    ) -> [f64; 3] {
        let mut largest = [0.0; 3];
        for (which, kind) in [Kind::Rate, Kind::Change, Kind::Range]
            .into_iter()
            .enumerate()
        {
            for k in 0..self.innovations.len() {
                let seen = navigator.observe(kind, k, epoch.system[k], dev);
                self.innovations[k] = match seen.filter(|_| !without(k)) {
                    Some((row, value, variance)) => {
                        let found = self.filter.update(&row, value, variance, robust);
                        found.normalised().clamp(-clip, clip)
                    }
                    None => f64::NAN,
                };
            }
            self.windows[which].push(&self.innovations);
            largest[which] = self.windows[which].deviates().fold(0.0, f64::max);
        }
        self.filter.remember();
        largest
    }

    /// How far it has parted from the coasting navigator, horizontally.
    pub fn separation(&self, navigator: &Square) -> f64 {
        const N: usize = 4;
        let state = [POSITION, POSITION + 1, VELOCITY, VELOCITY + 1];
        let own = self.filter.navigation();
        let spread = nalgebra::SMatrix::<f64, N, N>::from_fn(|r, c| {
            navigator[state[r]][state[c]] - own[state[r]][state[c]]
        });
        let x = nalgebra::SVector::<f64, N>::from_fn(|k, _| self.filter.x[state[k]]);
        debug_assert!(self.filter.x.len() >= NAV);
        match spread.cholesky() {
            Some(root) => deviate(x.dot(&root.solve(&x)), N),
            None => 0.0,
        }
    }
}
