//! Every tap against the reference on noise, for whatever channels proptest comes up with; and
//! what retuning may change.

use proptest::prelude::*;
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::C64;

use crate::format::{noise, Format, FORMATS};
use crate::kinds::KINDS;
use crate::reference::{Begun, Heard};
use crate::scenario::{Closed, Op, Plan, Scenario, Step};
use crate::setting::Setting;

/// What the correlator may lose by turning groups of runs and not samples, by design.
const TURNING_DB: f64 = 0.025;
const DB: f64 = 20.0 * std::f64::consts::LOG10_E;

/// Rms phase error in radians, by design: the oscillator's 128 cells, dithered, and the turning of
/// the carrier within a group of runs, at most 20 us or what loses [`TURNING_DB`] (half the square
/// of the phase).
fn design_error(kind: usize, begun: &Begun) -> f64 {
    let oscillator = std::f64::consts::TAU / 128.0 / 6f64.sqrt();
    let samples = 20e-3 * KINDS[kind].chips() * begun.samples_per_chip;
    let turning = std::f64::consts::TAU * begun.carrier.abs() * samples / 12f64.sqrt();
    oscillator.hypot(turning.min((2.0 * TURNING_DB / DB).sqrt()))
}

fn format() -> impl Strategy<Value = Format> {
    // Floats are turned into 16 bits.
    prop::sample::select(&FORMATS[..9])
}

/// Any number in a range, or one that puts edges on samples exactly (with sub-chips of 1/24).
fn position(most: f64) -> impl Strategy<Value = f64> {
    let whole = 1..(most / 3.0) as u32;
    prop_oneof![2 => 3.0..most, 1 => whole.prop_map(|n| 3.0 * f64::from(n))]
}

prop_compose! {
    /// Carrier in cycles per sample for up to 50 kHz, and samples per chip.
    fn rates(kind: usize)(hz in -50e3..50e3, samples_per_chip in position(30.0)) -> (f64, f64) {
        (hz * 1e-3 / (KINDS[kind].chips() * samples_per_chip), samples_per_chip)
    }
}

fn step(kind: usize) -> impl Strategy<Value = Step> {
    prop_oneof![
        rates(kind).prop_map(|(f, s)| Step::Rates(f, s)),
        (-30.0..300.0).prop_map(Step::Code),
        (-9.0..9.0).prop_map(Step::Carrier),
    ]
}

prop_compose! {
    fn plan(kind: usize)(
        taps in prop::collection::vec((-60..60i64, any::<bool>()), 0..6),
        index in 0..30usize,
        start in position(900.0),
        (carrier, samples_per_chip) in rates(kind),
        steps in prop::collection::vec(step(kind), 1..3),
    ) -> Plan {
        let (taps, outer) = taps.into_iter().chain([(0, false)]).unzip();
        Plan { kind, band: 0, taps, outer, index, start, carrier, samples_per_chip, steps }
    }
}

fn scenario() -> impl Strategy<Value = Scenario> {
    let origin = prop_oneof![0..1000u64, (1 << 40) - 20_000..(1 << 40) + 20_000u64];
    let plan = (0..KINDS.len()).prop_flat_map(plan);
    (format(), origin, -0.45..0.45, plan).prop_map(|(format, origin, frequency, plan)| Scenario {
        format,
        origin,
        frequencies: vec![frequency],
        reach: 60,
        ops: vec![Op::Attach(plan), Op::Feed(usize::MAX / 64)],
    })
}

