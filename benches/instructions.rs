//! A fixed workload for counting instructions: `instructions WORKLOAD TIMES`; and
//! `instructions levels` lists the levels of vector instructions.
//!
//! Set-up is the same however often the work is repeated, so that the difference between two
//! counts is the work alone. `benches/instructions.py` counts and compares.

use std::process::ExitCode;

use sdr_spoof_core::acquire::{Input, Job, Search};
use sdr_spoof_core::dsp::raw::RawSamples;
use sdr_spoof_core::inertial::batch::{self, Run, COLUMNS};
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::signal;
use sdr_spoof_core::simd::Level;
use workload::inertial::{imu, increments, plan};
use workload::{engine, noise, run, synthesizer, LO_HZ, PER_MS, PRNS, RATE_HZ, TAPS, WORKLOADS};

const ENGINE_MS: usize = 20;
const SYNTHESIS_SAMPLES: usize = 1 << 17;
/// Code periods summed in the search, as by default.
const BLOCKS: usize = 20;
const INERTIAL_S: usize = 20;
const INERTIAL_RUNS: usize = 4;
/// Doppler bins of the search, +-5 kHz.
const BINS: i64 = 10;

/// 12 satellites in both bands, one thread.
fn correlate(workload: &str, times: usize) {
    let kinds = WORKLOADS.iter().find(|w| w.0 == workload);
    let (_, kinds) = kinds.expect("one of the workloads");
    let samples = noise(ENGINE_MS * PER_MS);
    let mut engine = engine(kinds, &TAPS, Level::best(), &samples);
    for _ in 0..times {
        assert!(run(&mut engine, &samples) > 0);
    }
}

/// The blind search for B1I of one satellite, samples prepared anew each time.
fn acquire(times: usize) {
    let spec = signal::find("B1I").expect("registered");
    let bytes = noise((BLOCKS + 2) * PER_MS);
    let raw = RawSamples {
        bytes: &bytes,
        format: SampleFormat::parse("ri8").expect("a known format"),
        scale: 1.0,
        conjugate: false,
    };
    let input = Input {
        raw,
        sample_rate_hz: RATE_HZ,
        first: PER_MS / 2,
        if_hz: spec.carrier_hz - LO_HZ,
    };
    let job = Job {
        prn: PRNS[0],
        low: -BINS,
        high: BINS,
    };
    for _ in 0..times {
        let search = Search::new(spec, input, BLOCKS, -BINS..=BINS, 1).expect("samples to search");
        assert_eq!(search.run(&[job]).expect("transmitted").len(), 1);
    }
}

/// 24 emitters and noise.
fn synthesise(times: usize) {
    let synthesizer = synthesizer(&["B1I", "B1CP"], false, 1);
    for k in 0..times {
        let start = (k * SYNTHESIS_SAMPLES) as u64;
        let bytes = synthesizer.generate(start, SYNTHESIS_SAMPLES);
        assert_eq!(bytes.expect("whole bytes").len(), SYNTHESIS_SAMPLES);
    }
}

/// 20 s of four IMUs with noise.
fn navigate(times: usize) {
    let increments = increments(INERTIAL_S);
    let plan = plan(&increments);
    let errors = [Some((imu(), 0)); INERTIAL_RUNS];
    let runs = errors.map(|errors| Run {
        errors,
        alignments: &[],
    });
    let mut out = vec![0.0; COLUMNS * plan.rows() * INERTIAL_RUNS];
    for _ in 0..times {
        batch::navigate(&plan, &runs, &mut out);
        assert!(out.iter().all(|v| v.is_finite()));
    }
}

fn number(text: &str) -> usize {
    text.parse().expect("a number of repetitions")
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["levels"] => Level::available()
            .iter()
            .for_each(|l| println!("{}", l.name())),
        ["acquisition", times] => acquire(number(times)),
        ["synthesis", times] => synthesise(number(times)),
        ["inertial", times] => navigate(number(times)),
        [workload, times] => correlate(workload, number(times)),
        _ => {
            eprintln!("usage: instructions levels | instructions WORKLOAD TIMES");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
