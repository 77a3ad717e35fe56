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

    /// Takes another value for the mean of what was added, with a value that stands for `interval_s`.
    fn replace(&mut self, value: f64, interval_s: f64) {
        self.elapsed_s += interval_s;
        self.value = value;
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
    /// Of the first prompts, over the square of the time that they were summed for.
    first: RunningMean,
}

/// Until so much noise was heard, the ratio is that of both means: the power of few noise taps may
/// be next to nothing, and one prompt over it would spoil the mean of ratios for seconds.
const FIRST_NOISE_S: f64 = 0.05;

impl Cn0 {
    /// An empty estimator; prompts are averaged over `memory_s`, noise over four times that.
    pub fn new(memory_s: f64) -> Self {
        Cn0 {
            noise: RunningMean::new(4.0 * memory_s),
            ratio_hz: RunningMean::new(memory_s),
            first: RunningMean::new(FIRST_NOISE_S),
        }
    }

    /// Adds the noise tap of one slice.
    pub fn add_noise(&mut self, tap: C64, interval_s: f64) {
        self.noise.add(tap.norm_sqr() / interval_s, interval_s);
    }

    /// Adds a coherent prompt over `interval_s`.
    pub fn add_prompt(&mut self, prompt: C64, interval_s: f64) {
        let noise = self.noise_power(interval_s);
        if noise <= 0.0 {
            return;
        }
        let power = prompt.norm_sqr();
        if self.noise.elapsed_s() < FIRST_NOISE_S {
            self.first
                .add(power / (interval_s * interval_s), interval_s);
            let ratio = self.first.value() * interval_s * interval_s / noise - 1.0;
            self.ratio_hz.replace(ratio / interval_s, interval_s);
        } else {
            self.ratio_hz
                .add((power / noise - 1.0) / interval_s, interval_s);
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
        self.first = RunningMean::new(FIRST_NOISE_S);
    }
}

/// Whether a signal is there, and its phase held.
#[derive(Debug, Clone)]
pub struct Lock {
    aligned: RunningMean,
    signal: RunningMean,
    present: RunningMean,
}

impl Lock {
    /// An empty detector.
    pub fn new(memory_s: f64) -> Self {
        let [aligned, signal, present] = std::array::from_fn(|_| RunningMean::new(memory_s));
        Lock {
            aligned,
            signal,
            present,
        }
    }

    /// Adds a prompt with the mean noise power in it; `least_snr` is that of the weakest signal
    /// that counts as present.
    pub fn add(&mut self, prompt: C64, noise_power: f64, least_snr: f64, interval_s: f64) {
        let power = prompt.norm_sqr();
        self.aligned
            .add(prompt.re * prompt.re - prompt.im * prompt.im, interval_s);
        self.signal.add(power - noise_power, interval_s);
        let present = power > noise_power * (1.0 + least_snr);
        self.present.add(f64::from(u8::from(present)), interval_s);
    }

    /// Phase lock: mean of cos(2 phase error) weighted by power, noise removed; 1 locked, 0 not,
    /// -1 a quarter of a cycle off. 0 while empty.
    pub fn phase(&self) -> f64 {
        if self.signal.value() > 0.0 {
            (self.aligned.value() / self.signal.value()).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    }

    /// Share of prompts with the power of a signal. A mean of powers would remember a strong
    /// signal long after it has vanished.
    pub fn presence(&self) -> f64 {
        self.present.value()
    }

    /// Seconds added.
    pub fn elapsed_s(&self) -> f64 {
        self.aligned.elapsed_s()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_first_noise_tap_of_next_to_nothing_is_soon_forgotten() {
        let mut cn0 = Cn0::new(0.5);
        let (slice_s, signal, noise) = (1e-3, C64::new(10.0, 0.0), C64::new(1.0, 0.0));
        for slice in 0..100 {
            let tap = if slice == 0 { 0.01 * noise } else { noise };
            cn0.add_noise(tap, slice_s);
            cn0.add_prompt(signal, slice_s);
        }
        // |signal|^2 / |noise|^2 - 1, in 1 ms.
        let expected = 10.0 * (99.0f64 / slice_s).log10();
        assert!((cn0.dbhz() - expected).abs() < 0.2, "{}", cn0.dbhz());
    }
}
