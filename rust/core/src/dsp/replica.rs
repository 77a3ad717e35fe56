//! Replicas as lists of sign changes, cut into slices.

use std::sync::OnceLock;

use crate::signal::{Layer, Modulation, SignalSpec};
use crate::simd::runs::UNIT;
use crate::{Error, Result, C64};

/// Slices are this long in code time.
pub const SLICE_S: f64 = 1e-3;
/// Runs that may be summed before the residual carrier turns them.
const TURNS: [usize; 6] = [64, 32, 16, 8, 4, 2];
/// The longest of them that is of use, s.
const LONGEST_S: f64 = 16e-6;
/// What turning groups of runs, and not samples, may lose.
const LOSS_DB: f64 = 0.025;
/// Runs are cut to this length where the residual carrier is fast: two of them are within the loss
/// at more than 60 kHz.
const FINE_S: f64 = 0.3e-6;
/// Sub-chips per chip divide this.
pub(super) const SUBCHIPS: u64 = 24;

/// What a part of a replica is correlated for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Output {
    /// All taps of the channel.
    Taps = 0,
    /// All but the outer ones.
    InnerTaps = 1,
    /// The prompt of the companion signal.
    Companion = 2,
}

/// One subcarrier layer of one code.
#[derive(Debug)]
pub(super) struct Part {
    /// Conjugate of the layer's weight.
    pub(super) weight: C64,
    pub(super) output: Output,
    /// First sign of each slice.
    pub(super) signs: Vec<f64>,
    layer: Layer,
    code: Vec<i8>,
    chip_s: f64,
    chips_per_slice: usize,
    runs: RunList,
    fine: OnceLock<RunList>,
}

/// Where runs begin.
#[derive(Debug)]
pub(super) struct RunList {
    /// Positions are in these parts of a chip.
    pub(super) subchips: u64,
    /// 0, every sign change, and the slice's end until whole turns are full; per slice.
    pub(super) slices: Vec<Vec<u16>>,
    turns: Vec<Turn>,
}

/// How many runs may be turned together.
#[derive(Debug)]
struct Turn {
    runs: usize,
    /// Root mean square length, in chips.
    span: f64,
    /// Length of the longest step of a correlator, in chips.
    longest: f64,
}

/// The replica of a code period, cut into slices.
#[derive(Debug)]
pub struct Replica {
    pub(super) parts: Vec<Part>,
    chips_per_slice: u64,
    slices: usize,
}

impl Replica {
    /// The replica of a satellite's signal with the given modulation (a QMBOC pilot may be
    /// received as plain BOC(1,1) where the bandwidth is narrow).
    ///
    /// # Errors
    /// [`Error::UnknownPrn`]
    pub fn new(spec: &SignalSpec, prn: u16, modulation: Modulation) -> Result<Self> {
        let mut parts = parts(spec, prn, modulation, Output::InnerTaps)?;
        parts[0].output = Output::Taps;
        Ok(Replica {
            chips_per_slice: parts[0].chips_per_slice as u64,
            slices: parts[0].signs.len(),
            parts,
        })
    }

    /// Adds a signal that is sent together with this one (the data component beside its pilot):
    /// its prompt is correlated with the same oscillators.
    ///
    /// # Errors
    /// [`Error::UnknownPrn`]; [`Error::Invalid`] if its code is not as long, or the carrier
    /// another.
    pub fn with_companion(
        mut self,
        pilot: &SignalSpec,
        spec: &SignalSpec,
        prn: u16,
    ) -> Result<Self> {
        let shape = |s: &SignalSpec| (s.code_length, s.chip_rate_hz, s.carrier_hz);
        if shape(spec) != shape(pilot) {
            return Err(Error::Invalid(format!(
                "{} and {} do not share code timing and carrier",
                pilot.id, spec.id
            )));
        }
        let turn = spec.phase_offset_cycles - pilot.phase_offset_cycles;
        let turn = C64::from_polar(1.0, -std::f64::consts::TAU * turn);
        let mut companion = parts(spec, prn, spec.modulation, Output::Companion)?;
        companion.iter_mut().for_each(|part| part.weight *= turn);
        self.parts.append(&mut companion);
        Ok(self)
    }

    /// What brings the main layer alone to unit power.
    pub(super) fn outer_gain(&self) -> f64 {
        1.0 / self.parts[0].weight.norm()
    }

    /// Chips in a slice.
    pub fn chips_per_slice(&self) -> u64 {
        self.chips_per_slice
    }

    /// Slices per code period.
    pub fn slices_per_period(&self) -> usize {
        self.slices
    }
}

fn parts(spec: &SignalSpec, prn: u16, modulation: Modulation, output: Output) -> Result<Vec<Part>> {
    let code = spec.code(prn)?;
    let layers = modulation.layers().iter();
    layers
        .map(|&layer| Part::new(spec, &code, layer, output))
        .collect()
}

