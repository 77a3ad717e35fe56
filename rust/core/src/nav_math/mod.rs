//! Navigation: orbits, geodesy, delays of the atmosphere, position, velocity and time.
//!
//! Times are seconds since a reference that the caller chooses, in GPST; `gpst_s` is GPST since
//! 1980-01-06. Lengths are in m, angles in rad, Earth-fixed coordinates throughout.

pub mod batch;
pub mod bdgim;
pub mod dop;
pub mod ekf;
pub mod fix;
pub mod geodesy;
pub mod hatch;
pub mod ionosphere;
mod kepler;
pub mod least_squares;
pub mod measurement;
pub mod orbit;
pub mod raim;
pub mod search;
pub mod snapshot;
pub mod troposphere;
pub mod velocity;

/// Speed of light in vacuum, exact (IS-GPS-200, 20.3.4.3; BDS-SIS-ICD-B1I-3.0, 5.2.4.10).
pub const SPEED_OF_LIGHT_M_S: f64 = 299_792_458.0;
