//! What the benches and the instruction counts run.
//!
//! W1 is 12 satellites with B1I and the B1C pilot as BOC(1,1), 5 taps, in real 8-bit samples at
//! 120 Msps. W2 is the same with the whole QMBOC pilot and the data component's prompt.

pub mod inertial;

use std::sync::Arc;

use sdr_spoof_core::dsp::correlator::Correlator;
use sdr_spoof_core::dsp::engine::Engine;
use sdr_spoof_core::dsp::front_end::Stream;
use sdr_spoof_core::dsp::replica::Replica;
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::signal::{self, Modulation, SignalSpec};
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::synth::{Emitter, Filter, SynthConfig, Synthesizer};

/// Sample rate.
pub const RATE_HZ: f64 = 120e6;
/// Radio frequency at 0 Hz in the samples: B1I at 22.839 MHz, B1C at 37.161 MHz.
pub const LO_HZ: f64 = 1538.259e6;
/// Samples in a millisecond.
pub const PER_MS: usize = 120_000;
/// Tap offsets in samples, on the raster of 8.
pub const TAPS: [i64; 5] = [-16, -8, 0, 8, 16];
/// Farthest tap that an engine is built for, samples.
pub const REACH: usize = 64;
/// Satellites with B1I and B1C.
pub const PRNS: [u16; 12] = [19, 21, 23, 25, 27, 29, 32, 34, 36, 38, 40, 42];

/// A kind of channel.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// Short name.
    pub name: &'static str,
    /// Registry name of the signal.
    pub signal: &'static str,
    /// How the replica's chips are shaped.
    pub modulation: Modulation,
    /// Correlate the data component beside the pilot too.
    pub companion: bool,
}

/// B1I.
pub const B1I: Kind = Kind {
    name: "B1I",
    signal: "B1I",
    modulation: Modulation::Bpsk,
    companion: false,
};
/// B1C pilot as BOC(1,1).
pub const B1C_BOC: Kind = Kind {
    name: "B1C BOC(1,1)",
    signal: "B1CP",
    modulation: Modulation::Boc11,
    companion: false,
};
/// B1C pilot as QMBOC.
pub const B1C_QMBOC: Kind = Kind {
    name: "B1C QMBOC",
    signal: "B1CP",
    modulation: Modulation::Qmboc,
    companion: false,
};
/// B1C pilot as QMBOC, and the prompt of its data component.
pub const B1C_WHOLE: Kind = Kind {
    name: "B1C QMBOC and data",
    companion: true,
    ..B1C_QMBOC
};
/// Every kind of channel.
pub const KINDS: [Kind; 4] = [B1I, B1C_BOC, B1C_QMBOC, B1C_WHOLE];
/// The channels of a satellite, by workload.
pub const WORKLOADS: [(&str, [Kind; 2]); 2] = [("W1", [B1I, B1C_BOC]), ("W2", [B1I, B1C_WHOLE])];

/// Bytes from a linear congruence, -32 to 31: their values do not matter to the speed.
pub fn noise(count: usize) -> Vec<u8> {
    let mut z = 1u32;
    (0..count)
        .map(|_| {
            z = z.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((z >> 26) as i8 - 32) as u8
        })
        .collect()
}

/// Samples of a format, by its name, from sample 0 on.
pub fn stream(format: &str) -> Stream {
    Stream {
        format: SampleFormat::parse(format).expect("a known format"),
        conjugate: false,
        float_scale: 1.0,
        start: 0,
    }
}

/// Frequency of a kind's band, cycles per sample.
pub fn frequency(kind: &Kind) -> f64 {
    (spec(kind).carrier_hz - LO_HZ) / RATE_HZ
}

fn spec(kind: &Kind) -> &'static SignalSpec {
    signal::find(kind.signal).expect("registered")
}

/// The replica of the satellite at this place in [`PRNS`].
pub fn replica(kind: &Kind, place: usize) -> Arc<Replica> {
    let (spec, prn) = (spec(kind), PRNS[place]);
    let replica = Replica::new(spec, prn, kind.modulation).expect("transmitted");
    Arc::new(match spec.companion().filter(|_| kind.companion) {
        Some(data) => replica
            .with_companion(spec, data, prn)
            .expect("transmitted"),
        None => replica,
    })
}

/// The channel of the satellite at this place in [`PRNS`]; Doppler within 4 kHz and delays within
/// a millisecond, other ones for each.
pub fn channel(kind: &Kind, place: usize, replica: Arc<Replica>, taps: &[i64]) -> Correlator {
    let spec = spec(kind);
    let start = REACH as f64 + 0.37 + 7_777.7 * place as f64;
    let doppler_hz = -4e3 + 8e3 * place as f64 / (PRNS.len() - 1) as f64;
    let chip_rate_hz = spec.chip_rate_hz * (1.0 + doppler_hz / spec.carrier_hz);
    let mut channel = Correlator::new(replica, taps, 0, start);
    channel.set_rates(doppler_hz / RATE_HZ, RATE_HZ / chip_rate_hz);
    channel
}

/// An engine with the given kinds of channel for all satellites, every channel under way.
pub fn engine(kinds: &[Kind], taps: &[i64], level: Level, samples: &[u8]) -> Engine {
    let mut bands: Vec<f64> = Vec::new();
    let places: Vec<usize> = kinds
        .iter()
        .map(|k| band_of(&mut bands, frequency(k)))
        .collect();
    let mut engine = Engine::new(stream("ri8"), &bands, REACH, level);
    for (kind, band) in kinds.iter().zip(places) {
        for place in 0..PRNS.len() {
            engine.attach(band, channel(kind, place, replica(kind, place), taps));
        }
    }
    assert!(run(&mut engine, samples) > 0, "no channel has started");
    engine
}

fn band_of(bands: &mut Vec<f64>, frequency: f64) -> usize {
    bands
        .iter()
        .position(|&b| b == frequency)
        .unwrap_or_else(|| {
            bands.push(frequency);
            bands.len() - 1
        })
}

/// Feeds samples; gives the number of slices that channels have closed.
pub fn run(engine: &mut Engine, samples: &[u8]) -> usize {
    let mut slices = 0;
    engine.feed(samples, |_, _, _| slices += 1);
    slices
}

/// A synthesiser of these components of all satellites, the components of each moving as one; with
/// the front-end filter of the demonstration scenarios.
pub fn synthesizer(components: &[&str], filter: bool, threads: usize) -> Synthesizer {
    let satellite = |&prn: &u16| {
        components.iter().map(move |id| Emitter {
            delay_s: 0.07 + 1e-4 * f64::from(prn),
            doppler_hz: 100.0 * f64::from(prn) - 3e3,
            ..Emitter::new(signal::find(id).expect("registered"), prn, 45.0)
        })
    };
    let filter = filter.then(|| Filter::new(0.25, 50e6 / RATE_HZ, 63, false));
    let config = SynthConfig {
        sample_rate_hz: RATE_HZ,
        lo_hz: LO_HZ,
        format: SampleFormat::parse("ri8").expect("a known format"),
        noise_rms_lsb: 16.0,
        noise: true,
        seed: 1,
        filter: filter.map(|f| f.expect("inside the sampled band")),
        threads,
    };
    let emitters = PRNS.iter().flat_map(satellite).collect();
    Synthesizer::new(config, emitters).expect("a valid plan")
}
