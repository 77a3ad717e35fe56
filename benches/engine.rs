//! The correlator engine as a whole, one thread: W1, W2 and their parts by themselves, at each
//! level of vector instructions. Counts samples of the recording: real time is 120 Melem/s.
//! Every channel is under way before timing begins.

// What criterion's macros make has no documentation.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use sdr_spoof_core::simd::Level;
use workload::{engine, noise, run, KINDS, PER_MS, TAPS, WORKLOADS};

fn engines(c: &mut Criterion) {
    let samples = noise(20 * PER_MS);
    let mut group = c.benchmark_group("engine, 12 satellites");
    group.throughput(Throughput::Elements(samples.len() as u64));
    let whole = WORKLOADS.iter().map(|(name, kinds)| (*name, &kinds[..]));
    let parts = KINDS.iter().map(|k| (k.name, std::slice::from_ref(k)));
    for (name, kinds) in whole.chain(parts) {
        for level in Level::available() {
            let mut engine = engine(kinds, &TAPS, level, &samples);
            group.bench_function(BenchmarkId::new(name, level.name()), |b| {
                b.iter(|| run(&mut engine, black_box(&samples)))
            });
        }
    }
    group.finish();
}

criterion_group!(benches, engines);
criterion_main!(benches);
