//! Which satellites agree with the INS and with one another, from means of their deviations.
//!
//! The INS coasts meanwhile. Its errors of position, velocity and clock (8 states) have the
//! filter's covariance; a satellite adds a mean pseudorange and a mean rate. The weighted square
//! sum of the best fit follows chi-square with two degrees of freedom a satellite if all agree; its
//! part that needs no INS is that of RAIM.

use nalgebra::{SMatrix, SVector, Vector3};

use super::covariance::Square;
use super::settings::ReceiverNoise;
use super::windows::deviate;
use super::{CLOCK, DRIFT, POSITION, VELOCITY};

/// Position, velocity, clock, drift.
const STATES: usize = 8;
type Normal = SMatrix<f64, STATES, STATES>;
type Sums = SVector<f64, STATES>;

/// Means over the last epochs of what satellites deviate from the INS.
#[derive(Debug, Clone)]
pub struct Means {
    depth: usize,
    satellites: usize,
    ring: Vec<[f64; 2]>,
    count: usize,
    /// Mean deviation of pseudorange and rate, and number, of each satellite.
    pub mean: Vec<([f64; 2], usize)>,
}

impl Means {
    /// Over `depth` epochs.
    pub fn new(depth: usize, satellites: usize) -> Self {
        Means {
            depth,
            satellites,
            ring: vec![[f64::NAN; 2]; depth * satellites],
            count: 0,
            mean: vec![([0.0; 2], 0); satellites],
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.ring.fill([f64::NAN; 2]);
        self.count = 0;
        self.mean.fill(([0.0; 2], 0));
    }

    /// Epochs since the beginning, at most the depth.
    pub fn filled(&self) -> usize {
        self.count.min(self.depth)
    }

    /// Takes an epoch's deviations, NaN where there is none.
    pub fn push(&mut self, range: &[f64], rate: &[f64]) {
        let row = self.count % self.depth * self.satellites;
        for k in 0..self.satellites {
            self.ring[row + k] = [range[k], rate[k]];
        }
        self.count += 1;
        for k in 0..self.satellites {
            let (mut sum, mut count) = ([0.0; 2], 0);
            for epoch in 0..self.depth {
                let value = self.ring[epoch * self.satellites + k];
                if value[0].is_finite() && value[1].is_finite() {
                    sum = [sum[0] + value[0], sum[1] + value[1]];
                    count += 1;
                }
            }
            let n = f64::max(count as f64, 1.0);
            self.mean[k] = ([sum[0] / n, sum[1] / n], count);
        }
    }
}

/// What one satellite adds to the normal equations.
#[derive(Debug, Clone, Copy)]
struct Part {
    satellite: usize,
    normal: Normal,
    sums: Sums,
    square: f64,
}

/// How well a set of satellites agrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// With one another and with the INS, as a normal deviate.
    pub all: f64,
    /// With one another.
    pub mutual: f64,
    /// Of their common solution with the INS.
    pub inertial: f64,
    /// The same where the clock may be anything.
    pub position: f64,
    /// Satellites that were asked.
    pub count: usize,
}

/// Chi-square of a set of satellites.
pub struct Jury {
    parts: Vec<Part>,
    prior: Normal,
    prior_without_clock: Normal,
}

impl Jury {
    /// Room for so many satellites.
    pub fn new(satellites: usize) -> Self {
        Jury {
            parts: Vec::with_capacity(satellites),
            prior: Normal::zeros(),
            prior_without_clock: Normal::zeros(),
        }
    }

    /// Takes the means of those satellites that have enough of them.
    pub fn summon(
        &mut self,
        means: &Means,
        towards: impl Fn(usize) -> Vector3<f64>,
        covariance: &Square,
        noise: &ReceiverNoise,
    ) {
        let state = |k: usize| match k {
            0..3 => POSITION + k,
            3..6 => VELOCITY + k - 3,
            6 => CLOCK,
            _ => DRIFT,
        };
        let p = Normal::from_fn(|r, c| covariance[state(r)][state(c)]);
        let inverse = |p: Normal| p.try_inverse().unwrap_or_else(Normal::zeros);
        self.prior = inverse(p);
        let mut loose = p;
        loose[(6, 6)] += 1e10;
        loose[(7, 7)] += 1e6;
        self.prior_without_clock = inverse(loose);
        self.parts.clear();
        for (satellite, (mean, count)) in means.mean.iter().enumerate() {
            if 2 * count > means.filled() {
                let part = part(satellite, &towards(satellite), mean, *count, noise);
                self.parts.push(part);
            }
        }
    }

