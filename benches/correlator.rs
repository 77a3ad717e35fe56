//! Speed of the correlator's two parts on 2 ms of noise at 120 Msps:
//! `cargo bench --package sdr_spoof_benches`.
//!
//! - `front end`: one band, real and complex samples; once per band, whatever the satellites;
//! - `correlator`: one channel of each signal with the tracking loops' taps, on a band that is
//!   already summed.
//!
//! Both count samples of the recording. The ring of sums is as long as the tracker's, so that it
//! lies in the same level of cache.

// What criterion's macros make has no documentation.
#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use criterion::{criterion_group, criterion_main, BatchSize, Criterion, Throughput};

use sdr_spoof_core::dsp::band::{Band, Layout, Samples};
use sdr_spoof_core::dsp::correlator::Correlator;
use sdr_spoof_core::dsp::replica::Replica;
use sdr_spoof_core::signal::{self, Modulation};
use sdr_spoof_core::track::taps::Taps;

const RATE_HZ: f64 = 120e6;
const SLICES: usize = 2;
const SAMPLES: usize = 240_000;
const RING: usize = 1 << 18;
const LO_HZ: f64 = 1538.259e6;

/// Numbers in -8..8 from a linear congruence: their values do not matter to the speed.
fn noise(count: usize) -> Vec<i16> {
    let mut z = 1u32;
    (0..count)
        .map(|_| {
            z = z.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (z >> 28) as i16 - 8
        })
        .collect()
}

fn front_end(c: &mut Criterion) {
    let mut group = c.benchmark_group("front end");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    for (name, complex) in [("real", false), ("complex", true)] {
        let samples = noise(SAMPLES * if complex { 2 } else { 1 });
        let mut band = PrefixBand::new(0.19, complex, 0, RING);
        group.bench_function(name, |b| b.iter(|| band.feed(black_box(&samples))));
    }
    group.finish();
}

fn correlator(c: &mut Criterion) {
    let mut group = c.benchmark_group("correlator");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    for (id, modulation) in [
        ("B1I", Modulation::Bpsk),
        ("B1CD", Modulation::Boc11),
        ("B1CP", Modulation::Boc11),
        ("B1CP", Modulation::Qmboc),
        ("L1CA", Modulation::Bpsk),
    ] {
        let spec = signal::find(id).expect("registered");
        let samples_per_chip = RATE_HZ / spec.chip_rate_hz;
        let code = spec.code(20).expect("transmitted");
        let taps = Taps::new(modulation, &code, samples_per_chip);
        let replica = Arc::new(Replica::new(spec, 20, modulation).expect("transmitted"));
        let frequency = (spec.carrier_hz - LO_HZ) / RATE_HZ;
        let start = taps.reach() as f64 + 0.37;
        let mut band = PrefixBand::new(frequency, false, 0, RING);
        band.feed(&noise(SAMPLES + 2 * taps.reach() as usize));
        let channel = || {
            let mut channel = Correlator::new(Arc::clone(&replica), &taps.offsets, 0, start);
            channel.set_rates(1234.5 / RATE_HZ, samples_per_chip);
            channel
        };
        group.bench_function(format!("{id} {modulation:?}"), |b| {
            b.iter_batched_ref(
                channel,
                |channel| {
                    for _ in 0..SLICES {
                        black_box(channel.advance(&band).expect("slices are summed"));
                    }
                },
                BatchSize::SmallInput,
            )
        });
    }
    group.finish();
}

criterion_group!(benches, front_end, correlator);
criterion_main!(benches);
