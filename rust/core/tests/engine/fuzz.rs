//! Bytes of any kind become operations on engines. None may panic but at a documented door, lose
//! samples, or give other bits at another level or cut.
//!
//! `cargo test` runs a few; `scripts/fuzz.sh` goes on for as long as it is told.

use std::cell::Cell;
use std::ops::Range;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Once;
use std::time::{Duration, Instant};

use sdr_spoof_core::simd::Level;

use crate::doors::said;
use crate::format::FORMATS;
use crate::kinds::KINDS;
use crate::scenario::{Closed, Op, Plan, Scenario, Step};

/// What documented panics say, and whether that depends on how samples come.
const DOORS: [(&str, bool); 11] = [
    ("cannot start at sample", false),
    ("for an inner tap", false),
    ("samples from the prompt", false),
    ("samples from its prompt", false),
    ("cannot correlate at", false),
    ("cannot move a replica", false),
    ("cannot turn a carrier", false),
    ("holds those from", false),
    ("no band at", false),
    ("no oscillator at", false),
    // A replica that is moved back is late by what the engine took at a time.
    ("has forgotten it", true),
];

const WILD: [f64; 12] = [
    0.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    9_007_199_254_740_992.0,
    -9_223_372_036_854_775_808.0,
    0.5,
    1e-12,
];

/// Input to be read as decisions; zeros once it is used up.
pub struct Input<'a> {
    bytes: &'a [u8],
    /// Numbers may be any.
    wild: bool,
}

impl<'a> Input<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut input = Input { bytes, wild: false };
        input.wild = input.chance(64);
        input
    }

    fn byte(&mut self) -> u8 {
        let (first, rest) = self.bytes.split_first().unwrap_or((&0, &[]));
        self.bytes = rest;
        *first
    }

    pub fn below(&mut self, limit: usize) -> usize {
        usize::from(u16::from_le_bytes([self.byte(), self.byte()])) * limit >> 16
    }

    pub fn chance(&mut self, of_256: u8) -> bool {
        self.byte() < of_256
    }

    /// A number in a range, or now and then any other.
    pub fn number(&mut self, range: Range<f64>) -> f64 {
        if self.wild && self.chance(8) {
            return WILD[self.below(WILD.len())];
        }
        let fine = self.below(1 << 16) as f64 + self.below(1 << 16) as f64 / 65536.0;
        range.start + (range.end - range.start) * fine / 65536.0
    }

    fn tap(&mut self, reach: usize) -> i64 {
        match self.byte() {
            0 if self.wild => i64::MIN,
            1 if self.wild => reach as i64 + 1,
            2 if self.wild => 1 << 31,
            n if n < 128 => 8 * (self.below(reach / 4 + 1) as i64 - reach as i64 / 8),
            _ => self.below(2 * reach + 1) as i64 - reach as i64,
        }
    }

    fn step(&mut self) -> Step {
        match self.below(8) {
            0 => Step::Keep,
            1 => Step::Carrier(self.number(-10.0..10.0)),
            // Not by as much as a slice, or it would never end.
            2 => Step::Code(self.number(-200.0..3000.0)),
            3 => Step::Rates(self.number(-0.5..0.5), self.number(0.25..512.0)),
            _ => Step::Rates(self.number(-0.01..0.01), self.number(0.3..16.0)),
        }
    }

    fn plan(&mut self, bands: usize, reach: usize) -> Plan {
        let count = 1 + self.below(9);
        let taps: Vec<i64> = (0..count).map(|_| self.tap(reach)).collect();
        let mut outer: Vec<bool> = taps.iter().map(|_| self.chance(60)).collect();
        outer[0] &= self.wild;
        let steps = self.below(5);
        Plan {
            kind: self.below(KINDS.len()),
            band: self.below(bands),
            taps,
            outer,
            index: self.below(40),
            start: self.number(-(reach as f64)..5000.0),
            carrier: self.number(-0.01..0.01),
            samples_per_chip: self.number(0.3..16.0),
            steps: (0..steps).map(|_| self.step()).collect(),
        }
    }

    fn op(&mut self, bands: usize, reach: usize) -> Op {
        match self.below(10) {
            0..=4 => Op::Feed(self.below(12_000)),
            5 => Op::Feed(self.below(40)),
            6 => Op::Retune(self.below(bands), self.number(-0.01..0.01)),
            7 => Op::PutBack(self.below(5)),
            8 => Op::Detach(self.below(5)),
            _ => Op::Attach(self.plan(bands, reach)),
        }
    }

    fn scenario(&mut self) -> Scenario {
        let origin = match self.byte() {
            0..100 => 0,
            100..200 => self.below(1 << 16) as u64,
            200..250 => (1 << 40) - self.below(1 << 16) as u64,
            _ if self.wild => 1 << 53,
            _ => 1 << 36,
        };
        let bands = 1 + self.below(2);
        let reach = self.below(3000);
        let ops = 2 + self.below(16);
        let first = Op::Attach(self.plan(bands, reach));
        Scenario {
            format: FORMATS[self.below(FORMATS.len())],
            origin,
            frequencies: (0..bands).map(|_| self.number(-0.6..0.6)).collect(),
            reach,
            ops: std::iter::once(first)
                .chain((1..ops).map(|_| self.op(bands, reach)))
                .collect(),
        }
    }

    /// Samples: noise, all alike, or both by turns.
    pub fn samples(&mut self, count: usize) -> Vec<u8> {
        let (alike, noisy) = (self.byte(), self.byte());
        let mut random = Random(u64::from(self.byte()) + 1);
        (0..count)
            .map(|k| {
                let noise = random.byte();
                if k / 5000 % 2 == usize::from(noisy % 2) || noisy > 200 {
                    noise
                } else {
                    alike
                }
            })
            .collect()
    }
}

