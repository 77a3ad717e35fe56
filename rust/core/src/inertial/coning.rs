//! What happens within an interval: coning and sculling, from this increment and the two before.
//!
//! P. G. Savage, "Strapdown inertial navigation integration algorithm design", J. Guidance,
//! Control, Dynamics 21 (1998) 19 and 208. Rate and specific force are taken as parabolas in time
//! over three equal intervals, as lines over two, which need not be equally long.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::Increment;

/// Rotation over an interval as one vector, and velocity in the axes at its beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Rotation vector, rad.
    pub rotation: Vector3<f64>,
    /// m/s.
    pub velocity: Vector3<f64>,
}

/// The increments before, as far as they are known and follow one another.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct History {
    last: Option<Increment>,
    earlier: Option<Increment>,
}

impl History {
    /// Motion over the increment that follows; from then on it is part of the history.
    #[inline]
    pub fn motion(&mut self, now: &Increment) -> Motion {
        let (rotation, velocity) = self.trends(now);
        self.earlier = self.last.replace(*now);
        motion(now, &rotation, &velocity)
    }

    /// Trends of rotation and velocity: with three equal intervals a parabola, with two a line.
    #[inline]
    fn trends(&self, now: &Increment) -> (Trend, Trend) {
        let Some(last) = &self.last else {
            return (Trend::default(), Trend::default());
        };
        let share = now.interval / last.interval;
        match &self.earlier {
            Some(earlier) if same(share) && same(last.interval / earlier.interval) => (
                Trend::parabola(&now.rotation, &last.rotation, &earlier.rotation),
                Trend::parabola(&now.velocity, &last.velocity, &earlier.velocity),
            ),
            // The first interval's own trend, not known then, is made up for in the second.
            earlier => {
                let weight = if earlier.is_none() { 2.0 } else { 1.0 };
                (
                    Trend::line(&now.rotation, &last.rotation, share, weight),
                    Trend::line(&now.velocity, &last.velocity, share, weight),
                )
            }
        }
    }
}

#[inline]
fn same(share: f64) -> bool {
    (share - 1.0).abs() < 1e-3
}

/// Rate within an interval, in units of the interval: a + slope t + bend t^2, t from 0 to 1.
#[derive(Debug, Clone, Copy, Default)]
struct Trend {
    slope: Vector3<f64>,
    bend: Vector3<f64>,
}

impl Trend {
    #[inline]
    fn line(now: &Vector3<f64>, last: &Vector3<f64>, share: f64, weight: f64) -> Self {
        Trend {
            slope: (now - share * last) * (weight * 2.0 * share / (1.0 + share)),
            bend: Vector3::zeros(),
        }
    }

    #[inline]
    fn parabola(now: &Vector3<f64>, last: &Vector3<f64>, earlier: &Vector3<f64>) -> Self {
        Trend {
            slope: now - last,
            bend: 0.5 * (now - 2.0 * last + earlier),
        }
    }
}

/// Half the integral of angle x rate (coning), its like for force and rate (sculling), the
/// rotation of a steady force in a steady turn, and what a trend changes in the latter.
#[inline]
fn motion(now: &Increment, turn: &Trend, push: &Trend) -> Motion {
    let (angle, velocity) = (&now.rotation, &now.velocity);
    let (turns, pushes) = (turn.slope + turn.bend, push.slope + push.bend);
    let coning = angle.cross(&turns) / 12.0 + turn.slope.cross(&turn.bend) / 360.0;
    let sculling = (angle.cross(&pushes) + velocity.cross(&turns)) / 12.0
        + (turn.slope.cross(&push.bend) + push.slope.cross(&turn.bend)) / 360.0;
    let (_, _, first, second) = series(angle.norm_squared());
    let across = angle.cross(velocity);
    let twice =
        second * across + angle.cross(&push.slope) / 24.0 - turn.slope.cross(velocity) / 48.0;
    Motion {
        rotation: angle + coning,
        velocity: velocity + first * across + angle.cross(&twice) + sculling
            - turn.slope.cross(&across) / 48.0,
    }
}

