//! What the filter believes of its sensors, and how it tests them.

use nalgebra::Vector3;

use super::epoch::Epoch;

/// Noise of an IMU as the filter takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuNoise {
    /// Angle random walk, rad/sqrt(s).
    pub gyro: f64,
    /// Velocity random walk, m/s/sqrt(s).
    pub accelerometer: f64,
    /// Random walk of the gyros' biases, rad/s/sqrt(s).
    pub gyro_walk: f64,
    /// Random walk of the accelerometers' biases, m/s^2/sqrt(s).
    pub accelerometer_walk: f64,
}

/// Noise of the receiver as the filter takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReceiverNoise {
    /// White part of a pseudorange, m.
    pub code: f64,
    /// Gauss-Markov part of a pseudorange, a state of each satellite; 0: none, m.
    pub wander: f64,
    /// Its correlation time, s.
    pub wander_time: f64,
    /// Of a range rate, m/s.
    pub rate: f64,
    /// Of a change by carrier phase; 0: changes are not used, m.
    pub change: f64,
    /// Variances grow below this C/N0 as the ratio to it, dB-Hz; 0: they never do.
    pub reference_cn0: f64,
    /// Random walk of the clock, m^2/s.
    pub clock: f64,
    /// Random walk of its drift, (m/s)^2/s.
    pub drift: f64,
}

/// Standard deviations of what the filter starts with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartSigma {
    /// North, east, down, m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
    /// Roll and pitch, rad.
    pub level: f64,
    /// rad.
    pub heading: f64,
    /// rad/s; 0: biases of gyros are no states (11 states).
    pub gyro_bias: f64,
    /// m/s^2; 0: biases of accelerometers are no states.
    pub accelerometer_bias: f64,
    /// m; the clock itself is taken from the first epoch.
    pub clock: f64,
    /// m/s.
    pub drift: f64,
}

/// Which of the three readings of the published R statistic counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// (1/L) sum |d|^2.
    MeanSquare,
    /// (1/(L-1)) sum d_k d_(k-1).
    Lag1,
    /// |(1/L) sum d|^2.
    Coherent,
}

/// The published statistics: length, form, and what each is divided by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Published {
    /// Epochs of a sum.
    pub length: usize,
    /// Which one the verdict asks.
    pub form: Form,
    /// Divisors of position, velocity, pseudorange and rate, in their units squared.
    pub divisors: [f64; 4],
}

/// What happens to satellites that do not agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Nothing: tests only.
    Off,
    /// As published: whatever has R > 1 is left out of this epoch's update.
    Printed,
    /// Trusted copies, exclusion, re-admission: see `guard`.
    Robust,
}

/// Of the robust tests and of the state machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Testing {
    /// Thresholds of innovation windows of rates, of changes and of codes, separation, clock, as
    /// normal deviates.
    pub thresholds: [f64; 5],
    /// Rise of C/N0 of the third strongest riser that counts as an attack, dB.
    pub power_rise: f64,
    /// Innovations beyond so many standard deviations weigh less; 0: all weigh the same.
    pub robust: f64,
    /// Part of the filter's own covariance that a separation may have besides.
    pub slack: f64,
    /// Most satellites that are looked for as a subset.
    pub most_excluded: usize,
    /// Satellites that the receiver's own detectors call spoofed are left out.
    pub heed_receiver: bool,
}

impl Testing {
    /// Whether the receiver calls a satellite spoofed, and that counts.
    pub fn flags(&self, epoch: &Epoch<'_>, satellite: usize) -> bool {
        self.heed_receiver && epoch.spoofed[satellite]
    }
}

/// All of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Of the IMU.
    pub imu: ImuNoise,
    /// Of the receiver.
    pub receiver: ReceiverNoise,
    /// At the start.
    pub start: StartSigma,
    /// The published statistics.
    pub published: Published,
    /// What is done.
    pub mode: Mode,
    /// How it is tested.
    pub testing: Testing,
    /// Antenna from the INS: forward, right, down, m.
    pub lever_arm: Vector3<f64>,
    /// Coast without GNSS within these times, s: pairs of beginning and end.
    pub outages: Vec<(f64, f64)>,
    /// Gaps of the IMU up to so long are bridged, longer ones make attitude and velocity uncertain, s.
    pub bridge: f64,
    /// Whether every epoch is also estimated from all that was measured before and after it.
    pub smooth: bool,
    /// Whether a filter without each satellite runs beside the whole one.
    pub subsets: bool,
}
