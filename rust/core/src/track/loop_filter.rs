//! Loop filters whose discrete noise bandwidth is exactly the one asked for.
//!
//! The usual design maps an analogue loop to samples and misses its bandwidth by tens of percent
//! at B T = 0.1. Here the natural frequency is solved for, on the loop as it runs: the
//! discriminator sees the mean error over an interval, the oscillator holds its rate over the next.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// A loop filter of order 1 to 3: mean error over an interval in, oscillator rate out.
#[derive(Debug, Clone)]
pub struct LoopFilter {
    /// Proportional, integral, double-integral gain.
    gains: [f64; 3],
    interval_s: f64,
    /// Rate (first integrator), units per second.
    pub rate: f64,
    /// Acceleration (second integrator), units per second squared.
    pub acceleration: f64,
}

/// Gains at natural frequency w: Butterworth poles, so that an attack's transient does not ring.
fn gains(order: usize, w: f64) -> [f64; 3] {
    match order {
        1 => [w, 0.0, 0.0],
        2 => [std::f64::consts::SQRT_2 * w, w * w, 0.0],
        _ => [2.0 * w, 2.0 * w * w, w * w * w],
    }
}

impl LoopFilter {
    /// A filter of the given order whose closed loop has single-sided noise bandwidth
    /// `bandwidth_hz` at updates every `interval_s`. `bandwidth_hz * interval_s` must not exceed
    /// 0.25.
    pub fn new(order: usize, bandwidth_hz: f64, interval_s: f64) -> Self {
        LoopFilter {
            gains: gains(order, natural_frequency(order, bandwidth_hz, interval_s)),
            interval_s,
            rate: 0.0,
            acceleration: 0.0,
        }
    }

    /// The same with initial rate and acceleration.
    pub fn starting(mut self, rate: f64, acceleration: f64) -> Self {
        self.rate = rate;
        self.acceleration = acceleration;
        self
    }

    /// Takes the mean error over the last interval; returns the rate for the next.
    pub fn update(&mut self, error: f64) -> f64 {
        self.acceleration += self.gains[2] * self.interval_s * error;
        self.rate += self.interval_s * (self.gains[1] * error + self.acceleration);
        self.rate + self.gains[0] * error
    }
}

/// Natural frequency of the loop with the given noise bandwidth. Found once for each design: a
/// receiver's channels change between a handful of them all the time.
fn natural_frequency(order: usize, bandwidth_hz: f64, interval_s: f64) -> f64 {
    static KNOWN: Mutex<BTreeMap<(usize, u64, u64), f64>> = Mutex::new(BTreeMap::new());
    let design = (order, bandwidth_hz.to_bits(), interval_s.to_bits());
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = known().get(&design).copied();
    found.unwrap_or_else(|| {
        let frequency = solve_natural_frequency(order, bandwidth_hz, interval_s);
        known().insert(design, frequency);
        frequency
    })
}

fn solve_natural_frequency(order: usize, bandwidth_hz: f64, interval_s: f64) -> f64 {
    let (mut low, mut high) = (0.1 * bandwidth_hz, 8.0 * bandwidth_hz);
    for _ in 0..50 {
        let w = (low * high).sqrt();
        if noise_bandwidth_hz(gains(order, w), interval_s) < bandwidth_hz {
            low = w;
        } else {
            high = w;
        }
    }
    (low * high).sqrt()
}

/// Single-sided noise bandwidth of the closed loop, from its impulse response:
/// B = sum h^2 / (2 T). Infinite where the loop is unstable.
fn noise_bandwidth_hz(gains: [f64; 3], interval_s: f64) -> f64 {
    let mut filter = LoopFilter {
        gains,
        interval_s,
        rate: 0.0,
        acceleration: 0.0,
    };
    let (mut phase, mut rate, mut energy) = (0.0, 0.0, 0.0);
    let mut quiet = 0;
    for n in 0..100_000 {
        let mean: f64 = phase + 0.5 * rate * interval_s;
        energy += mean * mean;
        if energy > 1e6 {
            return f64::INFINITY;
        }
        quiet = if mean.abs() < 1e-9 && n > 0 {
            quiet + 1
        } else {
            0
        };
        if quiet > 20 {
            break;
        }
        phase += rate * interval_s;
        rate = filter.update(f64::from(u8::from(n == 0)) - mean);
    }
    energy / (2.0 * interval_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bandwidth_is_the_one_asked_for() {
        for order in 1..=3 {
            for (b, t) in [
                (1.0, 0.01),
                (10.0, 0.01),
                (20.0, 0.001),
                (10.0, 0.02),
                (25.0, 0.01),
            ] {
                let f = LoopFilter::new(order, b, t);
                let got = noise_bandwidth_hz(f.gains, t);
                assert!(
                    (got / b - 1.0).abs() < 1e-6,
                    "order {order}, {b} Hz, {t} s: {got}"
                );
            }
        }
    }

    #[test]
    fn third_order_follows_a_doppler_rate_without_error() {
        let (t, slope) = (0.01, 50.0);
        let mut filter = LoopFilter::new(3, 10.0, t);
        let (mut phase, mut rate, mut error) = (0.0, 0.0, 0.0);
        for n in 0..400 {
            let (from, to) = (f64::from(n) * t, f64::from(n + 1) * t);
            let truth = slope * (to.powi(3) - from.powi(3)) / (6.0 * t);
            error = truth - (phase + 0.5 * rate * t);
            phase += rate * t;
            rate = filter.update(error);
        }
        assert!(error.abs() < 1e-6, "{error}");
        assert!((filter.acceleration - slope).abs() < 1e-3);
    }
}
