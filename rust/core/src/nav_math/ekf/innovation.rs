//! Measurements against what the state expects, their test, and the update by them.

use nalgebra::{DMatrix, DVector, Vector3};

use super::super::measurement::{geometry, Correction, Measurement};
use super::super::velocity::rate_model;
use super::super::SPEED_OF_LIGHT_M_S;
use super::{satellites, Ekf, Running, CLOCK};

/// Innovations of one epoch.
pub(super) struct Innovation {
    pub rows: Vec<(usize, usize)>,
    pub h: DMatrix<f64>,
    pub z: DVector<f64>,
    pub r: DVector<f64>,
}

impl Ekf<'_> {
    pub(super) fn innovation(
        &self,
        run: &Running,
        used: &[(&Measurement, Correction)],
    ) -> Innovation {
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

    pub(super) fn agrees(&self, run: &Running, used: &[(&Measurement, Correction)]) -> bool {
        if used.is_empty() {
            return true;
        }
        let (sum, freedom) = self.square_sum(run, used);
        sum <= self.batch.settings.threshold(freedom)
    }

    /// The satellite without which the innovations agree best.
    pub(super) fn worst(&self, run: &Running, used: &[(&Measurement, Correction)]) -> usize {
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

    /// The update, in Joseph's form.
    pub(super) fn absorb(&self, run: &mut Running, used: &[(&Measurement, Correction)]) {
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
}
