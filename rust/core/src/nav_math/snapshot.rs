//! Coarse-time navigation: a position from code phases alone, without the time of transmission.
//!
//! Source: van Diggelen, "A-GPS: Assisted GPS, GNSS, and SBAS" (2009), chapter 4: position, common
//! bias and coarse time from pseudoranges known but for whole code periods. The whole periods
//! follow from the place and time that one begins with; as those are known to some 100 km and a
//! minute only, many beginnings are tried, and the one whose residuals are least is kept.

use nalgebra::{DMatrix, DVector, Matrix4, Vector3};
use rayon::prelude::*;

use super::batch::{Column, Status};
use super::geodesy::{enu, WGS84};
use super::least_squares::{distinct, inverse_normal, Unknowns};
use super::measurement::{geometry, range_rate, Correction, Measurement, Settings};
use super::orbit::Orbit;
use super::SPEED_OF_LIGHT_M_S;

const MOST_STEPS: usize = 15;
const CONVERGED_M: f64 = 1e-4;
/// Beginnings lie so far apart that from the nearest one codes of 1 ms are told right: signals on
/// opposite sides of the sky then differ by 42 km and 12 km each from what is expected, less than
/// half a period (150 km) together.
const PLACE_STEP_M: f64 = 60e3;
const TIME_STEP_S: f64 = 30.0;
/// A solution may lie so much farther off than the uncertainty says.
const MARGIN: f64 = 1.5;
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

/// Where and when to search.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// Earth-fixed, m.
    pub place: Vector3<f64>,
    /// How far off it may be, m.
    pub place_uncertainty_m: f64,
    /// Of the snapshot, since the reference of the orbits, s.
    pub time_s: f64,
    /// How far off it may be, s.
    pub time_uncertainty_s: f64,
    /// GPST of the reference since 1980-01-06, s.
    pub reference_s: f64,
}

/// What a snapshot tells.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Whether its residuals agree, and no other place fits as well.
    pub status: Status,
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

/// Where a search stands.
#[derive(Debug, Clone, Copy)]
struct Trial {
    place: Vector3<f64>,
    time_s: f64,
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
    /// The beginnings do not depend on one another, nor the choice between them on threads.
    pub fn solve(&self, search: &Search) -> Option<Snapshot> {
        let found: Vec<Snapshot> = beginnings(search)
            .into_par_iter()
            .filter_map(|trial| self.converge(trial, search))
            .filter(|s| search.holds(s))
            .collect();
        let least = found
            .iter()
            .min_by(|a, b| a.square_sum.total_cmp(&b.square_sum))?;
        let status = self.verdict(least, &found);
        Some(Snapshot {
            status,
            ..least.clone()
        })
    }

    /// A fix only if the residuals agree and those of no other place do.
    fn verdict(&self, best: &Snapshot, found: &[Snapshot]) -> Status {
        if best.freedom == 0 {
            return Status::Unchecked;
        }
        let thresholds = &self.settings.thresholds;
        let most = thresholds[best.freedom.min(thresholds.len()) - 1];
        let rival = |s: &Snapshot| {
            s.square_sum <= most && (s.position - best.position).norm() > SAME_PLACE_M
        };
        match (best.square_sum <= most, found.iter().any(rival)) {
            (false, _) => Status::Suspect,
            (true, true) => Status::Unchecked,
            (true, false) => Status::Fix,
        }
    }

    fn converge(&self, mut trial: Trial, search: &Search) -> Option<Snapshot> {
        for _ in 0..MOST_STEPS {
            let linear = self.linear(&trial, search.reference_s)?;
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

    fn linear(&self, trial: &Trial, reference_s: f64) -> Option<Linear> {
        let seen = self.seen(trial, reference_s);
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

impl Search {
    fn holds(&self, s: &Snapshot) -> bool {
        (s.position - self.place).norm() <= MARGIN * self.place_uncertainty_m.max(PLACE_STEP_M)
            && (s.time_s - self.time_s).abs() <= MARGIN * self.time_uncertainty_s.max(TIME_STEP_S)
    }
}

/// Places and times to begin with, on a raster as wide as the uncertainty.
fn beginnings(search: &Search) -> Vec<Trial> {
    let local = enu(WGS84.geodetic(search.place)).transpose();
    let reach = |uncertainty: f64, step: f64| (uncertainty / step - 0.5).ceil().max(0.0) as i32;
    let places = reach(search.place_uncertainty_m, PLACE_STEP_M);
    let times = reach(search.time_uncertainty_s, TIME_STEP_S);
    let mut all = Vec::new();
    for (east, north) in square(places) {
        let shift = Vector3::new(f64::from(east), f64::from(north), 0.0) * PLACE_STEP_M;
        for step in -times..=times {
            all.push(Trial {
                place: search.place + local * shift,
                time_s: search.time_s + f64::from(step) * TIME_STEP_S,
            });
        }
    }
    all
}

fn square(reach: i32) -> impl Iterator<Item = (i32, i32)> {
    (-reach..=reach).flat_map(move |x| (-reach..=reach).map(move |y| (x, y)))
}
