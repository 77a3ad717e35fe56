//! Amplitude and noise of soft binary symbols, from the symbols alone.

/// Amplitude of the symbols and standard deviation of the noise on them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Mean of a symbol of bit 0.
    pub amplitude: f32,
    /// Of each value.
    pub noise: f32,
}

/// Enough at any C/N0 at which the codes can be decoded.
const ITERATIONS: usize = 12;
/// Noise that is assumed at least, of the amplitude: lets hard decisions pass for soft values.
const NOISE_AT_LEAST: f32 = 0.1;

impl Level {
    /// Logarithm of the probability of bit 0 over that of bit 1 for each value; none where a value
    /// is not finite.
    pub fn likelihoods(&self, values: &[f32]) -> Vec<f32> {
        let scale = 2.0 * self.amplitude / (self.noise * self.noise);
        let likelihood = |v: &f32| if v.is_finite() { v * scale } else { 0.0 };
        values.iter().map(likelihood).collect()
    }
}

/// Maximum-likelihood amplitude and noise of symbols of unknown sign, by expectation maximisation
/// (Dempster, Laird and Rubin 1977) of two normal laws of opposite means. Zeros, which stand for
/// missing symbols, do not count.
pub fn estimate(values: &[f32]) -> Level {
    let counted: Vec<f64> = values
        .iter()
        .filter(|v| v.is_finite() && **v != 0.0)
        .map(|&v| f64::from(v))
        .collect();
    let count = counted.len().max(1) as f64;
    let power = counted.iter().map(|v| v * v).sum::<f64>() / count;
    if power <= 0.0 || !power.is_finite() {
        let (amplitude, noise) = (0.0, 1.0);
        return Level { amplitude, noise };
    }
    let floor = power * f64::from(NOISE_AT_LEAST * NOISE_AT_LEAST);
    let mut amplitude = (power / 2.0).sqrt();
    for _ in 0..ITERATIONS {
        let variance = (power - amplitude * amplitude).max(floor);
        let expected = |v: &f64| v * (amplitude / variance * v).tanh();
        amplitude = counted.iter().map(expected).sum::<f64>() / count;
    }
    Level {
        amplitude: amplitude as f32,
        noise: (power - amplitude * amplitude).max(floor).sqrt() as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fec::test_noise::Normal;

    #[test]
    fn finds_amplitude_and_noise() {
        let mut normal = Normal::new(5);
        for sigma in [0.3f32, 0.6, 0.8] {
            let values: Vec<f32> = (0..20_000)
                .map(|k| 0.7 * (if k % 3 == 0 { -1.0 } else { 1.0 } + sigma * normal.next()))
                .collect();
            let level = estimate(&values);
            assert!((level.amplitude / 0.7 - 1.0).abs() < 0.04, "{level:?}");
            assert!(
                (level.noise / (0.7 * sigma) - 1.0).abs() < 0.04,
                "{level:?}"
            );
        }
    }

    #[test]
    fn degenerate_values_give_finite_levels() {
        for values in [
            vec![],
            vec![0.0; 9],
            vec![f32::NAN; 4],
            vec![1.0, -1.0],
            vec![f32::MAX; 5],
        ] {
            let level = estimate(&values);
            assert!(
                level.amplitude.is_finite() && level.noise > 0.0,
                "{values:?}: {level:?}"
            );
        }
    }
}
