//! Strapdown navigation: 100 IMUs over 1750 s at 100 Hz by their share of 50 s, with and without
//! noise, in local and in Earth-fixed axes, all threads. Counts increments: the whole is
//! 17.5 million.

// What criterion's macros make has no documentation.
#![allow(missing_docs)]

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use sdr_spoof_core::inertial::batch::{self, Mechanisation, Plan, Run, COLUMNS};
use workload::inertial::{imu, increments, plan};

const SECONDS: usize = 50;
const RUNS: usize = 8;

fn navigation(c: &mut Criterion) {
    let mut group = c.benchmark_group("navigation");
    let increments = increments(SECONDS);
    group.throughput(Throughput::Elements((RUNS * increments.len()) as u64));
    group.sample_size(20);
    for (name, errors) in [("ideal", None), ("noise", Some((imu(), 0)))] {
        for mechanisation in [Mechanisation::Local, Mechanisation::EarthFixed] {
            let plan = Plan {
                mechanisation,
                ..plan(&increments)
            };
            let run = Run {
                errors,
                alignments: &[],
            };
            let mut out = vec![0.0; COLUMNS * plan.rows() * RUNS];
            let setting = format!("{mechanisation:?}");
            group.bench_function(BenchmarkId::new(name, setting), |b| {
                b.iter(|| batch::navigate(&plan, &[run; RUNS], &mut out));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, navigation);
criterion_main!(benches);
