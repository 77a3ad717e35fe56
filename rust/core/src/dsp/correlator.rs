//! Correlates one signal of one satellite from the running sums of its band.
//!
//! The unit of integration is the slice: 1 ms of code. The replica of each subcarrier layer is a
//! list of sign-change positions; edges fall on the first sample at or after the code phase of the
//! change, exactly as a sampled replica has them. Runs are gathered in groups, as long as the
//! residual carrier allows, and each group is turned by the residual carrier at its middle. All
//! sums are integers: the same bits however the samples come, whatever the processor.

use std::sync::Arc;

use super::band::Band;
use super::replica::{Output, Part, Replica, SUBCHIPS};
use super::ring::LANES;
use crate::simd::runs::{correlate, Runs, Sums, FRACTION, TURN_AMPLITUDE};
use crate::{nco, C64};

/// A code position of one sample.
const ONE: f64 = (1u64 << FRACTION) as f64;

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

/// How taps lie in groups of eight, 8 samples apart, that cost one load each.
#[derive(Debug, Default)]
struct TapPlan {
    /// Offset of each group's first lane.
    groups: Vec<i64>,
    /// Tap, and the group and lane where its sum is.
    places: Vec<(usize, usize, usize)>,
}

impl TapPlan {
    /// A plan for taps, by their index and offset.
    fn new(taps: impl Iterator<Item = (usize, i64)>) -> Self {
        let mut taps: Vec<_> = taps.collect();
        taps.sort_by_key(|tap| tap.1);
        let mut plan = TapPlan::default();
        for (tap, offset) in taps {
            let lane = |&group: &i64| {
                let distance = offset - group;
                let lane = distance as usize / LANES;
                (distance % LANES as i64 == 0 && lane < LANES).then_some(lane)
            };
            let mut known = plan.groups.iter().enumerate();
            let place = known.find_map(|(g, first)| lane(first).map(|l| (tap, g, l)));
            plan.places
                .push(place.unwrap_or((tap, plan.groups.len(), 0)));
            if place.is_none() {
                plan.groups.push(offset);
            }
        }
        plan
    }
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
    pub fn new(replica: Arc<Replica>, taps: &[i64], index: usize, start: f64) -> Self {
        Self::with_outer_taps(replica, taps, &vec![false; taps.len()], index, start)
    }

    /// The same, where taps that are marked as outer ones see the main subcarrier layer only, at
    /// unit power: BOC(6,1) costs eight times BOC(1,1), and is of use near the peak.
    pub fn with_outer_taps(
        replica: Arc<Replica>,
        taps: &[i64],
        outer: &[bool],
        index: usize,
        start: f64,
    ) -> Self {
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
    /// in cycles per sample, and samples per chip. To be called between slices only.
    pub fn set_rates(&mut self, carrier: f64, samples_per_chip: f64) {
        self.carrier_step = nco::step_from_frequency(carrier) as i64;
        self.chip_step = (samples_per_chip * ONE / SUBCHIPS as f64).round() as u64 * SUBCHIPS;
    }

    /// Adds to the carrier phase (cycles), between slices.
    pub fn shift_carrier(&mut self, cycles: f64) {
        self.carrier += (cycles * nco::CYCLE) as i128;
    }

    /// Moves the replica by this many samples (positive = later), between slices.
    pub fn shift_code(&mut self, samples: f64) {
        let position = self.start() + samples;
        let base = position.floor();
        self.carrier += i128::from(self.carrier_step) * (base as i128 - i128::from(self.base));
        self.base = base as u64;
        self.fraction = ((position - base) * ONE) as u64;
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

    /// Works off what the band holds; gives the slice once it is complete, and stands then at
    /// the start of the next.
    pub fn advance(&mut self, band: &Band) -> Option<&Slice> {
        let limit = band.end().wrapping_sub(self.base) as i64 - self.reach[1];
        if limit < 0 {
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

    /// Residual carrier per sample at the slice's start, 2^-64 cycles.
    fn residual(&self, band: &Band) -> u64 {
        (self.carrier_step as u64).wrapping_sub(band.detuning(self.base).step)
    }

    /// Chooses how runs are turned in the slice that begins.
    fn begin(&mut self, band: &Band) {
        let residual = nco::frequency_from_step(self.residual(band)) * self.samples_per_chip();
        for (part, progress) in self.replica.parts.iter().zip(&mut self.progress) {
            (progress.fine, progress.runs_per_turn) = part.choose(residual);
            progress.edges = 0;
            progress.sums.fill(Sums::default());
        }
        self.begun = true;
    }

    fn advance_part(&mut self, at: usize, band: &Band, limit: i64) -> bool {
        let part = &self.replica.parts[at];
        let list = part.list(self.progress[at].fine);
        let edges = &list.slices[self.index];
        debug_assert!(
            self.held(band, edges[self.progress[at].edges], list.subchips),
            "the band has lost samples that a channel needs"
        );
        let progress = &mut self.progress[at];
        let taps = &self.plans[part.output as usize].groups;
        let [before, since] = band.detunings();
        // What lies before the last retuning is turned as the oscillator was then.
        let tuned = since.from.wrapping_sub(self.base) as i64;
        for (detuning, limit) in [(before, limit.min(tuned)), (since, limit)] {
            let rest = &edges[progress.edges..];
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

    /// Whether the earliest sum that is needed from an edge on is still there.
    fn held(&self, band: &Band, edge: u16, subchips: u64) -> bool {
        let position = (self.fraction + u64::from(edge) * (self.chip_step / subchips)) >> FRACTION;
        let oldest = (self.base + position) as i64 + self.reach[0];
        band.end() as i64 - oldest < band.ring().capacity() as i64
    }

    fn finish(&mut self, band: &Band) {
        self.twist(self.residual(band));
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
        self.begun = false;
    }

    /// Taps were turned by the carrier at the prompt.
    fn twist(&mut self, residual: u64) {
        if self.twisted == Some(residual) {
            return;
        }
        let frequency = nco::frequency_from_step(residual);
        let taps = self.offsets.iter().zip(&self.gains);
        for (twist, (&tap, gain)) in self.twists.iter_mut().zip(taps) {
            *twist = turn_back(frequency * tap as f64) * gain;
        }
        self.twisted = Some(residual);
    }
}
