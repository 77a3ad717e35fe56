//! Extended Kalman filter of position, velocity and clocks, fed with pseudoranges and Doppler.
//!
//! Source: Brown and Hwang, "Introduction to Random Signals and Applied Kalman Filtering" (1997),
//! chapter 11: constant velocity driven by white acceleration, two-state clock. Innovations are
//! tested by their chi-square; the worst satellite is left out as in RAIM.

mod innovation;
mod process;

use nalgebra::{DMatrix, DVector, Vector3};

use super::batch::Batch;
use super::dop::Dop;
use super::fix::{Fix, Status, Use};
use super::least_squares::distinct;
use super::measurement::{geometry, Correction, Measurement};

/// First clock in the state; before it are position and velocity.
const CLOCK: usize = 6;

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

    fn dop(&self, run: &Running, used: &[(&Measurement, Correction)]) -> Dop {
        let place = Vector3::new(run.x[0], run.x[1], run.x[2]);
        let (h, systems) = design(used, place);
        if h.nrows() < h.ncols() {
            return Dop::NONE;
        }
        Dop::of(&h, systems, place)
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
