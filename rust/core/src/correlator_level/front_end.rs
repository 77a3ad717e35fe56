//! What the front-end filter does to a signal's correlation and to the noise.

use std::f64::consts::TAU;

use super::pulse::Pulse;
use super::Setting;
use crate::synth::Filter;
use crate::C64;

/// The filter as a carrier sees it: delays in chips, with their weights.
pub(super) struct FrontEnd {
    signal: Option<Vec<(f64, C64)>>,
    noise: Option<Vec<(f64, C64)>>,
}

impl FrontEnd {
    /// Noise behind the filter has the power that it would have without.
    pub fn new(setting: &Setting, carrier_hz: f64, samples_per_chip: f64) -> Self {
        let turns = (carrier_hz - setting.lo_hz) / setting.sample_rate_hz;
        let seen = |delay: i64, weight: C64| {
            let turn = C64::from_polar(1.0, -TAU * turns * delay as f64);
            (delay as f64 / samples_per_chip, weight * turn)
        };
        let filter = setting.filter.as_ref();
        FrontEnd {
            signal: filter.map(|f| {
                let reach = f.reach() as i64;
                let weight = |k| f.tap(k) / f.noise_gain();
                (-reach..=reach).map(|k| seen(k, weight(k))).collect()
            }),
            noise: filter.map(|f| {
                let reach = 2 * f.reach() as i64;
                let power = f.noise_gain().powi(2);
                (-reach..=reach)
                    .map(|m| seen(m, overlap(f, m) / power))
                    .collect()
            }),
        }
    }

    #[cfg(test)]
    pub fn unlimited() -> Self {
        FrontEnd {
            signal: None,
            noise: None,
        }
    }

    /// A received chip behind the filter.
    pub fn signal(&self, pulse: Pulse) -> Pulse {
        through(pulse, self.signal.as_deref())
    }

    /// Power gain at so many frequencies beside the carrier, `step_hz` apart, of which a chip has the
    /// given rate.
    pub fn gains(&self, chip_rate_hz: f64, first_hz: f64, step_hz: f64, count: usize) -> Vec<f64> {
        let Some(response) = &self.signal else {
            return vec![1.0; count];
        };
        let mut sums = vec![C64::default(); count];
        for (delay, weight) in response {
            let turn = |hz: f64| C64::from_polar(1.0, -TAU * hz * delay / chip_rate_hz);
            let (mut phasor, step) = (weight * turn(first_hz), turn(step_hz));
            for sum in &mut sums {
                *sum += phasor;
                phasor *= step;
            }
        }
        sums.iter().map(C64::norm_sqr).collect()
    }

    /// What correlates the noise of two replicas `pulse` apart.
    pub fn noise(&self, pulse: Pulse) -> Pulse {
        through(pulse, self.noise.as_deref())
    }
}

fn through(pulse: Pulse, response: Option<&[(f64, C64)]>) -> Pulse {
    match response {
        Some(response) => pulse.through(response),
        None => pulse,
    }
}

/// The filter's autocorrelation: sum over k of h(k) conj(h(k - m)).
fn overlap(filter: &Filter, m: i64) -> C64 {
    let reach = filter.reach() as i64;
    let inside = (-reach).max(m - reach)..=reach.min(m + reach);
    inside
        .map(|k| filter.tap(k) * filter.tap(k - m).conj())
        .sum()
}
