//! The numerical core of sdr-spoof.
//!
//! Everything that runs per sample or per epoch lives here: spreading codes, IF synthesis,
//! correlation, acquisition and tracking. The crate knows nothing of Python.
//!
//! The only clock is the absolute sample index. Results never depend on how the input is cut
//! into blocks or on the number of threads.

#![deny(unsafe_code)]

pub mod acquire;
pub mod correlator_level;
pub mod decision;
pub mod dsp;
pub mod error;
pub mod fec;
pub mod inertial;
pub mod nav_math;
pub mod nco;
pub mod sample;
pub mod signal;
#[allow(unsafe_code)]
pub mod simd;
pub mod synth;
pub mod track;

pub use error::{Error, Result};

/// Complex double, the type of every correlator output.
pub type C64 = num_complex::Complex<f64>;
