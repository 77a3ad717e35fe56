//! Noise-free output, sample by sample, against the formula.

use num_complex::Complex64;
use std::sync::Arc;

use sdr_spoof_core::synth::{
    Data, Emitter, Profile, Spline, SynthConfig, Synthesizer, SPEED_OF_LIGHT,
};

use crate::reference::{amplitude, config, emitter, samples, Reference};

/// Compares `count` samples from `start`: every sample away from a code edge within 2 % of the
/// amplitude, and amplitude and phase over all of them much closer.
fn compare(config: &SynthConfig, e: &Emitter, start: u64, count: usize) {
    compare_off_edges(config, e, start, count, 1e-5);
}

fn compare_off_edges(
    config: &SynthConfig,
    e: &Emitter,
    start: u64,
    count: usize,
    tolerance_chips: f64,
) {
    let synth = Synthesizer::new(config.clone(), vec![e.clone()]).unwrap();
    let x = samples(config, &synth.generate(start, count).unwrap());
    let reference = Reference::new(e, config);
    let (mut cross, mut power, mut edges) = (Complex64::ZERO, 0.0, 0);
    let complex = config.format.is_complex();
    for (k, &value) in x.iter().enumerate() {
        let index = start + k as u64;
        let level = e.cn0_at_dbhz(index as f64 / config.sample_rate_hz);
        let (replica, edge) = reference.sample(index);
        let replica = replica * amplitude(config, level);
        let expected = if complex {
            replica
        } else {
            Complex64::new(replica.re, 0.0)
        };
        if edge < tolerance_chips {
            edges += 1; // either side of the edge is right
        } else {
            let error = (value - expected).norm();
            assert!(
                error < 0.02 * amplitude(config, e.cn0_dbhz),
                "{} sample {index}: {value} instead of {expected}",
                e.signal.id
            );
        }
        cross += value * replica.conj() * if complex { 1.0 } else { 2.0 };
        power += replica.norm_sqr();
    }
    assert!(
        edges < 100 + count / 1000,
        "{edges} samples on edges of {count}"
    );
    let ratio = cross / power;
    // 0.002 dB and 0.0002 cycle; a real product leaves a rest at twice the frequency.
    assert!(
        (ratio.norm() - 1.0).abs() < if complex { 2e-4 } else { 2e-3 },
        "{ratio}"
    );
    assert!(
        ratio.arg().abs() < 0.0002 * std::f64::consts::TAU * if complex { 1.0 } else { 5.0 },
        "{ratio}"
    );
}

fn moving(signal: &str, prn: u16) -> Emitter {
    Emitter {
        delay_s: 0.073_412_345,
        phase_cycles: 0.3,
        doppler_hz: -1723.4,
        doppler_rate_hz_s: 0.7,
        data: Data::Seeded(9),
        ..emitter(signal, prn, 50.0)
    }
}

#[test]
fn every_signal_real_and_complex() {
    for (signal, prn) in [
        ("B1I", 19),
        ("B1I", 3),
        ("B1CD", 27),
        ("B1CP", 40),
        ("L1CA", 5),
    ] {
        let e = moving(signal, prn);
        // Starts before the first code period and crosses secondary chips and symbols.
        compare(&config("cf32", 25e6, 1568.259e6), &e, 12_345, 1_500_000);
        compare(&config("rf32", 60e6, 1550e6), &e, 600_001, 1_500_000);
    }
}

#[test]
fn far_into_a_recording() {
    for (signal, prn) in [("B1I", 19), ("B1CP", 40)] {
        let e = Emitter {
            doppler_rate_hz_s: 0.01,
            ..moving(signal, prn)
        };
        compare(&config("cf32", 25e6, 1568.259e6), &e, 1 << 35, 400_000);
    }
}

#[test]
fn any_delay() {
    for delay_s in [-7.3, -0.0051, 0.0, 3.0e-9, 19.2] {
        for (signal, prn) in [("B1I", 30), ("B1CP", 30)] {
            let e = Emitter {
                delay_s,
                ..moving(signal, prn)
            };
            compare(&config("cf32", 20e6, 1568.259e6), &e, 0, 300_000);
        }
    }
}

/// Any part of a code period, either sign; the pilot, which has no data, does not care.
#[test]
fn late_and_wrong_data() {
    for (signal, prn, data_delay_s) in [
        ("B1I", 19, 0.0034),
        ("B1CD", 27, 0.000_123_4),
        ("L1CA", 5, -0.0271),
        ("B1CP", 40, 0.004),
    ] {
        let e = Emitter {
            data_delay_s,
            data_error_rate: 0.3,
            ..moving(signal, prn)
        };
        compare(&config("cf32", 25e6, 1568.259e6), &e, 0, 1_500_000);
    }
}

