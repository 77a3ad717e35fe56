//! Finds where symbols and secondary codes start, from prompts of one code period each.

use super::watch::Step;
use crate::C64;

/// Decisions are taken at this many standard deviations.
const SIGMAS: f64 = 4.5;

/// Finds the phase of a short overlay of `overlay.len()` periods (NH20, or plain symbols given as
/// all ones) under unknown data, from the products of consecutive prompts.
///
/// The product over a symbol boundary is random and left out; every other product has the sign of
/// two consecutive overlay chips. Carrier phase and its slow errors do not matter.
#[derive(Debug, Clone)]
pub struct SymbolSync {
    overlay: Vec<i8>,
    sums: Vec<f64>,
    powers: Vec<f64>,
    previous: Option<C64>,
    count: usize,
}

impl SymbolSync {
    /// A search for an overlay that repeats with each symbol.
    pub fn new(overlay: Vec<i8>) -> Self {
        let n = overlay.len();
        SymbolSync {
            overlay,
            sums: vec![0.0; n],
            powers: vec![0.0; n],
            previous: None,
            count: 0,
        }
    }

    /// A search for the overlay of a signal, or for plain symbols of `periods` code periods where
    /// it has none.
    pub fn of(overlay: &[i8], periods: usize) -> Self {
        Self::new(match overlay {
            [] => vec![1; periods],
            chips => chips.to_vec(),
        })
    }

    /// Adds the prompt of the next period. Returns, once it is certain, the overlay index of the
    /// period *after* this one.
    pub fn add(&mut self, prompt: C64) -> Option<usize> {
        let n = self.overlay.len();
        self.push(prompt);
        (self.count.is_multiple_of(n) && self.count >= 3 * n)
            .then(|| self.decide())
            .flatten()
    }

    /// Adds the prompt of the period that is held for the one with overlay index `index`, and
    /// looks after each `symbols` whether it is. After a verdict all begins anew.
    pub(super) fn watch(&mut self, prompt: C64, index: usize, symbols: usize) -> Step {
        let n = self.overlay.len();
        self.push(prompt);
        if !self.count.is_multiple_of(symbols * n) {
            return Step::Open;
        }
        match self.decide() {
            None => Step::Open,
            Some(next) => {
                self.forget();
                if next == (index + 1) % n {
                    Step::In
                } else {
                    Step::Out
                }
            }
        }
    }

    fn push(&mut self, prompt: C64) {
        if let Some(previous) = self.previous {
            let product = (prompt * previous.conj()).re;
            let class = self.count % self.overlay.len();
            self.sums[class] += product;
            self.powers[class] += product * product;
        }
        self.previous = Some(prompt);
        self.count += 1;
    }

    pub(super) fn forget(&mut self) {
        self.sums.fill(0.0);
        self.powers.fill(0.0);
        (self.previous, self.count) = (None, 0);
    }

    /// Weight of the product in `class` if overlay index 0 falls on class `boundary`.
    fn weight(&self, boundary: usize, class: usize) -> f64 {
        let n = self.overlay.len();
        let index = (class + n - boundary) % n;
        if index == 0 {
            0.0
        } else {
            f64::from(self.overlay[index] * self.overlay[index - 1])
        }
    }

    fn decide(&self) -> Option<usize> {
        let n = self.overlay.len();
        let score = |b: usize| {
            (0..n)
                .map(|c| self.weight(b, c) * self.sums[c])
                .sum::<f64>()
        };
        let best = (0..n).max_by(|&a, &b| score(a).total_cmp(&score(b)))?;
        let certain = (0..n).filter(|&b| b != best).all(|b| {
            let variance: f64 = (0..n)
                .map(|c| (self.weight(best, c) - self.weight(b, c)).powi(2) * self.powers[c])
                .sum();
            score(best) - score(b) > SIGMAS * variance.sqrt()
        });
        certain.then(|| (self.count + n - best) % n)
    }
}

/// Finds the phase and sign of a long secondary code on a phase-locked pilot.
#[derive(Debug, Clone)]
pub struct SecondarySync {
    code: Vec<i8>,
    inphase: Vec<f64>,
}

