//! What perfect sensors read along a known motion.
//!
//! The motion is a cubic Hermite piece from each knot to the next, in latitude, longitude, height
//! and in yaw, pitch, roll; there its rates and accelerations are closed forms. Angular rate and
//! specific force against inertial space follow from them exactly (Groves 2013, Principles of GNSS,
//! Inertial, and Multisensor Integrated Navigation Systems, equations 5.22 to 5.25 and 5.53 to 5.56
//! the other way about) and are integrated by Gauss's rule, exact to the fifth power of time. What
//! is lost is 1e-9 of an increment; nothing is accumulated.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::earth::{Earth, E2};
use super::{gravity, Increment};
use crate::nav_math::geodesy::Geodetic;

/// A knot: latitude and longitude (rad) and height (m) beyond those of the origin; yaw, pitch,
/// roll (rad, not wrapped); then the rates of the six.
pub type Knot = [f64; 12];

/// Points and weights of Gauss's rule with three points, over 0 to 1.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Value, rate and acceleration of one coordinate.
#[derive(Clone, Copy)]
struct Jet(f64, f64, f64);

/// A cubic piece between two knots, `u` from 0 to 1 of a step.
#[inline]
fn hermite(a: &Knot, b: &Knot, axis: usize, u: f64, step: f64) -> Jet {
    let (from, rate) = (a[axis], step * a[axis + 6]);
    let (rise, end) = (b[axis] - from, step * b[axis + 6]);
    let (c2, c3) = (3.0 * rise - 2.0 * rate - end, rate + end - 2.0 * rise);
    Jet(
        from + u * (rate + u * (c2 + u * c3)),
        (rate + u * (2.0 * c2 + 3.0 * u * c3)) / step,
        (2.0 * c2 + 6.0 * u * c3) / (step * step),
    )
}

/// Where the Earth is under a body, and how the body moves over it.
struct Motion {
    earth: Earth,
    /// North, east, down, m/s.
    velocity: Vector3<f64>,
    /// Rate of its components, m/s^2.
    change: Vector3<f64>,
    gravity: f64,
}

impl Motion {
    #[inline]
    fn of(latitude: Jet, longitude: Jet, height: Jet) -> Self {
        let earth = Earth::at(latitude.0, height.0);
        let (sin, cos, squeeze) = (earth.sin, earth.cos, 1.0 - E2 * earth.sin * earth.sin);
        // Radii of curvature grow towards the poles.
        let bend = E2 * sin * cos * latitude.1 / squeeze;
        let meridian = 3.0 * (earth.meridian - height.0) * bend + height.1;
        let normal = (earth.normal - height.0) * bend + height.1;
        let level = earth.normal * cos;
        Motion {
            velocity: Vector3::new(earth.meridian * latitude.1, level * longitude.1, -height.1),
            change: Vector3::new(
                earth.meridian * latitude.2 + meridian * latitude.1,
                level * longitude.2
                    + (normal * cos - earth.normal * sin * latitude.1) * longitude.1,
                -height.2,
            ),
            gravity: gravity::normal(sin, height.0),
            earth,
        }
    }

    /// Turn of the local axes against inertial space.
    #[inline]
    fn turn(&self) -> Vector3<f64> {
        self.earth.rotation() + self.earth.transport(&self.velocity)
    }

    /// In local axes, m/s^2.
    #[inline]
    fn specific_force(&self) -> Vector3<f64> {
        let turn = self.turn() + self.earth.rotation();
        self.change + turn.cross(&self.velocity) - Vector3::new(0.0, 0.0, self.gravity)
    }
}

/// From local to body axes, and the turn of the body against the local axes in body axes.
#[inline]
fn turned(yaw: Jet, pitch: Jet, roll: Jet) -> (Matrix3<f64>, Vector3<f64>) {
    let ((sy, cy), (sp, cp)) = (yaw.0.sin_cos(), pitch.0.sin_cos());
    let (sr, cr) = roll.0.sin_cos();
    let axes = Matrix3::new(
        cy * cp,
        sy * cp,
        -sp,
        cy * sp * sr - sy * cr,
        sy * sp * sr + cy * cr,
        cp * sr,
        cy * sp * cr + sy * sr,
        sy * sp * cr - cy * sr,
        cp * cr,
    );
    let rate = Vector3::new(
        roll.1 - yaw.1 * sp,
        pitch.1 * cr + yaw.1 * cp * sr,
        yaw.1 * cp * cr - pitch.1 * sr,
    );
    (axes, rate)
}

