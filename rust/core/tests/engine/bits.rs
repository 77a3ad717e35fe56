//! The same bits whatever the processor's level, however samples come, at full scale, and where
//! indices and sums wrap.

use proptest::prelude::*;
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::C64;

use crate::format::{noise, Format, FORMATS};
use crate::kinds::KINDS;
use crate::reference::Heard;
use crate::scenario::{Closed, Op, Plan, Scenario, Step};

/// Groups of four samples at a time that cuts are tried at: a few, less than a block, a prime
/// number, more than a ring.
const CUTS: [usize; 4] = [3, 31, 1009, 20_000];

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        2 => Just(Step::Keep),
        4 => (-0.01..0.01, 4.0..24.0).prop_map(|(f, s)| Step::Rates(f, s)),
        1 => (-300.0..3000.0).prop_map(Step::Code),
        1 => (-9.0..9.0).prop_map(Step::Carrier),
    ]
}

prop_compose! {
    fn plan(bands: usize)(
        kind in 0..KINDS.len(),
        band in 0..bands,
        taps in prop::collection::vec((-200..200i64, any::<bool>()), 0..9),
        index in 0..30usize,
        start in -200.0..9000.0,
        carrier in -0.01..0.01,
        samples_per_chip in 4.0..24.0,
        steps in prop::collection::vec(step(), 0..4),
    ) -> Plan {
        // One at least is not an outer one.
        let taps = taps.into_iter().chain([(0, false)]);
        let (taps, outer) = taps.unzip();
        Plan { kind, band, taps, outer, index, start, carrier, samples_per_chip, steps }
    }
}

fn op(bands: usize) -> impl Strategy<Value = Op> {
    prop_oneof![
        6 => (1..6000usize).prop_map(Op::Feed),
        2 => plan(bands).prop_map(Op::Attach),
        1 => (0..4usize).prop_map(Op::Detach),
        2 => (0..4usize).prop_map(Op::PutBack),
        2 => (0..bands, -2e-3..2e-3).prop_map(|(b, f)| Op::Retune(b, f)),
    ]
}

/// Channels attached at the beginning and in the middle, taken out and put back, and oscillators
/// retuned, between feeds of any length.
fn scenario() -> impl Strategy<Value = Scenario> {
    let origin = prop_oneof![0..1000u64, (1 << 40) - 20_000..(1 << 40) + 20_000u64];
    let head = (
        0..FORMATS.len(),
        origin,
        prop::collection::vec(-0.5..0.5, 1..3),
    );
    head.prop_flat_map(|(format, origin, frequencies)| {
        let bands = frequencies.len();
        let first = prop::collection::vec(plan(bands).prop_map(Op::Attach), 1..3);
        let ops = prop::collection::vec(op(bands), 4..16);
        (first, ops).prop_map(move |(first, ops)| Scenario {
            format: FORMATS[format],
            origin,
            frequencies: frequencies.clone(),
            reach: 200,
            ops: first.into_iter().chain(ops).collect(),
        })
    })
}

/// Random bytes, a fifth of them saturated.
fn bytes(count: usize) -> Vec<u8> {
    let byte = |k: u64| match noise(k) {
        value if value > 0.6 => 0x80,
        value => (value * 200.0) as i64 as u8,
    };
    (0..count as u64).map(byte).collect()
}

/// Plays a scenario at every level, cut after each of these; the slices, if they are the same
/// bits.
fn played(scenario: &Scenario, bytes: &[u8], cuts: &[usize]) -> Vec<Vec<Closed>> {
    let whole = scenario.play(bytes, usize::MAX / 64, Level::Portable);
    for level in Level::available() {
        for &cut in cuts {
            let got = scenario.play(bytes, cut, level);
            assert!(got == whole, "{level:?}, cut {cut}: {scenario:?}");
        }
    }
    whole
}

proptest! {
    #![proptest_config(crate::config(48))]

    #[test]
    fn cuts_and_levels_do_not_matter(scenario in scenario()) {
        played(&scenario, &bytes(600_000), &CUTS);
    }
}

/// A channel on a recording of one band at 0 Hz: an outer tap on the prompt, and others.
fn alone(kind: usize, name: &'static str, conjugate: bool, samples_per_chip: f64) -> Scenario {
    let plan = Plan {
        kind,
        band: 0,
        taps: vec![0, -40, -8, 8, 13],
        outer: vec![true, true, false, false, false],
        index: 0,
        start: 100.3,
        carrier: 0.0,
        samples_per_chip,
        steps: Vec::new(),
    };
    Scenario {
        format: Format {
            name,
            conjugate,
            signal: 0.0,
            noise: 0.0,
        },
        origin: 0,
        frequencies: vec![0.0],
        reach: 40,
        ops: vec![Op::Attach(plan), Op::Feed(usize::MAX / 64)],
    }
}

