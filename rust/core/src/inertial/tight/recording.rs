//! A recording: increments, and measurements of one or many runs.

use super::epoch::Epoch;
use crate::inertial::errors::ImuErrors;
use crate::inertial::NavState;
use crate::{Error, Result};

/// Increments of an IMU.
#[derive(Debug, Clone, Copy)]
pub struct ImuLog<'a> {
    /// End of each interval, ascending, s.
    pub time: &'a [f64],
    /// Nominal length of one, s.
    pub interval: f64,
    /// rad.
    pub rotation: &'a [[f64; 3]],
    /// m/s.
    pub velocity: &'a [[f64; 3]],
}

/// What all runs share of their epochs: (E, S) row by row.
#[derive(Debug, Clone, Copy)]
pub struct Sky<'a> {
    /// s, ascending (E).
    pub time: &'a [f64],
    /// Number of the system of each satellite (S).
    pub system: &'a [usize],
    /// m.
    pub place: &'a [[f64; 3]],
    /// m/s.
    pub velocity: &'a [[f64; 3]],
    /// dB-Hz.
    pub cn0: &'a [f64],
    /// Called spoofed by the receiver.
    pub spoofed: &'a [bool],
}

/// Measurements of one run: (E, S) row by row.
#[derive(Debug, Clone, Copy)]
pub struct Measured<'a> {
    /// m.
    pub range: &'a [f64],
    /// m/s.
    pub rate: &'a [f64],
    /// m.
    pub change: &'a [f64],
}

impl Measured<'_> {
    /// How many values there are.
    pub fn count(&self) -> usize {
        let finite = |values: &[f64]| values.iter().filter(|v| v.is_finite()).count();
        finite(self.range) + finite(self.rate) + finite(self.change)
    }
}

/// One run.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// What it starts from.
    pub start: NavState,
    /// What is added to the increments; `None`: nothing.
    pub errors: Option<(ImuErrors, u64)>,
    /// Its measurements.
    pub measured: Measured<'a>,
}

impl<'a> Sky<'a> {
    /// Number of columns.
    pub fn satellites(&self) -> usize {
        self.system.len()
    }

    /// One epoch of a run.
    pub fn epoch(&self, e: usize, m: &Measured<'a>) -> Epoch<'a> {
        let row = e * self.satellites()..(e + 1) * self.satellites();
        Epoch {
            time: self.time[e],
            place: &self.place[row.clone()],
            velocity: &self.velocity[row.clone()],
            range: &m.range[row.clone()],
            rate: &m.rate[row.clone()],
            change: &m.change[row.clone()],
            cn0: &self.cn0[row.clone()],
            spoofed: &self.spoofed[row],
            system: self.system,
        }
    }

    /// Whether all arrays fit together.
    pub fn check(&self, runs: &[Run<'_>]) -> Result<()> {
        let cells = self.time.len() * self.satellites();
        let fits = |n: usize| n == cells;
        let shared = [
            self.place.len(),
            self.velocity.len(),
            self.cn0.len(),
            self.spoofed.len(),
        ];
        let own =
            |r: &Run<'_>| [r.measured.range, r.measured.rate, r.measured.change].map(<[f64]>::len);
        if !shared.into_iter().all(fits) || !runs.iter().all(|r| own(r).into_iter().all(fits)) {
            return Err(Error::Invalid(
                "epochs and satellites do not fit together".into(),
            ));
        }
        if self.satellites() > 64 {
            return Err(Error::Invalid("more than 64 satellites".into()));
        }
        Ok(())
    }
}