impl Part {
    fn new(spec: &SignalSpec, code: &[i8], layer: Layer, output: Output) -> Result<Self> {
        let chips_per_slice = (spec.chip_rate_hz * SLICE_S).round() as usize;
        let subchips = layer.subchips as u64;
        if !SUBCHIPS.is_multiple_of(subchips)
            || chips_per_slice as u64 * subchips > u64::from(u16::MAX)
        {
            return Err(Error::Invalid(format!(
                "{}: {subchips} sub-chips in each of {chips_per_slice} chips cannot be correlated",
                spec.id
            )));
        }
        let chip_s = 1.0 / spec.chip_rate_hz;
        Ok(Part {
            weight: C64::new(layer.re, -layer.im),
            output,
            signs: code
                .iter()
                .step_by(chips_per_slice)
                .map(|&c| f64::from(c))
                .collect(),
            runs: RunList::new(code, chips_per_slice, &layer, 1, false, chip_s),
            fine: OnceLock::new(),
            code: code.to_vec(),
            layer,
            chip_s,
            chips_per_slice,
        })
    }

    /// The runs, and how many of them are turned together, for a residual carrier in cycles per
    /// chip: as many as its loss allows, and the longest step of a correlator in chips.
    pub(super) fn choose(&self, residual: f64, longest: f64) -> (bool, usize) {
        let fit = |list: &RunList| {
            let fits = |t: &&Turn| t.longest <= longest && loss_db(residual * t.span) <= LOSS_DB;
            list.turns.iter().find(fits).map(|t| t.runs)
        };
        match fit(&self.runs) {
            Some(runs) => (false, runs),
            None => (true, fit(self.list(true)).unwrap_or(TURNS[TURNS.len() - 1])),
        }
    }

    pub(super) fn list(&self, fine: bool) -> &RunList {
        if !fine {
            return &self.runs;
        }
        self.fine.get_or_init(|| {
            let subchip_s = self.chip_s / self.layer.subchips as f64;
            let cuts = (subchip_s / FINE_S).ceil() as usize;
            // Positions must stay within 16 bits, and cuts divide a chip evenly.
            let cuts = (1..=cuts)
                .rev()
                .find(|n| {
                    let subchips = n * self.layer.subchips;
                    SUBCHIPS.is_multiple_of(subchips as u64)
                        && self.chips_per_slice * subchips <= usize::from(u16::MAX)
                })
                .unwrap_or(1);
            RunList::new(
                &self.code,
                self.chips_per_slice,
                &self.layer,
                cuts,
                true,
                self.chip_s,
            )
        })
    }
}

/// Loss of a sum over `turn` cycles.
fn loss_db(turn: f64) -> f64 {
    let x = std::f64::consts::PI * turn;
    20.0 * std::f64::consts::LOG10_E * x * x / 6.0
}

impl RunList {
    /// `cuts` positions to a sub-chip; where `fine`, a run ends at each, and one of no length goes
    /// between two of the same sign.
    fn new(
        code: &[i8],
        chips_per_slice: usize,
        layer: &Layer,
        cuts: usize,
        fine: bool,
        chip_s: f64,
    ) -> Self {
        let subchips = layer.subchips * cuts;
        let edges = |chips: &[i8]| {
            let sign = |k: usize| {
                let flips = k / cuts % layer.subchips % 2 == 1;
                chips[k / subchips] * if flips { -1 } else { 1 }
            };
            let total = chips.len() * subchips;
            let mut edges = vec![0u16];
            for k in 1..total {
                if sign(k) != sign(k - 1) {
                    edges.push(k as u16);
                } else if fine {
                    edges.extend([k as u16; 2]);
                }
            }
            edges.push(total as u16);
            edges
        };
        let mut slices: Vec<Vec<u16>> = code.chunks(chips_per_slice).map(edges).collect();
        let run_s = chip_s * chips_per_slice as f64 / slices[0].len() as f64;
        let usable = |&turn: &usize| turn <= UNIT || turn as f64 * run_s <= LONGEST_S;
        let turns: Vec<usize> = TURNS.into_iter().filter(usable).collect();
        for slice in &mut slices {
            let whole = (slice.len() - 1).next_multiple_of(turns[0]) + 1;
            slice.resize(whole, slice[slice.len() - 1]);
        }
        let chips = |span: f64| span / subchips as f64;
        let turn = |runs: usize| Turn {
            runs,
            span: chips(rms_span(&slices[0], runs)),
            longest: chips(longest_step(&slices, runs.max(UNIT))),
        };
        RunList {
            subchips: subchips as u64,
            turns: turns.into_iter().map(turn).collect(),
            slices,
        }
    }
}

/// Length of a group of runs, weighted as its loss is: sqrt(sum T^3 / sum T).
fn rms_span(edges: &[u16], turn: usize) -> f64 {
    let (mut cubes, mut sum) = (0.0, 0.0);
    for group in edges.windows(turn + 1).step_by(turn) {
        let span = f64::from(group[turn] - group[0]);
        cubes += span * span * span;
        sum += span;
    }
    (cubes / sum).sqrt()
}

/// Length of the longest group of runs that are worked off together.
fn longest_step(slices: &[Vec<u16>], step: usize) -> f64 {
    let groups = slices
        .iter()
        .flat_map(|s| s.windows(step + 1).step_by(step));
    f64::from(groups.map(|g| g[step] - g[0]).max().unwrap_or(0))
}
