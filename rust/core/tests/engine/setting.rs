//! A signal in a recording, as the engine correlates it, and as the reference does.

use std::sync::Arc;

use sdr_spoof_core::dsp::correlator::{Correlator, Slice};
use sdr_spoof_core::dsp::engine::Engine;
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::C64;

use crate::format::{noise, Format};
use crate::kinds::{Kind, KINDS};
use crate::reference::{Begun, Heard, Sums};

/// The signal is so far ahead of the replica, cycles.
pub const LEAD_CYCLES: f64 = 0.21;

/// Everything that a channel and its input can differ in; frequencies in cycles per sample.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Of [`KINDS`].
    pub kind: usize,
    pub format: Format,
    pub samples_per_chip: f64,
    /// The band's frequency in the recording.
    pub intermediate: f64,
    /// The signal's beyond that.
    pub carrier: f64,
    /// Where the band's oscillator is moved to, and after how many of the bytes.
    pub retuned: (f64, usize),
    /// First sample of the recording.
    pub origin: u64,
    /// The channel's start after that.
    pub lead: f64,
    pub index: usize,
    pub taps: Vec<i64>,
    pub outer: Vec<bool>,
    pub slices: usize,
}

impl Setting {
    pub fn kind(&self) -> &'static Kind {
        &KINDS[self.kind]
    }

    fn channel(&self) -> Correlator {
        let replica = Arc::clone(&self.kind().replica);
        let start = self.origin as f64 + self.lead;
        let mut channel =
            Correlator::with_outer_taps(replica, &self.taps, &self.outer, self.index, start);
        channel.set_rates(self.carrier, self.samples_per_chip);
        channel
    }

    fn heard<'a>(&self, samples: &'a [C64]) -> Heard<'a> {
        Heard {
            samples,
            origin: self.origin,
            intermediate: self.intermediate,
        }
    }

    /// The first slice as it begins.
    fn begun(&self) -> Begun {
        Begun::of(&self.channel(), self.index, self.carrier)
    }

    /// A recording with a signal and noise of these amplitudes, as long as the slices last.
    pub fn bytes(&self, signal: f64, noise_level: f64) -> Vec<u8> {
        let slices = self.slices as f64 * self.kind().chips() * self.samples_per_chip;
        let reach = self.taps.iter().copied().max().unwrap_or(0).max(0);
        let count = (self.lead + slices) as usize + reach as usize + 8;
        let heard = self.heard(&[]);
        let sources = heard.replicas(self.kind(), &self.begun(), false);
        let lead = C64::from_polar(signal, std::f64::consts::TAU * LEAD_CYCLES);
        self.format.bytes((0..count.next_multiple_of(4)).map(|k| {
            let wave: C64 = sources.iter().flatten().map(|s| s.wave(k as f64)).sum();
            let n = |part: u64| noise(2 * (self.origin + k as u64) + part) * noise_level;
            wave * lead + C64::new(n(0), n(1))
        }))
    }

    /// All slices by the engine.
    pub fn fast(&self, bytes: &[u8], level: Level) -> Vec<Slice> {
        let reach = self.taps.iter().map(|t| t.unsigned_abs()).max().unwrap() as usize;
        let stream = self.format.stream(self.origin);
        let mut engine = Engine::new(stream, &[self.intermediate], reach, level);
        engine.attach(0, self.channel());
        let mut slices = Vec::new();
        let (offset, after) = self.retuned;
        let (before, since) = bytes.split_at(after);
        engine.feed(before, |_, slice, _| slices.push(slice.clone()));
        engine.bands_mut()[0].retune(offset);
        engine.feed(since, |_, slice, _| slices.push(slice.clone()));
        slices
    }

    /// The same by the reference.
    pub fn slow(&self, bytes: &[u8]) -> Vec<Sums> {
        let samples = self.format.samples(bytes);
        let heard = self.heard(&samples);
        let first = self.begun();
        let slice = |s: usize| {
            let length = s as f64 * self.kind().chips() * first.samples_per_chip;
            let start = first.fraction + length;
            let whole = start.floor();
            let begun = Begun {
                index: first.index + s,
                base: first.base + whole as u64,
                fraction: start - whole,
                carrier_cycles: first.carrier * whole,
                ..first
            };
            heard.slice(self.kind, &begun, &self.taps, &self.outer)
        };
        (0..self.slices).map(slice).collect()
    }
}
