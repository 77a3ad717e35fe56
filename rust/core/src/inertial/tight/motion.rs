//! Transition of the errors over an interval, from what the navigator went through in it.

use nalgebra::{Matrix3, Vector3};

use super::covariance::{at_rest, zeros, Transition};
use super::settings::Settings;
use super::{ACCELEROMETER, ATTITUDE, CLOCK, DRIFT, GYRO, POSITION, VELOCITY};
use crate::inertial::{error_model, NavState};

/// What has happened since the filter was propagated last.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    /// Specific force in local axes, summed up, m/s.
    felt: Vector3<f64>,
    /// s.
    pub elapsed: f64,
    /// Extra variance for gaps that were bridged: of velocity and of attitude.
    pub blind: [f64; 2],
}

impl Motion {
    /// Nothing yet.
    pub fn new() -> Self {
        Motion {
            felt: Vector3::zeros(),
            elapsed: 0.0,
            blind: [0.0; 2],
        }
    }

    /// Adds an interval: the state at its end, and the velocity increment in body axes.
    pub fn add(&mut self, state: &NavState, velocity: &Vector3<f64>, interval: f64) {
        self.felt += state.attitude * velocity;
        self.elapsed += interval;
    }

    /// Transition over all that was added, about the state at the end.
    pub fn transition(&self, state: &NavState, settings: &Settings) -> Transition {
        let t = self.elapsed;
        let force = state.attitude.inverse() * (self.felt / t);
        let f = error_model::dynamics(state, &force);
        let step = error_model::transition(&f, t);
        let mut phi = at_rest(t);
        for row in 0..ATTITUDE + 3 {
            for column in 0..error_model::STATES {
                phi[row][column] = step[(row, column)];
            }
        }
        let mut made = Transition {
            phi,
            noise: zeros(),
            interval: t,
        };
        self.noise(&mut made, settings);
        made
    }

    fn noise(&self, made: &mut Transition, settings: &Settings) {
        let (imu, gnss, t) = (&settings.imu, &settings.receiver, self.elapsed);
        let q = &mut made.noise;
        let force = imu.accelerometer * imu.accelerometer;
        for k in 0..3 {
            let (p, v, a) = (POSITION + k, VELOCITY + k, ATTITUDE + k);
            q[p][p] = force * t * t * t / 3.0;
            q[p][v] = force * t * t / 2.0;
            q[v][p] = q[p][v];
            q[v][v] = force * t + self.blind[0];
            q[a][a] = imu.gyro * imu.gyro * t + self.blind[1];
            q[GYRO + k][GYRO + k] = imu.gyro_walk * imu.gyro_walk * t;
            let walk = imu.accelerometer_walk;
            q[ACCELEROMETER + k][ACCELEROMETER + k] = walk * walk * t;
        }
        q[CLOCK][CLOCK] = gnss.clock * t + gnss.drift * t * t * t / 3.0;
        q[CLOCK][DRIFT] = gnss.drift * t * t / 2.0;
        q[DRIFT][CLOCK] = q[CLOCK][DRIFT];
        q[DRIFT][DRIFT] = gnss.drift * t;
    }
}

impl Default for Motion {
    fn default() -> Self {
        Self::new()
    }
}

/// Axes from local (north, east, down) to Earth-fixed.
pub fn local_axes(state: &NavState) -> Matrix3<f64> {
    let (sin_b, cos_b) = state.place.latitude.sin_cos();
    let (sin_l, cos_l) = state.place.longitude.sin_cos();
    Matrix3::new(
        -sin_b * cos_l,
        -sin_l,
        -cos_b * cos_l,
        -sin_b * sin_l,
        cos_l,
        -cos_b * sin_l,
        cos_b,
        0.0,
        -sin_b,
    )
}
