//! What an IMU adds to the truth: biases, noise, scale factors, misalignments, range, resolution.
//!
//! A sensor of unit u (rad/s for a gyro, m/s^2 for an accelerometer) reads, over an interval,
//! `(1 + distortion) truth + (bias + wander) interval + density sqrt(interval) n`, clipped to its
//! range and rounded to its quantum, the remainder of which it keeps. The wander is a first-order
//! Gauss-Markov process, the densities those of IEEE Std 952-1997, annex C (angle and velocity
//! random walk). All noise is a pure function of (seed, run, number of the increment).

use nalgebra::{Matrix3, Vector3};

use super::draws::Draws;
use super::Increment;

/// Errors of three sensors of one kind, in body axes; `Default` is perfect ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorErrors {
    /// Constant, u.
    pub bias: Vector3<f64>,
    /// Standard deviation of the bias that wanders, the same for each axis, u.
    pub wander: f64,
    /// Its correlation time, s; infinite: a random constant.
    pub wander_time: f64,
    /// White noise: standard deviation of the sum over 1 s, u sqrt(s).
    pub density: f64,
    /// Scale factor errors on the diagonal; beside it the misalignments in rad, row a sensor,
    /// column the axis that it senses also.
    pub distortion: Matrix3<f64>,
    /// Largest value that can be read, u; infinite: any.
    pub limit: f64,
    /// Step of the sum over an interval, u s; 0: none.
    pub quantum: f64,
}

impl Default for SensorErrors {
    fn default() -> Self {
        SensorErrors {
            bias: Vector3::zeros(),
            wander: 0.0,
            wander_time: f64::INFINITY,
            density: 0.0,
            distortion: Matrix3::zeros(),
            limit: f64::INFINITY,
            quantum: 0.0,
        }
    }
}

/// Errors of an IMU.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ImuErrors {
    /// rad/s.
    pub gyro: SensorErrors,
    /// m/s^2.
    pub accelerometer: SensorErrors,
    /// Of the noise and of the wander.
    pub seed: u64,
}

/// Three sensors of one kind at work.
#[derive(Debug, Clone)]
struct Sensors {
    errors: SensorErrors,
    wander: Vector3<f64>,
    /// Of the wander from one increment to the next: what stays, and what comes anew.
    keeps: f64,
    adds: f64,
    /// Standard deviation of an increment's white noise.
    sigma: f64,
    remainder: Vector3<f64>,
}

impl Sensors {
    fn new(errors: SensorErrors) -> Self {
        Sensors {
            errors,
            wander: Vector3::zeros(),
            keeps: 1.0,
            adds: 0.0,
            sigma: 0.0,
            remainder: Vector3::zeros(),
        }
    }

    fn set_interval(&mut self, interval: f64) {
        self.sigma = self.errors.density * interval.sqrt();
        self.keeps = (-interval / self.errors.wander_time).exp();
        self.adds = self.errors.wander * (1.0 - self.keeps * self.keeps).sqrt();
    }

    fn step(&mut self, noise: Vector3<f64>) {
        self.wander = self.wander * self.keeps + noise * self.adds;
    }

    fn bias(&self) -> Vector3<f64> {
        self.errors.bias + self.wander
    }

    fn read(&mut self, truth: Vector3<f64>, interval: f64, noise: Vector3<f64>) -> Vector3<f64> {
        let e = &self.errors;
        let sum = truth + e.distortion * truth + self.bias() * interval + noise * self.sigma;
        let limit = e.limit * interval;
        let clipped = sum.map(|v| v.clamp(-limit, limit));
        if e.quantum == 0.0 {
            return clipped;
        }
        let whole = clipped + self.remainder;
        let read = whole.map(|v| (v / e.quantum).round() * e.quantum);
        self.remainder = whole - read;
        read
    }
}

/// The errors of one run, increment after increment.
#[derive(Debug, Clone)]
pub struct ErrorStream {
    gyro: Sensors,
    accelerometer: Sensors,
    white: Option<Draws>,
    wander: Option<Draws>,
    interval: f64,
}

impl ErrorStream {
    /// Run number `run` of a seed; the noises of runs are independent.
    pub fn new(errors: &ImuErrors, run: u64) -> Self {
        let [gyro, accelerometer] = [errors.gyro, errors.accelerometer].map(Sensors::new);
        let any = |of: fn(&SensorErrors) -> f64| of(&gyro.errors).max(of(&accelerometer.errors));
        let draws = |size, part| (size > 0.0).then(|| Draws::new(errors.seed, 2 * run + part));
        let mut stream = ErrorStream {
            white: draws(any(|e| e.density), 0),
            wander: draws(any(|e| e.wander), 1),
            gyro,
            accelerometer,
            interval: f64::NAN,
        };
        stream.start();
        stream
    }

    /// Draws the wander from its stationary law.
    fn start(&mut self) {
        if let Some(draws) = &mut self.wander {
            let [gyro, accelerometer] = draws.six();
            self.gyro.wander = gyro * self.gyro.errors.wander;
            self.accelerometer.wander = accelerometer * self.accelerometer.errors.wander;
        }
    }

    /// Goes on as if `count` increments of this length had been applied; what a quantised sensor
    /// then kept is forgotten.
    pub fn skip(&mut self, count: usize, interval: f64) {
        if let Some(white) = &mut self.white {
            white.skip(count);
        }
        if self.wander.is_some() {
            (0..count).for_each(|_| self.step(interval));
        }
    }

    /// Turns what happened into what is read.
    #[inline]
    pub fn apply(&mut self, increment: &mut Increment) {
        let interval = increment.interval;
        self.step(interval);
        let [gyro, accelerometer] = match &mut self.white {
            Some(white) => white.six(),
            None => [Vector3::zeros(); 2],
        };
        increment.rotation = self.gyro.read(increment.rotation, interval, gyro);
        increment.velocity = self
            .accelerometer
            .read(increment.velocity, interval, accelerometer);
    }

    /// Bias and wander of the last increment, rad/s and m/s^2.
    pub fn biases(&self) -> [Vector3<f64>; 2] {
        [self.gyro.bias(), self.accelerometer.bias()]
    }

    #[inline]
    fn step(&mut self, interval: f64) {
        if interval != self.interval {
            self.gyro.set_interval(interval);
            self.accelerometer.set_interval(interval);
            self.interval = interval;
        }
        if let Some(draws) = &mut self.wander {
            let [gyro, accelerometer] = draws.six();
            self.gyro.step(gyro);
            self.accelerometer.step(accelerometer);
        }
    }
}

#[cfg(test)]
mod tests;
