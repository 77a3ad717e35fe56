//! Extended Kalman filter of position, velocity and clocks, fed with pseudoranges and Doppler.
//!
//! Source: Brown and Hwang, "Introduction to Random Signals and Applied Kalman Filtering" (1997),
//! chapter 11: constant velocity driven by white acceleration, two-state clock. Innovations are
//! tested by their chi-square; the worst satellite is left out as in RAIM.

use nalgebra::{DMatrix, DVector, Vector3};

use super::batch::{Batch, Fix, Status, Use};
use super::dop::Dop;
use super::least_squares::distinct;
use super::measurement::{geometry, Correction, Measurement};
use super::velocity::rate_model;
use super::SPEED_OF_LIGHT_M_S;

/// First clock in the state; before it are position and velocity.
const CLOCK: usize = 6;
/// Standard deviation of what is not known yet, m.
const UNKNOWN_M: f64 = 1e6;
/// Velocity that a receiver without Doppler may have, m/s.
const UNKNOWN_M_S: f64 = 100.0;

/// Process noise and patience.
#[derive(Debug, Clone, PartialEq)]
pub struct EkfSettings {
    /// White acceleration on each axis, (m/s^2)/sqrt(Hz).
    pub acceleration: f64,
    /// White frequency noise of the clock, (m/s)/sqrt(Hz).
    pub clock: f64,
    /// Random walk of the clock's drift, (m/s^2)/sqrt(Hz).
    pub clock_drift: f64,
    /// Random walk between systems and signals, (m/s)/sqrt(Hz).
    pub bias: f64,
    /// Longest time without a full set of agreeing satellites before it begins anew, s.
    pub coast_s: f64,
}

/// The filter between two epochs.
#[derive(Debug)]
pub struct Ekf<'a> {
    batch: &'a Batch<'a>,
    settings: EkfSettings,
    start: Vector3<f64>,
    state: Option<Running>,
}

#[derive(Debug, Clone)]
struct Running {
    time_s: f64,
    /// When a full set of satellites last agreed.
    sound_s: f64,
    x: DVector<f64>,
    p: DMatrix<f64>,
}

/// Innovations of one epoch.
struct Innovation {
    rows: Vec<(usize, usize)>,
    h: DMatrix<f64>,
    z: DVector<f64>,
    r: DVector<f64>,
}

impl<'a> Ekf<'a> {
    /// Before the first epoch; `start` is where least squares begins to search.
    pub fn new(batch: &'a Batch<'a>, settings: EkfSettings, start: Vector3<f64>) -> Self {
        Self {
            batch,
            settings,
            start,
            state: None,
        }
    }

    fn drift(&self) -> usize {
        CLOCK + self.batch.systems + self.batch.groups.len()
    }

    /// Goes on to an epoch.
    pub fn step(&mut self, measured: &[Measurement], time_s: f64) -> Fix {
        match self.state.take() {
            Some(run) if time_s - run.sound_s <= self.settings.coast_s => {
                let run = self.predicted(run, time_s);
                self.update(run, measured)
            }
            _ => self.begin(measured, time_s),
        }
    }

    /// The first epoch is least squares.
    fn begin(&mut self, measured: &[Measurement], time_s: f64) -> Fix {
        let fix = self.batch.least_squares(measured, time_s, self.start);
        if matches!(fix.status, Status::Fix | Status::Unchecked) {
            self.state = Some(self.initial(&fix, time_s));
        }
        fix
    }