/// Angular rate and specific force in body axes.
#[inline]
fn sensed(origin: Geodetic, a: &Knot, b: &Knot, u: f64, step: f64) -> [Vector3<f64>; 2] {
    let jet = |axis| hermite(a, b, axis, u, step);
    let moved = |jet: Jet, by: f64| Jet(jet.0 + by, jet.1, jet.2);
    let motion = Motion::of(
        moved(jet(0), origin.latitude),
        moved(jet(1), origin.longitude),
        moved(jet(2), origin.height),
    );
    let (axes, rate) = turned(jet(3), jet(4), jet(5));
    [axes * motion.turn() + rate, axes * motion.specific_force()]
}

/// Increments over `per` steps each, from knots that are `step` seconds apart.
pub fn increments(origin: Geodetic, knots: &[Knot], step: f64, per: usize) -> Vec<Increment> {
    let count = knots.len().saturating_sub(1) / per;
    let one = |k: usize| {
        let mut increment = Increment {
            rotation: Vector3::zeros(),
            velocity: Vector3::zeros(),
            interval: step * per as f64,
        };
        for pair in knots[k * per..=(k + 1) * per].windows(2) {
            for (u, weight) in GAUSS {
                let [rate, force] = sensed(origin, &pair[0], &pair[1], u, step);
                increment.rotation += rate * (weight * step);
                increment.velocity += force * (weight * step);
            }
        }
        increment
    };
    (0..count)
        .into_par_iter()
        .with_min_len(1024)
        .map(one)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::closed_form::{aircraft, drone, ship, vehicle, Path};
    use crate::inertial::strapdown::error_of;
    use crate::inertial::Strapdown;

    const ORIGIN: Geodetic = Geodetic {
        latitude: 0.6,
        longitude: 1.9,
        height: 400.0,
    };
    const STEP: f64 = 0.01;

    /// Where a path begins, and its knots beyond that place.
    fn knots(path: &Path, count: usize) -> (Geodetic, Vec<Knot>) {
        let origin = Geodetic {
            latitude: path.latitude.start,
            longitude: path.longitude.start,
            height: path.height.start,
        };
        let mut moved = path.clone();
        (moved.latitude.start, moved.longitude.start) = (0.0, 0.0);
        moved.height.start = 0.0;
        let one = |k: usize| {
            let m = &moved;
            let curves = [
                &m.latitude,
                &m.longitude,
                &m.height,
                &m.yaw,
                &m.pitch,
                &m.roll,
            ];
            let mut knot = [0.0; 12];
            for (axis, curve) in curves.into_iter().enumerate() {
                (knot[axis], knot[axis + 6], _) = curve.at(STEP * k as f64);
            }
            knot
        };
        (origin, (0..count).map(one).collect())
    }

    #[test]
    fn a_body_at_rest_feels_the_earth() {
        let mut knot = [0.0; 12];
        knot[3] = 0.5;
        let got = increments(ORIGIN, &[knot; 3], STEP, 2);
        assert_eq!(got.len(), 1);
        let earth = Earth::at(ORIGIN.latitude, ORIGIN.height);
        let spin = earth.rotation() * 2.0 * STEP;
        let (sin, cos) = 0.5_f64.sin_cos();
        let expected = Vector3::new(spin.x * cos, -spin.x * sin, spin.z);
        assert!((got[0].rotation - expected).norm() < 1e-17);
        let g = gravity::normal(earth.sin, ORIGIN.height);
        let plumb = Vector3::new(0.0, 0.0, -2.0 * STEP * g);
        assert!((got[0].velocity - plumb).norm() < 1e-15);
    }

    #[test]
    fn increments_are_those_of_closed_forms() {
        for path in [vehicle(), aircraft(), ship(), drone()] {
            let (origin, knots) = knots(&path, 401);
            let got = increments(origin, &knots, STEP, 2);
            let (mut rotation, mut velocity) = (Vector3::zeros(), Vector3::zeros());
            for (k, got) in got.iter().enumerate() {
                let expected = path.increment(2.0 * STEP * k as f64, 2.0 * STEP);
                assert!((got.rotation - expected.rotation).norm() < 2e-10);
                assert!((got.velocity - expected.velocity).norm() < 2e-9);
                rotation += got.rotation - expected.rotation;
                velocity += got.velocity - expected.velocity;
            }
            // Nothing is accumulated.
            assert!(
                rotation.norm() < 1e-9 && velocity.norm() < 2e-8,
                "{rotation} {velocity}"
            );
        }
    }

    #[test]
    fn a_strapdown_comes_back_to_the_trajectory() {
        for path in [vehicle(), ship()] {
            let count = 175_000;
            let mut ins = Strapdown::new(path.state(0.0));
            let (origin, knots) = knots(&path, count + 1);
            for increment in increments(origin, &knots, STEP, 1) {
                ins.advance(&increment);
            }
            let error = error_of(ins.state(), &path.state(STEP * count as f64));
            assert!(error.velocity.norm() < 1e-4, "{error:?}");
            assert!(error.position.norm() < 0.05, "{error:?}");
        }
    }
}
