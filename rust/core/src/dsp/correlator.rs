//! Correlates one signal of one satellite from the prefix sums of its band.
//!
//! The unit of integration is the slice: 1 ms of code. The replica of each subcarrier layer is a
//! list of sign-change positions; edges fall on the first sample at or after the code phase of the
//! change, exactly as a sampled replica has them. Runs are gathered in groups of about 4 us, and
//! each group is turned by the channel's residual carrier at its middle.

use std::sync::{Arc, LazyLock};

use super::prefix::{PrefixBand, LO_AMPLITUDE};
use super::replica::{Replica, MAX_GROUP};
use crate::{nco, C64};

/// Fraction bits of code positions (samples).
const FRACTION: u32 = 40;
const ONE: f64 = (1u64 << FRACTION) as f64;

const TURN_BITS: u32 = 11;
/// exp(-j 2 pi phase) at the middle of each cell.
static TURN: LazyLock<Vec<[f32; 2]>> = LazyLock::new(|| {
    let cells = 1usize << TURN_BITS;
    (0..cells)
        .map(|i| {
            let (s, c) = (std::f64::consts::TAU * (i as f64 + 0.5) / cells as f64).sin_cos();
            [c as f32, -s as f32]
        })
        .collect()
});

/// exp(-j 2 pi cycles)
fn turn_back(cycles: f64) -> C64 {
    C64::from_polar(1.0, -std::f64::consts::TAU * cycles)
}

/// What one slice gave.
#[derive(Debug, Clone)]
pub struct Slice {
    /// Correlation per tap, in input units times samples.
    pub taps: Vec<C64>,
    /// Which slice of the code period this was.
    pub index: usize,
    /// Absolute index of the first sample.
    pub start: u64,
    /// Samples in the slice (prompt tap).
    pub samples: u64,
}

/// A channel's oscillators and partial sums.
#[derive(Debug)]
pub struct Correlator {
    replica: Arc<Replica>,
    taps: Vec<i64>,
    reach: (i64, i64),
    index: usize,
    /// Whole sample and 2^-40 fraction of the slice's start.
    base: u64,
    fraction: u64,
    /// Samples per chip, 2^-40 units.
    chip_step: u64,
    /// Residual carrier (beyond the band's oscillator) at sample `base`: 2^-64 cycles, unwrapped.
    carrier: i128,
    carrier_step: i64,
    /// Per layer: first edge of the next group.
    progress: Vec<usize>,
    sums: Vec<C64>,
}

impl Correlator {
    /// A channel with the given tap offsets (samples, positive = late replica); slice `index` of
    /// the code period starts at `start` samples.
    ///
    /// Call [`Correlator::set_rates`] before the first [`Correlator::advance`].
    pub fn new(replica: Arc<Replica>, taps: &[i64], index: usize, start: f64) -> Self {
        let base = start.floor();
        let layers = replica.layers.len();
        Correlator {
            taps: taps.to_vec(),
            reach: (
                taps.iter().copied().min().unwrap_or(0).min(0),
                taps.iter().copied().max().unwrap_or(0).max(0),
            ),
            index: index % replica.slices_per_period(),
            base: base as u64,
            fraction: ((start - base) * ONE) as u64,
            chip_step: 0,
            carrier: 0,
            carrier_step: 0,
            progress: vec![0; layers],
            sums: vec![C64::default(); layers * taps.len()],
            replica,
        }
    }