    fn initial(&self, fix: &Fix, time_s: f64) -> Running {
        let size = self.drift() + 1;
        let (mut x, mut p) = (DVector::zeros(size), DMatrix::zeros(size, size));
        let first = fix
            .clock_m
            .iter()
            .copied()
            .find(|c| c.is_finite())
            .unwrap_or(0.0);
        for k in 0..3 {
            x[k] = fix.position[k];
            for j in 0..3 {
                p[(k, j)] = fix.covariance[3 * j + k];
            }
        }
        self.initial_motion(fix, &mut x, &mut p);
        for system in 0..self.batch.systems {
            let known = fix.clock_m[system];
            x[CLOCK + system] = if known.is_finite() { known } else { first };
            p[(CLOCK + system, CLOCK + system)] = UNKNOWN_M.powi(2);
        }
        for group in 0..self.batch.groups.len() {
            let at = CLOCK + self.batch.systems + group;
            x[at] = if fix.bias_m[group].is_finite() {
                fix.bias_m[group]
            } else {
                0.0
            };
            let first = group == 0 || self.batch.groups[group - 1].0 != self.batch.groups[group].0;
            p[(at, at)] = if first { 0.0 } else { UNKNOWN_M.powi(2) };
        }
        Running {
            time_s,
            sound_s: time_s,
            x,
            p,
        }
    }

    fn initial_motion(&self, fix: &Fix, x: &mut DVector<f64>, p: &mut DMatrix<f64>) {
        let known = fix.drift_m_s.is_finite();
        let drift = self.drift();
        x[drift] = if known { fix.drift_m_s } else { 0.0 };
        // 1 ppm and more: the first Doppler settles it.
        p[(drift, drift)] = 1e3_f64.powi(2);
        for k in 0..3 {
            x[3 + k] = if known { fix.velocity[k] } else { 0.0 };
            for j in 0..3 {
                let unknown = if k == j { UNKNOWN_M_S.powi(2) } else { 0.0 };
                p[(3 + k, 3 + j)] = if known {
                    fix.velocity_covariance[3 * j + k]
                } else {
                    unknown
                };
            }
        }
    }

    fn predicted(&self, run: Running, time_s: f64) -> Running {
        let dt = time_s - run.time_s;
        let (size, drift) = (run.x.len(), self.drift());
        let mut f = DMatrix::identity(size, size);
        (0..3).for_each(|k| f[(k, 3 + k)] = dt);
        (CLOCK..CLOCK + self.batch.systems).for_each(|k| f[(k, drift)] = dt);
        let x = &f * run.x;
        let p = &f * run.p * f.transpose() + self.process_noise(size, dt);
        Running {
            time_s,
            x,
            p,
            ..run
        }
    }

    fn process_noise(&self, size: usize, dt: f64) -> DMatrix<f64> {
        let s = &self.settings;
        let (drift, clocks) = (self.drift(), CLOCK..CLOCK + self.batch.systems);
        let mut q = DMatrix::zeros(size, size);
        let walk = |density: f64| {
            (
                density.powi(2) * dt.powi(3) / 3.0,
                density.powi(2) * dt * dt / 2.0,
            )
        };
        let (far, cross) = walk(s.acceleration);
        for k in 0..3 {
            q[(k, k)] = far;
            q[(k, 3 + k)] = cross;
            q[(3 + k, k)] = cross;
            q[(3 + k, 3 + k)] = s.acceleration.powi(2) * dt;
        }
        let (far, cross) = walk(s.clock_drift);
        for k in clocks.clone() {
            for j in clocks.clone() {
                q[(k, j)] = s.clock.powi(2) * dt + far;
            }
            q[(k, k)] += if k > CLOCK { s.bias.powi(2) * dt } else { 0.0 };
            q[(k, drift)] = cross;
            q[(drift, k)] = cross;
        }
        q[(drift, drift)] = s.clock_drift.powi(2) * dt;
        for (group, kind) in self.batch.groups.iter().enumerate() {
            let first = group == 0 || self.batch.groups[group - 1].0 != kind.0;
            let at = CLOCK + self.batch.systems + group;
            q[(at, at)] = if first { 0.0 } else { s.bias.powi(2) * dt };
        }
        q
    }

