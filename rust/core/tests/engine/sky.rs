//! Satellites for the tracker to find: plain sums of codes on carriers, in noise.

use sdr_spoof_core::signal::{self, Modulation};
use sdr_spoof_core::track::engine::{Input, Target};
use sdr_spoof_core::track::epoch::Seed;
use sdr_spoof_core::C64;

use crate::format::{noise, Format};

/// A signal of one satellite.
pub struct Sent {
    pub id: &'static str,
    pub prn: u16,
    pub doppler_hz: f64,
    /// Of a code period, from the first sample.
    pub delay_s: f64,
    pub amplitude: f64,
}

/// A signal on its way: code and carrier, sample by sample.
struct Wave {
    chips: Vec<f64>,
    position: f64,
    step: f64,
    phasor: C64,
    turn: C64,
}

impl Wave {
    /// A signal whose secondary code, if it has one, begins with the first sample.
    fn new(sent: &Sent, input: &Input) -> Self {
        let spec = signal::find(sent.id).unwrap();
        let halves = match spec.modulation {
            Modulation::Bpsk => 1,
            Modulation::Boc11 | Modulation::Qmboc => 2,
        };
        let code = spec.code(sent.prn).unwrap();
        let overlay = spec.secondary(sent.prn).unwrap();
        let periods = if overlay.is_empty() { vec![1] } else { overlay };
        let chip = |period: i8, chip: i8, half: usize| {
            f64::from(period) * f64::from(chip) * [1.0, -1.0][half % 2]
        };
        let chips = periods.iter().take(100).flat_map(|&p| {
            let code = &code;
            code.iter()
                .flat_map(move |&c| (0..halves).map(move |half| chip(p, c, half)))
        });
        let rate = spec.chip_rate_hz * (1.0 + sent.doppler_hz / spec.carrier_hz);
        let fs = input.sample_rate_hz;
        let carrier = (spec.carrier_hz - input.lo_hz + sent.doppler_hz) / fs;
        let chips: Vec<f64> = chips.collect();
        let step = rate / fs * halves as f64;
        Wave {
            position: chips.len() as f64 - sent.delay_s * fs * step,
            step,
            chips,
            phasor: C64::from_polar(sent.amplitude, 0.7),
            turn: C64::from_polar(1.0, std::f64::consts::TAU * carrier),
        }
    }

    fn next(&mut self) -> C64 {
        let length = self.chips.len() as f64;
        if self.position >= length {
            self.position -= length;
        }
        let value = self.phasor * self.chips[self.position as usize];
        self.position += self.step;
        self.phasor *= self.turn;
        value
    }
}

/// So many seconds of the signals with noise of the given amplitude.
pub fn recording(
    input: &Input,
    format: Format,
    sent: &[Sent],
    duration_s: f64,
    level: f64,
) -> Vec<u8> {
    let count = (duration_s * input.sample_rate_hz) as usize / 4 * 4;
    let mut waves: Vec<Wave> = sent.iter().map(|s| Wave::new(s, input)).collect();
    format.bytes((0..count as u64).map(|k| {
        let n = C64::new(noise(2 * k), noise(2 * k + 1)) * level;
        waves.iter_mut().map(Wave::next).sum::<C64>() + n
    }))
}

impl Sent {
    /// As an acquisition finds it.
    pub fn target(&self, start: u64) -> Target {
        Target {
            signal: self.id.to_owned(),
            prn: self.prn,
            seed: Seed {
                sample: start,
                doppler_hz: self.doppler_hz,
                code_delay_s: self.delay_s,
            },
        }
    }
}
