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

    const ORIGIN: Geodetic = Geodetic {
        latitude: 0.6,
        longitude: 1.9,
        height: 400.0,
    };

    #[test]
    fn a_body_at_rest_feels_the_earth() {
        let mut knot = [0.0; 12];
        knot[3] = 0.5;
        let got = increments(ORIGIN, &[knot; 3], 0.01, 2);
        assert_eq!(got.len(), 1);
        let earth = Earth::at(ORIGIN.latitude, ORIGIN.height);
        let north = earth.rotation().x * 0.02;
        let expected = Vector3::new(
            north * 0.5_f64.cos(),
            -north * 0.5_f64.sin(),
            earth.rotation().z * 0.02,
        );
        assert!((got[0].rotation - expected).norm() < 1e-17);
        let g = gravity::normal(earth.sin, ORIGIN.height);
        assert!((got[0].velocity - Vector3::new(0.0, 0.0, -0.02 * g)).norm() < 1e-15);
    }

    /// Eastwards at a constant speed along a parallel: centripetal and Coriolis acceleration, and
    /// body axes that keep to the parallel.
    #[test]
    fn a_body_on_a_parallel_feels_its_curve() {
        let earth = Earth::at(ORIGIN.latitude, ORIGIN.height);
        let (speed, step) = (40.0, 0.01);
        let rate = speed / (earth.normal * earth.cos);
        let knots: Vec<Knot> = (0..3)
            .map(|k| {
                let mut knot = [0.0; 12];
                (knot[1], knot[7]) = (rate * step * f64::from(k), rate);
                knot
            })
            .collect();
        let got = increments(ORIGIN, &knots, step, 2)[0];
        // About the axis of the Earth, at a distance from it.
        let turn = crate::inertial::earth::ROTATION_RATE + rate;
        let expected = Vector3::new(earth.cos, 0.0, -earth.sin) * turn * 2.0 * step;
        assert!((got.rotation - expected).norm() < 1e-15);
        // Towards the axis, beyond what plumb lines at rest already hold.
        let spin = crate::inertial::earth::ROTATION_RATE;
        let inwards = (turn * turn - spin * spin) * earth.normal * earth.cos;
        let g = gravity::normal(earth.sin, ORIGIN.height);
        let force = Vector3::new(inwards * earth.sin, 0.0, inwards * earth.cos - g);
        assert!((got.velocity - force * 2.0 * step).norm() < 1e-14);
    }

    /// A body that rolls over while it yaws: the rates of its axes against finite rotations.
    #[test]
    fn rates_are_those_of_the_axes() {
        let jets = |t: f64| {
            [
                Jet(0.3 + 0.7 * t, 0.7, 0.0),
                Jet(-0.2 + 0.4 * t, 0.4, 0.0),
                Jet(1.0 - 0.9 * t, -0.9, 0.0),
            ]
        };
        let at = |t: f64| {
            let [yaw, pitch, roll] = jets(t);
            turned(yaw, pitch, roll)
        };
        let small = 1e-6;
        let (axes, rate) = at(0.0);
        let change = (at(small).0 - at(-small).0) / (2.0 * small) * axes.transpose();
        let expected = -rate.cross_matrix();
        assert!((change - expected).abs().max() < 1e-9);
    }
}
