//! Trajectories in closed form and the increments that an ideal IMU senses on them, for tests.
//!
//! Latitude, longitude, height, yaw, pitch and roll are each a straight line plus sines, so that
//! rates and accelerations are exact; increments are Gauss-Legendre sums of four points.

use nalgebra::{UnitQuaternion, Vector3};

use super::earth::{Earth, E2};
use super::{gravity, Increment, NavState};
use crate::nav_math::geodesy::{Geodetic, WGS84};

/// A line plus sines: value, rate, and (size, rad/s, phase) of each.
#[derive(Clone, Default)]
pub(crate) struct Curve {
    pub start: f64,
    pub rate: f64,
    pub waves: Vec<(f64, f64, f64)>,
}

impl Curve {
    pub fn line(start: f64, rate: f64) -> Self {
        Curve {
            start,
            rate,
            waves: Vec::new(),
        }
    }

    pub fn with(mut self, size: f64, rate: f64, phase: f64) -> Self {
        self.waves.push((size, rate, phase));
        self
    }

    /// Value and its first two derivatives.
    pub fn at(&self, t: f64) -> (f64, f64, f64) {
        let line = (self.start + self.rate * t, self.rate, 0.0);
        self.waves.iter().fold(line, |sum, &(size, rate, phase)| {
            let (sin, cos) = (rate * t + phase).sin_cos();
            (
                sum.0 + size * sin,
                sum.1 + size * rate * cos,
                sum.2 - size * rate * rate * sin,
            )
        })
    }
}

/// Latitude, longitude (rad), height (m) and yaw, pitch, roll (rad).
#[derive(Clone, Default)]
pub(crate) struct Path {
    pub latitude: Curve,
    pub longitude: Curve,
    pub height: Curve,
    pub yaw: Curve,
    pub pitch: Curve,
    pub roll: Curve,
}

impl Path {
    pub fn at_rest(latitude: f64, longitude: f64, height: f64) -> Self {
        Path {
            latitude: Curve::line(latitude, 0.0),
            longitude: Curve::line(longitude, 0.0),
            height: Curve::line(height, 0.0),
            ..Path::default()
        }
    }

    pub fn state(&self, t: f64) -> NavState {
        let (latitude, north, _) = self.latitude.at(t);
        let (longitude, east, _) = self.longitude.at(t);
        let (height, up, _) = self.height.at(t);
        let earth = Earth::at(latitude, height);
        let (roll, pitch, yaw) = (self.roll.at(t).0, self.pitch.at(t).0, self.yaw.at(t).0);
        NavState {
            place: Geodetic {
                latitude,
                longitude,
                height,
            },
            velocity: Vector3::new(north * earth.meridian, east * earth.normal * earth.cos, -up),
            attitude: UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        }
    }

    /// What an ideal IMU feels: rate against inertial space and specific force, in body axes.
    pub fn felt(&self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        let state = self.state(t);
        let earth = Earth::at(state.place.latitude, state.place.height);
        let (rotation, transport) = (earth.rotation(), earth.transport(&state.velocity));
        let pull = Vector3::new(0.0, 0.0, gravity::normal(earth.sin, state.place.height));
        let coriolis = (2.0 * rotation + transport).cross(&state.velocity);
        let force = self.acceleration(t, &earth) + coriolis - pull;
        let into = state.attitude.inverse();
        (
            into * (rotation + transport) + self.turning(t),
            into * force,
        )
    }

    /// Rate of change of the components of the velocity in local axes.
    fn acceleration(&self, t: f64, earth: &Earth) -> Vector3<f64> {
        let (_, b1, b2) = self.latitude.at(t);
        let (_, l1, l2) = self.longitude.at(t);
        let (_, h1, h2) = self.height.at(t);
        let w2 = 1.0 - E2 * earth.sin * earth.sin;
        let squeeze = E2 * earth.sin * earth.cos * b1 / w2.powf(1.5) * WGS84.a;
        let meridian1 = 3.0 * (1.0 - E2) / w2 * squeeze + h1;
        let normal1 = squeeze + h1;
        Vector3::new(
            b2 * earth.meridian + b1 * meridian1,
            (l2 * earth.normal + l1 * normal1) * earth.cos - l1 * earth.normal * earth.sin * b1,
            -h2,
        )
    }

