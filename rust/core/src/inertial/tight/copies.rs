//! Trusted copies: what the navigator would say had it used no GNSS since a certain time.
//!
//! A copy coasts on the same increments as the navigator, so the difference of both follows the
//! linear error model: it is carried by the transition and grows by what is taken off the
//! navigator. No second strapdown is needed. Without an attack its covariance is that of the copy
//! less that of the navigator (the difference is what the filter learnt from GNSS since then).

use nalgebra::{SMatrix, SVector};

use super::covariance::{Square, Transition, WORK_ROWS};
use super::windows::deviate;
use super::{CLOCK, DRIFT, NAV, POSITION, VELOCITY};

/// Youngest age of the tested copy of each pair, s; the oldest is twice that.
pub const SPANS: [f64; 4] = [15.0, 30.0, 60.0, 150.0];
/// A pair that may not be renewed gets no older than so many times its span.
const STALE: f64 = 4.0;

/// A copy, as its difference from the navigator.
#[derive(Debug, Clone)]
pub struct Copy {
    /// Navigator minus copy.
    pub difference: [f64; NAV],
    /// Of the copy's own errors.
    pub covariance: Square,
    /// When it parted from the navigator, s.
    pub born: f64,
}

/// Deviates of separation: horizontal position and velocity; clock and drift.
pub type Separation = [f64; 2];

impl Copy {
    /// Parts from the navigator now.
    pub fn new(covariance: &Square, time: f64) -> Self {
        Copy {
            difference: [0.0; NAV],
            covariance: *covariance,
            born: time,
        }
    }

    /// Moves on in time.
    pub fn predict(&mut self, step: &Transition, work: &mut [f64]) {
        step.carry(&mut self.difference);
        step.spread(self.covariance.as_flattened_mut(), NAV, work);
    }

    /// How unlikely its distance from the navigator is; `slack` times the navigator's covariance
    /// is allowed for besides.
    pub fn separation(&self, navigator: &Square, slack: f64) -> Separation {
        let level = |k: usize| [POSITION, POSITION + 1, VELOCITY, VELOCITY + 1][k];
        let clock = |k: usize| [CLOCK, DRIFT][k];
        [
            self.deviate_of::<4>(level, navigator, slack),
            self.deviate_of::<2>(clock, navigator, slack),
        ]
    }

    fn deviate_of<const N: usize>(
        &self,
        state: impl Fn(usize) -> usize,
        navigator: &Square,
        slack: f64,
    ) -> f64 {
        let spread = SMatrix::<f64, N, N>::from_fn(|r, c| {
            let (r, c) = (state(r), state(c));
            self.covariance[r][c] - (1.0 - slack) * navigator[r][c]
        });
        let d = SVector::<f64, N>::from_fn(|k, _| self.difference[state(k)]);
        // Not positive: copy and navigator have not parted yet.
        let Some(root) = spread.cholesky() else {
            return 0.0;
        };
        deviate(d.dot(&root.solve(&d)), N)
    }
}

/// Two copies a span; they are renewed in turn.
#[derive(Debug, Clone)]
pub struct Copies {
    pairs: [[Copy; 2]; SPANS.len()],
    work: Vec<f64>,
}

impl Copies {
    /// All new.
    pub fn new(covariance: &Square, time: f64) -> Self {
        let one = Copy::new(covariance, time);
        Copies {
            pairs: std::array::from_fn(|_| [one.clone(), one.clone()]),
            work: vec![0.0; WORK_ROWS * NAV],
        }
    }

    /// All new, in place.
    pub fn renew_all(&mut self, covariance: &Square, time: f64) {
        for copy in self.pairs.iter_mut().flatten() {
            *copy = Copy::new(covariance, time);
        }
    }

    /// Moves on in time.
    pub fn predict(&mut self, step: &Transition) {
        for copy in self.pairs.iter_mut().flatten() {
            copy.predict(step, &mut self.work);
        }
    }

    /// The navigator has taken these errors off.
    pub fn corrected(&mut self, errors: &[f64; NAV]) {
        for copy in self.pairs.iter_mut().flatten() {
            for (d, e) in copy.difference.iter_mut().zip(errors) {
                *d -= e;
            }
        }
    }

