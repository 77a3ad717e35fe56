//! The tracker: the same rows whatever the threads, the cuts and the processor's level.

use sdr_spoof_core::simd::Level;
use sdr_spoof_core::track::config::TrackConfig;
use sdr_spoof_core::track::engine::{Input, Target, Tracker};
use sdr_spoof_core::track::log::{ComboRows, SignalRows, State};

use crate::format::{Format, FORMATS};
use crate::sky::{recording, Sent};

const FORMAT: Format = FORMATS[1];

/// Rows of every channel: its signals', and its pair's.
pub type Rows = Vec<(Vec<SignalRows>, ComboRows)>;

fn input(sample_rate_hz: f64, lo_hz: f64, start: u64) -> Input {
    Input {
        format: FORMAT.parsed(),
        conjugate: FORMAT.conjugate,
        float_scale: 1.0,
        sample_rate_hz,
        lo_hz,
        start,
    }
}

pub fn tracked(tracker: &mut Tracker, bytes: &[u8], cut: usize) -> Rows {
    for piece in bytes.chunks(cut) {
        tracker.feed(piece);
    }
    let rows = tracker.channels().map(|c| {
        let signals = c.sidebands.iter().map(|s| s.rows.clone());
        (signals.collect(), c.combo.clone())
    });
    rows.collect()
}

/// Six satellites at a receiver clock error of 5 ppm, one of which is not there and is given up,
/// so that the oscillator follows the others.
#[test]
fn threads_cuts_and_levels_do_not_matter() {
    let start = 1_234_567;
    let input = input(2.5e6, 1575.42e6 - 100e3, start);
    let sent: Vec<Sent> = (0..6)
        .map(|k| Sent {
            id: "L1CA",
            prn: 3 + 4 * k,
            doppler_hz: 7.9e3 + 600.0 * f64::from(k) - if k == 0 { 4e3 } else { 0.0 },
            delay_s: 137e-6 * f64::from(k),
            amplitude: if k == 0 { 0.0 } else { 6.0 },
        })
        .collect();
    let targets: Vec<Target> = sent.iter().map(|s| s.target(start)).collect();
    let bytes = recording(&input, FORMAT, &sent, 2.6, 40.0);
    let run = |threads: usize, level: Level, cut: usize| {
        let config = TrackConfig::default();
        let mut tracker =
            Tracker::with_level(input.clone(), &config, &targets, threads, level).unwrap();
        tracked(&mut tracker, &bytes, 2 * cut)
    };
    let first = run(1, Level::best(), usize::MAX / 4);
    for (channel, (signals, _)) in first.iter().enumerate() {
        let last = if channel == 0 {
            State::Lost
        } else {
            State::Tracking
        };
        assert_eq!(
            signals[0].state.last(),
            Some(&(last as u8)),
            "channel {channel}"
        );
    }
    for threads in 2..=5 {
        let rows = run(threads, Level::best(), 400_000);
        assert!(rows == first, "{threads} threads");
    }
    for level in Level::available() {
        assert!(run(1, level, 100_003) == first, "{level:?}");
    }
    assert!(run(2, Level::best(), 777) == first, "small pieces");
}

/// Symbols of 20 ms and of 10 ms: neither sideband waits for the other, which would cost it its
/// samples, and they are joined.
#[test]
fn sidebands_with_unlike_symbols_are_integrated_alike() {
    let input = input(18.5e6, 1568.259e6, 0);
    // The ionosphere delays the lower carrier a little more.
    let sent = [("B1I", 0.3e-3), ("B1CD", 0.29984e-3)].map(|(id, delay_s)| Sent {
        id,
        prn: 21,
        doppler_hz: 1.2e3,
        delay_s,
        amplitude: 3.0,
    });
    let targets = sent.each_ref().map(|s| s.target(0));
    let bytes = recording(&input, FORMAT, &sent, 1.1, 40.0);
    let run = |cut: usize| {
        let config = TrackConfig {
            integration_ms: 20,
            pairs: vec![("B1I".to_owned(), "B1CD".to_owned())],
            ..TrackConfig::default()
        };
        let mut tracker = Tracker::new(input.clone(), &config, &targets, 1).unwrap();
        tracked(&mut tracker, &bytes, cut)
    };
    let rows = run(usize::MAX);
    let [(signals, pair)] = &rows[..] else {
        panic!("not one satellite")
    };
    for signal in signals {
        assert_eq!(signal.integration_s.last(), Some(&0.01));
        assert!(signal.cn0_dbhz.last().is_some_and(|&c| c > 40.0));
    }
    assert_eq!(pair.state.last(), Some(&(State::Combo as u8)));
    assert!(run(1202) == rows);
}

/// Two-bit samples come four to a byte: a start in the middle of one is no end of it.
#[test]
fn a_start_within_a_byte_is_no_endless_loop() {
    let mut input = input(2.5e6, 1575.42e6, 2_500_093);
    input.format = FORMATS[6].parsed();
    let mut tracker = Tracker::new(input, &TrackConfig::default(), &[], 1).unwrap();
    tracker.feed(&[0x1b; 1000]);
    assert_eq!(tracker.position(), 2_504_093);
}

#[test]
fn what_cannot_be_tracked_is_an_error() {
    let sane = Sent {
        id: "L1CA",
        prn: 3,
        doppler_hz: 0.0,
        delay_s: 0.0,
        amplitude: 0.0,
    };
    let target = sane.target(0);
    let new = |rate: f64, start: u64, target: &Target| {
        let config = TrackConfig::default();
        Tracker::new(
            input(rate, 1575.42e6, start),
            &config,
            std::slice::from_ref(target),
            1,
        )
        .err()
    };
    assert_eq!(new(4e6, 0, &target), None);
    for rate in [0.0, -4e6, f64::NAN, f64::INFINITY, 1e3, 1e9] {
        assert!(new(rate, 0, &target).is_some(), "{rate}");
    }
    assert!(new(4e6, u64::MAX, &target).is_some());
    for (doppler_hz, code_delay_s, sample) in [
        (f64::NAN, 0.0, 0),
        (3e6, 0.0, 0),
        (0.0, -1.0, 0),
        (0.0, f64::INFINITY, 0),
        (0.0, 0.0, u64::MAX),
    ] {
        let mut wrong = target.clone();
        wrong.seed.doppler_hz = doppler_hz;
        wrong.seed.code_delay_s = code_delay_s;
        wrong.seed.sample = sample;
        assert!(new(4e6, 0, &wrong).is_some(), "{:?}", wrong.seed);
    }
}
