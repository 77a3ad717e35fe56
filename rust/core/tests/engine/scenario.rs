//! Channels come and go, are steered, and oscillators are retuned while samples are fed.

use std::sync::Arc;

use sdr_spoof_core::dsp::correlator::{Correlator, Slice};
use sdr_spoof_core::dsp::engine::{ChannelId, Engine};
use sdr_spoof_core::nco;
use sdr_spoof_core::simd::Level;

use crate::format::Format;
use crate::kinds::{Kind, KINDS};
use crate::reference::Begun;

/// How a channel is steered after a slice.
#[derive(Debug, Clone, Copy)]
pub enum Step {
    Keep,
    /// Carrier in cycles per sample, and samples per chip.
    Rates(f64, f64),
    /// Samples.
    Code(f64),
    /// Cycles.
    Carrier(f64),
}

/// A channel to be attached.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Of [`KINDS`].
    pub kind: usize,
    pub band: usize,
    pub taps: Vec<i64>,
    pub outer: Vec<bool>,
    pub index: usize,
    /// Samples after what has been fed by then.
    pub start: f64,
    pub carrier: f64,
    pub samples_per_chip: f64,
    /// After each slice, in turn.
    pub steps: Vec<Step>,
}

/// What is done with an engine.
#[derive(Debug, Clone)]
pub enum Op {
    /// So many groups of four samples, which are whole bytes in every format.
    Feed(usize),
    Attach(Plan),
    /// Channels by their number: taken out for good, or put back at once.
    Detach(usize),
    PutBack(usize),
    /// A band's oscillator, cycles per sample.
    Retune(usize, f64),
}

#[derive(Debug, Clone)]
pub struct Scenario {
    pub format: Format,
    pub origin: u64,
    pub frequencies: Vec<f64>,
    pub reach: usize,
    pub ops: Vec<Op>,
}

/// A slice that came, and how it had begun.
#[derive(Debug, Clone, PartialEq)]
pub struct Closed {
    pub begun: Begun,
    pub slice: Slice,
}

/// A channel in the course of a scenario.
struct Player {
    plan: Plan,
    id: Option<ChannelId>,
    begun: Begun,
    closed: Vec<Closed>,
}

impl Plan {
    pub fn kind(&self) -> &'static Kind {
        &KINDS[self.kind]
    }

    /// The channel, attached at `end`.
    fn channel(&self, end: u64) -> Correlator {
        let replica = Arc::clone(&self.kind().replica);
        let start = (end as f64 + self.start).max(0.0);
        let (taps, outer) = (&self.taps, &self.outer);
        let mut channel = Correlator::with_outer_taps(replica, taps, outer, self.index, start);
        channel.set_rates(self.carrier, self.samples_per_chip);
        channel
    }

    /// The first slice of the channel, attached at `end`.
    pub fn begun(&self, end: u64) -> Begun {
        Begun::of(&self.channel(end), self.index, self.carrier)
    }
}

impl Player {
    fn close(&mut self, slice: &Slice, channel: &mut Correlator) {
        assert_eq!(slice.start, self.begun.base, "a gap or an overlap");
        let periods = self.plan.kind().replica.slices_per_period();
        assert_eq!(slice.index, self.begun.index % periods);
        assert_eq!(channel.base(), slice.start + slice.samples);
        let begun = self.begun;
        let (mut carrier, mut turned) = (begun.carrier, 0.0);
        let steps = &self.plan.steps;
        match steps.get(self.closed.len() % steps.len().max(1)) {
            Some(&Step::Rates(frequency, samples_per_chip)) => {
                channel.set_rates(frequency, samples_per_chip);
                carrier = frequency;
            }
            Some(&Step::Code(samples)) => channel.shift_code(samples),
            Some(&Step::Carrier(cycles)) => {
                channel.shift_carrier(cycles);
                turned = cycles;
            }
            Some(Step::Keep) | None => {}
        }
        let slice = slice.clone();
        self.closed.push(Closed { begun, slice });
        self.begun = Begun::of(channel, begun.index + 1, carrier);
        // The carrier goes on, wherever the replica is moved.
        let frequency = nco::frequency_from_step(nco::step_from_frequency(begun.carrier));
        let samples = self.begun.base as f64 - begun.base as f64;
        let expected = begun.carrier_cycles + frequency * samples + turned;
        let miss = (self.begun.carrier_cycles - expected).abs();
        assert!(
            miss < 1e-6 + 1e-9 * expected.abs(),
            "a carrier off by {miss} cycles"
        );
    }

    /// Nothing that could be had is still to come.
    fn check_worked_off(&self, end: u64) {
        let late = self.plan.taps.iter().copied().max().unwrap_or(0).max(0);
        let Begun { base, .. } = self.begun;
        let slice = self.plan.kind().chips() * self.begun.samples_per_chip;
        assert!(
            base as f64 + slice + late as f64 + 2.0 > end as f64,
            "a slice from {base} is missing at {end}"
        );
    }
}

impl Scenario {
    /// The slices of every channel; each feed cut after so many groups of four samples.
    pub fn play(&self, bytes: &[u8], cut: usize, level: Level) -> Vec<Vec<Closed>> {
        let stream = self.format.stream(self.origin);
        let mut engine = Engine::new(stream, &self.frequencies, self.reach, level);
        let mut players: Vec<Player> = Vec::new();
        let (mut rest, mut end) = (bytes, self.origin);
        let unit = stream.format.bits_per_sample() * 4 / 8;
        for op in &self.ops {
            match op {
                Op::Feed(groups) => {
                    let (now, after) = rest.split_at((groups * unit).min(rest.len()));
                    for piece in now.chunks(cut * unit) {
                        engine.feed(piece, |id, slice, channel| {
                            let player = players.iter_mut().find(|p| p.id == Some(id));
                            player.expect("no such channel").close(slice, channel);
                        });
                    }
                    end += (now.len() / unit * 4) as u64;
                    rest = after;
                    let fed = !now.is_empty();
                    let attached = players.iter().filter(|p| fed && p.id.is_some());
                    attached.for_each(|p| p.check_worked_off(end));
                }
                Op::Attach(plan) => {
                    let channel = plan.channel(end);
                    players.push(Player {
                        begun: Begun::of(&channel, plan.index, plan.carrier),
                        id: Some(engine.attach(plan.band, channel)),
                        plan: plan.clone(),
                        closed: Vec::new(),
                    });
                }
                Op::Detach(number) | Op::PutBack(number) => {
                    let player = players.get_mut(*number);
                    if let Some((player, id)) = player.and_then(|p| p.id.take().map(|id| (p, id))) {
                        let channel = engine.detach(id).expect("no such channel");
                        assert!(engine.detach(id).is_none(), "detached twice");
                        if matches!(op, Op::PutBack(_)) {
                            player.id = Some(engine.attach(player.plan.band, channel));
                        }
                    }
                }
                Op::Retune(band, offset) => engine.bands_mut()[*band].retune(*offset),
            }
        }
        players.into_iter().map(|p| p.closed).collect()
    }
}
