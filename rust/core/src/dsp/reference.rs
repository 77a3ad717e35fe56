//! The slow, obvious correlator in double precision that the fast one is compared with.

use crate::signal::Modulation;
use crate::C64;

/// A replica with constant rates, in absolute samples.
#[derive(Debug, Clone)]
pub struct ReferenceReplica {
    /// Chips of a code period, +1/-1.
    pub code: Vec<i8>,
    /// Chip shape.
    pub modulation: Modulation,
    /// Sample at which a code period starts.
    pub start: f64,
    /// Samples per chip.
    pub samples_per_chip: f64,
    /// Total carrier frequency in the file, cycles per sample.
    pub frequency: f64,
    /// Carrier phase at sample 0 in cycles.
    pub phase: f64,
}

impl ReferenceReplica {
    /// The baseband replica at a (fractional) sample: the sum of the modulation's layers.
    fn value(&self, sample: f64) -> C64 {
        let layers = self.modulation.layers().iter();
        layers
            .map(|layer| {
                let per_chip = layer.subchips as i64;
                // One division, so that a sample on an edge is on it.
                let samples = (sample - self.start) * per_chip as f64;
                let subchip = (samples / self.samples_per_chip).floor() as i64;
                let chip = subchip
                    .div_euclid(per_chip)
                    .rem_euclid(self.code.len() as i64);
                let sign = if subchip.rem_euclid(per_chip) % 2 == 0 {
                    1.0
                } else {
                    -1.0
                };
                C64::new(layer.re, layer.im) * sign * f64::from(self.code[chip as usize])
            })
            .sum()
    }

    /// The signal itself at a (fractional) sample: replica on its carrier.
    pub fn wave(&self, sample: f64) -> C64 {
        let carrier = (self.phase + self.frequency * sample).fract();
        C64::from_polar(1.0, std::f64::consts::TAU * carrier) * self.value(sample)
    }

    /// Correlates the replica delayed by `tap` samples with the recording over code phases from
    /// `from` to `to` chips. `sample` gives the recording's value at an absolute index.
    pub fn correlate(&self, sample: impl Fn(i64) -> C64, from: f64, to: f64, tap: i64) -> C64 {
        let first = (self.start + from * self.samples_per_chip).ceil() as i64 + tap;
        let last = (self.start + to * self.samples_per_chip).ceil() as i64 + tap;
        (first..last)
            .map(|k| {
                let carrier = (self.phase + self.frequency * k as f64).fract();
                sample(k)
                    * C64::from_polar(1.0, -std::f64::consts::TAU * carrier)
                    * self.value((k - tap) as f64).conj()
            })
            .sum()
    }
}
