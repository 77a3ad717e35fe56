//! The published R statistics: sums over the last L deviations of GNSS from the INS.
//!
//! The publication's formulas are lost; three readings of them are formed. Each is divided by
//! what is largest without interference ("as printed": the square of the largest deviation;
//! "self-normalised": the largest value of the statistic itself).

use super::settings::Published;

/// Mean square, lag-1 product and coherent square of one deviation of up to three components.
pub type Forms = [f64; 3];

/// Deviations of one channel; a missing one restarts the sum.
#[derive(Debug, Clone)]
pub struct Sliding {
    length: usize,
    values: Vec<[f64; 3]>,
    next: usize,
    filled: usize,
}

impl Sliding {
    /// Over `length` epochs.
    pub fn new(length: usize) -> Self {
        Sliding {
            length,
            values: vec![[0.0; 3]; length],
            next: 0,
            filled: 0,
        }
    }

    /// Takes the next deviation; NaN until there are `length` in a row.
    pub fn push(&mut self, deviation: [f64; 3]) -> Forms {
        if deviation.iter().any(|d| !d.is_finite()) {
            self.filled = 0;
            return [f64::NAN; 3];
        }
        self.values[self.next] = deviation;
        self.next = (self.next + 1) % self.length;
        self.filled = (self.filled + 1).min(self.length);
        if self.filled < self.length {
            return [f64::NAN; 3];
        }
        self.forms()
    }

    fn forms(&self) -> Forms {
        let (mut square, mut lagged, mut sum) = (0.0, 0.0, [0.0; 3]);
        let mut before: Option<&[f64; 3]> = None;
        for k in 0..self.length {
            let value = &self.values[(self.next + k) % self.length];
            for axis in 0..3 {
                square += value[axis] * value[axis];
                lagged += before.map_or(0.0, |b| b[axis] * value[axis]);
                sum[axis] += value[axis];
            }
            before = Some(value);
        }
        let n = self.length as f64;
        let coherent = sum.iter().map(|s| (s / n) * (s / n)).sum();
        [square / n, lagged / (n - 1.0).max(1.0), coherent]
    }
}

/// Verdict of the publication.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Threat {
    /// No statistic over 1, or none formed yet.
    None = 0,
    /// Some over 1.
    Risk = 1,
    /// All over 1.
    Attack = 2,
}

/// All statistics of one epoch.
#[derive(Debug, Clone)]
pub struct Panel {
    settings: Published,
    position: Sliding,
    velocity: Sliding,
    ranges: Vec<Sliding>,
    rates: Vec<Sliding>,
    /// Of position and velocity.
    pub solution: [Forms; 2],
    /// Of each satellite's pseudorange.
    pub range: Vec<Forms>,
    /// Of each satellite's rate.
    pub rate: Vec<Forms>,
}

impl Panel {
    /// For `satellites` channels.
    pub fn new(settings: Published, satellites: usize) -> Self {
        let one = Sliding::new(settings.length);
        Panel {
            settings,
            position: one.clone(),
            velocity: one.clone(),
            ranges: vec![one.clone(); satellites],
            rates: vec![one; satellites],
            solution: [[f64::NAN; 3]; 2],
            range: vec![[f64::NAN; 3]; satellites],
            rate: vec![[f64::NAN; 3]; satellites],
        }
    }

    /// Takes the deviations of an epoch: of the fix, and of each satellite (NaN: none).
    pub fn push(&mut self, fix: [[f64; 3]; 2], range: &[f64], rate: &[f64]) {
        self.solution = [self.position.push(fix[0]), self.velocity.push(fix[1])];
        for (k, (range, rate)) in range.iter().zip(rate).enumerate() {
            self.range[k] = self.ranges[k].push([*range, 0.0, 0.0]);
            self.rate[k] = self.rates[k].push([*rate, 0.0, 0.0]);
        }
    }

    fn over(&self, kind: usize, forms: &Forms) -> Option<bool> {
        let value = forms[self.settings.form as usize];
        value
            .is_finite()
            .then(|| value > self.settings.divisors[kind])
    }

    /// Whether position or velocity is over 1.
    pub fn solution_over(&self) -> bool {
        (0..2).any(|k| self.over(k, &self.solution[k]) == Some(true))
    }

    /// Whether a satellite's pseudorange or rate is over 1.
    pub fn satellite_over(&self, k: usize) -> bool {
        self.over(2, &self.range[k]) == Some(true) || self.over(3, &self.rate[k]) == Some(true)
    }

    /// Verdict, and the share of the statistics that are over 1.
    pub fn verdict(&self) -> (Threat, f64) {
        let solution = (0..2).map(|k| self.over(k, &self.solution[k]));
        let ranges = self.range.iter().map(|f| self.over(2, f));
        let rates = self.rate.iter().map(|f| self.over(3, f));
        let (mut over, mut all) = (0, 0);
        for one in solution.chain(ranges).chain(rates).flatten() {
            all += 1;
            over += usize::from(one);
        }
        let threat = match over {
            0 => Threat::None,
            _ if over == all => Threat::Attack,
            _ => Threat::Risk,
        };
        (threat, over as f64 / f64::max(all as f64, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::tight::settings::Form;

    fn published(form: Form) -> Published {
        Published {
            length: 4,
            form,
            divisors: [1.0; 4],
        }
    }

    #[test]
    fn forms_of_a_constant_and_of_an_alternation() {
        let mut sliding = Sliding::new(4);
        for _ in 0..3 {
            assert!(sliding.push([2.0, 0.0, 1.0])[0].is_nan());
        }
        assert_eq!(sliding.push([2.0, 0.0, 1.0]), [5.0, 5.0, 5.0]);
        let mut sliding = Sliding::new(4);
        let mut last = [0.0; 3];
        for k in 0..4 {
            last = sliding.push([if k % 2 == 0 { 1.0 } else { -1.0 }, 0.0, 0.0]);
        }
        assert_eq!(last, [1.0, -1.0, 0.0]);
    }

    #[test]
    fn a_gap_restarts_the_sum() {
        let mut sliding = Sliding::new(2);
        sliding.push([1.0, 0.0, 0.0]);
        sliding.push([f64::NAN, 0.0, 0.0]);
        assert!(sliding.push([1.0, 0.0, 0.0])[0].is_nan());
        assert_eq!(sliding.push([1.0, 0.0, 0.0])[0], 1.0);
    }

    #[test]
    fn one_glitch_moves_the_mean_square_and_not_the_lagged_product() {
        let mut sliding = Sliding::new(10);
        let mut last = [0.0; 3];
        for k in 0..10 {
            last = sliding.push([if k == 5 { 12.0 } else { 0.0 }, 0.0, 0.0]);
        }
        assert!(last[0] > 14.0 && last[1] == 0.0);
    }

    #[test]
    fn verdict_in_three_words() {
        let mut panel = Panel::new(published(Form::MeanSquare), 2);
        let mut say = |p: f64, range: [f64; 2]| {
            for _ in 0..4 {
                panel.push([[p, 0.0, 0.0], [p, 0.0, 0.0]], &range, &range);
            }
            (
                panel.verdict(),
                panel.satellite_over(1),
                panel.solution_over(),
            )
        };
        assert_eq!(say(0.1, [0.1, 0.1]), ((Threat::None, 0.0), false, false));
        let (verdict, satellite, solution) = say(0.1, [0.1, 3.0]);
        assert_eq!(verdict.0, Threat::Risk);
        assert!(satellite && !solution);
        assert!((verdict.1 - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!(say(9.0, [9.0, 9.0]).0, (Threat::Attack, 1.0));
    }
}