#[test]
fn so_many_symbols_are_wrong() {
    let right = moving("B1I", 19);
    for rate in [0.0, 0.1, 0.5, 1.0] {
        let e = Emitter {
            data_error_rate: rate,
            ..right.clone()
        };
        let wrong = |k: &i64| e.data_symbol(*k) != right.data_symbol(*k);
        let count = (-5000..5000).filter(wrong).count() as f64;
        let standard_error = (10_000.0 * rate * (1.0 - rate)).sqrt();
        assert!((count - 10_000.0 * rate).abs() <= 4.0 * standard_error);
    }
}

/// A range that grows by 612 m/s and swings by 5 m, and given symbols, of which few are known.
fn with_range(signal: &str, prn: u16) -> Emitter {
    let range = |t: f64| 2.3456e7 + 612.0 * t + 5.0 * (2.0 * t).sin();
    let rate = |t: f64| 612.0 + 10.0 * (2.0 * t).cos();
    let times = (-2..2000).map(|k| f64::from(k) * 0.01);
    let knots = times.map(|t| (t, range(t), rate(t))).collect();
    let symbols: Vec<i8> = (0..900).map(|k| 1 - 2 * (k * k / 7 % 2) as i8).collect();
    Emitter {
        range_m: Some(Arc::new(Spline::new(knots).unwrap())),
        delay_s: -17.5,
        doppler_hz: 0.0,
        doppler_rate_hz_s: 0.0,
        data: Data::Given {
            first_index: 100,
            symbols: symbols.into(),
        },
        ..moving(signal, prn)
    }
}

#[test]
fn ranges_and_given_symbols() {
    for (signal, prn) in [("B1I", 19), ("B1I", 3), ("B1CD", 27), ("B1CP", 40)] {
        let e = with_range(signal, prn);
        compare(&config("cf32", 25e6, 1568.259e6), &e, 12_345, 1_000_000);
        compare(&config("rf32", 60e6, 1550e6), &e, 600_001, 500_000);
        let offsets = Emitter {
            code_offset_m: Profile::new(vec![(0.0, 0.0), (0.1, 20.0)]).unwrap(),
            carrier_offset_hz: Profile::new(vec![(0.0, 3.0)]).unwrap(),
            doppler_hz: -312.5,
            data_delay_s: 0.0034,
            data_error_rate: 0.3,
            ..e
        };
        compare(
            &config("cf32", 25e6, 1568.259e6),
            &offsets,
            12_345,
            1_000_000,
        );
    }
}

/// Phase, delay and Doppler of a range, from their definitions.
#[test]
fn a_range_is_delay_phase_and_doppler() {
    let e = with_range("B1CP", 40);
    let (chip_rate, carrier) = (e.signal.chip_rate_hz, e.signal.carrier_hz);
    for k in 0..900 {
        let t = f64::from(k) * 0.02123;
        // Large numbers in integers of a cycle: 2.3456e7 m are so many cycles and a rest.
        let whole = (2.3456e7 / SPEED_OF_LIGHT * carrier).floor();
        let moved = 612.0 * t + 5.0 * (2.0 * t).sin();
        let rest = 2.3456e7 * carrier / SPEED_OF_LIGHT - whole + moved * carrier / SPEED_OF_LIGHT;
        let phase = e.received_phase_cycles(t) - e.phase_cycles + whole + rest;
        assert!(phase.abs() < 1e-5, "{t}: {phase}");
        let delay = (2.3456e7 + moved) / SPEED_OF_LIGHT - 17.5;
        let chips = e.code_phase_chips(t) - chip_rate * (t - delay);
        assert!(chips.abs() < 1e-6, "{t}: {chips}");
        let doppler = -carrier / SPEED_OF_LIGHT * (612.0 + 10.0 * (2.0 * t).cos());
        assert!((e.carrier_doppler_hz(t) - doppler).abs() < 1e-4, "{t}");
    }
}

#[test]
fn profiles_of_power_code_and_carrier() {
    let profile = |knots: &[(f64, f64)]| Profile::new(knots.to_vec()).unwrap();
    let e = Emitter {
        power_db: profile(&[(0.01, -3.0), (0.05, 1.0)]),
        code_offset_m: profile(&[(0.0, 3.0), (0.03, 0.0), (0.06, -2.0)]),
        carrier_offset_hz: profile(&[(0.01, 0.0), (0.04, 40.0), (0.05, -10.0)]),
        ..moving("B1CD", 27)
    };
    // A knot inside a segment is cut straight: 2 cm here.
    compare_off_edges(&config("cf32", 25e6, 1568.259e6), &e, 0, 2_000_000, 1e-4);
}

