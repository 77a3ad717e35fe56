//! A channel on a recording: as the engine correlates it, and as the reference does.

use std::sync::Arc;

use sdr_spoof_core::dsp::correlator::{Correlator, Slice};
use sdr_spoof_core::dsp::engine::Engine;
use sdr_spoof_core::dsp::front_end::Stream;
use sdr_spoof_core::dsp::reference::ReferenceReplica;
use sdr_spoof_core::nco;
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::signal::{self, Modulation};
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::C64;

use crate::kinds::{Kind, KINDS, PRN};

/// The signal is so far ahead of the replica, cycles.
pub const LEAD_CYCLES: f64 = 0.21;
/// Float samples are scaled by this.
const FLOAT_SCALE: f32 = 100.0;

/// Deterministic noise in [-1, 1).
pub fn noise(index: u64) -> f64 {
    let mut z = index
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(0x1234_5678);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A sample format, and what suits it.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    pub name: &'static str,
    pub conjugate: bool,
    /// Amplitudes of a signal well above the quantiser's noise.
    pub signal: f64,
    pub noise: f64,
}

pub const FORMATS: [Format; 11] = {
    const fn format(name: &'static str, conjugate: bool, signal: f64, noise: f64) -> Format {
        Format {
            name,
            conjugate,
            signal,
            noise,
        }
    }
    [
        format("ri8", false, 20.0, 30.0),
        format("ci8", false, 20.0, 30.0),
        format("ci8", true, 20.0, 30.0),
        format("ri16", false, 2000.0, 3000.0),
        format("ci16", false, 3.0, 4.5),
        format("ci16", true, 2000.0, 3000.0),
        format("r2", false, 1.5, 3.0),
        format("c2", false, 1.5, 3.0),
        format("c2", true, 1.5, 3.0),
        format("rf32", false, 0.2, 0.3),
        format("cf32", true, 0.2, 0.3),
    ]
};

impl Format {
    pub fn parsed(self) -> SampleFormat {
        SampleFormat::parse(self.name).unwrap()
    }

    pub fn stream(self, start: u64) -> Stream {
        Stream {
            format: self.parsed(),
            conjugate: self.conjugate,
            float_scale: FLOAT_SCALE,
            start,
        }
    }

    /// `samples` (of I + jQ) as the bytes of a file.
    pub fn bytes(self, samples: impl Iterator<Item = C64>) -> Vec<u8> {
        let format = self.parsed();
        let width = 1 + usize::from(format.is_complex());
        let q = if self.conjugate { -1.0 } else { 1.0 };
        let values: Vec<f32> = samples
            .flat_map(|v| [v.re as f32, (q * v.im) as f32].into_iter().take(width))
            .collect();
        let mut bytes = vec![0; values.len() * format.bits_per_sample() / width / 8];
        format.pack(&values, 1.0, &mut bytes);
        bytes
    }

    /// The samples in the bytes of a file.
    pub fn samples(self, bytes: &[u8]) -> Vec<C64> {
        let format = self.parsed();
        let mut values = Vec::new();
        format.unpack(bytes, FLOAT_SCALE, self.conjugate, &mut values);
        let values: Vec<f64> = values.into_iter().map(f64::from).collect();
        if format.is_complex() {
            values
                .chunks_exact(2)
                .map(|v| C64::new(v[0], v[1]))
                .collect()
        } else {
            values.into_iter().map(|v| C64::new(v, 0.0)).collect()
        }
    }
}

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
    /// Where the band's oscillator is moved to at the start.
    pub retuned: f64,
    /// First sample of the recording.
    pub origin: u64,
    /// The channel's start after that.
    pub lead: f64,
    pub index: usize,
    pub taps: Vec<i64>,
    pub outer: Vec<bool>,
    pub slices: usize,
}

/// What a slice gives: taps and companion.
pub type Sums = (Vec<C64>, C64);

