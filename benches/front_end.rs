//! The front end of one band (once per band, whatever the satellites): each sample format with
//! kernels of its own, at each level of vector instructions. Counts samples of the recording.

// What criterion's macros make has no documentation.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use sdr_spoof_core::dsp::front_end::FrontEnd;
use sdr_spoof_core::simd::Level;
use workload::{frequency, noise, stream, B1I, PER_MS, REACH};

fn front_end(c: &mut Criterion) {
    let mut group = c.benchmark_group("front end, one band");
    let samples = 2 * PER_MS;
    group.throughput(Throughput::Elements(samples as u64));
    for format in ["ri8", "ci8", "ri16", "ci16", "r2", "c2"] {
        let stream = stream(format);
        let bytes = noise(samples * stream.format.bits_per_sample() / 8);
        for level in Level::available() {
            let history = FrontEnd::history(REACH);
            let mut front = FrontEnd::new(stream, &[frequency(&B1I)], history, level);
            group.bench_function(BenchmarkId::new(format, level.name()), |b| {
                b.iter(|| front.feed(black_box(&bytes), |bands| assert_eq!(bands.len(), 1)))
            });
        }
    }
    group.finish();
}

criterion_group!(benches, front_end);
criterion_main!(benches);
