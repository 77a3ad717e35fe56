//! Correlates one signal of one satellite from the running sums of its band.
//!
//! The unit of integration is the slice: 1 ms of code. The replica of each subcarrier layer is a
//! list of sign-change positions; edges fall on the first sample at or after the code phase of the
//! change, exactly as a sampled replica has them. Runs are gathered in groups, as long as the
//! residual carrier allows, and each group is turned by the residual carrier at its middle. All
//! sums are integers: the same bits however the samples come, whatever the processor.

use std::sync::Arc;

use super::band::Band;
use super::clock::Clock;
pub use super::clock::SAMPLES_PER_CHIP;
use super::replica::{Output, Part, Replica};
use super::ring::LONGEST_STEP;
use super::tap_plan::TapPlan;
use crate::simd::runs::{correlate, Runs, Sums, FRACTION, TURN_AMPLITUDE};
use crate::{nco, C64};

/// Taps may lie so far from the prompt, samples.
pub const FARTHEST_TAP: usize = 1 << 30;

/// exp(-j 2 pi cycles)
fn turn_back(cycles: f64) -> C64 {
    C64::from_polar(1.0, -std::f64::consts::TAU * cycles)
}

/// What one slice gave.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Slice {
    /// Correlation per tap, in input units times samples.
    pub taps: Vec<C64>,
    /// Prompt of the companion signal; 0 without one.
    pub companion: C64,
    /// Which slice of the code period this was.
    pub index: usize,
    /// Absolute index of the first sample.
    pub start: u64,
    /// Samples in the slice (prompt tap).
    pub samples: u64,
}

/// What a part of the replica has come to.
#[derive(Debug)]
struct Progress {
    fine: bool,
    runs_per_turn: usize,
    /// Edges passed.
    edges: usize,
    sums: Vec<Sums>,
}

/// A channel's oscillators and partial sums.
#[derive(Debug)]
pub struct Correlator {
    replica: Arc<Replica>,
    offsets: Vec<i64>,
    /// Where the sums of the main layer, the other layers and the companion are.
    plans: [TapPlan; 3],
    /// Farthest tap before and after the prompt.
    reach: [i64; 2],
    clock: Clock,
    begun: bool,
    /// Carrier beyond the band's oscillator where the slice began, 2^-64 cycles per sample.
    residual: u64,
    progress: Vec<Progress>,
    /// Gain of each tap.
    gains: Vec<f64>,
    /// Residual carrier for which `twists` hold: what it turns from prompt to tap, and the gain.
    twisted: Option<u64>,
    twists: Vec<C64>,
    slice: Slice,
    /// Slice of the code period in progress.
    index: usize,
}

impl Correlator {
    /// A channel with the given tap offsets (samples, positive = late replica); slice `index` of
    /// the code period starts at `start` samples.
    ///
    /// Taps may lie anywhere; those 8 samples apart from their neighbours, up to eight, cost as
    /// much as one. Call [`Correlator::set_rates`] before the first [`Correlator::advance`].
    ///
    /// # Panics
    /// As [`Correlator::with_outer_taps`].
    pub fn new(replica: Arc<Replica>, taps: &[i64], index: usize, start: f64) -> Self {
        Self::with_outer_taps(replica, taps, &vec![false; taps.len()], index, start)
    }

    /// The same, where taps that are marked as outer ones see the main subcarrier layer only, at
    /// unit power: BOC(6,1) costs eight times BOC(1,1), and is of use near the peak.
    ///
    /// # Panics
    /// If `outer` does not say it of each tap, if there is none but outer ones, if one is farther
    /// than [`FARTHEST_TAP`], or if `start` is not within 0 and [`LAST_SAMPLE`](super::band::LAST_SAMPLE).
    pub fn with_outer_taps(
        replica: Arc<Replica>,
        taps: &[i64],
        outer: &[bool],
        index: usize,
        start: f64,
    ) -> Self {
        assert!(
            outer.len() == taps.len() && outer.contains(&false),
            "{} taps, {} marks, at least one of which must be for an inner tap",
            taps.len(),
            outer.len()
        );
        let farthest = taps.iter().map(|tap| tap.unsigned_abs()).fold(0, u64::max);
        assert!(
            farthest <= FARTHEST_TAP as u64,
            "a tap {farthest} samples from the prompt"
        );
        let all = || taps.iter().copied().enumerate();
        let inner = all().zip(outer).filter(|(_, &o)| !o).map(|(tap, _)| tap);
        let plans = [
            TapPlan::new(all()),
            TapPlan::new(inner),
            TapPlan::new(std::iter::once((0, 0))),
        ];
        let progress = |part: &Part| Progress {
            fine: false,
            runs_per_turn: 0,
            edges: 0,
            sums: vec![Sums::default(); plans[part.output as usize].groups.len()],
        };
        Correlator {
            clock: Clock::new(start),
            begun: false,
            residual: 0,
            progress: replica.parts.iter().map(progress).collect(),
            twisted: None,
            twists: vec![C64::default(); taps.len()],
            slice: Slice {
                taps: vec![C64::default(); taps.len()],
                ..Slice::default()
            },
            index: index % replica.slices_per_period(),
            offsets: taps.to_vec(),
            gains: outer
                .iter()
                .map(|&o| if o { replica.outer_gain() } else { 1.0 })
                .collect(),
            plans,
            reach: [
                taps.iter().copied().min().unwrap_or(0).min(0),
                taps.iter().copied().max().unwrap_or(0).max(0),
            ],
            replica,
        }
    }

