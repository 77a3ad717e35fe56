//! C/N0 estimation and lock detection, as running means.

use crate::C64;

/// A mean that starts as the plain average and becomes exponential.
#[derive(Debug, Clone)]
pub struct RunningMean {
    value: f64,
    elapsed_s: f64,
    memory_s: f64,
}

impl Default for RunningMean {
    /// An empty mean over 0.2 s.
    fn default() -> Self {
        RunningMean::new(0.2)
    }
}

impl RunningMean {
    /// An empty mean with the given memory.
    pub fn new(memory_s: f64) -> Self {
        RunningMean {
            value: 0.0,
            elapsed_s: 0.0,
            memory_s,
        }
    }

    /// Adds a value that stands for `interval_s`.
    pub fn add(&mut self, value: f64, interval_s: f64) {
        self.elapsed_s += interval_s;
        self.value += (value - self.value) * interval_s / self.elapsed_s.min(self.memory_s);
    }

    /// The mean; 0 while empty.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Seconds added.
    pub fn elapsed_s(&self) -> f64 {
        self.elapsed_s
    }
}

/// C/N0 from prompt power over the noise power of a tap far from the peak.
///
/// Both powers are of the same replica, so front-end filter, quantiser and bandwidth cancel.
#[derive(Debug, Clone)]
pub struct Cn0 {
    noise: RunningMean,
    ratio_hz: RunningMean,
}

impl Cn0 {
    /// An empty estimator; prompts are averaged over `memory_s`, noise over four times that.
    pub fn new(memory_s: f64) -> Self {
        Cn0 {
            noise: RunningMean::new(4.0 * memory_s),
            ratio_hz: RunningMean::new(memory_s),
        }
    }

    /// Adds the noise tap of one slice.
    pub fn add_noise(&mut self, tap: C64, interval_s: f64) {
        self.noise.add(tap.norm_sqr() / interval_s, interval_s);
    }

    /// Adds a coherent prompt over `interval_s`.
    pub fn add_prompt(&mut self, prompt: C64, interval_s: f64) {
        let noise = self.noise_power(interval_s);
        if noise > 0.0 {
            self.ratio_hz
                .add((prompt.norm_sqr() / noise - 1.0) / interval_s, interval_s);
        }
    }

    /// Mean noise power of a coherent sum over `interval_s`.
    pub fn noise_power(&self, interval_s: f64) -> f64 {
        self.noise.value() * interval_s
    }

    /// Mean signal power (noise removed) of a coherent sum over `interval_s`; never below the
    /// noise's own share at 15 dB-Hz.
    pub fn signal_power(&self, interval_s: f64) -> f64 {
        self.noise_power(interval_s) * interval_s * self.ratio_hz.value().max(31.6)
    }

    /// C/N0 in dB-Hz, not below 0.
    pub fn dbhz(&self) -> f64 {
        10.0 * self.ratio_hz.value().max(1.0).log10()
    }

    /// Forgets the prompts (not the noise), as after a restart.
    pub fn forget_signal(&mut self) {
        self.ratio_hz = RunningMean::new(self.ratio_hz.memory_s);
    }
}

/// Phase lock: mean of cos(2 phase error) over what noise alone leaves of it; 1 locked, 0 not,
/// -1 a quarter of a cycle off.
///
/// Every prompt counts alike: were they weighted by power, a signal that vanishes would be
/// remembered for as long as its power dwarfs the noise.
#[derive(Debug, Clone)]
pub struct PhaseLock {
    aligned: RunningMean,
    snr: f64,
}

impl PhaseLock {
    /// An empty detector.
    pub fn new(memory_s: f64) -> Self {
        PhaseLock {
            aligned: RunningMean::new(memory_s),
            snr: 1.0,
        }
    }

    /// Adds a prompt of a signal-to-noise ratio (C/N0 times the interval).
    pub fn add(&mut self, prompt: C64, snr: f64, interval_s: f64) {
        self.aligned.add((2.0 * prompt.arg()).cos(), interval_s);
        self.snr = snr;
    }

    /// The indicator in [-1, 1]; 0 while empty.
    pub fn value(&self) -> f64 {
        // Mean of cos(2 error) of a phasor in Gaussian noise.
        let left = 1.0 - (1.0 - (-self.snr).exp()) / self.snr;
        (self.aligned.value() / left).clamp(-1.0, 1.0)
    }

    /// Seconds added.
    pub fn elapsed_s(&self) -> f64 {
        self.aligned.elapsed_s()
    }
}
