//! The tests of every epoch: windows of innovations, separation from copies, power.

use super::alarms::{limit, CLOCKS, POWER, SEPARATION, TESTS, WINDOWS};
use super::copies::{Copies, SPANS};
use super::covariance::Square;
use super::guard::Alarm;
use super::power::Power;
use super::settings::Testing;
use super::windows::Windows;

/// All of them, and what they said last.
pub struct Monitors {
    windows: [Windows; 3],
    power: Power,
    interval: f64,
    /// By number, see `alarms`.
    pub deviates: [f64; TESTS],
}

impl Monitors {
    /// For epochs so many seconds apart.
    pub fn new(interval: f64, satellites: usize) -> Self {
        Monitors {
            windows: windows(interval, satellites),
            power: Power::new(satellites),
            interval,
            deviates: [0.0; TESTS],
        }
    }

    /// Takes an epoch: whitened innovations of rates, changes and codes, and C/N0 of the
    /// satellites in use (NaN: none).
    pub fn push(&mut self, innovations: &[Vec<f64>; 3], cn0: &[f64]) {
        let mut at = 0;
        for (windows, innovations) in self.windows.iter_mut().zip(innovations) {
            windows.push(innovations);
            for deviate in windows.deviates() {
                self.deviates[at] = deviate;
                at += 1;
            }
        }
        self.deviates[POWER] = self.power.push(cn0, self.interval);
    }

    /// Compares the navigator, whose covariance is `now`, with its copies.
    pub fn compare(&mut self, copies: &Copies, now: &Square, slack: f64) {
        for span in 0..SPANS.len() {
            let [place, clock] = copies.older(span).separation(now, slack);
            self.deviates[SEPARATION + span] = place;
            self.deviates[CLOCKS + span] = clock;
        }
    }

    /// The test furthest over its threshold, and its value as a share of it.
    pub fn worst(&self, testing: &Testing) -> (Alarm, f64) {
        let shares = (0..TESTS).map(|k| (k, self.deviates[k] / limit(k, testing).0));
        let (test, share) = shares.fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
        let age = limit(test, testing).1;
        (Alarm { test, age }, share)
    }

    /// Something was done: innovations from before do not count any more.
    pub fn clear(&mut self) {
        self.windows.iter_mut().for_each(Windows::clear);
    }

    /// The power of now is the usual one.
    pub fn rebase(&mut self) {
        self.power.rebase();
    }
}

/// Empty windows of rates, changes and codes for epochs so many seconds apart.
pub fn windows(interval: f64, satellites: usize) -> [Windows; 3] {
    WINDOWS.map(|seconds| {
        let epochs = |s: &f64| ((s / interval).round() as usize).max(1);
        let lengths: Vec<usize> = seconds.iter().map(epochs).collect();
        Windows::new(&lengths, satellites)
    })
}
