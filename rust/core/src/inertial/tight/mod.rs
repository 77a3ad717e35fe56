//! Tightly coupled GNSS/INS: pseudoranges and rates correct an INS, and the INS judges them.
//!
//! Errors are what the navigator says minus the truth, in local axes (see `error_model`); of the
//! biases, what the corrected sensors still sense too much. All functions of one step work in
//! memory that was allocated before.

pub mod adjoint;
pub mod alarms;
pub mod copies;
pub mod covariance;
pub mod decide;
pub mod epoch;
pub mod filter;
pub mod fix;
pub mod guard;
pub mod hearing;
pub mod measure;
pub mod monitors;
pub mod motion;
pub mod navigator;
pub mod output;
pub mod power;
pub mod recording;
pub mod run;
pub mod settings;
pub mod shadow;
pub mod smooth;
pub mod statistics;
pub mod step;
pub mod subsets;
pub mod supervisor;
pub mod tape;
pub mod windows;

/// Position, velocity, attitude, biases of gyros and accelerometers, clock, its drift.
pub const NAV: usize = 17;
/// First of the three position errors.
pub const POSITION: usize = 0;
/// First of the three velocity errors.
pub const VELOCITY: usize = 3;
/// First of the three attitude errors.
pub const ATTITUDE: usize = 6;
/// First of the gyros' biases.
pub const GYRO: usize = 9;
/// First of the accelerometers' biases.
pub const ACCELEROMETER: usize = 12;
/// The clock, m.
pub const CLOCK: usize = 15;
/// Its drift, m/s.
pub const DRIFT: usize = 16;