    /// Takes an epoch's measurements in and says how far they agree.
    fn update(&mut self, mut run: Running, measured: &[Measurement]) -> Fix {
        let place = Vector3::new(run.x[0], run.x[1], run.x[2]);
        let gpst_s = self.batch.reference_s + run.time_s;
        let settings = self.batch.settings;
        let with = measured
            .iter()
            .map(|m| (m, settings.correction(m, Some(place), gpst_s)));
        let mut used: Vec<_> = with
            .filter(|(_, c)| c.elevation >= settings.elevation_mask)
            .collect();
        let mut excluded = Vec::new();
        let mut agrees = self.agrees(&run, &used);
        while !agrees && excluded.len() < settings.exclusions && distinct(&satellites(&used)) > 1 {
            let worst = self.worst(&run, &used);
            used.retain(|(m, _)| m.satellite != worst);
            excluded.push(worst);
            agrees = self.agrees(&run, &used);
        }
        let needed = 3 + systems(&used);
        let full = distinct(&satellites(&used)) >= needed.max(4);
        if agrees {
            self.absorb(&mut run, &used);
            run.sound_s = if full { run.time_s } else { run.sound_s };
        }
        let mut fix = self.fix(&run, measured, &used, &excluded);
        fix.status = match (
            agrees,
            full && excluded.is_empty() || distinct(&satellites(&used)) > needed,
        ) {
            (false, _) => Status::Suspect,
            (true, true) => Status::Fix,
            (true, false) => Status::Unchecked,
        };
        self.state = Some(run);
        fix
    }

    fn innovation(&self, run: &Running, used: &[(&Measurement, Correction)]) -> Innovation {
        let rated = |m: &Measurement| m.rate_m_s.is_finite();
        let rows: Vec<_> = (0..used.len())
            .map(|k| (k, 0))
            .chain(
                (0..used.len())
                    .filter(|k| rated(used[*k].0))
                    .map(|k| (k, 1)),
            )
            .collect();
        let mut found = Innovation {
            h: DMatrix::zeros(rows.len(), run.x.len()),
            z: DVector::zeros(rows.len()),
            r: DVector::zeros(rows.len()),
            rows,
        };
        let place = Vector3::new(run.x[0], run.x[1], run.x[2]);
        for row in 0..found.rows.len() {
            let (k, kind) = found.rows[row];
            let (m, correction) = &used[k];
            if kind == 0 {
                self.range_row(run, m, correction, place, &mut found, row);
            } else {
                self.rate_row(run, m, place, &mut found, row);
            }
        }
        found
    }

    fn range_row(
        &self,
        run: &Running,
        m: &Measurement,
        correction: &Correction,
        place: Vector3<f64>,
        found: &mut Innovation,
        row: usize,
    ) {
        let (range, unit, _) = geometry(&m.state, place);
        let group = self
            .batch
            .groups
            .iter()
            .position(|g| *g == (m.system, m.group));
        let clock = CLOCK + m.system;
        let bias = group.map(|g| CLOCK + self.batch.systems + g);
        (0..3).for_each(|k| found.h[(row, k)] = unit[k]);
        let mut modelled = range + correction.delay_m - SPEED_OF_LIGHT_M_S * m.state.clock_s;
        for column in std::iter::once(clock).chain(bias) {
            found.h[(row, column)] = 1.0;
            modelled += run.x[column];
        }
        found.z[row] = m.range_m - modelled;
        found.r[row] = correction.variance;
    }

    fn rate_row(
        &self,
        run: &Running,
        m: &Measurement,
        place: Vector3<f64>,
        found: &mut Innovation,
        row: usize,
    ) {
        let (slopes, still) = rate_model(m, place);
        let columns = [3, 4, 5, self.drift()];
        let moving: f64 = columns
            .iter()
            .zip(&slopes)
            .map(|(c, s)| run.x[*c] * s)
            .sum();
        columns
            .iter()
            .zip(&slopes)
            .for_each(|(c, s)| found.h[(row, *c)] = *s);
        found.z[row] = m.rate_m_s - still - moving;
        found.r[row] = m.rate_variance;
    }

    fn square_sum(&self, run: &Running, used: &[(&Measurement, Correction)]) -> (f64, usize) {
        let found = self.innovation(run, used);
        let s = &found.h * &run.p * found.h.transpose() + DMatrix::from_diagonal(&found.r);
        let sum = s
            .cholesky()
            .map_or(f64::INFINITY, |c| found.z.dot(&c.solve(&found.z)));
        (sum, found.z.len())
    }

