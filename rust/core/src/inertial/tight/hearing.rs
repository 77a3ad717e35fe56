//! What satellites that are not believed say meanwhile: means of their deviations, and who agrees.

use super::covariance::Square;
use super::decide::{Agreement, Jury, Means};
use super::epoch::Deviations;
use super::settings::Settings;

/// Means that decide who is wrong, s.
const MEANS: f64 = 10.0;
/// Means of fewer epochs say nothing.
const LEAST: usize = 3;
/// All satellites agree only if there are so many.
const FEWEST: usize = 4;
/// A subset is looked for once satellites disagree with one another by this deviate.
const DISAGREE: f64 = 4.0;
/// Without the subset all others agree below this deviate: 99 %.
const REST: f64 = 2.33;
/// A single satellite agrees below so many standard deviations.
const AGREES: f64 = 2.8;
/// What the filter itself may be off, m and m/s.
const FILTER: [f64; 2] = [1.5, 0.02];

/// Means, and who judges them.
pub struct Hearing {
    means: Means,
    jury: Jury,
    heard: [Vec<f64>; 2],
}

impl Hearing {
    /// For epochs so many seconds apart.
    pub fn new(interval: f64, satellites: usize) -> Self {
        let epochs = ((MEANS / interval).round() as usize).max(1);
        Hearing {
            means: Means::new(epochs, satellites),
            jury: Jury::new(satellites),
            heard: std::array::from_fn(|_| vec![f64::NAN; satellites]),
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.means.clear();
    }

    /// Takes what all but `flagged` satellites deviate.
    pub fn push(&mut self, dev: &Deviations, flagged: impl Fn(usize) -> bool) {
        for k in 0..dev.range.len() {
            let said = [dev.range[k], dev.rate[k]];
            for (heard, value) in self.heard.iter_mut().zip(said) {
                heard[k] = if flagged(k) { f64::NAN } else { value };
            }
        }
        self.means.push(&self.heard[0], &self.heard[1]);
    }

    /// How well all agree with the coasting INS, whose covariance is given, and with one another;
    /// None of too few epochs or satellites.
    pub fn agreement(
        &mut self,
        dev: &Deviations,
        inertial: &Square,
        settings: &Settings,
    ) -> Option<Agreement> {
        if self.means.filled() < LEAST {
            return None;
        }
        let towards = |k: usize| dev.sight[k].towards;
        let noise = &settings.receiver;
        self.jury.summon(&self.means, towards, inertial, noise);
        Some(self.jury.agreement(0)).filter(|said| said.count >= FEWEST)
    }

    /// Without whom all others agree, if all, as just heard, do not.
    pub fn culprits(&self, said: &Agreement, most: usize) -> Option<u64> {
        match said.mutual > DISAGREE {
            true => self.jury.culprits(most, REST),
            false => None,
        }
    }

    /// Satellites whose means agree with the filter; its own errors are small then.
    pub fn agreeing(&self, settings: &Settings) -> u64 {
        if self.means.filled() < LEAST {
            return 0;
        }
        let noise = &settings.receiver;
        let mut mask = 0;
        for (k, (mean, count)) in self.means.mean.iter().enumerate() {
            let n = f64::max(*count as f64, 1.0);
            let code = noise.wander.hypot(noise.code / n.sqrt());
            let sigma = [
                code.hypot(FILTER[0]),
                (noise.rate / n.sqrt()).hypot(FILTER[1]),
            ];
            let agrees = (0..2).all(|i| mean[i].abs() < AGREES * sigma[i]);
            if agrees && 2 * count > self.means.filled() {
                mask |= 1 << k;
            }
        }
        mask
    }
}