#[test]
fn on_and_off_at_the_sample() {
    let config = config("rf32", 20e6, 1555e6);
    let e = Emitter {
        start_s: 0.001,
        end_s: 0.002,
        ..moving("B1I", 19)
    };
    let synth = Synthesizer::new(config.clone(), vec![e]).unwrap();
    let x = samples(&config, &synth.generate(0, 60_000).unwrap());
    let on: Vec<usize> = (0..60_000).filter(|&k| x[k].re != 0.0).collect();
    assert_eq!((on[0], on[on.len() - 1]), (20_000, 39_999));
}

#[test]
fn emitters_add_up() {
    let config = config("cf32", 25e6, 1568.259e6);
    let a = moving("B1CP", 27);
    let opposite = Emitter {
        phase_cycles: a.phase_cycles + 0.5,
        ..a.clone()
    };
    let other = moving("B1I", 19);
    let make = |e: Vec<Emitter>| {
        let synth = Synthesizer::new(config.clone(), e).unwrap();
        samples(&config, &synth.generate(0, 100_000).unwrap())
    };
    let residue = make(vec![a.clone(), opposite]);
    assert!(residue.iter().all(|v| v.norm() < 1e-4));
    let (x, y, both) = (
        make(vec![a.clone()]),
        make(vec![other.clone()]),
        make(vec![a, other]),
    );
    for k in 0..x.len() {
        assert!((x[k] + y[k] - both[k]).norm() < 1e-5);
    }
}

/// Components with the same motion are rendered together, and yet add up to what each is alone:
/// data and pilot of a satellite, and a signal of another system with the same delay.
#[test]
fn components_that_move_as_one_add_up() {
    let config = config("cf32", 50e6, 1568.259e6);
    let motion = |signal: &str, data| Emitter {
        data,
        power_db: Profile::new(vec![(0.0, -3.0), (0.02, 3.0)]).unwrap(),
        start_s: 0.000_7,
        end_s: 0.019,
        ..moving(signal, 27)
    };
    let all = vec![
        motion("B1CD", Data::Seeded(9)),
        motion("B1CP", Data::None),
        motion("L1CA", Data::Seeded(2)),
    ];
    let make = |e: Vec<Emitter>| {
        let synth = Synthesizer::new(config.clone(), e).unwrap();
        samples(&config, &synth.generate(0, 1_000_000).unwrap())
    };
    let alone: Vec<_> = all.iter().map(|e| make(vec![e.clone()])).collect();
    let together = make(all);
    assert!(together.iter().any(|v| v.norm() > 0.0));
    for (k, v) in together.iter().enumerate() {
        let sum: Complex64 = alone.iter().map(|x| x[k]).sum();
        assert!((sum - v).norm() < 1e-6, "sample {k}");
    }
}

#[test]
fn pilot_and_data_are_in_quadrature() {
    // BDS-SIS-ICD-B1C-1.0 section 4.2.1: the BOC(1,1) part of the pilot leads the data by 90
    // degrees, its BOC(6,1) part is in phase with the data.
    let config = config("cf32", 50e6, 1575.42e6);
    let one = |signal: &str| {
        let synth = Synthesizer::new(config.clone(), vec![emitter(signal, 27, 50.0)]).unwrap();
        samples(&config, &synth.generate(0, 500_000).unwrap())
    };
    let (data, pilot) = (one("B1CD"), one("B1CP"));
    let a = amplitude(&config, 50.0);
    assert!(data.iter().all(|v| v.im == 0.0));
    for v in &pilot {
        assert!((v.im.abs() - a * (29.0f64 / 33.0).sqrt()).abs() < 1e-4 * a);
        assert!((v.re.abs() - a * (4.0f64 / 33.0).sqrt()).abs() < 1e-4 * a);
    }
}

#[test]
fn what_cannot_be_made_is_refused() {
    let refused = |e: Emitter, lo_hz: f64| {
        let error = Synthesizer::new(config("ri8", 60e6, lo_hz), vec![e]).err();
        error.map(|e| e.to_string()).unwrap_or_default()
    };
    assert!(refused(emitter("B1I", 19, 45.0), 1600e6).contains("outside the sampled band"));
    assert!(refused(emitter("B1CP", 3, 45.0), 1550e6).contains("no PRN 3"));
    assert!(refused(emitter("B1I", 19, 190.0), 1550e6).contains("amplitudes"));
    let e = Emitter {
        doppler_hz: f64::NAN,
        ..emitter("B1I", 19, 45.0)
    };
    assert!(refused(e, 1550e6).contains("doppler_hz"));
}
