//! The result of one epoch.

use super::batch::Batch;
use super::dop::Dop;
use super::least_squares::{Failure, Solution};
use super::measurement::Measurement;
use super::raim::{Checked, Verdict};
use super::velocity::{self, Velocity};

/// What became of a signal at an epoch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Use {
    /// Nothing there.
    None = 0,
    /// In the fix.
    Used = 1,
    /// Below the mask, or there is no fix.
    Idle = 2,
    /// Left out by RAIM.
    Excluded = 3,
}

/// How far a fix is to be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// None.
    NoFix = 0,
    /// The residuals agree.
    Fix = 1,
    /// They do not.
    Suspect = 2,
    /// There was nothing to check it by.
    Unchecked = 3,
}

/// One epoch's result; NaN where there is none.
#[derive(Debug, Clone)]
pub struct Fix {
    /// Trust.
    pub status: Status,
    /// Why there is none.
    pub failure: Option<Failure>,
    /// Earth-fixed, m.
    pub position: [f64; 3],
    /// Earth-fixed, m/s.
    pub velocity: [f64; 3],
    /// m, by system.
    pub clock_m: Vec<f64>,
    /// m/s.
    pub drift_m_s: f64,
    /// m by (system, group), against the system's first.
    pub bias_m: Vec<f64>,
    /// Of position, row after row, m^2.
    pub covariance: [f64; 9],
    /// Of velocity, m^2/s^2.
    pub velocity_covariance: [f64; 9],
    /// Dilutions.
    pub dop: Dop,
    /// By column.
    pub usage: Vec<Use>,
    /// Measured minus modelled by column, m.
    pub residual_m: Vec<f64>,
    /// Weighted square sum of the residuals and its degrees of freedom.
    pub square_sum: f64,
    /// Degrees of freedom of it.
    pub freedom: usize,
}

impl Fix {
    pub(super) fn none(batch: &Batch<'_>, measured: &[Measurement]) -> Self {
        let signals = batch.columns.len();
        let mut usage = vec![Use::None; signals];
        measured.iter().for_each(|m| usage[m.column] = Use::Idle);
        Self {
            status: Status::NoFix,
            failure: None,
            position: [f64::NAN; 3],
            velocity: [f64::NAN; 3],
            clock_m: vec![f64::NAN; batch.systems],
            drift_m_s: f64::NAN,
            bias_m: vec![f64::NAN; batch.groups.len()],
            covariance: [f64::NAN; 9],
            velocity_covariance: [f64::NAN; 9],
            dop: Dop::NONE,
            usage,
            residual_m: vec![f64::NAN; signals],
            square_sum: f64::NAN,
            freedom: 0,
        }
    }

    pub(super) fn take(&mut self, batch: &Batch<'_>, measured: &[Measurement], checked: &Checked) {
        let solution = &checked.solution;
        self.status = match checked.verdict {
            Verdict::Passed => Status::Fix,
            Verdict::Failed => Status::Suspect,
            Verdict::Unchecked => Status::Unchecked,
        };
        self.place(solution);
        self.clocks(batch, solution);
        self.signals(measured, checked);
        if let Some(v) = velocity::solve(
            measured,
            &solution.columns,
            solution.position,
            batch.settings,
        ) {
            self.motion(&v);
        }
    }

    fn place(&mut self, solution: &Solution) {
        self.position = solution.position.into();
        self.covariance
            .copy_from_slice(solution.position_covariance().as_slice());
        self.dop = Dop::of(
            &solution.design,
            solution.unknowns.systems.len(),
            solution.position,
        );
        self.square_sum = solution.square_sum();
        self.freedom = solution.freedom();
    }

    fn clocks(&mut self, batch: &Batch<'_>, solution: &Solution) {
        let unknowns = &solution.unknowns;
        for (k, system) in unknowns.systems.iter().enumerate() {
            self.clock_m[*system] = solution.values[3 + k];
        }
        for (k, group) in unknowns.biases.iter().enumerate() {
            if let Some(at) = batch.groups.iter().position(|g| g == group) {
                self.bias_m[at] = solution.values[3 + unknowns.systems.len() + k];
            }
        }
    }

    fn signals(&mut self, measured: &[Measurement], checked: &Checked) {
        let solution = &checked.solution;
        for (row, column) in solution.columns.iter().enumerate() {
            self.usage[*column] = Use::Used;
            self.residual_m[*column] = solution.residuals[row];
        }
        for m in measured
            .iter()
            .filter(|m| checked.excluded.contains(&m.satellite))
        {
            self.usage[m.column] = Use::Excluded;
        }
    }

    pub(super) fn motion(&mut self, v: &Velocity) {
        self.velocity = v.velocity.into();
        self.drift_m_s = v.drift_m_s;
        let covariance = v.covariance.fixed_view::<3, 3>(0, 0).into_owned();
        self.velocity_covariance
            .copy_from_slice(covariance.as_slice());
    }
}