    fn agrees(&self, run: &Running, used: &[(&Measurement, Correction)]) -> bool {
        if used.is_empty() {
            return true;
        }
        let (sum, freedom) = self.square_sum(run, used);
        let thresholds = &self.batch.settings.thresholds;
        sum <= thresholds[freedom.min(thresholds.len()) - 1]
    }

    /// The satellite without which the innovations agree best.
    fn worst(&self, run: &Running, used: &[(&Measurement, Correction)]) -> usize {
        let mut all = satellites(used);
        all.sort_unstable();
        all.dedup();
        let without = |s: usize| {
            let rest: Vec<_> = used
                .iter()
                .filter(|(m, _)| m.satellite != s)
                .copied()
                .collect();
            self.square_sum(run, &rest).0
        };
        all.into_iter()
            .map(|s| (without(s), s))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .expect("some")
            .1
    }

    fn dop(&self, run: &Running, used: &[(&Measurement, Correction)]) -> Dop {
        let place = Vector3::new(run.x[0], run.x[1], run.x[2]);
        let (h, systems) = design(used, place);
        if h.nrows() < h.ncols() {
            return Dop::NONE;
        }
        Dop::of(&h, systems, place)
    }

    /// The update, in Joseph's form.
    fn absorb(&self, run: &mut Running, used: &[(&Measurement, Correction)]) {
        if used.is_empty() {
            return;
        }
        let Innovation { h, z, r, .. } = self.innovation(run, used);
        let r = DMatrix::from_diagonal(&r);
        let s = &h * &run.p * h.transpose() + &r;
        let Some(inverse) = s.cholesky().map(|c| c.inverse()) else {
            return;
        };
        let gain = &run.p * h.transpose() * inverse;
        run.x += &gain * z;
        let left = DMatrix::identity(run.x.len(), run.x.len()) - &gain * h;
        run.p = &left * &run.p * left.transpose() + &gain * r * gain.transpose();
    }

    fn fix(
        &self,
        run: &Running,
        measured: &[Measurement],
        used: &[(&Measurement, Correction)],
        excluded: &[usize],
    ) -> Fix {
        let mut fix = Fix::none(self.batch, measured);
        for k in 0..3 {
            fix.position[k] = run.x[k];
            fix.velocity[k] = run.x[3 + k];
            for j in 0..3 {
                fix.covariance[3 * j + k] = run.p[(k, j)];
                fix.velocity_covariance[3 * j + k] = run.p[(3 + k, 3 + j)];
            }
        }
        (0..self.batch.systems).for_each(|s| fix.clock_m[s] = run.x[CLOCK + s]);
        fix.drift_m_s = run.x[self.drift()];
        fix.dop = self.dop(run, used);
        let after = self.innovation(run, used);
        for (row, (k, kind)) in after.rows.iter().enumerate() {
            if *kind == 0 {
                let m = used[*k].0;
                fix.usage[m.column] = Use::Used;
                fix.residual_m[m.column] = after.z[row];
            }
        }
        for m in measured.iter().filter(|m| excluded.contains(&m.satellite)) {
            fix.usage[m.column] = Use::Excluded;
        }
        fix
    }
}

/// Columns of the geometry: position and the clocks of the systems used.
fn design(used: &[(&Measurement, Correction)], place: Vector3<f64>) -> (DMatrix<f64>, usize) {
    let mut known: Vec<usize> = used.iter().map(|(m, _)| m.system).collect();
    known.sort_unstable();
    known.dedup();
    let mut h = DMatrix::zeros(used.len(), 3 + known.len());
    for (row, (m, _)) in used.iter().enumerate() {
        h.fixed_view_mut::<1, 3>(row, 0)
            .copy_from(&geometry(&m.state, place).1.transpose());
        let clock = known.iter().position(|s| *s == m.system).expect("listed");
        h[(row, 3 + clock)] = 1.0;
    }
    (h, known.len())
}

fn satellites(used: &[(&Measurement, Correction)]) -> Vec<usize> {
    used.iter().map(|(m, _)| m.satellite).collect()
}

fn systems(used: &[(&Measurement, Correction)]) -> usize {
    distinct(&used.iter().map(|(m, _)| m.system).collect::<Vec<_>>())
}
