//! Operations on an engine.

use std::panic::{catch_unwind, AssertUnwindSafe};

use sdr_spoof_core::simd::Level;

use super::input::Input;
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

impl Input<'_> {
    fn tap(&mut self, reach: usize) -> i64 {
        match self.byte() {
            0 if self.wild() => i64::MIN,
            1 if self.wild() => reach as i64 + 1,
            2 if self.wild() => 1 << 31,
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
        outer[0] &= self.wild();
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
            _ if self.wild() => 1 << 53,
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
}

/// No panic but at a documented door, no samples lost, the same bits at every level and cut.
pub fn engine(bytes: &[u8]) {
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
