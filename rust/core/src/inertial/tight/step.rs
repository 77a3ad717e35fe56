//! Steps of the fix against the INS: how an attack ends that has led the fix away.
//!
//! Over a few seconds the INS is as good as perfect, whatever it has drifted: position may change
//! only as the velocity of the fix says.

use super::settings::ReceiverNoise;

/// Epochs before and after, s.
const HALF: f64 = 5.0;

/// Fixes minus INS of the last epochs.
#[derive(Debug, Clone)]
pub struct Steps {
    half: usize,
    ring: Vec<[[f64; 4]; 2]>,
    count: usize,
    /// Variances of a fix's mean change for a dilution of 1: position, velocity.
    unit: [f64; 2],
    seconds: f64,
}

impl Steps {
    /// For epochs so many seconds apart.
    pub fn new(interval: f64, noise: &ReceiverNoise) -> Self {
        let half = ((HALF / interval).round() as usize).max(2);
        let (n, seconds) = (half as f64, half as f64 * interval);
        let wander = 2.0 * noise.wander * noise.wander * seconds / noise.wander_time;
        let code = 2.0 * noise.code * noise.code / n + wander + noise.clock * seconds;
        let rate = 2.0 * noise.rate * noise.rate / n + noise.drift * seconds;
        Steps {
            half,
            ring: vec![[[f64::NAN; 4]; 2]; 2 * half],
            count: 0,
            unit: [code + seconds * seconds * rate / 4.0, rate],
            seconds,
        }
    }

    /// Takes position and clock, velocity and drift of a fix minus those of the INS, and the sums
    /// of the squared dilutions of both; gives the size of the step in standard deviations (0: not known).
    pub fn push(&mut self, fix: [[f64; 4]; 2], dilution: [f64; 2]) -> f64 {
        let slot = self.count % self.ring.len();
        self.ring[slot] = fix;
        self.count += 1;
        if self.count < self.ring.len() {
            return 0.0;
        }
        let n = self.half as f64;
        let mut square = 0.0;
        for axis in 0..4 {
            let mean = |first: usize, kind: usize| {
                let rows = (first..first + self.half).map(|k| (self.count + k) % self.ring.len());
                rows.map(|k| self.ring[k][kind][axis]).sum::<f64>() / n
            };
            let (before, after) = (mean(0, 0), mean(self.half, 0));
            let (slow, fast) = (mean(0, 1), mean(self.half, 1));
            let moved = after - before - 0.5 * (slow + fast) * self.seconds;
            square += moved * moved / (self.unit[0] * dilution[0]);
            square += (fast - slow) * (fast - slow) / (self.unit[1] * dilution[1]);
        }
        // All axes share the dilutions' sum.
        if square.is_finite() {
            square.sqrt()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: ReceiverNoise = ReceiverNoise {
        code: 1.0,
        wander: 1.5,
        wander_time: 200.0,
        rate: 0.05,
        change: 0.0,
        reference_cn0: 0.0,
        clock: 0.0,
        drift: 0.0,
    };

    fn largest(path: impl Fn(f64) -> (f64, f64)) -> f64 {
        let mut steps = Steps::new(1.0, &NOISE);
        let sizes = (0..40).map(|k| {
            let (p, v) = path(f64::from(k));
            steps.push([[p, 0.0, 0.0, 0.0], [v, 0.0, 0.0, 0.0]], [4.0, 4.0])
        });
        sizes.fold(0.0, f64::max)
    }

    #[test]
    fn drags_are_no_steps_and_their_ends_are() {
        assert!(largest(|t| (2.0 * t, 2.0)) < 1e-6);
        assert!(largest(|t| (0.01 * t * t, 0.02 * t)) < 3.0);
        let ends = |t: f64| {
            if t < 20.0 {
                (0.2 * (t + 300.0), 0.2)
            } else {
                (0.0, 0.0)
            }
        };
        assert!(largest(ends) > 20.0);
        assert_eq!(largest(|_| (f64::NAN, 0.0)), 0.0);
    }
}