    /// Sets the oscillators for the slices to come: carrier beyond the band's nominal frequency
    /// in cycles per sample (wrapping at half a cycle), and samples per chip. To be called between
    /// slices only.
    ///
    /// # Panics
    /// Within a slice, if the carrier is not finite, or for samples per chip out of
    /// [`SAMPLES_PER_CHIP`].
    pub fn set_rates(&mut self, carrier: f64, samples_per_chip: f64) {
        self.check_between_slices();
        self.clock.set_rates(carrier, samples_per_chip);
    }

    /// Adds to the carrier phase (cycles), between slices.
    ///
    /// # Panics
    /// Within a slice, or for more cycles than [`LAST_SAMPLE`](super::band::LAST_SAMPLE).
    pub fn shift_carrier(&mut self, cycles: f64) {
        self.check_between_slices();
        self.clock.shift_carrier(cycles);
    }

    /// Moves the replica by this many samples (positive = later), between slices. What it is
    /// moved back to must still be held by its band.
    ///
    /// # Panics
    /// Within a slice, or to a sample that is not within 0 and [`LAST_SAMPLE`](super::band::LAST_SAMPLE).
    pub fn shift_code(&mut self, samples: f64) {
        self.check_between_slices();
        self.clock.shift_code(samples);
    }

    fn check_between_slices(&self) {
        assert!(!self.begun, "a channel is to be steered between slices");
    }

    /// Start of the present slice in samples.
    pub fn start(&self) -> f64 {
        self.clock.start()
    }

    /// Fraction of a sample between [`Correlator::base`] and the present slice's start.
    pub fn fraction(&self) -> f64 {
        self.clock.fraction()
    }

    /// Samples per chip of the replica.
    pub fn samples_per_chip(&self) -> f64 {
        self.clock.samples_per_chip()
    }

    /// Carrier phase beyond the band's nominal frequency at [`Correlator::base`], cycles,
    /// unwrapped.
    pub fn carrier_cycles(&self) -> f64 {
        self.clock.carrier_cycles()
    }

    /// Whole sample at or before the present slice's start.
    pub fn base(&self) -> u64 {
        self.clock.base
    }

    /// Farthest tap from the prompt.
    pub(crate) fn reach(&self) -> usize {
        self.reach[1].max(-self.reach[0]) as usize
    }

    /// The earliest sample that the slice in progress needs; it may lie before the recording.
    pub(crate) fn oldest(&self) -> i64 {
        let parts = 0..self.progress.len();
        let needed = parts.map(|part| self.needed(part)).min();
        needed.unwrap_or(self.clock.base as i64)
    }

    /// The earliest sample that a part of the replica still needs.
    fn needed(&self, part: usize) -> i64 {
        let progress = &self.progress[part];
        let list = self.replica.parts[part].list(progress.fine);
        let edge = u64::from(list.slices[self.index][progress.edges]);
        let passed =
            (self.clock.fraction + edge * (self.clock.chip_step / list.subchips)) >> FRACTION;
        (self.clock.base + passed) as i64 + self.reach[0]
    }

    /// Works off what the band holds; gives the slice once it is complete, and stands then at
    /// the start of the next.
    ///
    /// # Panics
    /// If the band no longer holds samples that are needed, or rates have never been set.
    pub fn advance(&mut self, band: &Band) -> Option<&Slice> {
        let limit = band.end().wrapping_sub(self.clock.base) as i64 - self.reach[1];
        if limit <= 0 {
            return None;
        }
        if !self.begun {
            self.begin(band);
        }
        let mut complete = true;
        for part in 0..self.progress.len() {
            complete &= self.advance_part(part, band, limit);
        }
        if !complete {
            return None;
        }
        self.finish(band);
        Some(&self.slice)
    }

