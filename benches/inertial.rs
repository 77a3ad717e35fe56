//! Increments of a body that sways, and IMUs with noise, for the strapdown computer.

use nalgebra::{UnitQuaternion, Vector3};
use sdr_spoof_core::inertial::batch::{Mechanisation, Plan};
use sdr_spoof_core::inertial::errors::ImuErrors;
use sdr_spoof_core::inertial::{Increment, NavState};
use sdr_spoof_core::nav_math::geodesy::Geodetic;

/// Increments a second.
pub const INERTIAL_HZ: usize = 100;

/// Of a body that rolls by 0.1 rad and sways by 1 m/s^2.
pub fn increments(seconds: usize) -> Vec<Increment> {
    let interval = 1.0 / INERTIAL_HZ as f64;
    let one = |k: usize| {
        let (sin, cos) = (0.7 * k as f64 * interval).sin_cos();
        Increment {
            rotation: Vector3::new(0.07 * cos, 0.02 * sin, 0.01) * interval,
            velocity: Vector3::new(sin, 0.98 * cos, -9.8) * interval,
            interval,
        }
    };
    (0..seconds * INERTIAL_HZ).map(one).collect()
}

/// A row of output a second.
pub fn plan(increments: &[Increment]) -> Plan<'_> {
    Plan {
        increments,
        start: NavState {
            place: Geodetic {
                latitude: 0.593,
                longitude: 1.885,
                height: 400.0,
            },
            velocity: Vector3::new(5.0, 3.0, 0.0),
            attitude: UnitQuaternion::identity(),
        },
        resets: &[],
        vertical: None,
        every: INERTIAL_HZ,
        mechanisation: Mechanisation::Local,
    }
}

/// Biases and white noise.
pub fn imu() -> ImuErrors {
    let mut errors = ImuErrors {
        seed: 1,
        ..ImuErrors::default()
    };
    errors.gyro.bias = Vector3::repeat(5e-7);
    errors.gyro.density = 3e-6;
    errors.accelerometer.bias = Vector3::repeat(5e-4);
    errors.accelerometer.density = 1e-4;
    errors
}
