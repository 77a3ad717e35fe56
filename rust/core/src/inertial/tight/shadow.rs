//! After an alarm: the filter that goes on with all satellites, to see whether the alarm was right.
//!
//! The navigator has gone back to a trusted copy and coasts. The shadow is what it would have been:
//! an open-loop filter whose errors are those of the coasting navigator. An alarm proves nothing by
//! its size, one in so many epochs is as large: it is confirmed only by what comes after it. Under
//! an attack new sums of innovations alarm by themselves, or the shadow parts from the INS; after a
//! false alarm they have nothing to do with it, and both together are as good as impossible.

use super::copies::Copy;
use super::covariance::{Square, Transition, WORK_ROWS};
use super::epoch::{Deviations, Epoch, Kind};
use super::filter::ErrorFilter;
use super::monitors::windows;
use super::navigator::Navigator;
use super::settings::Testing;
use super::windows::{Windows, CLIP};
use super::NAV;

/// So far beyond its threshold the separation from the coasting navigator confirms. It holds what
/// alarmed, so that reaching it must be improbable by itself: 1e-5 in a clean run of 1500 s, in
/// which a separation exceeds z with 110 times the probability that a normal deviate does.
const BEYOND: f64 = 1.2;
/// Below this the separation since the alarm acquits: 999 of 1000 without an attack are.
const USUAL: f64 = 3.0;

/// The filter, its windows, and whether it runs.
pub struct Shadow {
    /// Its errors are what it finds the navigator's to be.
    pub filter: ErrorFilter,
    windows: [Windows; 3],
    /// What it would say had it coasted since the alarm, as errors of the navigator.
    left: Copy,
    active: bool,
    confirmed: bool,
    acquits: bool,
    work: Vec<f64>,
    innovations: Vec<f64>,
}

impl Shadow {
    /// Asleep.
    pub fn new(filter: &ErrorFilter, interval: f64, satellites: usize) -> Self {
        Shadow {
            filter: filter.clone(),
            windows: windows(interval, satellites),
            left: Copy::new(&filter.navigation(), 0.0),
            active: false,
            confirmed: false,
            acquits: false,
            work: vec![0.0; WORK_ROWS * NAV],
            innovations: vec![f64::NAN; satellites],
        }
    }

    /// Begins with what was put into the filter; what the windows held has alarmed and proves
    /// nothing any more.
    pub fn begin(&mut self) {
        self.windows.iter_mut().for_each(Windows::clear);
        self.left.covariance = self.filter.navigation();
        self.left.difference.copy_from_slice(&self.filter.x[..NAV]);
        (self.active, self.confirmed, self.acquits) = (true, false, false);
    }

    /// Whether what came after the alarm was an alarm of its own.
    pub fn confirmed(&self) -> bool {
        self.confirmed
    }

    /// Whether what came after the alarm is what comes without an attack.
    pub fn acquits(&self) -> bool {
        self.acquits
    }

    /// What it finds the navigator's errors to be, and their covariance, if it still follows.
    pub fn finding(&self) -> Option<([f64; NAV], Square)> {
        let mut errors = [0.0; NAV];
        errors.copy_from_slice(&self.filter.x[..NAV]);
        (self.active && !self.confirmed).then(|| (errors, self.filter.navigation()))
    }

    /// Ends.
    pub fn end(&mut self) {
        self.active = false;
    }

    /// Takes an epoch, and looks whether it confirms the alarm.
    pub fn follow(
        &mut self,
        navigator: &Navigator,
        epoch: &Epoch<'_>,
        dev: &Deviations,
        testing: &Testing,
    ) {
        if !self.active || self.confirmed {
            return;
        }
        let largest = self.epoch(navigator, epoch, dev, testing);
        let [old, new] = self.separations(&navigator.filter.navigation(), testing.slack);
        let t = &testing.thresholds;
        self.acquits = new < USUAL;
        self.confirmed =
            old > t[3] + BEYOND || new > t[3] || largest.iter().zip(t).any(|(z, limit)| z > limit);
    }

    /// Moves on in time.
    pub fn predict(&mut self, step: &Transition) {
        if self.active && !self.confirmed {
            self.filter.predict(step);
            self.left.predict(step, &mut self.work);
        }
    }

    /// Uses all satellites that the receiver does not call spoofed; gives the largest deviate of
    /// each kind of window.
    fn epoch(
        &mut self,
        navigator: &Navigator,
        epoch: &Epoch<'_>,
        dev: &Deviations,
        testing: &Testing,
    ) -> [f64; 3] {
        let mut largest = [0.0; 3];
        for (which, kind) in [Kind::Rate, Kind::Change, Kind::Range]
            .into_iter()
            .enumerate()
        {
            for k in 0..self.innovations.len() {
                let seen = navigator.observe(kind, k, epoch.system[k], dev);
                self.innovations[k] = match seen.filter(|_| !testing.flags(epoch, k)) {
                    Some((row, value, variance)) => {
                        let found = self.filter.update(&row, value, variance, testing.robust);
                        found.normalised().clamp(-CLIP, CLIP)
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

    /// How far it has parted from the coasting navigator, and from where the alarm left it.
    fn separations(&self, navigator: &Square, slack: f64) -> [f64; 2] {
        let own = self.filter.navigation();
        let from = |copy: &Square, begin: &[f64; NAV]| {
            let mut apart = Copy::new(copy, 0.0);
            for ((d, x), b) in apart.difference.iter_mut().zip(&self.filter.x).zip(begin) {
                *d = x - b;
            }
            apart.separation(&own, slack)[0]
        };
        [
            from(navigator, &[0.0; NAV]),
            from(&self.left.covariance, &self.left.difference),
        ]
    }
}