impl Setting {
    pub fn kind(&self) -> &'static Kind {
        &KINDS[self.kind]
    }

    pub fn channel(&self) -> Correlator {
        let replica = Arc::clone(&self.kind().replica);
        let start = self.origin as f64 + self.lead;
        let mut channel =
            Correlator::with_outer_taps(replica, &self.taps, &self.outer, self.index, start);
        channel.set_rates(self.carrier, self.samples_per_chip);
        channel
    }

    /// Samples of the recording: a signal and noise of these amplitudes for as long as the slices
    /// last.
    pub fn bytes(&self, signal: f64, noise_level: f64) -> Vec<u8> {
        let slices = self.slices as f64 * self.kind().chips() * self.samples_per_chip;
        let reach = self.taps.iter().copied().max().unwrap_or(0).max(0);
        let count = (self.lead + slices) as usize + reach as usize + 8;
        let sources: Vec<_> = match signal {
            0.0 => Vec::new(),
            _ => self.references(false).into_iter().flatten().collect(),
        };
        let lead = C64::from_polar(signal, std::f64::consts::TAU * LEAD_CYCLES);
        let sample = |k: usize| {
            let wave: C64 = sources.iter().map(|s| s.wave(k as f64)).sum();
            let n = |part: u64| noise(2 * (self.origin + k as u64) + part) * noise_level;
            wave * lead + C64::new(n(0), n(1))
        };
        let whole = (0..count.next_multiple_of(4)).map(sample);
        self.format.bytes(whole)
    }

    /// All slices, the input cut after these numbers of bytes (cyclically, of whole samples).
    pub fn fast(&self, bytes: &[u8], cuts: &[usize], level: Level) -> Vec<Slice> {
        let reach = self.taps.iter().map(|t| t.unsigned_abs()).max().unwrap() as usize;
        let stream = self.format.stream(self.origin);
        let mut engine = Engine::new(stream, &[self.intermediate], reach, level);
        if self.retuned != 0.0 {
            engine.bands_mut()[0].retune(self.retuned);
        }
        engine.attach(0, self.channel());
        let mut slices = Vec::new();
        let (mut rest, mut cuts) = (bytes, cuts.iter().cycle());
        let unit = stream.format.bits_per_sample().div_ceil(8);
        while !rest.is_empty() {
            let length = (cuts.next().unwrap() / unit + 1) * unit;
            let (piece, after) = rest.split_at(length.min(rest.len()));
            engine.feed(piece, |_, slice, _| slices.push(slice.clone()));
            rest = after;
        }
        slices
    }

    /// The same by the reference.
    pub fn slow(&self, bytes: &[u8]) -> Vec<Sums> {
        let samples = self.format.samples(bytes);
        let sample = |k: i64| {
            let at = usize::try_from(k).ok().and_then(|k| samples.get(k));
            at.copied().unwrap_or_default()
        };
        let chips = self.kind().chips();
        let [whole, companion] = self.references(false);
        let [main, _] = self.references(true);
        let slice = |s: usize| {
            let from = self.first_chip() + s as f64 * chips;
            let correlate =
                |r: &ReferenceReplica, tap| r.correlate(sample, from, from + chips, tap);
            let taps = self.taps.iter().zip(&self.outer).map(|(&tap, &outer)| {
                let replica = if outer { &main } else { &whole };
                correlate(replica.as_ref().unwrap(), tap)
            });
            let companion = companion.as_ref().map(|c| correlate(c, 0));
            (taps.collect(), companion.unwrap_or_default())
        };
        (0..self.slices).map(slice).collect()
    }

    /// Where in the code period the first slice begins.
    fn first_chip(&self) -> f64 {
        (self.index % self.kind().replica.slices_per_period()) as f64 * self.kind().chips()
    }

    /// Replica and companion on a time axis that begins at the origin; the replica's main layer
    /// alone, if `main`.
    fn references(&self, main: bool) -> [Option<ReferenceReplica>; 2] {
        let kind = self.kind();
        let channel = self.channel();
        let lead = channel.start() - self.origin as f64;
        // The band's oscillator counts from sample 0; beyond it the channel's is 0 at its base.
        let band = nco::step_from_frequency(self.intermediate).wrapping_mul(self.origin);
        let phase = nco::cycles_from_phase(band) - (self.carrier * lead.floor()).fract();
        let replica = |id: &str, modulation, turn: f64| ReferenceReplica {
            code: signal::find(id).unwrap().code(PRN).unwrap(),
            modulation,
            start: lead - self.first_chip() * self.samples_per_chip,
            samples_per_chip: channel.samples_per_chip(),
            frequency: self.intermediate + self.carrier,
            phase: phase + turn,
        };
        let modulation = match kind.modulation {
            Modulation::Qmboc if main => Modulation::Boc11,
            m => m,
        };
        let companion = kind.companion.map(|id| {
            let spec = signal::find(id).unwrap();
            let turn = spec.phase_offset_cycles - kind.spec().phase_offset_cycles;
            replica(id, spec.modulation, turn)
        });
        [Some(replica(kind.id, modulation, 0.0)), companion]
    }
}
