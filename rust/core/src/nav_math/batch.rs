//! All epochs of a recording in one call. Epochs of least squares do not depend on one another and
//! run in parallel; the results are the same for any number of threads.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::ekf::{Ekf, EkfSettings};
use super::fix::Fix;
use super::least_squares::solve;
use super::measurement::{Measurement, Settings};
use super::orbit::Orbit;
use super::raim::solve_checked;
use super::SPEED_OF_LIGHT_M_S;
use crate::{Error, Result};

/// What is known of a column of the observations.
#[derive(Debug, Clone)]
pub struct Column {
    /// Columns of one satellite share it.
    pub satellite: usize,
    /// Index of the system's clock.
    pub system: usize,
    /// Signals of a system that share a receiver delay share it.
    pub group: usize,
    /// Hz.
    pub carrier_hz: f64,
}

/// E epochs of S signals, row after row; NaN where there is none.
#[derive(Debug, Clone, Copy)]
pub struct Epochs<'a> {
    /// Receiver time since the reference, s (E).
    pub time_s: &'a [f64],
    /// Row of the orbits, negative where the signal is not to be used (E x S).
    pub orbit: &'a [i32],
    /// Without group delay, m (E x S).
    pub range_m: &'a [f64],
    /// m^2 (E x S).
    pub variance: &'a [f64],
    /// m/s (E x S).
    pub rate_m_s: &'a [f64],
    /// m^2/s^2 (E x S).
    pub rate_variance: &'a [f64],
}

/// How positions are found.
#[derive(Debug, Clone)]
pub enum Filter {
    /// Each epoch by itself.
    LeastSquares,
    /// Carried on from epoch to epoch.
    Ekf(EkfSettings),
}

/// A recording's satellites and settings.
#[derive(Debug)]
pub struct Batch<'a> {
    /// One for each row of the table.
    pub orbits: &'a [Orbit],
    /// GPST of the reference since 1980-01-06, s.
    pub reference_s: f64,
    /// S columns.
    pub columns: &'a [Column],
    /// Of each (system, group) pair used, ascending.
    pub groups: &'a [(usize, usize)],
    /// How many systems have a clock.
    pub systems: usize,
    /// Models, mask, thresholds.
    pub settings: &'a Settings,
}

impl Batch<'_> {
    /// Fixes of all epochs.
    ///
    /// # Errors
    /// [`Error::Invalid`] if lengths do not fit together.
    pub fn solve(&self, epochs: Epochs<'_>, filter: &Filter, threads: usize) -> Result<Vec<Fix>> {
        self.check(&epochs)?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| Error::Invalid(e.to_string()))?;
        let measured: Vec<Vec<Measurement>> = pool.install(|| {
            let all = 0..epochs.time_s.len();
            all.into_par_iter()
                .map(|e| self.measurements(&epochs, e))
                .collect()
        });
        let start = self.start(&measured, epochs.time_s);
        Ok(match filter {
            Filter::LeastSquares => pool.install(|| {
                let all = measured.par_iter().zip(epochs.time_s);
                all.map(|(m, time_s)| self.least_squares(m, *time_s, start))
                    .collect()
            }),
            Filter::Ekf(settings) => {
                let mut ekf = Ekf::new(self, settings.clone(), start);
                measured
                    .iter()
                    .zip(epochs.time_s)
                    .map(|(m, t)| ekf.step(m, *t))
                    .collect()
            }
        })
    }

    fn check(&self, epochs: &Epochs<'_>) -> Result<()> {
        let cells = epochs.time_s.len() * self.columns.len();
        let lengths = [
            epochs.orbit.len(),
            epochs.range_m.len(),
            epochs.variance.len(),
            epochs.rate_m_s.len(),
            epochs.rate_variance.len(),
        ];
        let known = |orbit: &i32| *orbit < self.orbits.len() as i32;
        let fits =
            lengths.iter().all(|l| *l == cells) && self.settings.ionosphere.len() == self.systems;
        if !fits || !epochs.orbit.iter().all(known) || self.settings.thresholds.is_empty() {
            return Err(Error::Invalid(
                "observations and orbits do not fit together".into(),
            ));
        }
        if self.columns.iter().any(|c| c.system >= self.systems) {
            return Err(Error::Invalid("a column's system has no clock".into()));
        }
        Ok(())
    }

    fn measurements(&self, epochs: &Epochs<'_>, epoch: usize) -> Vec<Measurement> {
        let first = epoch * self.columns.len();
        let cells = self
            .columns
            .iter()
            .enumerate()
            .map(|(k, column)| (k, first + k, column));
        cells
            .filter(|(_, at, _)| epochs.orbit[*at] >= 0 && epochs.range_m[*at].is_finite())
            .map(|(k, at, column)| {
                let range_m = epochs.range_m[at];
                let orbit = &self.orbits[epochs.orbit[at] as usize];
                let sent_s = epochs.time_s[epoch] - range_m / SPEED_OF_LIGHT_M_S;
                // By the satellite's clock; its offset changes the place by millimetres only.
                let state = orbit.state(sent_s - orbit.state(sent_s).clock_s);
                Measurement {
                    column: k,
                    satellite: column.satellite,
                    system: column.system,
                    group: column.group,
                    range_m,
                    variance: epochs.variance[at],
                    rate_m_s: epochs.rate_m_s[at],
                    rate_variance: epochs.rate_variance[at],
                    carrier_hz: column.carrier_hz,
                    state,
                }
            })
            .collect()
    }

    /// Where all epochs begin to search: the first place that is found from the Earth's centre.
    fn start(&self, measured: &[Vec<Measurement>], time_s: &[f64]) -> Vector3<f64> {
        let centre = Vector3::zeros();
        let found = measured
            .iter()
            .zip(time_s)
            .find_map(|(m, t)| solve(m, centre, self.reference_s + t, self.settings).ok());
        found.map_or(centre, |s| s.position)
    }

    /// One epoch by least squares.
    pub(super) fn least_squares(
        &self,
        measured: &[Measurement],
        time_s: f64,
        start: Vector3<f64>,
    ) -> Fix {
        let mut fix = Fix::none(self, measured);
        match solve_checked(measured, start, self.reference_s + time_s, self.settings) {
            Ok(checked) => fix.take(self, measured, &checked),
            Err(failure) => fix.failure = Some(failure),
        }
        fix
    }
}