    /// Rate of the body against local axes, in body axes, from those of yaw, pitch and roll.
    fn turning(&self, t: f64) -> Vector3<f64> {
        let (_, yaw1, _) = self.yaw.at(t);
        let (pitch, pitch1, _) = self.pitch.at(t);
        let (roll, roll1, _) = self.roll.at(t);
        Vector3::new(
            roll1 - yaw1 * pitch.sin(),
            pitch1 * roll.cos() + yaw1 * pitch.cos() * roll.sin(),
            -pitch1 * roll.sin() + yaw1 * pitch.cos() * roll.cos(),
        )
    }

    /// Increment over (t, t + interval).
    pub fn increment(&self, t: f64, interval: f64) -> Increment {
        const NODES: [(f64, f64); 4] = [
            (0.069_431_844_202_973_7, 0.173_927_422_568_726_9),
            (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
            (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
            (0.930_568_155_797_026_3, 0.173_927_422_568_726_9),
        ];
        let mut sum = Increment {
            rotation: Vector3::zeros(),
            velocity: Vector3::zeros(),
            interval,
        };
        for (node, weight) in NODES {
            let (rate, force) = self.felt(t + node * interval);
            sum.rotation += weight * interval * rate;
            sum.velocity += weight * interval * force;
        }
        sum
    }
}

/// A car in the plane: 15 m/s, turns of 3 m/s^2, over rolling ground.
pub(crate) fn vehicle() -> Path {
    Path {
        latitude: Curve::line(0.593, 1e-6)
            .with(4e-6, 0.31, 0.0)
            .with(2e-5, 0.03, 1.0),
        longitude: Curve::line(1.885, 2e-6).with(4e-6, 0.31, 1.57),
        height: Curve::line(400.0, 0.02).with(8.0, 0.05, 0.0),
        yaw: Curve::line(0.3, 0.31).with(0.4, 0.2, 0.0),
        pitch: Curve::line(0.0, 0.0).with(0.06, 0.4, 1.0),
        roll: Curve::line(0.0, 0.0).with(0.04, 0.7, 2.0),
    }
}

/// An aircraft that climbs to 9 km at 120 m/s with banked turns.
pub(crate) fn aircraft() -> Path {
    Path {
        latitude: Curve::line(0.593, 1.2e-5).with(3e-4, 0.02, 0.0),
        longitude: Curve::line(3.1, 1.5e-5).with(3e-4, 0.02, 1.57),
        height: Curve::line(400.0, 5.0).with(200.0, 0.02, 0.0),
        yaw: Curve::line(0.5, 0.02).with(0.5, 0.1, 0.0),
        pitch: Curve::line(0.05, 0.0).with(0.1, 0.3, 1.0),
        roll: Curve::line(0.0, 0.0).with(0.5, 0.15, 0.0),
    }
}

/// A ship at 8 m/s in waves of 3 m: roll of 12 degrees in 9 s, pitch of 4 in 7 s, heave, sway.
pub(crate) fn ship() -> Path {
    Path {
        latitude: Curve::line(0.593, 8e-7).with(1.5e-7, 0.7, 0.3),
        longitude: Curve::line(1.885, 1e-6).with(1.5e-7, 0.8, 1.3),
        height: Curve::line(10.0, 0.0).with(1.5, 0.75, 0.0),
        yaw: Curve::line(0.8, 0.0)
            .with(0.05, 0.2, 0.0)
            .with(0.5, 0.01, 0.0),
        pitch: Curve::line(0.0, 0.0).with(0.07, 0.9, 0.5),
        roll: Curve::line(0.0, 0.0).with(0.21, 0.7, 0.0),
    }
}

/// A drone: turns of 0.5 rad/s about all axes.
pub(crate) fn drone() -> Path {
    Path {
        latitude: Curve::line(-0.4, 5e-7).with(3e-6, 0.5, 0.3),
        longitude: Curve::line(-2.0, 1e-6).with(3e-6, 0.6, 1.3),
        height: Curve::line(50.0, 0.1).with(10.0, 0.3, 0.0),
        yaw: Curve::line(0.8, 0.5).with(0.3, 2.0, 0.0),
        pitch: Curve::line(0.0, 0.0).with(0.15, 3.0, 0.5),
        roll: Curve::line(0.0, 0.0).with(0.2, 2.5, 0.0),
    }
}