    /// Sets the oscillators for the slices to come: residual carrier in cycles per sample, and
    /// samples per chip. To be called between slices only.
    pub fn set_rates(&mut self, carrier: f64, samples_per_chip: f64) {
        self.carrier_step = nco::step_from_frequency(carrier) as i64;
        self.chip_step = (samples_per_chip * ONE).round() as u64;
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

    /// Residual carrier phase at [`Correlator::base`], cycles, unwrapped.
    pub fn carrier_cycles(&self) -> f64 {
        self.carrier as f64 / nco::CYCLE
    }

    /// Whole sample at or before the present slice's start.
    pub fn base(&self) -> u64 {
        self.base
    }

    /// Works off what the band holds; gives the slice once it is complete, and stands then at
    /// the start of the next.
    pub fn advance(&mut self, band: &PrefixBand) -> Option<Slice> {
        let mut complete = true;
        for layer in 0..self.replica.layers.len() {
            complete &= self.advance_layer(layer, band);
        }
        complete.then(|| self.finish())
    }

    /// End of the slice, in 2^-40 samples after `base`.
    fn end(&self) -> u64 {
        self.fraction + self.replica.chips_per_slice() * self.chip_step
    }

    fn advance_layer(&mut self, layer: usize, band: &PrefixBand) -> bool {
        let replica = Arc::clone(&self.replica);
        let runs = &replica.slices[self.index][layer];
        let step = self.chip_step / replica.layers[layer].subchips as u64;
        let last = runs.edges.len() - 1;
        let ceil = |p: u64| ((p + (1 << FRACTION) - 1) >> FRACTION) as i64;
        let (fraction, end) = (self.fraction, self.end());
        let position = |i: usize| {
            let at = if i == last {
                end
            } else {
                fraction + u64::from(runs.edges[i]) * step
            };
            ceil(at)
        };
        let available = band.end() as i64 - self.base as i64 - self.reach.1;
        let mut edges = [0i64; MAX_GROUP + 1];
        let mut from = self.progress[layer];
        edges[0] = position(from);
        while from < last {
            let to = (from + replica.group[layer]).min(last);
            let count = to - from;
            for (edge, i) in edges[1..=count].iter_mut().zip(from + 1..) {
                *edge = position(i);
            }
            if edges[count] > available {
                break;
            }
            let sign = if from.is_multiple_of(2) {
                runs.first
            } else {
                -runs.first
            };
            let sums = &mut self.sums[layer * self.taps.len()..][..self.taps.len()];
            add_group(
                band,
                &edges[..=count],
                self.base as i64,
                &self.taps,
                sign,
                (self.carrier as u64, self.carrier_step),
                sums,
            );
            edges[0] = edges[count];
            from = to;
        }
        self.progress[layer] = from;
        from == last
    }

    fn finish(&mut self) -> Slice {
        let n = self.taps.len();
        let frequency = nco::frequency_from_step(self.carrier_step as u64);
        let taps = (0..n)
            .map(|t| {
                let sum: C64 = self
                    .replica
                    .layers
                    .iter()
                    .enumerate()
                    .map(|(l, layer)| self.sums[l * n + t] * C64::new(layer.re, -layer.im))
                    .sum();
                sum * turn_back(frequency * self.taps[t] as f64) / LO_AMPLITUDE
            })
            .collect();
        let end = self.end();
        let whole = end >> FRACTION;
        let slice = Slice {
            taps,
            index: self.index,
            start: self.base,
            samples: whole,
        };
        self.base += whole;
        self.fraction = end & ((1 << FRACTION) - 1);
        self.carrier += i128::from(self.carrier_step) * i128::from(whole);
        self.index = (self.index + 1) % self.replica.slices_per_period();
        self.progress.fill(0);
        self.sums.fill(C64::default());
        slice
    }
}

/// Adds the alternating sum over one group of runs to every tap.
fn add_group(
    band: &PrefixBand,
    edges: &[i64],
    base: i64,
    taps: &[i64],
    sign: f64,
    (phase, step): (u64, i64),
    sums: &mut [C64],
) {
    let last = edges.len() - 1;
    // Twice the middle sample of the group, so that it stays an integer.
    let middle = edges[0] + edges[last] - 1;
    let advance = (i128::from(step) * i128::from(middle) / 2) as u64;
    let turn = TURN[(phase.wrapping_add(advance) >> (64 - TURN_BITS)) as usize];
    let turn = C64::new(f64::from(turn[0]), f64::from(turn[1])) * sign;
    for (&tap, sum) in taps.iter().zip(sums) {
        let at = base + tap;
        let (mut s, mut plus) = ([0i64; 2], true);
        // first + ... : runs alternate, so inner edges count twice.
        for &edge in &edges[1..last] {
            let w = band.prefix(at + edge);
            let v = if plus {
                w
            } else {
                [w[0].wrapping_neg(), w[1].wrapping_neg()]
            };
            s = [s[0].wrapping_add(v[0]), s[1].wrapping_add(v[1])];
            plus = !plus;
        }
        let (a, b) = (band.prefix(at + edges[0]), band.prefix(at + edges[last]));
        let b = if plus {
            b
        } else {
            [b[0].wrapping_neg(), b[1].wrapping_neg()]
        };
        let total = |k: usize| (s[k].wrapping_mul(2)).wrapping_sub(a[k]).wrapping_add(b[k]) as f64;
        *sum += turn * C64::new(total(0), total(1));
    }
}
