//! Piecewise-linear functions of time, with their exact integral.

use crate::{Error, Result};

/// A piecewise-linear function of time; constant before the first and after the last knot.
///
/// Two knots at the same time make a step. Without knots it is zero everywhere.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Profile {
    knots: Vec<(f64, f64)>,
    /// Integral from the first knot to each knot.
    area: Vec<f64>,
}

impl Profile {
    /// A profile through `(time in s, value)` knots.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a number is not finite or times decrease.
    pub fn new(knots: Vec<(f64, f64)>) -> Result<Self> {
        if knots.iter().any(|&(t, v)| !t.is_finite() || !v.is_finite()) {
            return Err(Error::Invalid(
                "a profile knot is not a finite number".into(),
            ));
        }
        if knots.windows(2).any(|w| w[1].0 < w[0].0) {
            return Err(Error::Invalid("profile times must not decrease".into()));
        }
        let mut area = vec![0.0; knots.len()];
        for k in 1..knots.len() {
            let (t0, v0) = knots[k - 1];
            let (t1, v1) = knots[k];
            area[k] = area[k - 1] + 0.5 * (v0 + v1) * (t1 - t0);
        }
        Ok(Profile { knots, area })
    }

    /// Value at time `t` seconds.
    pub fn value(&self, t: f64) -> f64 {
        let k = self.knots.partition_point(|knot| knot.0 <= t);
        match (k.checked_sub(1).map(|j| self.knots[j]), self.knots.get(k)) {
            (Some((t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * ((t - t0) / (t1 - t0)),
            (Some((_, v)), None) | (None, Some(&(_, v))) => v,
            (None, None) => 0.0,
        }
    }

    /// Largest value at a knot; 0 without knots.
    pub fn max(&self) -> f64 {
        self.knots
            .iter()
            .map(|k| k.1)
            .reduce(f64::max)
            .unwrap_or(0.0)
    }

    /// Integral from time 0 to `t` seconds.
    pub fn integral(&self, t: f64) -> f64 {
        self.area_since_first_knot(t) - self.area_since_first_knot(0.0)
    }

    fn area_since_first_knot(&self, t: f64) -> f64 {
        let Some(&(first, value)) = self.knots.first() else {
            return 0.0;
        };
        let k = self.knots.partition_point(|knot| knot.0 <= t);
        match k.checked_sub(1) {
            None => value * (t - first),
            Some(j) => {
                let (t0, v0) = self.knots[j];
                self.area[j] + 0.5 * (v0 + self.value(t)) * (t - t0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_and_integral() {
        let p = Profile::new(vec![(1.0, 2.0), (3.0, 6.0), (3.0, 0.0), (4.0, 1.0)]).unwrap();
        assert_eq!(
            [0.0, 1.0, 2.0, 3.0, 3.5, 9.0].map(|t| p.value(t)),
            [2., 2., 4., 0., 0.5, 1.]
        );
        assert_eq!(p.integral(-1.0), -2.0);
        assert_eq!(p.integral(2.0), 2.0 + 3.0);
        assert_eq!(p.integral(5.0), 2.0 + 8.0 + 0.5 + 1.0);
        assert_eq!(Profile::default().integral(7.0), 0.0);
    }

    #[test]
    fn bad_knots_are_refused() {
        assert!(Profile::new(vec![(1.0, 0.0), (0.0, 0.0)]).is_err());
        assert!(Profile::new(vec![(f64::NAN, 0.0)]).is_err());
    }
}
