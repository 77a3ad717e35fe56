//! Coarse-time navigation: a position from code phases alone, without the time of transmission.
//!
//! Source: van Diggelen, "A-GPS: Assisted GPS, GNSS, and SBAS" (2009), chapter 4: position, common
//! bias and coarse time from pseudoranges known but for whole code periods. The whole periods
//! follow from the place and time that one begins with; as those are known to some 100 km and a
//! minute only, many beginnings are tried, and the one whose residuals are least is kept.

use nalgebra::{DMatrix, DVector, Matrix4, Vector3};
use rayon::prelude::*;

use super::batch::Column;
use super::fix::Status;
use super::least_squares::{distinct, inverse_normal, Unknowns};
use super::measurement::{geometry, range_rate, Correction, Measurement, Settings};
use super::orbit::Orbit;
use super::search::{beginnings, Search, Trial};
use super::SPEED_OF_LIGHT_M_S;

const MOST_STEPS: usize = 15;
const CONVERGED_M: f64 = 1e-4;
/// Solutions nearer to one another are the same.
const SAME_PLACE_M: f64 = 1e3;
/// A typical travel time: satellites move 1 km in its error.
const TRAVEL_S: f64 = 0.08;
/// Column of time in the design; those of clocks and biases follow.
const TIME: usize = 3;

/// One signal at the instant of the snapshot.
#[derive(Debug, Clone)]
pub struct CodePhase {
    /// Its satellite, system, group and carrier.
    pub column: Column,
    /// Row of the orbits.
    pub orbit: usize,
    /// Pseudorange modulo `period_m`, without the signal's group delay, m.
    pub range_m: f64,
    /// Code period times the speed of light.
    pub period_m: f64,
    /// m^2.
    pub variance: f64,
}

/// What a snapshot tells.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Whether its residuals agree, and no other place fits as well.
    pub status: Status,
    /// Satellite left out because it contradicts the others.
    pub excluded: Option<usize>,
    /// Earth-fixed, m.
    pub position: Vector3<f64>,
    /// Since the reference, s.
    pub time_s: f64,
    /// Of position and time (m, s).
    pub covariance: Matrix4<f64>,
    /// Measured minus modelled, m; NaN where a signal is not used.
    pub residual_m: Vec<f64>,
    /// Weighted square sum and its degrees of freedom.
    pub square_sum: f64,
    /// Measurements beyond the unknowns.
    pub freedom: usize,
}

/// Orbits, signals and settings of a snapshot.
#[derive(Debug)]
pub struct Problem<'a> {
    /// One for each row of the table.
    pub orbits: &'a [Orbit],
    /// Signals.
    pub phases: &'a [CodePhase],
    /// Atmosphere, mask, thresholds.
    pub settings: &'a Settings,
}

/// Signals above the mask, linearised at a trial.
struct Linear {
    columns: Vec<usize>,
    design: DMatrix<f64>,
    misses: DVector<f64>,
    weights: DVector<f64>,
}

