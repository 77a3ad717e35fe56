//! Correlates one signal of one satellite from the running sums of its band.
//!
//! The unit of integration is the slice: 1 ms of code. The replica of each subcarrier layer is a
//! list of sign-change positions; edges fall on the first sample at or after the code phase of the
//! change, exactly as a sampled replica has them. Runs are gathered in groups, as long as the
//! residual carrier allows, and each group is turned by the residual carrier at its middle. All
//! sums are integers: the same bits however the samples come, whatever the processor.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::band::{Band, LAST_SAMPLE};
use super::replica::{Output, Part, Replica, SUBCHIPS};
use super::ring::LONGEST_STEP;
use super::tap_plan::TapPlan;
use crate::simd::runs::{correlate, Runs, Sums, FRACTION, TURN_AMPLITUDE, UNIT};
use crate::{nco, C64};

/// A code position of one sample.
const ONE: f64 = (1u64 << FRACTION) as f64;
/// Samples per chip that can be correlated: a step of the runs of eight chips is the longest.
pub const SAMPLES_PER_CHIP: RangeInclusive<f64> = 0.25..=(LONGEST_STEP / UNIT) as f64;
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
    /// Whole sample and 2^-40 fraction of the slice's start.
    base: u64,
    fraction: u64,
    /// Samples per chip, 2^-40 units, a multiple of all sub-chips.
    chip_step: u64,
    /// Carrier beyond the band's nominal frequency at sample `base`: 2^-64 cycles, unwrapped.
    carrier: i128,
    carrier_step: i64,
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
    /// than [`FARTHEST_TAP`], or if `start` is not within 0 and [`LAST_SAMPLE`].
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
        assert!(
            (0.0..=LAST_SAMPLE as f64).contains(&start),
            "a channel cannot start at sample {start}"
        );
        let base = start.floor();
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
            base: base as u64,
            fraction: ((start - base) * ONE) as u64,
            chip_step: 0,
            carrier: 0,
            carrier_step: 0,
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
        assert!(
            carrier.is_finite() && SAMPLES_PER_CHIP.contains(&samples_per_chip),
            "cannot correlate at {carrier} cycles per sample and {samples_per_chip} samples per chip"
        );
        self.carrier_step = nco::step_from_frequency(carrier) as i64;
        self.chip_step = (samples_per_chip * ONE / SUBCHIPS as f64).round() as u64 * SUBCHIPS;
    }

    /// Adds to the carrier phase (cycles), between slices.
    ///
    /// # Panics
    /// Within a slice, or for more cycles than [`LAST_SAMPLE`].
    pub fn shift_carrier(&mut self, cycles: f64) {
        self.check_between_slices();
        assert!(
            cycles.abs() <= LAST_SAMPLE as f64,
            "cannot turn a carrier by {cycles} cycles"
        );
        self.carrier += (cycles * nco::CYCLE) as i128;
    }

    /// Moves the replica by this many samples (positive = later), between slices. What it is
    /// moved back to must still be held by its band.
    ///
    /// # Panics
    /// Within a slice, or to a sample that is not within 0 and [`LAST_SAMPLE`].
    pub fn shift_code(&mut self, samples: f64) {
        self.check_between_slices();
        let here = (i128::from(self.base) << FRACTION) | i128::from(self.fraction);
        let there = here.saturating_add((samples * ONE).round() as i128);
        assert!(
            !samples.is_nan() && (0..=i128::from(LAST_SAMPLE) << FRACTION).contains(&there),
            "cannot move a replica at sample {} by {samples}",
            self.base
        );
        let base = (there >> FRACTION) as u64;
        self.carrier += i128::from(self.carrier_step) * (i128::from(base) - i128::from(self.base));
        self.base = base;
        self.fraction = there as u64 & ((1 << FRACTION) - 1);
    }

    fn check_between_slices(&self) {
        assert!(!self.begun, "a channel is to be steered between slices");
    }

    /// Start of the present slice in samples.
    pub fn start(&self) -> f64 {
        self.base as f64 + self.fraction as f64 / ONE
    }

    /// Fraction of a sample between [`Correlator::base`] and the present slice's start.
    pub fn fraction(&self) -> f64 {
        self.fraction as f64 / ONE
    }

    /// Samples per chip of the replica.
    pub fn samples_per_chip(&self) -> f64 {
        self.chip_step as f64 / ONE
    }

    /// Carrier phase beyond the band's nominal frequency at [`Correlator::base`], cycles,
    /// unwrapped.
    pub fn carrier_cycles(&self) -> f64 {
        self.carrier as f64 / nco::CYCLE
    }

    /// Whole sample at or before the present slice's start.
    pub fn base(&self) -> u64 {
        self.base
    }

    /// Farthest tap from the prompt.
    pub(crate) fn reach(&self) -> usize {
        self.reach[1].max(-self.reach[0]) as usize
    }

    /// The earliest sample that the slice in progress needs; it may lie before the recording.
    pub(crate) fn oldest(&self) -> i64 {
        let parts = 0..self.progress.len();
        let needed = parts.map(|part| self.needed(part)).min();
        needed.unwrap_or(self.base as i64)
    }

    /// The earliest sample that a part of the replica still needs.
    fn needed(&self, part: usize) -> i64 {
        let progress = &self.progress[part];
        let list = self.replica.parts[part].list(progress.fine);
        let edge = u64::from(list.slices[self.index][progress.edges]);
        let passed = (self.fraction + edge * (self.chip_step / list.subchips)) >> FRACTION;
        (self.base + passed) as i64 + self.reach[0]
    }

    /// Works off what the band holds; gives the slice once it is complete, and stands then at
    /// the start of the next.
    ///
    /// # Panics
    /// If the band no longer holds samples that are needed, or rates have never been set.
    pub fn advance(&mut self, band: &Band) -> Option<&Slice> {
        let limit = band.end().wrapping_sub(self.base) as i64 - self.reach[1];
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
        assert!(self.chip_step > 0, "a channel without rates");
        let step = band.detuning_step(self.base);
        self.residual = (self.carrier_step as u64).wrapping_sub(step);
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
            let limit = limit.min(end.wrapping_sub(self.base) as i64);
            if rest.len() == 1 || limit < 0 {
                continue;
            }
            let runs = Runs {
                cells: band.ring().cells(),
                geometry: band.ring().geometry(),
                edges: rest,
                fraction: self.fraction,
                step: self.chip_step / list.subchips,
                base: self.base,
                limit,
                phase: (self.carrier as u64).wrapping_sub(detuning.phase(self.base)),
                phase_step: (self.carrier_step as u64).wrapping_sub(detuning.step),
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
        let end = self.fraction + self.replica.chips_per_slice() * self.chip_step;
        let whole = end >> FRACTION;
        (slice.index, slice.start, slice.samples) = (self.index, self.base, whole);
        self.base += whole;
        self.fraction = end & ((1 << FRACTION) - 1);
        self.carrier += i128::from(self.carrier_step) * i128::from(whole);
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
