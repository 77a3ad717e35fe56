//! Synthesis of 12 satellites with noise, real 8-bit samples at 120 Msps: components per satellite,
//! front-end filter of the demonstration scenarios, vector instructions and threads. Counts samples
//! of the recording: 120 Msamples/s are real time.

// What criterion's macros make has no documentation.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use sdr_spoof_core::simd::Level;
use workload::{synthesizer, PER_MS};

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
