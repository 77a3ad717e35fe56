//! One code loop for two sidebands that are tracked as one signal.
//!
//! Both discriminators, in seconds, are weighted by the inverse of their variances: their mean
//! steers both replicas alike. What lies between the two codes (ionosphere, group delays, and an
//! attack on one of them) is a state of its own, followed by a slow loop that leaves the weighted
//! mean where it is: it keeps both discriminators near zero, where they are straight, so that
//! replica plus discriminator measures each code without bias.

use super::loop_filter::LoopFilter;

/// The joint code loop.
#[derive(Debug, Clone)]
pub struct JointCode {
    mean: LoopFilter,
    bias: LoopFilter,
}

/// Weights of two values: the inverses of their variances, sum 1.
pub fn weights(variances: [f64; 2]) -> [f64; 2] {
    let sum = variances[0] + variances[1];
    [variances[1] / sum, variances[0] / sum]
}

impl JointCode {
    /// A loop of the given bandwidths, for the mean and for the difference of the codes.
    pub fn new(bandwidths_hz: [f64; 2], interval_s: f64) -> Self {
        let [mean, bias] = bandwidths_hz.map(|b| LoopFilter::new(1, b, interval_s));
        JointCode { mean, bias }
    }

    /// Takes the discriminators (lower, upper) of one epoch, received minus replica code phase in
    /// seconds, and their variances. Gives the corrections of the replicas' rates, seconds per
    /// second.
    pub fn update(&mut self, errors_s: [f64; 2], variances: [f64; 2]) -> [f64; 2] {
        let weights = weights(variances);
        let error = weights[0] * errors_s[0] + weights[1] * errors_s[1];
        let mean = self.mean.update(error);
        let bias = self.bias.update(errors_s[1] - errors_s[0]);
        [mean - weights[1] * bias, mean + weights[0] * bias]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INTERVAL_S: f64 = 0.01;
    const VARIANCES: [f64; 2] = [9.0, 1.0];

    /// Errors left after so many epochs of a loop that begins with the given ones.
    fn left(mut errors: [f64; 2], epochs: usize) -> [f64; 2] {
        let mut code = JointCode::new([1.0, 0.1], INTERVAL_S);
        for _ in 0..epochs {
            let rates = code.update(errors, VARIANCES);
            for i in 0..2 {
                errors[i] -= rates[i] * INTERVAL_S;
            }
        }
        errors
    }

    #[test]
    fn the_less_noisy_code_has_more_weight() {
        let [lower, upper] = weights(VARIANCES);
        assert!((lower - 0.1).abs() < 1e-12 && (upper - 0.9).abs() < 1e-12);
    }

    #[test]
    fn what_is_common_goes_fast_and_the_difference_slowly() {
        let [lower, upper] = left([1.0, 1.0], 100);
        assert!(lower.abs() < 0.02 && (lower - upper).abs() < 1e-12);
        let [lower, upper] = left([-0.9, 0.1], 100);
        assert!((0.1 * lower + 0.9 * upper).abs() < 1e-12, "{lower} {upper}");
        assert!((0.6..0.7).contains(&(upper - lower)), "{lower} {upper}");
        for error in left([-0.9, 0.1], 3000) {
            assert!(error.abs() < 1e-4, "{error}");
        }
    }
}