    /// Works off all that the band holds; `closed` gets every slice, and the channel to steer.
    pub fn work_off(&mut self, band: &Band, mut closed: impl FnMut(&Slice, &mut Self)) {
        while self.advance(band).is_some() {
            let slice = std::mem::take(&mut self.slice);
            closed(&slice, self);
            self.slice = slice;
        }
    }

    /// Chooses how runs are turned in the slice that begins.
    fn begin(&mut self, band: &Band) {
        assert!(self.clock.chip_step > 0, "a channel without rates");
        let step = band.detuning_step(self.clock.base);
        self.residual = (self.clock.carrier_step as u64).wrapping_sub(step);
        let per_chip = nco::frequency_from_step(self.residual) * self.samples_per_chip();
        let longest = LONGEST_STEP as f64 / self.samples_per_chip();
        for (part, progress) in self.replica.parts.iter().zip(&mut self.progress) {
            (progress.fine, progress.runs_per_turn) = part.choose(per_chip, longest);
            progress.sums.fill(Sums::default());
        }
        self.begun = true;
    }

    fn advance_part(&mut self, at: usize, band: &Band, limit: i64) -> bool {
        assert!(
            band.end() as i64 - self.needed(at) < band.ring().capacity() as i64,
            "a channel needs sample {} of a band that stands at {} and has forgotten it",
            self.needed(at),
            band.end()
        );
        let part = &self.replica.parts[at];
        let progress = &mut self.progress[at];
        let list = part.list(progress.fine);
        let edges = &list.slices[self.index];
        let taps = &self.plans[part.output as usize].groups;
        // What lies before a retuning is turned as the oscillator was then.
        for (detuning, end) in band.detunings() {
            let rest = &edges[progress.edges..];
            let limit = limit.min(end.wrapping_sub(self.clock.base) as i64);
            if rest.len() == 1 || limit < 0 {
                continue;
            }
            let runs = Runs {
                cells: band.ring().cells(),
                geometry: band.ring().geometry(),
                edges: rest,
                fraction: self.clock.fraction,
                step: self.clock.chip_step / list.subchips,
                base: self.clock.base,
                limit,
                phase: (self.clock.carrier as u64).wrapping_sub(detuning.phase(self.clock.base)),
                phase_step: (self.clock.carrier_step as u64).wrapping_sub(detuning.step),
                runs_per_turn: progress.runs_per_turn,
            };
            progress.edges += correlate(band.level(), &runs, taps, &mut progress.sums);
        }
        progress.edges + 1 == edges.len()
    }

    fn finish(&mut self, band: &Band) {
        self.twist();
        let scale = 1.0 / (band.gain() * TURN_AMPLITUDE);
        let slice = &mut self.slice;
        slice.taps.fill(C64::default());
        slice.companion = C64::default();
        for (part, progress) in self.replica.parts.iter().zip(&self.progress) {
            let weight = part.weight * (part.signs[self.index] * scale);
            for &(tap, group, lane) in &self.plans[part.output as usize].places {
                let [re, im] = progress.sums[group];
                let sum = weight * C64::new(re[lane] as f64, im[lane] as f64);
                match part.output {
                    Output::Companion => slice.companion += sum,
                    _ => slice.taps[tap] += sum,
                }
            }
        }
        for (tap, twist) in slice.taps.iter_mut().zip(&self.twists) {
            *tap *= twist;
        }
        slice.start = self.clock.base;
        slice.samples = self.clock.pass(self.replica.chips_per_slice());
        slice.index = self.index;
        self.index = (self.index + 1) % self.replica.slices_per_period();
        self.progress.iter_mut().for_each(|p| p.edges = 0);
        self.begun = false;
    }

    /// Taps were turned by the carrier at the prompt.
    fn twist(&mut self) {
        if self.twisted == Some(self.residual) {
            return;
        }
        let frequency = nco::frequency_from_step(self.residual);
        let taps = self.offsets.iter().zip(&self.gains);
        for (twist, (&tap, gain)) in self.twists.iter_mut().zip(taps) {
            *twist = turn_back(frequency * tap as f64) * gain;
        }
        self.twisted = Some(self.residual);
    }
}
