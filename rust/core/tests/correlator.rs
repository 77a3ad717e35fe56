//! The fast correlator against the double-precision reference on the same samples.

use std::sync::Arc;

use sdr_spoof_core::dsp::band::{Band, Layout, Samples};
use sdr_spoof_core::dsp::correlator::Correlator;
use sdr_spoof_core::dsp::reference::ReferenceReplica;
use sdr_spoof_core::dsp::replica::Replica;
use sdr_spoof_core::signal::{self, Modulation};
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::C64;

const TAPS: [i64; 5] = [-12, -5, 0, 5, 12];

/// Deterministic noise in [-1, 1).
fn noise(index: u64) -> f64 {
    let mut z = index
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(0x1234_5678);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

struct Case {
    id: &'static str,
    modulation: Modulation,
    rate: f64,
    intermediate: f64,
    doppler: f64,
    complex: bool,
}

struct Outcome {
    fast: Vec<Vec<C64>>,
    slow: Vec<Vec<C64>>,
}

/// Correlates three slices of a weak signal in noise with both correlators.
fn run(case: &Case, chunk: usize, signal_lsb: f64, noise_lsb: f64) -> Outcome {
    let spec = signal::find(case.id).unwrap();
    let prn = 20;
    let samples_per_chip = case.rate / (spec.chip_rate_hz * (1.0 + case.doppler / spec.carrier_hz));
    let start = 400.37;
    let replica = ReferenceReplica {
        code: spec.code(prn).unwrap(),
        modulation: case.modulation,
        start,
        samples_per_chip,
        frequency: (case.intermediate + case.doppler) / case.rate,
        phase: 0.3,
    };
    // The signal arrives 0.21 cycle ahead of the replica.
    let source = ReferenceReplica {
        phase: 0.3 + 0.21,
        ..replica.clone()
    };
    let total = (start + 3.2e-3 * case.rate) as usize;
    let width = if case.complex { 2 } else { 1 };
    let samples: Vec<i16> = (0..total)
        .flat_map(|k| {
            let wave = source.wave(k as f64) * signal_lsb;
            let n = |c: u64| noise(2 * k as u64 + c) * noise_lsb;
            [wave.re + n(0), wave.im + n(1)].into_iter().take(width)
        })
        .map(|v| v.round() as i16)
        .collect();
    let at = |k: i64| {
        let v = &samples[k as usize * width..][..width];
        C64::new(
            f64::from(v[0]),
            if case.complex { f64::from(v[1]) } else { 0.0 },
        )
    };

    let layout = Layout {
        complex: case.complex,
        conjugate: false,
    };
    let frequency = case.intermediate / case.rate;
    let mut band = Band::new(frequency, layout, 0, 1 << 20, Level::best());
    let fast_replica = Arc::new(Replica::new(spec, prn, case.modulation).unwrap());
    let mut channel = Correlator::new(fast_replica, &TAPS, 0, start);
    channel.set_rates(case.doppler / case.rate, samples_per_chip);
    // Phase of the reference replica at the channel's base, beyond the band's oscillator.
    channel.shift_carrier((replica.phase + case.doppler / case.rate * start.floor()).fract());
    let mut fast = Vec::new();
    for piece in samples.chunks(chunk * width) {
        band.feed(Samples::Int16(piece));
        while let Some(slice) = channel.advance(&band) {
            fast.push(slice.taps.clone());
        }
    }
    let chips = spec.chip_rate_hz * 1e-3;
    let slow = (0..3)
        .map(|s| {
            let from = f64::from(s) * chips;
            TAPS.iter()
                .map(|&t| replica.correlate(at, from, from + chips, t))
                .collect()
        })
        .collect();
    Outcome { fast, slow }
}

fn cases() -> Vec<Case> {
    let case = |id, modulation, rate, intermediate, doppler, complex| Case {
        id,
        modulation,
        rate,
        intermediate,
        doppler,
        complex,
    };
    use Modulation::{Boc11, Bpsk, Qmboc};
    vec![
        case("B1I", Bpsk, 120e6, 22.839e6, 4987.0, false),
        case("B1I", Bpsk, 25e6, -7.161e6, -3210.0, true),
        case("B1CD", Boc11, 120e6, 37.161e6, -4987.0, false),
        case("B1CP", Qmboc, 120e6, 37.161e6, 4987.0, false),
        case("B1CP", Qmboc, 50e6, 7.161e6, 123.0, true),
        case("B1CP", Boc11, 12e6, 3e6, 2500.0, false),
        case("L1CA", Bpsk, 4e6, 0.0, -4100.0, true),
        case("L1CA", Bpsk, 12e6, 3e6, 5000.0, false),
    ]
}

#[test]
fn prompt_loss_below_0_05_db_and_phase_error_below_0_002_cycle() {
    for case in cases() {
        let out = run(&case, 10_000, 20.0, 3.0);
        assert_eq!(out.fast.len(), 3, "{}", case.id);
        let sum = |v: &[Vec<C64>], tap: usize| v.iter().map(|s| s[tap]).sum::<C64>();
        let ratio = sum(&out.fast, 2) / sum(&out.slow, 2);
        let loss_db = -20.0 * ratio.norm().log10();
        let phase = ratio.arg() / std::f64::consts::TAU;
        println!(
            "{} {:?} {:.0} Hz: loss {loss_db:.4} dB, phase {phase:.5} cycle",
            case.id, case.modulation, case.rate
        );
        assert!(loss_db.abs() < 0.05, "{}: loss {loss_db} dB", case.id);
        assert!(phase.abs() < 0.002, "{}: phase {phase} cycle", case.id);
        // The signal's phase lead is measured.
        let lead = sum(&out.fast, 2).arg() / std::f64::consts::TAU;
        assert!((lead - 0.21).abs() < 0.01, "{}: lead {lead}", case.id);
    }
}

#[test]
fn every_tap_agrees_on_noise() {
    // Noise alone: the two correlators must be coherent, tap by tap.
    for case in cases() {
        let out = run(&case, 10_000, 0.0, 40.0);
        for tap in 0..TAPS.len() {
            let (mut cross, mut fast, mut slow) = (C64::default(), 0.0, 0.0);
            for (f, s) in out.fast.iter().zip(&out.slow) {
                cross += f[tap] * s[tap].conj();
                fast += f[tap].norm_sqr();
                slow += s[tap].norm_sqr();
            }
            let coherence = cross.norm() / (fast * slow).sqrt();
            assert!(coherence > 0.99, "{} tap {tap}: {coherence}", case.id);
        }
    }
}

#[test]
fn chunks_of_any_length_give_the_same_bits() {
    let case = &cases()[3];
    let whole = run(case, usize::MAX / 4, 20.0, 30.0).fast;
    for chunk in [1_000, 7_919, 120_000] {
        assert_eq!(run(case, chunk, 20.0, 30.0).fast, whole, "chunk {chunk}");
    }
}
