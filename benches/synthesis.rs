//! Synthesis of 12 satellites with noise, real 8-bit samples at 120 Msps: components per satellite,
//! front-end filter of the demonstration scenarios, vector instructions and threads. Counts samples
//! of the recording: 120 Msamples/s are real time.

// What criterion's macros make has no documentation.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::signal;
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::synth::{Emitter, Filter, SynthConfig, Synthesizer};
use workload::{LO_HZ, PER_MS, PRNS, RATE_HZ};

/// A synthesiser of these components of all satellites, the components of each moving as one.
fn synthesizer(components: &[&str], filter: bool, threads: usize) -> Synthesizer {
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

fn synthesis(c: &mut Criterion) {
    let mut group = c.benchmark_group("synthesis");
    let samples = 20 * PER_MS;
    group.throughput(Throughput::Elements(samples as u64));
    group.sample_size(20);
    let threads = |level| if level == Level::best() { 1..=2 } else { 1..=1 };
    for components in [
        &["B1I", "B1CD"][..],
        &["B1I", "B1CP"],
        &["B1I", "B1CD", "B1CP"],
    ] {
        for filter in [false, true] {
            let name = components.join(" + ") + if filter { ", filter" } else { "" };
            for level in Level::available() {
                for threads in threads(level) {
                    let synth = synthesizer(components, filter, threads).at_level(level);
                    let setting = format!("{}, threads: {threads}", level.name());
                    group.bench_function(BenchmarkId::new(&name, setting), |b| {
                        b.iter(|| synth.generate(black_box(0), samples).expect("whole bytes"))
                    });
                }
            }
        }
    }
    group.finish();
}

criterion_group!(benches, synthesis);
criterion_main!(benches);