/// The farthest that sums can go: a signal of full scale that the replica matches, on 0 Hz, at
/// rates at which the groups of runs are as long as they may be.
#[test]
fn full_scale_stays_within_32_bits() {
    for (kind, of) in KINDS.iter().enumerate() {
        for samples_per_chip in [117.3, 500.0] {
            let scenario = alone(kind, "ci16", false, samples_per_chip);
            let Op::Attach(plan) = &scenario.ops[0] else {
                panic!("no channel")
            };
            let heard = Heard {
                samples: &[],
                origin: 0,
                intermediate: 0.0,
            };
            let [replica, _] = heard.replicas(of, &plan.begun(0), true);
            let replica = replica.unwrap();
            let count = (of.chips() * samples_per_chip + 200.0) as usize;
            // I and Q alike, so that the carrier's 0 Hz is not all that keeps them small.
            let sample = |k: usize| C64::new(1.0, 1.0) * replica.wave(k as f64).re * 32767.0;
            let bytes = scenario
                .format
                .bytes((0..count.next_multiple_of(4)).map(sample));
            let slices = &scenario.play(&bytes, 9000, Level::best())[0];
            let Closed { slice, .. } = &slices[0];
            let expected = C64::new(1.0, 1.0) * 32767.0 * slice.samples as f64;
            let miss = (slice.taps[0] / expected - 1.0).norm();
            assert!(miss < 0.007, "{} at {samples_per_chip}: {miss}", of.name);
        }
    }
}

/// Minus full scale throughout, which has no positive counterpart. 32 bits of a running sum of
/// bytes wrap every 264 000 samples, of 16-bit samples every 16 500.
#[test]
fn saturated_samples_wrap_the_sums() {
    for name in ["ri8", "ci8", "ri16", "ci16"] {
        for conjugate in [false, true] {
            let scenario = alone(1, name, conjugate, 20.2);
            let low = if name.ends_with("16") { 0 } else { 0x80 };
            let bytes: Vec<u8> = [low, 0x80].into_iter().cycle().take(900_000).collect();
            let slices = &played(&scenario, &bytes, &[1009])[0];
            let samples = scenario.format.samples(&bytes);
            let heard = Heard {
                samples: &samples,
                origin: 0,
                intermediate: 0.0,
            };
            // All after the first wrap.
            for Closed { begun, slice } in &slices[slices.len() - 2..] {
                assert!(name != "ri8" || slice.start > 300_000);
                let (taps, _) = heard.slice(1, begun, &[13], &[false]);
                let miss = (slice.taps[4] - taps[0]).norm() / samples[0].norm();
                // Of 20 000 samples.
                assert!(
                    miss < 20.0,
                    "{name} {conjugate}: {} {}",
                    slice.taps[4],
                    taps[0]
                );
            }
        }
    }
}

/// A channel that is attached later than it begins, and after the oscillator was retuned, before
/// that or after, gives what it would have given had it been there.
#[test]
fn a_channel_may_come_after_a_retuning() {
    let bytes = bytes(100_000);
    for (taps, retuned) in [
        ([0, -8], -700),
        ([0, -8], 0),
        ([0, 300], 900),
        ([5, 0], 1400),
    ] {
        let plan = Plan {
            kind: 1,
            band: 0,
            taps: taps.to_vec(),
            outer: vec![false; 2],
            index: 0,
            start: 0.0,
            carrier: 2e-4,
            samples_per_chip: 11.3,
            steps: Vec::new(),
        };
        let play = |late: bool| {
            let mut plan = plan.clone();
            // Of the groups of four samples that are fed.
            let (begin, retuning, end) = (2000, (8000 + retuned) as usize / 4, 2500);
            plan.start = 4.0
                * if late {
                    begin as f64 - end as f64
                } else {
                    begin as f64
                };
            let attach = Op::Attach(plan);
            let mut ops = vec![
                Op::Feed(retuning),
                Op::Retune(0, 1e-3),
                Op::Feed(end - retuning),
            ];
            ops.insert(if late { 3 } else { 0 }, attach);
            ops.push(Op::Feed(20_000));
            let scenario = Scenario {
                format: FORMATS[0],
                origin: 0,
                frequencies: vec![0.13],
                reach: 3000,
                ops,
            };
            scenario.play(&bytes, usize::MAX / 64, Level::best())
        };
        let early = play(false);
        assert!(early[0].len() > 3);
        assert!(
            play(true) == early,
            "retuned {retuned} samples after the start"
        );
    }
}
