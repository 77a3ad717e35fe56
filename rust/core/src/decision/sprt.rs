//! Wald's sequential test with the mean estimated as it goes, and two readings of a published
//! compensation of it.
//!
//! With m_k and v_k the mean and variance of the first k samples, the log-likelihood ratio of a
//! shift by m_k that was there from the first sample is k m_k^2 / (2 v_k).

/// Where the variance of the samples comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variance {
    /// One: the samples are in standard deviations.
    Known,
    /// Of the samples so far about their mean, divided by their number.
    Sample,
    /// The published recursion, which leaves out the factors of the true one.
    Printed,
}

/// What is made of the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// As Wald has it.
    Classic,
    /// Adds ln(z^2 / (2 v `risk`)) of the *current* sample and never falls below zero.
    Floored {
        /// Of one more sample over that of a false alarm.
        risk: f64,
    },
    /// Adds ln(m^2 / (2 v `risk`)) with every sample, as printed.
    Printed {
        /// Of one more sample over that of a false alarm.
        risk: f64,
    },
}

/// A sequential test; nothing is tested within the first `guard` samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sprt {
    /// Which statistic.
    pub form: Form,
    /// Of the samples.
    pub variance: Variance,
    /// First samples that are not tested.
    pub guard: usize,
}

/// Mean and variance of the samples so far.
struct Moments {
    which: Variance,
    count: f64,
    mean: f64,
    spread: f64,
}

impl Moments {
    fn new(which: Variance) -> Self {
        Self {
            which,
            count: 0.0,
            mean: 0.0,
            spread: 0.0,
        }
    }

    fn add(&mut self, z: f64) {
        self.count += 1.0;
        let step = (z - self.mean) / self.count;
        self.mean += step;
        self.spread += match self.which {
            Variance::Known => 0.0,
            Variance::Sample => (self.count - 1.0) * self.count * step * step,
            Variance::Printed => (self.count - 1.0) / self.count * step * step,
        };
    }

    fn variance(&self) -> f64 {
        match self.which {
            Variance::Known => 1.0,
            Variance::Sample => self.spread / self.count,
            Variance::Printed => self.spread,
        }
    }
}

impl Sprt {
    /// The path of the statistic; zero where the variance of the samples is still zero.
    pub fn path(&self, samples: &[f64], path: &mut [f64]) {
        let mut moments = Moments::new(self.variance);
        let mut sum = 0.0_f64;
        for (k, (z, out)) in samples.iter().zip(path).enumerate() {
            moments.add(*z);
            let (mean, variance) = (moments.mean, moments.variance());
            *out = 0.0;
            // Samples that do not scatter at all tell nothing.
            if k < self.guard || variance <= 0.0 {
                continue;
            }
            let ratio = (z * mean - 0.5 * mean * mean) / variance;
            *out = match self.form {
                Form::Classic => 0.5 * moments.count * mean * mean / variance,
                Form::Floored { risk } => {
                    sum = (sum + ratio + (z * z / (2.0 * variance * risk)).ln()).max(0.0);
                    sum
                }
                Form::Printed { risk } => {
                    sum += ratio + (mean * mean / (2.0 * variance * risk)).ln();
                    sum
                }
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::{close, samples};
    use super::*;

    fn path_of(form: Form, variance: Variance, guard: usize, z: &[f64]) -> Vec<f64> {
        let mut path = vec![0.0; z.len()];
        Sprt {
            form,
            variance,
            guard,
        }
        .path(z, &mut path);
        path
    }

    fn slow(z: &[f64]) -> (f64, f64, f64) {
        let count = z.len() as f64;
        let mean = z.iter().sum::<f64>() / count;
        let variance = z.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
        (count, mean, variance)
    }

    #[test]
    fn classic_is_its_definition() {
        let z = samples(200);
        let wanted: Vec<f64> = (1..=z.len())
            .map(|k| {
                let (count, mean, variance) = slow(&z[..k]);
                if k == 1 {
                    0.0
                } else {
                    0.5 * count * mean * mean / variance
                }
            })
            .collect();
        close(&path_of(Form::Classic, Variance::Sample, 0, &z), &wanted);
    }

    #[test]
    fn the_printed_variance_is_its_definition() {
        let z = samples(50);
        let mut variance = 0.0;
        let mut wanted = vec![0.0];
        for k in 2..=z.len() {
            let (count, mean, _) = slow(&z[..k]);
            let (_, before, _) = slow(&z[..k - 1]);
            variance += (count - 1.0) / count * (before - mean).powi(2);
            wanted.push(0.5 * count * mean * mean / variance);
        }
        close(&path_of(Form::Classic, Variance::Printed, 0, &z), &wanted);
    }

    #[test]
    fn compensated_forms_are_their_definitions() {
        let z = samples(300);
        let (mut floored, mut printed) = (vec![], vec![]);
        let (mut up, mut down) = (0.0_f64, 0.0_f64);
        for k in 1..=z.len() {
            let (_, mean, _) = slow(&z[..k]);
            let f = z[k - 1];
            let ratio = 0.5 * (f * f - (f - mean).powi(2));
            if k > 10 {
                up = (up + ratio + (f * f).ln()).max(0.0);
            }
            down += ratio + (mean * mean).ln();
            floored.push(up);
            printed.push(down);
        }
        let risk = 0.5;
        close(
            &path_of(Form::Floored { risk }, Variance::Known, 10, &z),
            &floored,
        );
        close(
            &path_of(Form::Printed { risk }, Variance::Known, 0, &z),
            &printed,
        );
    }

    #[test]
    fn samples_that_do_not_scatter_tell_nothing() {
        let path = path_of(Form::Classic, Variance::Sample, 0, &[0.0; 20]);
        assert!(path.iter().all(|v| *v == 0.0));
    }
}
