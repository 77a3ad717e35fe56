//! The output is a pure function of the sample index.

use sdr_spoof_core::simd::Level;
use std::sync::Arc;

use sdr_spoof_core::synth::{
    Data, Drive, Emitter, Filter, GainControl, GainSettings, Profile, SynthConfig, Synthesizer,
};

use crate::reference::{config, emitter};

fn scene() -> Vec<Emitter> {
    let ramp = Profile::new(vec![(0.0, -10.0), (1.0, 5.0)]).unwrap();
    let mut emitters = Vec::new();
    for (signal, prn) in [("B1I", 19), ("B1CD", 27), ("B1CP", 27)] {
        emitters.push(Emitter {
            delay_s: 0.0712,
            doppler_hz: 1234.5,
            data: Data::Seeded(3),
            power_db: ramp.clone(),
            start_s: 0.0003,
            ..emitter(signal, prn, 55.0)
        });
    }
    emitters
}

fn with_filter(format: &str, threads: usize) -> Synthesizer {
    let mut config = SynthConfig {
        noise: true,
        threads,
        ..config(format, 120e6, 1538.259e6)
    };
    let complex = config.format.is_complex();
    let centre = if complex { 0.0833 } else { 0.25 };
    config.noise_rms_lsb = if format.ends_with('2') { 2.0 } else { 16.0 };
    config.filter = Some(Filter::new(centre, 0.4, 63, complex).unwrap());
    if complex {
        config.lo_hz = 1560e6;
    }
    Synthesizer::new(config, scene()).unwrap()
}

/// Noise that rises, and a gain that follows it.
fn with_gain(format: &str, threads: usize) -> Synthesizer {
    let noise_db = Profile::new(vec![(0.0, 0.0), (4e-4, 0.0), (4e-4, 12.0)]).unwrap();
    let settings = GainSettings {
        time_constant_s: 1e-4,
        update_s: 1e-5,
        range_db: [-40.0, 20.0],
        duration_s: 1e-3,
    };
    let plan = config(format, 120e6, 1538.259e6);
    let gain = GainControl::new(&plan, settings, &scene(), &noise_db).unwrap();
    with_filter(format, threads).driven(Drive {
        noise_db,
        gain: Some(Arc::new(gain)),
    })
}

#[test]
fn neither_cuts_nor_threads_matter() {
    for format in ["ri8", "ci8", "ri16", "cf32", "r2", "c2"] {
        cuts_and_threads(format, &with_filter(format, 1), &with_filter(format, 3));
        cuts_and_threads(format, &with_gain(format, 1), &with_gain(format, 3));
    }
}

fn cuts_and_threads(format: &str, one: &Synthesizer, three: &Synthesizer) {
    for origin in [0u64, (1 << 35) + 4] {
        let count = 100_000;
        let whole = one.generate(origin, count).unwrap();
        assert!(
            whole == three.generate(origin, count).unwrap(),
            "{format}: threads"
        );
        let mut joined = Vec::new();
        let mut at = 0;
        for length in [4, 120, 16_384, 30_000, 36, 53_456] {
            joined.extend(three.generate(origin + at, length).unwrap());
            at += length as u64;
        }
        assert_eq!(at, count as u64);
        assert!(joined == whole, "{format}: cuts");
    }
}

#[test]
fn the_vector_instructions_do_not_matter() {
    for format in ["ri8", "ci8", "ri16", "cf32", "r2", "c2"] {
        let portable = with_filter(format, 2).at_level(Level::Portable);
        let expected = portable.generate((1 << 35) + 4, 100_000).unwrap();
        for level in Level::available() {
            let synth = with_filter(format, 2).at_level(level);
            let seen = synth.generate((1 << 35) + 4, 100_000).unwrap();
            assert!(seen == expected, "{format}: {level:?}");
        }
    }
}

/// Figures in the documentation come from such samples: they change only on purpose.
#[test]
fn samples_are_those_of_all_versions() {
    let sum = |format: &str| {
        let bytes = with_filter(format, 0).generate(50_000, 200_000).unwrap();
        // Fowler-Noll-Vo 1a
        bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    };
    assert_eq!(
        [sum("ri8"), sum("ci8")],
        [4704628505548791446, 6161967029060096287]
    );
}

#[test]
fn another_seed_is_another_noise() {
    let make = |seed| {
        let config = SynthConfig {
            noise: true,
            seed,
            noise_rms_lsb: 16.0,
            ..config("ri8", 1e6, 0.0)
        };
        Synthesizer::new(config, vec![])
            .unwrap()
            .generate(0, 1000)
            .unwrap()
    };
    assert_eq!(make(1), make(1));
    assert_ne!(make(1), make(2));
}

#[test]
fn two_bit_samples_begin_on_a_byte() {
    let synth = with_filter("r2", 1);
    assert!(synth
        .generate(2, 4)
        .unwrap_err()
        .to_string()
        .contains("whole byte"));
    assert!(synth.generate(4, 3).is_err());
    assert_eq!(with_filter("c2", 1).generate(2, 2).unwrap().len(), 1);
    assert!(synth.generate(4, 0).unwrap().is_empty());
}
