//! The search without FFTs: one cell at a time, straight from the definition.

use std::f64::consts::TAU;

use super::replica::{replica, search_rate_hz};
use super::{Input, Job, Search};
use crate::dsp::resample::RawSamples;
use crate::sample::SampleFormat;
use crate::signal::{find, SignalSpec};
use crate::C64;

/// Power of the cell, summed over the blocks.
fn cell(search: &Search, prn: u16, bin: i64, lag: usize) -> f64 {
    let code = replica(search.spec, prn, search.period).unwrap();
    let step = bin as f64 * search.doppler_bin_hz() / search_rate_hz(search.spec);
    let period = search.period as i64;
    (0..search.blocks)
        .map(|k| {
            let drift = search.drift(bin, k).round() as i64;
            let from = k * search.period + (lag as i64 + drift).rem_euclid(period) as usize;
            let sum: C64 = code
                .iter()
                .zip(&search.samples[from..])
                .enumerate()
                .map(|(n, (r, x))| {
                    let wide = |v: num_complex::Complex32| C64::new(v.re.into(), v.im.into());
                    wide(*x) * wide(*r).conj() * C64::from_polar(1.0, -TAU * step * n as f64)
                })
                .sum();
            sum.norm_sqr()
        })
        .sum()
}

/// Bytes of reproducible noise.
fn noise(count: usize) -> Vec<u8> {
    let mut state = 7u64;
    let mut next = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 56) as u8
    };
    (0..count).map(|_| next()).collect()
}

fn search(spec: &'static SignalSpec, bytes: &[u8], blocks: usize) -> Search {
    let format = SampleFormat::parse("ci8").unwrap();
    let raw = RawSamples {
        bytes,
        format,
        scale: 1.0,
        conjugate: false,
    };
    let input = Input {
        raw,
        sample_rate_hz: 5e6,
        first: 37,
        if_hz: 12e3,
    };
    Search::new(spec, input, blocks, 1).unwrap()
}

#[test]
fn every_cell_is_what_the_definition_says() {
    let bytes = noise(2 * 5_000 * 80);
    for (id, prn, blocks) in [
        ("L1CA", 5, 3),
        ("B1I", 9, 7),
        ("B1I", 9, 1),
        ("B1CP", 20, 2),
    ] {
        let search = search(find(id).unwrap(), &bytes, blocks);
        let code = replica(search.spec, prn, search.period).unwrap();
        let size = (search.span + 1) * search.period;
        let mut code = super::padded_spectrum(&search.forward, &code, size);
        code.iter_mut().for_each(|v| *v = v.conj());
        let mut work = search.work();
        for bin in [-2000, -3, 0, 1, 1500] {
            search.fill_row(&code, bin, &mut work);
            for lag in [0, 1, 1023, search.period - 1] {
                let want = cell(&search, prn, bin, lag);
                // The inverse FFT is not normalised.
                let got = f64::from(work.row[lag]) / (size as f64).powi(2);
                let scale = (blocks * search.period) as f64;
                assert!(
                    (got - want).abs() < 2e-3 * (want + scale),
                    "{id} {bin} {lag} {got} {want}"
                );
            }
        }
    }
}

#[test]
fn the_statistic_is_the_largest_cell_over_the_mean() {
    let bytes = noise(2 * 5_000 * 12);
    let search = search(find("L1CA").unwrap(), &bytes, 4);
    let job = Job {
        prn: 30,
        low: -4,
        high: 5,
    };
    let peak = search.run(&[job]).unwrap()[0];
    assert_eq!(peak.cells, 10 * 2048);
    let lag = (peak.code_delay_s * search_rate_hz(search.spec)).round() as i64;
    let bin = (peak.doppler_hz / search.doppler_bin_hz()).round() as i64;
    let near: Vec<(i64, i64)> = (-1..=1)
        .flat_map(|b| (-1..=1).map(move |l| (b, l)))
        .collect();
    let top = near
        .iter()
        .map(|(b, l)| cell(&search, 30, bin + b, (lag + l).rem_euclid(2048) as usize))
        .fold(0.0, f64::max);
    // Mean power of a cell in noise of unit power: the energy of the replica.
    let code = replica(search.spec, 30, 2048).unwrap();
    let energy: f64 = code.iter().map(|v| f64::from(v.norm_sqr())).sum();
    let expected = 2.0 * top / energy;
    assert!(
        (peak.statistic / expected - 1.0).abs() < 0.05,
        "{peak:?} {expected}"
    );
}
