//! Ranges through knots: piecewise cubic, with a continuous rate.

use crate::{Error, Result};

/// A knot: time in s, value, rate of change per s.
pub type Knot = (f64, f64, f64);

/// A cubic Hermite spline; beyond its ends it goes on at the rate of the last knot.
///
/// Between two knots the error is at most the fourth derivative times (spacing)^4 / 384 (de Boor,
/// "A Practical Guide to Splines", chapter V); that of the numbers is half a unit in the last place
/// of the value, 4 nm at 4e7 m.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    knots: Vec<Knot>,
}

impl Spline {
    /// A spline through knots.
    ///
    /// # Errors
    /// [`Error::Invalid`] for fewer than two knots, a number that is not finite, or times that do
    /// not increase.
    pub fn new(knots: Vec<Knot>) -> Result<Self> {
        let finite = |&(t, x, v): &Knot| t.is_finite() && x.is_finite() && v.is_finite();
        let fault = if knots.len() < 2 {
            "a spline needs two knots or more"
        } else if !knots.iter().all(finite) {
            "a spline knot is not a finite number"
        } else if knots.windows(2).any(|w| w[1].0 <= w[0].0) {
            "spline times must increase"
        } else {
            return Ok(Spline { knots });
        };
        Err(Error::Invalid(fault.into()))
    }

    /// Value at time `t` seconds.
    pub fn value(&self, t: f64) -> f64 {
        self.at(t).0
    }

    /// Rate of change at time `t` seconds.
    pub fn rate(&self, t: f64) -> f64 {
        self.at(t).1
    }

    /// Value and rate.
    fn at(&self, t: f64) -> (f64, f64) {
        let k = self.knots.partition_point(|knot| knot.0 <= t);
        let near = self.knots[k.saturating_sub(1)];
        if k == 0 || k == self.knots.len() {
            return (near.1 + near.2 * (t - near.0), near.2);
        }
        between(near, self.knots[k], t)
    }
}

/// In Newton's form, so that a large value loses nothing: the rest is small against it.
fn between((t0, x0, v0): Knot, (t1, x1, v1): Knot, t: f64) -> (f64, f64) {
    let (length, into) = (t1 - t0, t - t0);
    let mean = (x1 - x0) / length;
    let (b, c) = (
        (mean - v0) / length,
        (v0 + v1 - 2.0 * mean) / (length * length),
    );
    let left = t - t1;
    let value = x0 + into * (v0 + into * (b + left * c));
    (value, v0 + into * (2.0 * b + c * (into + 2.0 * left)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is its own spline.
    #[test]
    fn cubics_are_exact() {
        let x = |t: f64| 3.0 - 2.0 * t + 0.5 * t * t - 0.25 * t * t * t;
        let v = |t: f64| -2.0 + t - 0.75 * t * t;
        let knots = [-1.0, 0.5, 2.0].map(|t| (t, x(t), v(t)));
        let spline = Spline::new(knots.to_vec()).unwrap();
        for t in [-1.0, -0.3, 0.5, 1.9, 2.0] {
            assert!((spline.value(t) - x(t)).abs() < 1e-12, "{t}");
            assert!((spline.rate(t) - v(t)).abs() < 1e-12, "{t}");
        }
        assert!((spline.value(4.0) - (x(2.0) + 2.0 * v(2.0))).abs() < 1e-12);
        assert_eq!(spline.rate(-9.0), v(-1.0));
    }

    #[test]
    fn large_values_keep_their_precision() {
        // As of a satellite over 10 h.
        let small = |t: f64| 900.0 * (t / 5000.0).sin();
        let rate = |t: f64| 900.0 / 5000.0 * (t / 5000.0).cos();
        let knots = (0..360_000).map(|k| {
            let t = f64::from(k) * 0.1;
            (t, 4e7 + small(t), rate(t))
        });
        let spline = Spline::new(knots.collect()).unwrap();
        for k in 0..2000 {
            let t = f64::from(k) * 17.777 + 0.0123;
            assert!((spline.value(t) - 4e7 - small(t)).abs() < 2e-8, "{t}");
            assert!((spline.rate(t) - rate(t)).abs() < 5e-7, "{t}");
        }
    }

    #[test]
    fn bad_knots_are_refused() {
        assert!(Spline::new(vec![(0.0, 1.0, 0.0)]).is_err());
        assert!(Spline::new(vec![(0.0, 1.0, 0.0), (0.0, 1.0, 0.0)]).is_err());
        assert!(Spline::new(vec![(0.0, 1.0, 0.0), (1.0, f64::NAN, 0.0)]).is_err());
    }
}
