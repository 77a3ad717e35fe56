//! Which of the equally spaced ranges that fit a phase is the code's.
//!
//! The phase says where within a step the range lies, the code which step. The difference of the
//! two is averaged until its standard deviation, by the code's variance, is small against a step;
//! only then is there an answer. It is looked at on and on: a slip of the phase is followed once
//! the mean is clearly nearer to another step.

use super::quality::RunningMean;

/// The mean difference must have so many standard deviations to half a step.
const SIGMAS: f64 = 4.0;
/// Memory of the mean, s.
const MEMORY_S: f64 = 4.0;
/// The step is changed only once the mean is farther off than this, steps.
const MOVED: f64 = 0.75;

/// The ambiguity of a range.
#[derive(Debug, Clone)]
pub struct Ambiguity {
    /// Code minus phase.
    difference_m: RunningMean,
    variance_m2: RunningMean,
    offset_m: Option<f64>,
}

impl Default for Ambiguity {
    /// An open one.
    fn default() -> Self {
        let [difference_m, variance_m2] = std::array::from_fn(|_| RunningMean::new(MEMORY_S));
        Ambiguity {
            difference_m,
            variance_m2,
            offset_m: None,
        }
    }
}

impl Ambiguity {
    /// The range of a phase that repeats every `step_m`, from a measurement of the code with its
    /// variance; NaN while it is open.
    pub fn resolve(
        &mut self,
        phase_m: f64,
        step_m: f64,
        [code_m, variance_m2]: [f64; 2],
        interval_s: f64,
    ) -> f64 {
        self.difference_m.add(code_m - phase_m, interval_s);
        self.variance_m2.add(variance_m2, interval_s);
        let mean = self.difference_m.value();
        let far = |offset: f64| (mean - offset).abs() > MOVED * step_m;
        if self.offset_m.is_none_or(far) {
            let certain = SIGMAS * self.sigma_m(interval_s) < 0.5 * step_m;
            self.offset_m = certain.then(|| (mean / step_m).round() * step_m);
        }
        self.offset_m.map_or(f64::NAN, |offset| phase_m + offset)
    }

    /// Standard deviation of the mean difference.
    fn sigma_m(&self, interval_s: f64) -> f64 {
        let averaged = self.difference_m.elapsed_s().min(MEMORY_S) / interval_s;
        (self.variance_m2.value() / averaged).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_M: f64 = 10.0;

    fn resolved(a: &mut Ambiguity, phase_m: f64, code_m: f64, sigma_m: f64) -> f64 {
        a.resolve(phase_m, STEP_M, [code_m, sigma_m * sigma_m], 0.01)
    }

    #[test]
    fn it_is_open_until_the_code_is_good_enough() {
        let mut a = Ambiguity::default();
        // 4 sigma of the mean of n epochs fit into 5 m from n = 64 on.
        let first = (1..).find(|_| resolved(&mut a, 3.0, 124.0, 10.0).is_finite());
        assert!(matches!(first, Some(64..=65)), "{first:?}");
        assert_eq!(resolved(&mut a, 3.0, 124.0, 10.0), 123.0);
    }

    #[test]
    fn a_slip_is_followed_and_noise_is_not() {
        let mut a = Ambiguity::default();
        for n in 0..400 {
            let noise = if n % 2 == 0 { 9.0 } else { -9.0 };
            let range = resolved(&mut a, 3.0, 23.0 + noise, 1.0);
            assert!(n < 20 || range == 23.0, "{n}: {range}");
        }
        let back = (0..1000).position(|_| resolved(&mut a, 13.0, 23.0, 1.0) == 23.0);
        assert!(back.is_some_and(|epochs| epochs < 700), "{back:?}");
    }
}