proptest! {
    #![proptest_config(crate::config(64))]

    /// Noise in, so nothing but agreement at every chip edge, at the carrier and code phase that
    /// the channel says it has, makes the two agree. The rest is noise of the known size; 6 sigma
    /// leaves room for groups longer than the mean.
    #[test]
    fn every_tap_is_the_references(scenario in scenario()) {
        let Op::Attach(plan) = &scenario.ops[0] else { unreachable!() };
        // Two slices and a bit, the longest that they may become.
        let count = (2.2 * plan.kind().chips() * 30.0) as usize + 1500;
        let format = scenario.format;
        let level = if format.name.ends_with("16") { 3000.0 } else { 40.0 };
        let sample = |k: usize| C64::new(noise(2 * k as u64), noise(2 * k as u64 + 1)) * level;
        let bytes = format.bytes((0..count.next_multiple_of(4)).map(sample));
        let slices = &scenario.play(&bytes, 7000, Level::best())[0];
        prop_assert!(slices.len() >= 2);
        let samples = format.samples(&bytes);
        let heard = Heard {
            samples: &samples,
            origin: scenario.origin,
            intermediate: scenario.frequencies[0],
        };
        let power = samples.iter().map(C64::norm_sqr).sum::<f64>() / samples.len() as f64;
        for Closed { begun, slice } in &slices[..2] {
            let (slow, companion) = heard.slice(plan.kind, begun, &plan.taps, &plan.outer);
            let rms = (power * slice.samples as f64).sqrt() * design_error(plan.kind, begun);
            let pairs = slice.taps.iter().zip(&slow).chain([(&slice.companion, &companion)]);
            for (fast, slow) in pairs {
                let miss = (fast - slow).norm() / rms;
                prop_assert!(miss < 6.0, "{fast} against {slow}, {miss} sigma: {begun:?}");
            }
        }
    }

    /// The oscillators of a channel drift from where they should be by no more than the rounding
    /// of their rates.
    #[test]
    fn slices_follow_each_other_at_the_rate_of_the_code(
        scenario in scenario(),
        slices in 1..12usize,
    ) {
        let mut scenario = scenario;
        let Op::Attach(plan) = &mut scenario.ops[0] else { unreachable!() };
        plan.steps.clear();
        let Plan { start, carrier, samples_per_chip, .. } = *plan;
        let slice = plan.kind().chips() * samples_per_chip;
        let count = (start + slice * slices as f64) as usize + 200;
        let silence = (0..count.next_multiple_of(4)).map(|_| C64::default());
        let got = &scenario.play(&scenario.format.bytes(silence), 5000, Level::best())[0];
        prop_assert!(got.len() >= slices);
        let Begun { base, fraction, carrier_cycles, .. } = got[slices - 1].begun;
        let position = (base - scenario.origin) as f64 + fraction;
        let expected = start + slice * (slices - 1) as f64;
        prop_assert!((position - expected).abs() < 1e-3, "{position} {expected}");
        let turned = carrier * (position - fraction - start.floor());
        prop_assert!((carrier_cycles - turned).abs() < 1e-3, "{carrier_cycles} {turned}");
    }

    /// The band's oscillator may be moved anywhere in the stream by as much as satellites drift:
    /// what comes out is the signal all the same.
    #[test]
    fn retuning_stays_within_the_loss(
        kind in 0..KINDS.len(),
        format in format(),
        rates in (-5e3..5e3, 4.0..12.0),
        retuned in (-1e3..1e3, 0.1..0.9),
        intermediate in 0.1..0.4,
    ) {
        let (hz, samples_per_chip) = rates;
        let per_hz = 1e-3 / (KINDS[kind].chips() * samples_per_chip);
        let mut setting = Setting {
            kind,
            format,
            samples_per_chip,
            intermediate,
            carrier: hz * per_hz,
            retuned: (0.0, 0),
            origin: 12_345,
            lead: 70.6,
            index: 4,
            taps: vec![-9, 0, 8],
            outer: vec![false; 3],
            slices: 3,
        };
        let bytes = setting.bytes(format.signal, format.noise);
        let (offset, part) = retuned;
        setting.retuned = (offset * per_hz, (part * bytes.len() as f64) as usize / 16 * 16);
        let fast = setting.fast(&bytes, Level::best());
        prop_assert_eq!(fast.len(), 3);
        let fast: C64 = fast.iter().map(|s| s.taps[1]).sum();
        let slow: C64 = setting.slow(&bytes).iter().map(|s| s.0[1]).sum();
        let ratio = fast / slow;
        prop_assert!(ratio.norm().ln().abs() * DB < 0.05, "{ratio}");
        prop_assert!(ratio.arg().abs() < 0.002 * std::f64::consts::TAU, "{ratio}");
    }
}
