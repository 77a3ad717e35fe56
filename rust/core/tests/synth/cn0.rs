//! C/N0 of the output, measured by correlation.

use num_complex::Complex64;
use sdr_spoof_core::synth::{Data, Emitter, Filter, SynthConfig, Synthesizer};

use crate::reference::{config, emitter, samples, Reference};

/// Strong enough that the mean is known to 0.01 dB, weak enough to stay well below the noise.
const CN0_DBHZ: f64 = 54.0;

/// Loss of the optimum 4-level quantiser on white noise: 0.8825 (Max 1960, table I: 1 - 0.1175).
const TWO_BIT_LOSS_DB: f64 = 0.543;

/// C/N0 from the mean and the variance of many short correlations.
///
/// `blocks` correlations make the standard error of the variance 1/sqrt(blocks), so 40 000 blocks
/// keep 4 standard errors at 0.09 dB.
fn measure(config: &SynthConfig, e: &Emitter, block: usize, blocks: usize) -> f64 {
    let synth = Synthesizer::new(config.clone(), vec![e.clone()]).unwrap();
    let reference = Reference::new(e, config);
    let mut prompts = Vec::new();
    let per_call = 1000;
    for call in 0..blocks / per_call {
        let start = (call * per_call * block) as u64;
        let x = samples(config, &synth.generate(start, per_call * block).unwrap());
        for (b, x) in x.chunks_exact(block).enumerate() {
            let at = start + (b * block) as u64;
            let pairs = x.iter().enumerate();
            let sum: Complex64 = pairs
                .map(|(k, v)| v * reference.sample(at + k as u64).0.conj())
                .sum();
            prompts.push(sum);
        }
    }
    let n = prompts.len() as f64;
    let mean = prompts.iter().sum::<Complex64>() / n;
    let variance = prompts.iter().map(|p| (p - mean).norm_sqr()).sum::<f64>() / (n - 1.0);
    let integration_s = block as f64 / config.sample_rate_hz;
    10.0 * (mean.norm_sqr() / variance / integration_s).log10()
}

fn check(config: &SynthConfig, signal: &str, prn: u16, loss_db: f64) {
    let e = Emitter {
        delay_s: 0.07,
        doppler_hz: 987.0,
        data: Data::Seeded(1),
        ..emitter(signal, prn, CN0_DBHZ)
    };
    let seen = measure(config, &e, 401, 40_000);
    let expected = CN0_DBHZ - loss_db;
    assert!(
        (seen - expected).abs() < 0.1,
        "{signal} {:?}: {seen} dB-Hz",
        config.format
    );
}

fn noisy(format: &str, sample_rate_hz: f64, lo_hz: f64, rms: f64) -> SynthConfig {
    SynthConfig {
        noise: true,
        noise_rms_lsb: rms,
        ..config(format, sample_rate_hz, lo_hz)
    }
}

#[test]
fn every_signal_complex() {
    for (signal, prn) in [("B1CP", 27), ("L1CA", 5)] {
        check(&noisy("ci8", 6.25e6, 1575e6, 16.0), signal, prn, 0.0);
    }
    check(&noisy("ci16", 6.25e6, 1561e6, 300.0), "B1I", 19, 0.0);
}

#[test]
fn every_signal_real() {
    for (signal, prn) in [("B1CD", 27), ("B1CP", 27)] {
        check(&noisy("ri8", 12.5e6, 1572.3e6, 16.0), signal, prn, 0.0);
    }
    check(&noisy("ri8", 12.5e6, 1558.0e6, 16.0), "B1I", 19, 0.0);
}

#[test]
fn two_bits_lose_what_theory_says() {
    check(
        &noisy("c2", 6.25e6, 1561e6, 2.0),
        "B1I",
        19,
        TWO_BIT_LOSS_DB,
    );
    check(
        &noisy("r2", 12.5e6, 1572.3e6, 2.0),
        "B1CD",
        27,
        TWO_BIT_LOSS_DB,
    );
}

/// Signal and noise pass the same filter, so C/N0 changes only by the power cut off the signal:
/// B1I within 12 of the sampled 15 MHz either side loses about 0.7 % (0.03 dB) of it.
#[test]
fn a_filter_keeps_the_cn0_in_its_band() {
    let mut real = noisy("ri8", 60e6, 1546.098e6, 16.0);
    real.filter = Some(Filter::new(0.25, 0.4, 63, false).unwrap());
    check(&real, "B1I", 19, 0.03);
    let mut complex = noisy("ci8", 30e6, 1561.098e6, 16.0);
    complex.filter = Some(Filter::new(0.0, 0.8, 63, true).unwrap());
    check(&complex, "B1I", 19, 0.03);
}