/// A half-cycle slip spoils the search: it starts afresh after this many periods.
const SECONDARY_WINDOW: usize = 400;

impl SecondarySync {
    /// A search for the given secondary code.
    pub fn new(code: Vec<i8>) -> Self {
        SecondarySync {
            code,
            inphase: Vec::new(),
        }
    }

    /// Adds the (phase-locked) prompt of the next period. Returns, once it is certain, the index of
    /// the period *after* this one and whether the carrier is locked with reversed sign.
    pub fn add(&mut self, prompt: C64) -> Option<(usize, bool)> {
        if self.inphase.len() == SECONDARY_WINDOW {
            self.inphase.clear();
        }
        self.inphase.push(prompt.re);
        let count = self.inphase.len();
        (count >= 50 && count.is_multiple_of(10))
            .then(|| self.decide())
            .flatten()
    }

    fn decide(&self) -> Option<(usize, bool)> {
        let n = self.code.len();
        let score = |shift: usize| {
            let chips = self.code.iter().cycle().skip(shift);
            self.inphase
                .iter()
                .zip(chips)
                .map(|(y, &c)| y * f64::from(c))
                .sum::<f64>()
        };
        let (shift, best) = (0..n)
            .map(|s| (s, score(s)))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let power: f64 = self.inphase.iter().map(|y| y * y).sum();
        // 7 sigma: 3600 hypotheses at 1e-12 each; a perfect match of 50 periods reaches it.
        (best.abs() > 7.0 * power.sqrt()).then(|| ((shift + self.inphase.len()) % n, best < 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal;

    fn noise(seed: &mut u64) -> f64 {
        // Sum of uniform numbers: Gaussian enough for a prompt.
        (0..12)
            .map(|_| {
                *seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (*seed >> 11) as f64 / (1u64 << 53) as f64
            })
            .sum::<f64>()
            - 6.0
    }

    /// Prompts of `periods`, overlay starting at `first`, random data each overlay, SNR per period.
    fn prompts(overlay: &[i8], first: usize, periods: usize, snr: f64, seed: &mut u64) -> Vec<C64> {
        let mut data = 1.0;
        (0..periods)
            .map(|k| {
                let i = (k + first) % overlay.len();
                if i == 0 {
                    data = noise(seed).signum();
                }
                let a = (2.0 * snr).sqrt() * data * f64::from(overlay[i]);
                C64::new(a + noise(seed), noise(seed)) * C64::from_polar(1.0, 0.7)
            })
            .collect()
    }

    #[test]
    fn symbols_are_found_or_left_open_but_not_mistaken() {
        let nh = signal::find("B1I").unwrap().secondary(20).unwrap();
        let mut seed = 1;
        for (overlay, snr) in [
            (nh.clone(), 1.0),
            (nh, 30.0),
            (vec![1; 20], 10.0),
            (vec![1; 2], 10.0),
        ] {
            let mut found = 0;
            for first in 0..overlay.len() {
                let mut sync = SymbolSync::new(overlay.clone());
                for (k, p) in prompts(&overlay, first, 2500, snr, &mut seed)
                    .into_iter()
                    .enumerate()
                {
                    if let Some(index) = sync.add(p) {
                        assert_eq!(index, (k + 1 + first) % overlay.len());
                        found += 1;
                        break;
                    }
                }
            }
            assert_eq!(found, overlay.len(), "SNR {snr}");
        }
    }

    #[test]
    fn secondary_code_is_found_with_its_sign() {
        let code = signal::find("B1CP").unwrap().secondary(20).unwrap();
        let mut seed = 2;
        for first in [0, 1, 777, 1799] {
            let mut sync = SecondarySync::new(code.clone());
            let found = (0..200).find_map(|k| {
                let a = -4.0 * f64::from(code[(k + first) % code.len()]);
                sync.add(C64::new(a + noise(&mut seed), noise(&mut seed)))
                    .map(|f| (k, f))
            });
            let (k, (index, reversed)) = found.expect("found");
            assert_eq!(index, (k + 1 + first) % code.len());
            assert!(reversed);
        }
    }
}
