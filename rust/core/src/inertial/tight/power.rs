//! Power monitor: overpowered signals that take the loops at once raise C/N0 of many satellites.

/// C/N0 against its own past; all in dB-Hz.
#[derive(Debug, Clone)]
pub struct Power {
    /// Slow mean of each satellite, NaN before the first.
    past: Vec<f64>,
    /// Fast mean.
    present: Vec<f64>,
    rises: Vec<f64>,
}

/// Time constants of the means, s.
const PAST: f64 = 60.0;
const PRESENT: f64 = 2.0;
/// A satellite's rise counts only if so many rise.
const TOGETHER: usize = 3;

impl Power {
    /// For `satellites` channels.
    pub fn new(satellites: usize) -> Self {
        Power {
            past: vec![f64::NAN; satellites],
            present: vec![f64::NAN; satellites],
            rises: Vec::with_capacity(satellites),
        }
    }

    /// Forgets what was before.
    pub fn rebase(&mut self) {
        self.past.fill(f64::NAN);
    }

    /// Takes an epoch's C/N0 of the satellites in use (NaN: none), `interval` s after the one
    /// before; gives the third largest rise in dB.
    pub fn push(&mut self, cn0: &[f64], interval: f64) -> f64 {
        self.rises.clear();
        let share = |time: f64| 1.0 - (-interval / time).exp();
        for (k, &now) in cn0.iter().enumerate() {
            if !now.is_finite() {
                continue;
            }
            if self.past[k].is_nan() {
                (self.past[k], self.present[k]) = (now, now);
            }
            self.present[k] += share(PRESENT) * (now - self.present[k]);
            self.rises.push(self.present[k] - self.past[k]);
            self.past[k] += share(PAST) * (now - self.past[k]);
        }
        self.rises.sort_unstable_by(|a, b| b.total_cmp(a));
        self.rises.get(TOGETHER - 1).copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quiet(satellites: usize) -> Power {
        let mut power = Power::new(satellites);
        for _ in 0..200 {
            power.push(&vec![45.0; satellites], 1.0);
        }
        power
    }

    #[test]
    fn ten_decibels_on_three_are_seen_within_seconds() {
        let mut power = quiet(5);
        let rise: Vec<f64> = (0..4)
            .map(|_| power.push(&[55.0, 55.0, 55.0, 45.0, 45.0], 1.0))
            .collect();
        assert!(rise[0] > 3.0 && rise[3] > 7.5);
        power.rebase();
        assert_eq!(power.push(&[55.0; 5], 1.0), 0.0);
    }

    #[test]
    fn two_that_come_out_of_a_shadow_are_not() {
        let mut power = quiet(5);
        for _ in 0..10 {
            assert!(power.push(&[55.0, 55.0, 45.0, f64::NAN, 45.0], 1.0) < 0.1);
        }
    }
}
