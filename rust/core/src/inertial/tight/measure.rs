//! What a place, a velocity and a clock predict of a satellite's measurements.

use nalgebra::{Matrix3, Vector3};

use super::covariance::Row;
use super::filter::Layout;
use super::{ATTITUDE, CLOCK, DRIFT, POSITION, VELOCITY};

/// Antenna and clock as the navigator has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Antenna {
    /// Earth-fixed, m.
    pub position: Vector3<f64>,
    /// m/s.
    pub velocity: Vector3<f64>,
    /// From the INS, in local axes, m.
    pub lever: Vector3<f64>,
    /// Columns north, east, down in Earth-fixed axes.
    pub axes: Matrix3<f64>,
    /// m.
    pub clock: f64,
    /// m/s.
    pub drift: f64,
}

/// A satellite as the antenna should see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Distance plus clock, m.
    pub range: f64,
    /// m/s.
    pub rate: f64,
    /// Unit vector towards it, local axes.
    pub towards: Vector3<f64>,
    /// How the rate grows with the antenna's place, local axes, 1/s.
    pub turning: Vector3<f64>,
}

impl Antenna {
    /// Of a satellite's place and velocity.
    pub fn sight(&self, place: &Vector3<f64>, velocity: &Vector3<f64>) -> Sight {
        let line = place - self.position;
        let distance = line.norm();
        let unit = line / distance;
        let relative = velocity - self.velocity;
        let along = unit.dot(&relative);
        let across = relative - unit * along;
        Sight {
            range: distance + self.clock,
            rate: along + self.drift,
            towards: self.axes.tr_mul(&unit),
            turning: self.axes.tr_mul(&across) / -distance,
        }
    }

    /// Distance plus clock, and the unit vector towards a satellite in local axes.
    pub fn range(&self, place: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let line = place - self.position;
        let distance = line.norm();
        (distance + self.clock, self.axes.tr_mul(&line) / distance)
    }
}

/// How a predicted pseudorange errs; `satellite` and `system` are its columns.
pub fn range_row(
    sight: &Sight,
    lever: &Vector3<f64>,
    layout: &Layout,
    satellite: usize,
    system: usize,
) -> Row {
    let mut row = Row::default();
    row.push3(POSITION, &-sight.towards);
    if *lever != Vector3::zeros() {
        // The antenna errs by (phi x lever) against the INS with the sign of phi turned round.
        row.push3(ATTITUDE, &-sight.towards.cross(lever));
    }
    row.push(CLOCK, 1.0);
    if let Some(first) = layout.wander {
        row.push(first + satellite, 1.0);
    }
    if system > 0 {
        row.push(layout.systems + system - 1, 1.0);
    }
    row
}

/// How a predicted rate errs.
pub fn rate_row(sight: &Sight) -> Row {
    let mut row = Row::default();
    row.push3(POSITION, &sight.turning);
    row.push3(VELOCITY, &-sight.towards);
    row.push(DRIFT, 1.0);
    row
}

/// How a predicted change since the epoch before errs; `before` is the direction then.
pub fn change_row(sight: &Sight, before: &Vector3<f64>, past: usize) -> Row {
    let mut row = Row::default();
    row.push3(POSITION, &-sight.towards);
    row.push(CLOCK, 1.0);
    row.push3(past, before);
    row.push(past + 3, -1.0);
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::tight::settings::ReceiverNoise;

    fn antenna(shift: Vector3<f64>, speed: Vector3<f64>) -> Antenna {
        let axes = Matrix3::new(0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0);
        Antenna {
            position: Vector3::new(6.4e6, 0.0, 0.0) + axes * shift,
            velocity: axes * speed,
            lever: Vector3::zeros(),
            axes,
            clock: 5.0,
            drift: 0.1,
        }
    }

    /// Rows against differences of the prediction itself.
    #[test]
    fn rows_are_derivatives() {
        let (place, velocity) = (
            Vector3::new(2.0e7, 9e6, -1.1e7),
            Vector3::new(900.0, -2e3, 1500.0),
        );
        let none = Vector3::zeros();
        let middle = antenna(none, none).sight(&place, &velocity);
        let noise = ReceiverNoise {
            code: 1.0,
            wander: 0.0,
            wander_time: 1.0,
            rate: 1.0,
            change: 0.0,
            reference_cn0: 0.0,
            clock: 0.0,
            drift: 0.0,
        };
        let layout = Layout::new(&noise, 1, 1);
        let (range, rate) = (range_row(&middle, &none, &layout, 0, 0), rate_row(&middle));
        for axis in 0..3 {
            let mut error = [0.0; crate::inertial::tight::NAV];
            let step = Vector3::ith(axis, 10.0);
            error[POSITION + axis] = 10.0;
            let moved = antenna(step, none).sight(&place, &velocity);
            assert!((moved.range - middle.range - range.times(&error)).abs() < 1e-4);
            assert!((moved.rate - middle.rate - rate.times(&error)).abs() < 1e-8);
            error[POSITION + axis] = 0.0;
            error[VELOCITY + axis] = 10.0;
            let moved = antenna(none, step).sight(&place, &velocity);
            assert!((moved.rate - middle.rate - rate.times(&error)).abs() < 1e-8);
        }
    }
}
