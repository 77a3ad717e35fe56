//! Inertial navigation: from increments of an IMU to position, velocity and attitude.
//!
//! Body axes are forward, right, down; local axes north, east, down (NED). SI units, angles in rad.

pub mod alignment;
pub mod batch;
#[cfg(test)]
pub(crate) mod closed_form;
pub mod coning;
pub mod covariance;
mod draws;
pub mod earth;
pub mod ecef;
pub mod error_model;
pub mod errors;
pub mod gravity;
pub mod ideal;
pub mod strapdown;
pub mod tight;

use nalgebra::{UnitQuaternion, Vector3};

pub use self::strapdown::{StateError, Strapdown};
use crate::nav_math::geodesy::Geodetic;

/// What gyros and accelerometers have summed up over an interval, in body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Increment {
    /// Rotation against inertial space, rad.
    pub rotation: Vector3<f64>,
    /// Specific force, m/s.
    pub velocity: Vector3<f64>,
    /// Length of the interval, s.
    pub interval: f64,
}

/// Where a body is, how it moves over the Earth and how it is turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavState {
    /// WGS-84.
    pub place: Geodetic,
    /// Against the Earth, in local axes, m/s.
    pub velocity: Vector3<f64>,
    /// From body to local axes.
    pub attitude: UnitQuaternion<f64>,
}