    /// Renews the older copy of each pair whose younger one has reached the span; `hold`: none,
    /// as long as they are not stale.
    pub fn renew(&mut self, covariance: &Square, time: f64, hold: bool) {
        for (pair, span) in self.pairs.iter_mut().zip(SPANS) {
            let old = usize::from(pair[1].born < pair[0].born);
            let young = &pair[1 - old];
            let due = time - young.born >= span;
            if due && (!hold || time - young.born >= (STALE - 1.0) * span) {
                pair[old] = Copy::new(covariance, time);
            }
        }
    }

    /// The older copy of a span.
    pub fn older(&self, span: usize) -> &Copy {
        let pair = &self.pairs[span];
        &pair[usize::from(pair[1].born < pair[0].born)]
    }

    /// The youngest of the older copies that is at least so old; the oldest if none is.
    pub fn at_least(&self, age: f64, time: f64) -> &Copy {
        let old = (0..SPANS.len()).map(|k| self.older(k));
        let enough = old
            .clone()
            .filter(|c| time - c.born >= age)
            .max_by(|a, b| a.born.total_cmp(&b.born));
        let oldest = old.min_by(|a, b| a.born.total_cmp(&b.born));
        enough.or(oldest).expect("there are spans")
    }

    /// The navigator has gone back to `chosen`: copies that parted later are no longer trusted and
    /// become that one.
    pub fn taken_back(&mut self, chosen: &Copy) {
        for copy in self.pairs.iter_mut().flatten() {
            if copy.born > chosen.born {
                *copy = chosen.clone();
            }
            for (d, c) in copy.difference.iter_mut().zip(&chosen.difference) {
                *d -= c;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::tight::covariance::{at_rest, zeros};

    fn unit(scale: f64) -> Square {
        let mut square = zeros();
        for (k, row) in square.iter_mut().enumerate() {
            row[k] = scale;
        }
        square
    }

    fn step() -> Transition {
        let mut phi = at_rest(1.0);
        for k in 0..3 {
            phi[k][k + 3] = 1.0;
        }
        Transition {
            phi,
            noise: unit(0.01),
            interval: 1.0,
        }
    }

    #[test]
    fn ages_stay_between_span_and_twice_the_span() {
        let mut copies = Copies::new(&unit(1.0), 0.0);
        for second in 1..2000 {
            let time = f64::from(second);
            copies.renew(&unit(1.0), time, false);
            for (k, span) in SPANS.into_iter().enumerate() {
                let age = time - copies.older(k).born;
                assert!(time < 2.0 * span || (age >= span && age <= 2.0 * span));
            }
        }
        assert!(2000.0 - copies.at_least(100.0, 2000.0).born >= 100.0);
        assert!(2000.0 - copies.at_least(1e9, 2000.0).born >= 150.0);
    }

    #[test]
    fn held_copies_go_stale_in_the_end() {
        let mut copies = Copies::new(&unit(1.0), 0.0);
        let mut oldest: f64 = 0.0;
        for second in 1..2000 {
            let time = f64::from(second);
            copies.renew(&unit(1.0), time, true);
            oldest = oldest.max(time - copies.older(0).born);
        }
        assert!(oldest > 2.0 * SPANS[0] && oldest <= 2.0 * STALE * SPANS[0]);
    }

    #[test]
    fn corrections_of_the_navigator_separate_it() {
        let mut copies = Copies::new(&unit(1.0), 0.0);
        let mut errors = [0.0; NAV];
        errors[0] = -0.5;
        for _ in 0..20 {
            copies.predict(&step());
            copies.corrected(&errors);
        }
        let copy = copies.older(0).clone();
        assert!((copy.difference[0] - 10.0).abs() < 1e-12);
        let near = copy.separation(&unit(1e-3), 0.0);
        assert!(near[0] < 3.0 && near[1] < 0.0, "{near:?}");
        copies.corrected(&[-100.0; NAV]);
        assert!(copies.older(0).separation(&unit(1e-3), 0.0)[0] > 8.0);
    }

    #[test]
    fn going_back_makes_the_chosen_copy_the_navigator() {
        let mut copies = Copies::new(&unit(1.0), 0.0);
        copies.renew(&unit(1.0), 20.0, false);
        copies.corrected(&[1.0; NAV]);
        let chosen = copies.at_least(1.0, 30.0).clone();
        copies.taken_back(&chosen);
        assert!(copies.older(0).difference.iter().all(|d| *d == 0.0));
        assert!(copies.older(0).born <= chosen.born);
    }
}
