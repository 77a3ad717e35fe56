//! The search without FFTs: one cell at a time, straight from the definition.

use std::f64::consts::TAU;

use super::fft::LANES;
use super::replica::search_rate_hz;
use super::{Input, Job, Search, SPECTRUM_RMS};
use crate::dsp::raw::RawSamples;
use crate::sample::SampleFormat;
use crate::signal::{find, SignalSpec};
use crate::C64;

/// Power of the cell, summed over the blocks.
fn cell(search: &Search, prn: u16, bin: i64, lag: usize) -> f64 {
    let code = search.replicas.samples(prn).unwrap();
    let (common, zone) = (&search.common, search.zone(bin).unwrap());
    let step = (bin - zone.centre) as f64 / 2.0 / common.period as f64;
    let period = common.period as i64;
    (0..common.blocks)
        .map(|k| {
            let drift = zone.drift(common, bin, k).round() as i64;
            let from = k * common.period + (lag as i64 + drift).rem_euclid(period) as usize;
            let sum: C64 = code
                .iter()
                .zip(&zone.samples[from..])
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
    Search::new(spec, input, blocks, -110..=1010, 1).unwrap()
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
        let period = search.common.period;
        let code = search.code(prn).unwrap();
        // The inverse transform is not normalised, and both spectra are scaled.
        let size = search.plan.size() as f64;
        let scale = f64::from(SPECTRUM_RMS).powi(2) / (size * period as f64).sqrt() * size;
        for bin in [-105, -3, 0, 1, 100, 1000] {
            let pair = search.pair(&code, bin).unwrap();
            let row = search.with_worker(|w| w.fill_row(pair, bin).to_vec());
            assert_eq!(row.len(), period);
            for lag in [0, 1, LANES - 1, 1023, period - 1] {
                let want = cell(&search, prn, bin, lag);
                let got = f64::from(row[lag]) / scale.powi(2);
                let noise = (blocks * period) as f64;
                assert!(
                    (got - want).abs() < 2e-3 * (want + noise),
                    "{id} {bin} {lag} {got} {want}"
                );
            }
        }
    }
}

#[test]
fn any_cut_of_the_doppler_range_gives_the_same_peak() {
    let bytes = noise(2 * 5_000 * 40);
    let search = search(find("B1CP").unwrap(), &bytes, 2);
    // Through three zones, in parts of 16 bins.
    let whole = Job {
        prn: 33,
        low: -20,
        high: 500,
    };
    let peak = search.run(&[whole]).unwrap()[0];
    let bin = (peak.doppler_hz / search.doppler_bin_hz()).round() as i64;
    for (below, above) in [(0, 1), (1, 0), (7, 30)] {
        let part = Job {
            low: bin - below,
            high: bin + above,
            ..whole
        };
        let again = search.run(&[part]).unwrap()[0];
        let delay = again.code_delay_s - peak.code_delay_s;
        assert!(
            (again.doppler_hz - peak.doppler_hz).abs() < 3.0,
            "{again:?} {peak:?}"
        );
        assert!(
            delay.abs() * search_rate_hz(search.common.spec) < 0.1,
            "{again:?} {peak:?}"
        );
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
    let lag = (peak.code_delay_s * search_rate_hz(search.common.spec)).round() as i64;
    let bin = (peak.doppler_hz / search.doppler_bin_hz()).round() as i64;
    let near: Vec<(i64, i64)> = (-1..=1)
        .flat_map(|b| (-1..=1).map(move |l| (b, l)))
        .collect();
    let top = near
        .iter()
        .map(|(b, l)| cell(&search, 30, bin + b, (lag + l).rem_euclid(2048) as usize))
        .fold(0.0, f64::max);
    // Mean power of a cell in noise of unit power: the energy of the replica.
    let code = search.replicas.samples(30).unwrap();
    let energy: f64 = code.iter().map(|v| f64::from(v.norm_sqr())).sum();
    let expected = 2.0 * top / energy;
    assert!(
        (peak.statistic / expected - 1.0).abs() < 0.05,
        "{peak:?} {expected}"
    );
}