impl Problem<'_> {
    /// The best place and time; `None` where signals are too few or nothing converges.
    ///
    /// Where the residuals contradict one another, and RAIM may leave a satellite out, all are left
    /// out in turn: one is, if it alone makes the others agree.
    pub fn solve(&self, search: &Search) -> Option<Snapshot> {
        let all = self.best(search, None);
        let fine = all.as_ref().is_some_and(|s| s.status != Status::Suspect);
        if fine || self.settings.exclusions == 0 {
            return all;
        }
        let mut satellites: Vec<_> = self.phases.iter().map(|p| p.column.satellite).collect();
        satellites.sort_unstable();
        satellites.dedup();
        let sound = |s: &Snapshot| s.status == Status::Fix;
        let tried = satellites
            .iter()
            .filter_map(|s| self.best(search, Some(*s)).filter(sound));
        let tried: Vec<Snapshot> = tried.collect();
        match &tried[..] {
            [one] => Some(one.clone()),
            _ => all,
        }
    }

    /// The best place without one of the satellites.
    ///
    /// The beginnings do not depend on one another, nor the choice between them on threads.
    fn best(&self, search: &Search, excluded: Option<usize>) -> Option<Snapshot> {
        let found: Vec<Snapshot> = beginnings(search)
            .into_par_iter()
            .filter_map(|trial| self.converge(trial, search, excluded))
            .filter(|s| search.holds(s))
            .collect();
        let least = found
            .iter()
            .min_by(|a, b| a.square_sum.total_cmp(&b.square_sum))?;
        let status = self.verdict(least, &found);
        Some(Snapshot {
            status,
            excluded,
            ..least.clone()
        })
    }

    /// A fix only if the residuals agree and those of no other place do.
    fn verdict(&self, best: &Snapshot, found: &[Snapshot]) -> Status {
        if best.freedom == 0 {
            return Status::Unchecked;
        }
        let most = self.settings.threshold(best.freedom);
        let rival = |s: &Snapshot| {
            s.square_sum <= most && (s.position - best.position).norm() > SAME_PLACE_M
        };
        match (best.square_sum <= most, found.iter().any(rival)) {
            (false, _) => Status::Suspect,
            (true, true) => Status::Unchecked,
            (true, false) => Status::Fix,
        }
    }

    fn converge(
        &self,
        mut trial: Trial,
        search: &Search,
        excluded: Option<usize>,
    ) -> Option<Snapshot> {
        for _ in 0..MOST_STEPS {
            let linear = self.linear(&trial, search.reference_s, excluded)?;
            let covariance = inverse_normal(&linear.design, &linear.weights)?;
            let weighted = linear.weights.component_mul(&linear.misses);
            let step = &covariance * linear.design.tr_mul(&weighted);
            trial.place += step.fixed_rows::<3>(0);
            trial.time_s += step[TIME];
            if !step.iter().all(|s| s.is_finite()) {
                return None;
            }
            if step.fixed_rows::<3>(0).norm() < CONVERGED_M {
                let residuals = &linear.misses - &linear.design * step;
                return Some(self.snapshot(&trial, &linear, &covariance, &residuals));
            }
        }
        None
    }

    fn snapshot(
        &self,
        trial: &Trial,
        linear: &Linear,
        covariance: &DMatrix<f64>,
        residuals: &DVector<f64>,
    ) -> Snapshot {
        let mut residual_m = vec![f64::NAN; self.phases.len()];
        linear
            .columns
            .iter()
            .zip(residuals)
            .for_each(|(k, r)| residual_m[*k] = *r);
        Snapshot {
            status: Status::Unchecked,
            excluded: None,
            position: trial.place,
            time_s: trial.time_s,
            covariance: covariance.fixed_view::<4, 4>(0, 0).into_owned(),
            residual_m,
            square_sum: residuals
                .iter()
                .zip(&linear.weights)
                .map(|(r, w)| r * r * w)
                .sum(),
            freedom: linear.design.nrows() - linear.design.ncols(),
        }
    }

    fn linear(&self, trial: &Trial, reference_s: f64, excluded: Option<usize>) -> Option<Linear> {
        let mut seen = self.seen(trial, reference_s);
        seen.retain(|(m, _)| Some(m.satellite) != excluded);
        let measurements: Vec<_> = seen.iter().map(|(m, _)| m).collect();
        let satellites: Vec<_> = measurements.iter().map(|m| m.satellite).collect();
        let unknowns = Unknowns::of(&measurements);
        let size = unknowns.count() + 1;
        if distinct(&satellites) < unknowns.satellites() + 1 || seen.len() < size {
            return None;
        }
        let mut design = DMatrix::zeros(seen.len(), size);
        let mut misses = DVector::zeros(seen.len());
        for (row, (m, correction)) in seen.iter().enumerate() {
            let (range, unit, _) = geometry(&m.state, trial.place);
            let rate = range_rate(&m.state, trial.place, Vector3::zeros());
            let (clock, bias) = unknowns.columns(m);
            design
                .fixed_view_mut::<1, 3>(row, 0)
                .copy_from(&unit.transpose());
            design[(row, TIME)] = rate - SPEED_OF_LIGHT_M_S * m.state.clock_drift;
            std::iter::once(clock)
                .chain(bias)
                .for_each(|c| design[(row, c + 1)] = 1.0);
            let sent = SPEED_OF_LIGHT_M_S * m.state.clock_s;
            misses[row] = m.range_m - (range + correction.delay_m - sent);
        }
        let columns: Vec<usize> = measurements.iter().map(|m| m.column).collect();
        self.unwrap(&columns, &mut misses);
        let weights = seen.iter().map(|(_, c)| 1.0 / c.variance);
        let weights = DVector::from_iterator(seen.len(), weights);
        Some(Linear {
            columns,
            design,
            misses,
            weights,
        })
    }

    /// Takes whole periods out, so that all agree as well as they can with one that has the
    /// longest period.
    fn unwrap(&self, columns: &[usize], misses: &mut DVector<f64>) {
        let periods: Vec<f64> = columns.iter().map(|k| self.phases[*k].period_m).collect();
        let first = (0..periods.len()).max_by(|a, b| periods[*a].total_cmp(&periods[*b]));
        let Some(first) = first else { return };
        let common = misses[first];
        for (miss, period) in misses.iter_mut().zip(periods) {
            *miss -= period * ((*miss - common) / period).round();
        }
    }

    /// Signals above the mask from a trial's place, with their corrections there.
    fn seen(&self, trial: &Trial, reference_s: f64) -> Vec<(Measurement, Correction)> {
        let gpst_s = reference_s + trial.time_s;
        let all = (0..self.phases.len()).map(|k| self.measurement(k, trial));
        all.map(|m| {
            let correction = self.settings.correction(&m, Some(trial.place), gpst_s);
            (m, correction)
        })
        .filter(|(_, c)| c.elevation >= self.settings.elevation_mask)
        .collect()
    }

    fn measurement(&self, k: usize, trial: &Trial) -> Measurement {
        let phase = &self.phases[k];
        let orbit = &self.orbits[phase.orbit];
        let mut state = orbit.state(trial.time_s - TRAVEL_S);
        for _ in 0..2 {
            let travel = geometry(&state, trial.place).0 / SPEED_OF_LIGHT_M_S;
            state = orbit.state(trial.time_s - travel);
        }
        Measurement {
            column: k,
            satellite: phase.column.satellite,
            system: phase.column.system,
            group: phase.column.group,
            range_m: phase.range_m,
            variance: phase.variance,
            rate_m_s: f64::NAN,
            rate_variance: f64::NAN,
            carrier_hz: phase.column.carrier_hz,
            state,
        }
    }
}