/// Quaternion of a rotation vector.
#[inline]
pub fn quaternion(rotation: &Vector3<f64>) -> UnitQuaternion<f64> {
    let (cos, sin, _, _) = series(rotation.norm_squared());
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, sin * rotation))
}

/// Of an angle x squared: cos x/2, sin(x/2)/x, (1 - cos x)/x^2, (x - sin x)/x^3.
#[inline]
fn series(square: f64) -> (f64, f64, f64, f64) {
    if square > 0.04 {
        let x = square.sqrt();
        let (half_sin, half_cos) = (x / 2.0).sin_cos();
        let sin = x.sin();
        return (
            half_cos,
            half_sin / x,
            2.0 * half_sin * half_sin / square,
            (x - sin) / (square * x),
        );
    }
    let q = square / 4.0;
    let s = square;
    (
        1.0 - q / 2.0 * (1.0 - q / 12.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0 * (1.0 - q / 90.0)))),
        0.5 * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0)))),
        0.5 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0)))),
        1.0 / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0)))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_forms_meet() {
        let (below, above) = (series(0.04), series(0.04 + 1e-15));
        for (b, a) in [
            (below.0, above.0),
            (below.1, above.1),
            (below.2, above.2),
            (below.3, above.3),
        ] {
            assert!((b - a).abs() < 1e-13, "{b} {a}");
        }
    }

    /// Constant rate, force fixed in space: its integral in the first axes is the force itself.
    #[test]
    fn a_steady_turn_is_undone_to_third_order() {
        let angle = Vector3::new(0.01, -0.02, 0.03);
        let force = Vector3::new(1.0, 2.0, -9.8);
        let step = |k: f64| {
            // Sum of the force seen from the axes at the middle of many small parts.
            let parts = 2000;
            let sum = (0..parts).fold(Vector3::zeros(), |sum, i| {
                let part = k + (f64::from(i) + 0.5) / f64::from(parts);
                sum + quaternion(&(-part * angle)) * force / f64::from(parts)
            });
            Increment {
                rotation: angle,
                velocity: sum,
                interval: 1.0,
            }
        };
        let got = History {
            last: Some(step(-1.0)),
            earlier: Some(step(-2.0)),
        }
        .motion(&step(0.0));
        assert!((got.velocity - force).norm() < 0.04_f64.powi(3) * 10.0 / 20.0);
    }

    /// Coning motion: the drift left over is that of the classical two-increment algorithm.
    #[test]
    fn coning_is_compensated() {
        let (size, rate, interval) = (0.01_f64, 20.0_f64, 0.01);
        // Exact rate of a body whose axis describes a cone of half angle `size`.
        let turn = |t: f64| {
            let axis = Vector3::new((rate * t).cos(), (rate * t).sin(), 0.0);
            quaternion(&(size * axis))
        };
        let gyro = |t: f64| {
            let parts = 400;
            let width = interval / f64::from(parts);
            (0..parts).fold(Vector3::zeros(), |sum, i| {
                let start = t + f64::from(i) * width;
                sum + (turn(start).inverse() * turn(start + width)).scaled_axis()
            })
        };
        let (mut with, mut without) = (turn(0.0), turn(0.0));
        let mut history = History::default();
        for k in 0..1000 {
            let now = Increment {
                rotation: gyro(f64::from(k) * interval),
                velocity: Vector3::zeros(),
                interval,
            };
            with *= quaternion(&history.motion(&now).rotation);
            without *= quaternion(&now.rotation);
        }
        let truth = turn(1000.0 * interval);
        let left = (truth.inverse() * with).angle();
        let uncompensated = (truth.inverse() * without).angle();
        assert!(left < 1e-6, "{left}");
        assert!(uncompensated > 50.0 * left, "{uncompensated} {left}");
    }
}