/// The fuzz target.
fn engines(bytes: &[u8]) {
    let mut input = Input::new(bytes);
    let scenario = input.scenario();
    let samples = input.samples(1_000_000);
    let cut = 1 + input.below(3000);
    let whole = usize::MAX / 64;
    let plays = Level::available().into_iter().map(|level| (level, whole));
    let plays = plays.chain([(Level::best(), cut)]);
    let played: Vec<Result<Vec<Vec<Closed>>, String>> = plays
        .map(|(level, cut)| {
            catch_unwind(AssertUnwindSafe(|| scenario.play(&samples, cut, level)))
                .map_err(|panic| said(&*panic))
        })
        .collect();
    let mut depends = false;
    for message in played.iter().filter_map(|p| p.as_ref().err()) {
        let door = DOORS.iter().find(|d| message.contains(d.0));
        let Some((_, cuts)) = door else {
            panic!("an undocumented panic: {message}: {scenario:?}");
        };
        depends |= cuts;
    }
    if !depends {
        let same = played.iter().all(|p| *p == played[0]);
        assert!(same, "other bits, cut {cut}: {scenario:?}");
    }
}

struct Random(u64);

impl Random {
    fn byte(&mut self) -> u8 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 56) as u8
    }
}

/// Panics that are looked for are not printed.
fn quietly<T>(f: impl FnOnce() -> T) -> T {
    thread_local!(static QUIET: Cell<bool> = const { Cell::new(false) });
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let loud = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !QUIET.get() {
                loud(info);
            }
        }));
    });
    QUIET.set(true);
    let result = f();
    QUIET.set(false);
    result
}

/// Runs a target on the input that follows from each seed.
pub fn run(target: fn(&[u8]), seeds: impl Iterator<Item = u64>) {
    for seed in seeds {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let length = 200 + usize::from(random.byte()) * 8;
        let bytes: Vec<u8> = (0..length).map(|_| random.byte()).collect();
        let outcome = quietly(|| catch_unwind(|| target(&bytes)));
        if let Err(panic) = outcome {
            panic!("seed {seed}: {}", said(&*panic));
        }
    }
}

/// Seeds from `FUZZ_SEED` (0 unless it is set) on, until `FUZZ_SECONDS` (60) are over.
pub fn timed() -> impl Iterator<Item = u64> {
    let of = |name: &str| std::env::var(name).ok().and_then(|v| v.parse().ok());
    let first = of("FUZZ_SEED").unwrap_or(0);
    let end = Instant::now() + Duration::from_secs(of("FUZZ_SECONDS").unwrap_or(60));
    (first..).take_while(move |seed| {
        let go_on = Instant::now() < end;
        if !go_on {
            println!("seeds {first} to {seed}");
        }
        go_on
    })
}

#[test]
fn a_few_engines() {
    run(engines, 0..60);
}

#[test]
#[ignore = "goes on for FUZZ_SECONDS"]
fn long_engines() {
    run(engines, timed());
}
