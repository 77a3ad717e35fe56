//! How the state begins and how it goes on from epoch to epoch.

use nalgebra::{DMatrix, DVector};

use super::super::fix::Fix;
use super::{Ekf, Running, CLOCK};

/// Standard deviation of what is not known yet, m.
const UNKNOWN_M: f64 = 1e6;
/// Velocity that a receiver without Doppler may have, m/s.
const UNKNOWN_M_S: f64 = 100.0;

impl Ekf<'_> {
    pub(super) fn initial(&self, fix: &Fix, time_s: f64) -> Running {
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

    pub(super) fn predicted(&self, run: Running, time_s: f64) -> Running {
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
}
