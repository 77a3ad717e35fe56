//! What the engine cannot do it says at the door, and what is before a recording is silence.

use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Arc;

use sdr_spoof_core::dsp::band::LAST_SAMPLE;
use sdr_spoof_core::dsp::correlator::{Correlator, FARTHEST_TAP, SAMPLES_PER_CHIP};
use sdr_spoof_core::dsp::engine::Engine;
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::C64;

use crate::format::{noise, Format, FORMATS};
use crate::kinds::KINDS;
use crate::reference::Heard;
use crate::scenario::{Closed, Op, Plan, Scenario};

/// Complex bytes.
const FORMAT: Format = FORMATS[1];

/// What a panic said.
pub fn said(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    let text = text.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
    text.unwrap_or_default()
}

fn refused<T>(because: &str, f: impl FnOnce() -> T) {
    let Err(panic) = catch_unwind(AssertUnwindSafe(f)) else {
        panic!("not refused: {because}");
    };
    let said = said(&*panic);
    assert!(said.contains(because), "'{said}' and not '{because}'");
}

fn channel(taps: &[i64], start: f64) -> Correlator {
    let mut channel = Correlator::new(Arc::clone(&KINDS[0].replica), taps, 0, start);
    channel.set_rates(0.0, 5.0);
    channel
}

fn engine(frequency: f64, reach: usize) -> Engine {
    Engine::new(FORMAT.stream(0), &[frequency], reach, Level::best())
}

#[test]
fn channels_that_cannot_be() {
    let new = |taps: &[i64], outer: &[bool], start| {
        Correlator::with_outer_taps(Arc::clone(&KINDS[2].replica), taps, outer, 0, start)
    };
    for start in [-0.1, f64::NAN, f64::INFINITY, 2.1 * LAST_SAMPLE as f64] {
        refused("cannot start at sample", || new(&[0], &[false], start));
    }
    refused("0 taps, 0 marks", || new(&[], &[], 0.0));
    refused("2 taps, 1 marks", || new(&[0, 8], &[false], 0.0));
    refused("for an inner tap", || new(&[0, 8], &[true; 2], 0.0));
    for tap in [FARTHEST_TAP as i64 + 1, i64::MIN, i64::MAX] {
        refused("samples from the prompt", || {
            new(&[0, tap], &[false; 2], 0.0)
        });
    }
}

#[test]
fn rates_and_shifts_that_cannot_be() {
    let range = SAMPLES_PER_CHIP;
    let (low, high) = (range.start(), range.end());
    for samples_per_chip in [0.0, -5.0, f64::NAN, f64::INFINITY, 0.99 * low, 1.01 * high] {
        refused("samples per chip", || {
            channel(&[0], 0.0).set_rates(0.0, samples_per_chip)
        });
    }
    for carrier in [f64::NAN, f64::INFINITY] {
        refused("cycles per sample", || {
            channel(&[0], 0.0).set_rates(carrier, 5.0)
        });
    }
    for samples in [-100.1, f64::NAN, f64::NEG_INFINITY, 1e300] {
        refused("cannot move", || channel(&[0], 100.0).shift_code(samples));
    }
    for cycles in [f64::NAN, 1e300] {
        refused("cannot turn", || channel(&[0], 0.0).shift_carrier(cycles));
    }
}

#[test]
fn a_channel_is_steered_between_slices_only() {
    let mut engine = engine(0.1, 0);
    let id = engine.attach(0, channel(&[0], 0.0));
    engine.feed(&[1; 1000], |_, _, _| {});
    let mut channel = engine.detach(id).unwrap();
    refused("between slices", || channel.set_rates(0.0, 5.0));
    refused("between slices", || channel.shift_code(1.0));
    refused("between slices", || channel.shift_carrier(0.1));
}

#[test]
fn engines_and_input_that_cannot_be() {
    refused("cycles per sample", || engine(f64::NAN, 0));
    refused("from the prompt", || engine(0.1, FARTHEST_TAP + 1));
    refused("from sample", || {
        Engine::new(FORMAT.stream(u64::MAX), &[0.1], 0, Level::best())
    });
    refused("whole samples", || {
        engine(0.1, 0).feed(&[0; 3], |_, _, _| {})
    });
    refused("no oscillator", || {
        engine(0.1, 0).bands_mut()[0].retune(f64::INFINITY)
    });
}

#[test]
fn channels_that_do_not_belong() {
    refused("no band 1", || engine(0.1, 9).attach(1, channel(&[0], 0.0)));
    refused("a tap 10 samples", || {
        engine(0.1, 9).attach(0, channel(&[0, -10], 0.0))
    });
    let mut engine = engine(0.1, 9);
    engine.feed(&[1; 2 * 100_000], |_, _, _| {});
    refused("holds those from", || {
        engine.attach(0, channel(&[0], 50_000.0))
    });
    // As far back as is promised.
    engine.attach(0, channel(&[-9, 0], 99_991.0));
}

#[test]
fn a_channel_without_rates_or_samples_is_not_garbage() {
    let new = || Correlator::new(Arc::clone(&KINDS[0].replica), &[0], 0, 0.0);
    let mut without = engine(0.1, 0);
    without.attach(0, new());
    refused("without rates", || without.feed(&[0; 64], |_, _, _| {}));

    let mut moved = engine(0.1, 0);
    moved.attach(0, channel(&[0], 90_000.0));
    refused("has forgotten it", || {
        moved.feed(&[0; 2 * 200_000], |_, _, c| c.shift_code(-60_000.0))
    });
}

/// A channel's early taps, and its start itself, may lie before the recording.
#[test]
fn silence_comes_before_a_recording() {
    for origin in [0, 5000] {
        let plan = Plan {
            kind: 2,
            band: 0,
            taps: vec![-600, -3, 0, 8],
            outer: vec![true, false, false, false],
            index: 3,
            start: if origin == 0 { 1.2 } else { -599.3 },
            carrier: 0.0,
            samples_per_chip: 6.1,
            steps: Vec::new(),
        };
        let bytes: Vec<u8> = (0..20_000).map(|k| (40.0 * noise(k)) as i8 as u8).collect();
        let scenario = Scenario {
            format: FORMAT,
            origin,
            frequencies: vec![0.21],
            reach: 600,
            ops: vec![Op::Attach(plan.clone()), Op::Feed(usize::MAX / 64)],
        };
        let samples = FORMAT.samples(&bytes);
        let heard = Heard {
            samples: &samples,
            origin,
            intermediate: 0.21,
        };
        let Closed { begun, slice } = &scenario.play(&bytes, 100, Level::best())[0][0];
        let (slow, _) = heard.slice(plan.kind, begun, &plan.taps, &plan.outer);
        let rms = samples.iter().map(C64::norm_sqr).sum::<f64>().sqrt();
        for (fast, slow) in slice.taps.iter().zip(&slow) {
            assert!((fast - slow).norm() < 0.15 * rms, "{fast} against {slow}");
        }
    }
}

/// A level that the processor lacks may be named: it gets the best that there is.
#[test]
fn any_level_may_be_named() {
    let bytes: Vec<u8> = (0..40_000).map(|k| (40.0 * noise(k)) as i8 as u8).collect();
    let all = [Level::Portable, Level::Avx2, Level::Avx512].map(|level| {
        let mut engine = Engine::new(FORMAT.stream(0), &[0.1], 0, level);
        engine.attach(0, channel(&[0], 0.0));
        let mut slices = Vec::new();
        engine.feed(&bytes, |_, slice, _| slices.push(slice.clone()));
        slices
    });
    assert!(!all[0].is_empty() && all[0] == all[1] && all[1] == all[2]);
}
