//! Likelihood of samples under a mixture of changes, against white normal samples: what importance
//! sampling divides by.

/// How the samples change at the onset.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture {
    /// Each equally likely, and so is each sign: the mean shifts by so much, and the standard
    /// deviation becomes so much.
    pub shifts: Vec<(f64, f64)>,
    /// One more change, as likely as all shifts together: the density of a sample gains the factor
    /// z^2.
    pub energy: bool,
    /// Whether the change is there from the first sample; else every onset is equally likely.
    pub from_start: bool,
}

impl Mixture {
    /// ln of the density of the samples up to each row under the mixture, over that without change.
    ///
    /// The sum over onsets is the Shiryaev-Roberts recursion R_k = (1 + R_(k-1)) L_k; onsets after
    /// row k leave the samples up to it as they are.
    pub fn log_ratio(&self, samples: &[f64], path: &mut [f64]) {
        let shifts = 2 * self.shifts.len();
        let energy = if self.energy { shifts.max(1) } else { 0 } as f64;
        let parts = shifts as f64 + energy;
        let onsets = if self.from_start {
            1.0
        } else {
            samples.len() as f64
        };
        path.fill(0.0);
        let both = |(d, s): &(f64, f64)| [(*d, *s), (-d, *s)];
        for (shift, scale) in self.shifts.iter().flat_map(both) {
            self.gather(samples, path, 1.0, |z| ratio(z, shift, scale));
        }
        if self.energy {
            self.gather(samples, path, energy, |z| z * z);
        }
        for (k, value) in path.iter_mut().enumerate() {
            let later = if self.from_start {
                0.0
            } else {
                onsets - (k + 1) as f64
            };
            *value = (*value / (parts * onsets) + later / onsets).ln();
        }
    }

    fn gather(&self, samples: &[f64], path: &mut [f64], weight: f64, of: impl Fn(f64) -> f64) {
        let born = if self.from_start { 0.0 } else { 1.0 };
        let mut sum = 1.0 - born;
        for (z, out) in samples.iter().zip(path) {
            sum = (born + sum) * of(*z);
            *out += weight * sum;
        }
    }
}

/// Density of a normal sample with that mean and standard deviation over that of a standard one.
fn ratio(z: f64, shift: f64, scale: f64) -> f64 {
    let other = (z - shift) / scale;
    (0.5 * (z * z - other * other)).exp() / scale
}

#[cfg(test)]
mod tests {
    use super::super::reference::{close, samples};
    use super::*;

    #[test]
    fn is_the_sum_over_onsets_and_changes() {
        let z = samples(30);
        for from_start in [false, true] {
            let mixture = Mixture {
                shifts: vec![(0.5, 1.0), (2.0, 0.5)],
                energy: true,
                from_start,
            };
            let factor = |part: usize, z: f64| match part {
                0..4 => {
                    let (d, s) = [(0.5, 1.0), (-0.5, 1.0), (2.0, 0.5), (-2.0, 0.5)][part];
                    let density = |z: f64, d: f64, s: f64| (-0.5 * ((z - d) / s).powi(2)).exp() / s;
                    density(z, d, s) / density(z, 0.0, 1.0)
                }
                _ => z * z,
            };
            let onsets = if from_start { 1 } else { z.len() };
            let wanted: Vec<f64> = (1..=z.len())
                .map(|k| {
                    let mut sum = 0.0;
                    for onset in 0..onsets {
                        for part in 0..8 {
                            sum += z[onset.min(k)..k]
                                .iter()
                                .map(|v| factor(part, *v))
                                .product::<f64>();
                        }
                    }
                    (sum / (8 * onsets) as f64).ln()
                })
                .collect();
            let mut path = vec![0.0; z.len()];
            mixture.log_ratio(&z, &mut path);
            close(&path, &wanted);
        }
    }
}
