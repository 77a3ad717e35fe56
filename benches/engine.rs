//! quick
#![allow(missing_docs)]
use sdr_spoof_core::dsp::correlator::Correlator;
use sdr_spoof_core::dsp::engine::Engine;
use sdr_spoof_core::dsp::front_end::Stream;
use sdr_spoof_core::dsp::replica::Replica;
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::signal::{self, Modulation};
use sdr_spoof_core::simd::Level;
use std::sync::Arc;
use std::time::Instant;

const FS: f64 = 120e6;
const LO: f64 = 1538.259e6;

fn run(level: Level, mods: &[(&str, Modulation, bool)], taps: &[i64], n: u16, data: &[u8]) -> f64 {
    let stream = Stream {
        format: SampleFormat::parse("ri8").unwrap(),
        conjugate: false,
        float_scale: 1.0,
        start: 0,
    };
    let mut carriers: Vec<f64> = Vec::new();
    for m in mods {
        let c = (signal::find(m.0).unwrap().carrier_hz - LO) / FS;
        if !carriers.contains(&c) {
            carriers.push(c)
        }
    }
    let mut e = Engine::new(
        stream,
        &carriers,
        std::env::var("REACH").map_or(64, |v| v.parse().unwrap()),
        level,
    );
    for (k, &(id, m, comp)) in mods.iter().enumerate() {
        let spec = signal::find(id).unwrap();
        let c = (spec.carrier_hz - LO) / FS;
        let band = carriers.iter().position(|x| *x == c).unwrap();
        for s in 0..n {
            let prn = 19 + 2 * s;
            let mut r = Replica::new(spec, prn, m).unwrap();
            if comp {
                r = r
                    .with_companion(spec, signal::find("B1CD").unwrap(), prn)
                    .unwrap();
            }
            let mut ch =
                Correlator::new(Arc::new(r), taps, 0, 100.3 + 777.7 * (s as f64 + k as f64));
            let d = -4000.0 + 8000.0 * s as f64 / n as f64;
            ch.set_rates(
                d / FS,
                FS / (spec.chip_rate_hz * (1.0 + d / spec.carrier_hz)),
            );
            e.attach(band, ch);
        }
    }
    let mut best = f64::MAX;
    let mut slices = 0;
    for _ in 0..30 {
        let t = Instant::now();
        e.feed(data, |_, _, _| slices += 1);
        best = best.min(t.elapsed().as_secs_f64());
    }
    assert!(n == 0 || slices > 0);
    best / (data.len() as f64 / FS * 1e3) * 1e6
}
fn main() {
    let mut z = 1u32;
    let data: Vec<u8> = (0..2_400_000)
        .map(|_| {
            z = z.wrapping_mul(1664525).wrapping_add(1013904223);
            (z >> 26) as u8
        })
        .collect();
    use Modulation::*;
    let five = [-16, -8, 0, 8, 16];
    if let Ok(which) = std::env::var("ONLY") {
        let pilot = if which == "W2" { Qmboc } else { Boc11 };
        for _ in 0..10 {
            let us = run(
                Level::Avx512,
                &[("B1I", Bpsk, false), ("B1CP", pilot, which == "W2")],
                &five,
                12,
                &data,
            );
            println!("{us:.1} us/ms");
        }
        return;
    }
    for level in Level::available().into_iter().rev() {
        let r = |name: &str, us: f64| println!("{level:?} {name}: {us:.1} us/ms, {:.1}x", 1e3 / us);
        r(
            "front ends",
            run(
                level,
                &[("B1I", Bpsk, false), ("B1CP", Boc11, false)],
                &five,
                0,
                &data,
            ),
        );
        r(
            "B1I x12",
            run(level, &[("B1I", Bpsk, false)], &five, 12, &data),
        );
        r(
            "B1C11 x12",
            run(level, &[("B1CP", Boc11, false)], &five, 12, &data),
        );
        r(
            "W1",
            run(
                level,
                &[("B1I", Bpsk, false), ("B1CP", Boc11, false)],
                &five,
                12,
                &data,
            ),
        );
        r(
            "W2",
            run(
                level,
                &[("B1I", Bpsk, false), ("B1CP", Qmboc, true)],
                &five,
                12,
                &data,
            ),
        );
        r(
            "W2 3 tap groups",
            run(
                level,
                &[("B1I", Bpsk, false), ("B1CP", Qmboc, true)],
                &[-56, -8, 0, 8, 56, 60],
                12,
                &data,
            ),
        );
    }
}