    /// Satellites that were summoned.
    pub fn satellites(&self) -> impl Iterator<Item = usize> + '_ {
        self.parts.iter().map(|p| p.satellite)
    }

    fn total(&self, without: u64) -> (Part, usize) {
        let none = Part {
            satellite: 0,
            normal: Normal::zeros(),
            sums: Sums::zeros(),
            square: 0.0,
        };
        let mut count = 0;
        let kept = self
            .parts
            .iter()
            .filter(|p| without >> p.satellite & 1 == 0);
        let total = kept.fold(none, |a, b| {
            count += 1;
            Part {
                satellite: 0,
                normal: a.normal + b.normal,
                sums: a.sums + b.sums,
                square: a.square + b.square,
            }
        });
        (total, count)
    }

    /// Square sum of all but `without` with the INS.
    fn square(&self, without: u64) -> (f64, usize) {
        let (total, count) = self.total(without);
        (best(&total, &self.prior), count)
    }

    /// How well all but `without` agree.
    pub fn agreement(&self, without: u64) -> Agreement {
        let (total, count) = self.total(without);
        let all = best(&total, &self.prior);
        let loose = best(&total, &self.prior_without_clock);
        // A trace of the prior keeps it invertible where there are few satellites.
        let mutual = best(&total, &(self.prior * 1e-9));
        let freedom = (2 * count).saturating_sub(STATES);
        Agreement {
            all: deviate(all, 2 * count),
            mutual: deviate(mutual, freedom),
            inertial: deviate((all - mutual).max(0.0), STATES.min(2 * count)),
            position: deviate((loose - mutual).max(0.0), (STATES - 2).min(2 * count)),
            count,
        }
    }

    /// The smallest set of up to `most` satellites without which all others agree (their deviate
    /// is below `limit`), if no other set of that size comes close.
    pub fn culprits(&self, most: usize, limit: f64) -> Option<u64> {
        for size in 1..=most.min(self.parts.len().saturating_sub(4)) {
            let (mut first, mut second) = ((f64::INFINITY, 0), f64::INFINITY);
            self.subsets(size, 0, 0, &mut |mask| {
                let (square, count) = self.square(mask);
                let value = deviate(square, 2 * count);
                if value < first.0 {
                    (second, first) = (first.0, (value, mask));
                } else {
                    second = second.min(value);
                }
            });
            if first.0 < limit {
                return (second > first.0 + CLEARLY).then_some(first.1);
            }
        }
        None
    }

    fn subsets(&self, size: usize, from: usize, mask: u64, judge: &mut impl FnMut(u64)) {
        if size == 0 {
            judge(mask);
            return;
        }
        for k in from..self.parts.len() {
            let with = mask | 1 << self.parts[k].satellite;
            self.subsets(size - 1, k + 1, with, judge);
        }
    }
}

/// So much worse, in standard deviations, the next best set of the same size must be.
const CLEARLY: f64 = 1.5;

fn part(
    satellite: usize,
    towards: &Vector3<f64>,
    mean: &[f64; 2],
    count: usize,
    noise: &ReceiverNoise,
) -> Part {
    let n = count as f64;
    let range = noise.wander * noise.wander + noise.code * noise.code / n;
    let rate = noise.rate * noise.rate / n;
    let row = |position: f64, velocity: f64, clock: f64, drift: f64| {
        let u = -towards;
        Sums::from([
            position * u.x,
            position * u.y,
            position * u.z,
            velocity * u.x,
            velocity * u.y,
            velocity * u.z,
            clock,
            drift,
        ])
    };
    let (a, b) = (row(1.0, 0.0, 1.0, 0.0), row(0.0, 1.0, 0.0, 1.0));
    Part {
        satellite,
        normal: a * a.transpose() / range + b * b.transpose() / rate,
        sums: a * (mean[0] / range) + b * (mean[1] / rate),
        square: mean[0] * mean[0] / range + mean[1] * mean[1] / rate,
    }
}

fn best(total: &Part, prior: &Normal) -> f64 {
    match (total.normal + prior).cholesky() {
        Some(root) => total.square - total.sums.dot(&root.solve(&total.sums)),
        None => total.square,
    }
}

#[cfg(test)]
mod tests;
