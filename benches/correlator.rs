//! One channel on a band that is already summed, one slice of 1 ms: each kind of channel with 1 to 16 taps on
//! the raster of 8 samples, and 5 taps beside each other, which share no load; at each level of
//! vector instructions. Counts samples of the recording.
//!
//! The sums of a millisecond, 1 MB, are more than the receiver keeps at a time, so that figures are
//! a little worse than in the engine.

// What criterion's macros make has no documentation.
#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use criterion::{criterion_group, criterion_main, BatchSize, BenchmarkId, Criterion, Throughput};
use sdr_spoof_core::dsp::band::{Band, Layout, Samples};
use sdr_spoof_core::simd::Level;
use workload::{channel, frequency, noise, replica, Kind, KINDS, PER_MS, REACH};

/// Samples that hold a slice, its start and its taps: they fill a ring of 2^17 sums.
const SAMPLES: usize = (1 << 17) - 256;
const LAYOUT: Layout = Layout {
    complex: false,
    conjugate: false,
};

/// Offsets of taps this far apart, about the prompt.
fn taps(count: i64, step: i64) -> Vec<i64> {
    (0..count).map(|tap| (tap - count / 2) * step).collect()
}

/// A band that holds what the channels need.
fn band(kind: &Kind, level: Level) -> Band {
    let mut band = Band::new(frequency(kind), LAYOUT, 0, 1 << 17, level);
    band.feed(Samples::Int8(&noise(SAMPLES)));
    band
}

fn correlator(c: &mut Criterion) {
    let mut group = c.benchmark_group("channel");
    group.throughput(Throughput::Elements(PER_MS as u64));
    let sets = [(1, 8), (5, 8), (8, 8), (9, 8), (16, 8), (5, 1)];
    for kind in KINDS {
        let replica = replica(&kind, 0);
        for level in Level::available() {
            let band = band(&kind, level);
            for (count, step) in sets {
                let taps = taps(count, step);
                assert!(taps.iter().all(|t| t.unsigned_abs() as usize <= REACH));
                let start = || channel(&kind, 0, Arc::clone(&replica), &taps);
                assert!(start().advance(&band).is_some(), "the band holds a slice");
                let name = format!("{}, {count} taps {step} apart", kind.name);
                group.bench_function(BenchmarkId::new(name, level.name()), |b| {
                    b.iter_batched_ref(
                        start,
                        |channel| black_box(channel.advance(&band).is_some()),
                        BatchSize::LargeInput,
                    )
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, correlator);
criterion_main!(benches);
