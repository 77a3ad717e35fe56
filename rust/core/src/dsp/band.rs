//! Shared front end of a band: one local oscillator and running (prefix) sums.
//!
//! All satellites of a band lie within a few kHz of one frequency. The band is mixed once and
//! summed once; a run of equal chips of any channel, at any delay, is then the difference of two
//! running sums at its sample-exact edges, and the channel's Doppler a slow rotation of it.

use super::oscillator::{Oscillator, AMPLITUDE, WAVE};
use super::ring::{Ring, Sum, Total, BLOCK, ORIGIN, TOTAL_BITS};
use crate::nco;
use crate::simd::front_end::{self, Blocks};
use crate::simd::Level;

/// Samples as the front end takes them: real, or I and Q interleaved.
#[derive(Debug, Clone, Copy)]
pub enum Samples<'a> {
    /// Signed bytes.
    Int8(&'a [u8]),
    /// 16-bit integers.
    Int16(&'a [i16]),
}

/// Samples are counted up to here, exactly as floats.
pub const LAST_SAMPLE: u64 = 1 << 53;

/// How a band's samples are to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// I and Q, interleaved.
    pub complex: bool,
    /// Take I - jQ.
    pub conjugate: bool,
}

impl Layout {
    /// Values per sample.
    pub fn width(self) -> usize {
        1 + usize::from(self.complex)
    }

    /// A sample times the oscillator.
    #[inline(always)]
    pub(crate) fn mix(self, i: i32, q: i32, [c, s]: [i32; 2]) -> Sum {
        if !self.complex {
            [i * c, i * s]
        } else if self.conjugate {
            [i * c + q * s, i * s - q * c]
        } else {
            [i * c - q * s, i * s + q * c]
        }
    }
}

impl Samples<'_> {
    fn len(&self) -> usize {
        match self {
            Samples::Int8(v) => v.len(),
            Samples::Int16(v) => v.len(),
        }
    }

    fn part(&self, from: usize, to: usize) -> Self {
        match self {
            Samples::Int8(v) => Samples::Int8(&v[from..to]),
            Samples::Int16(v) => Samples::Int16(&v[from..to]),
        }
    }

    /// Sample `at` times the oscillator, as the running total takes it.
    #[inline(always)]
    pub(crate) fn mixed(&self, at: usize, layout: Layout, wave: [i32; 2]) -> [i32; 2] {
        let at = at * layout.width();
        match self {
            Samples::Int8(v) => {
                let q = if layout.complex { v[at + 1] } else { 0 };
                let product = layout.mix(i32::from(v[at] as i8), i32::from(q as i8), wave);
                product.map(|p| p << TOTAL_BITS)
            }
            Samples::Int16(v) => {
                let q = if layout.complex { v[at + 1] } else { 0 };
                layout.mix(i32::from(v[at]), i32::from(q), wave)
            }
        }
    }

    /// What the sums are multiples of: oscillator amplitude in the units of the samples.
    fn gain(&self) -> f64 {
        match self {
            Samples::Int8(_) => f64::from(AMPLITUDE),
            Samples::Int16(_) => f64::from(AMPLITUDE) / f64::from(1 << TOTAL_BITS),
        }
    }
}

/// The oscillator beyond the band's nominal frequency, over a stretch of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Detuning {
    /// First sample.
    from: u64,
    /// Phase beyond the nominal oscillator's at sample `from`, 2^-64 cycles.
    phase: u64,
    /// And its step per sample.
    pub(crate) step: u64,
}

impl Detuning {
    /// Phase beyond the nominal oscillator's at a sample, 2^-64 cycles.
    pub(crate) fn phase(&self, sample: u64) -> u64 {
        let ahead = sample.wrapping_sub(self.from);
        self.phase.wrapping_add(self.step.wrapping_mul(ahead))
    }
}

/// Running sums of one band of the recording, mixed to about zero by the band's oscillator.
#[derive(Debug)]
pub struct Band {
    level: Level,
    layout: Layout,
    /// Nominal frequency, as a step per sample.
    nominal: u64,
    oscillator: Oscillator,
    /// Of the sums that the ring holds, the oldest first.
    detunings: Vec<Detuning>,
    ring: Ring,
    total: Total,
    end: u64,
    gain: f64,
}

impl Band {
    /// A band at `frequency` (cycles per sample, of the recording) from absolute sample `start`.
    ///
    /// At least `history` sums are kept: channels must have worked off older samples before more
    /// are fed. What comes before `start` counts as zeros.
    ///
    /// # Panics
    /// If the frequency is not finite, or for a start after [`LAST_SAMPLE`].
    pub fn new(frequency: f64, layout: Layout, start: u64, history: usize, level: Level) -> Self {
        assert!(
            frequency.is_finite() && start <= LAST_SAMPLE,
            "no band at {frequency} cycles per sample from sample {start}"
        );
        let nominal = nco::step_from_frequency(frequency);
        let detuning = Detuning {
            from: start,
            phase: 0,
            step: 0,
        };
        Band {
            level,
            layout,
            nominal,
            oscillator: Oscillator::new(nominal, 0, 0),
            detunings: vec![detuning],
            ring: Ring::new(history),
            total: Total::from(ORIGIN),
            end: start,
            gain: f64::from(AMPLITUDE),
        }
    }

    /// Moves the oscillator to `offset` (cycles per sample) beyond the nominal frequency for the
    /// samples to come, its phase unbroken. Channels are turned less, and so less often, the
    /// nearer they are to it; what they measure does not depend on it.
    ///
    /// A slice that the oscillator is moved in is correlated as its beginning asks for, so move it
    /// seldom, and not by more than channels may be off.
    ///
    /// # Panics
    /// If the offset is not finite.
    pub fn retune(&mut self, offset: f64) {
        assert!(offset.is_finite(), "no oscillator at {offset}");
        let next = Detuning {
            from: self.end,
            phase: self.now().phase(self.end),
            step: nco::step_from_frequency(offset),
        };
        self.detunings.push(next);
        let oldest = self.end.saturating_sub(self.ring.capacity() as u64);
        let gone = self.detunings[1..].iter().take_while(|d| d.from <= oldest);
        self.detunings.drain(..gone.count());
        let phase = self.oscillator.phase(self.end);
        let step = self.nominal.wrapping_add(next.step);
        self.oscillator = Oscillator::new(step, self.end, phase);
    }

    fn now(&self) -> Detuning {
        self.detunings[self.detunings.len() - 1]
    }

    /// Oscillator beyond the nominal frequency, cycles per sample.
    pub fn offset(&self) -> f64 {
        nco::frequency_from_step(self.now().step)
    }

    /// One past the last sample absorbed: running sums up to this index exist.
    pub fn end(&self) -> u64 {
        self.end
    }

    /// Absorbs samples; no more at a time than the history has room for.
    pub fn feed(&mut self, samples: Samples<'_>) {
        self.gain = samples.gain();
        let width = self.layout.width();
        let total = samples.len() / width;
        let mut at = 0;
        while at < total {
            let into = self.end as usize % BLOCK;
            let blocks = (total - at) / BLOCK;
            let count = if into != 0 || blocks == 0 {
                let count = (BLOCK - into).min(total - at);
                self.absorb_singly(samples.part(at * width, (at + count) * width), count);
                count
            } else {
                let rows = BLOCK / super::ring::LANES;
                let geometry = self.ring.geometry();
                let row = geometry.row(self.end);
                let count = blocks.min((geometry.rows - row) / rows) * BLOCK;
                let blocks = Blocks {
                    samples: samples.part(at * width, (at + count) * width),
                    layout: self.layout,
                    oscillator: &self.oscillator,
                    first: self.oscillator.block(self.end),
                    geometry,
                    row,
                };
                front_end::absorb(self.level, &blocks, self.ring.cells_mut(), &mut self.total);
                if row == 0 {
                    self.ring.repeat_first_rows();
                }
                self.end += count as u64;
                count
            };
            at += count;
        }
        self.ring.store(self.end, self.total.sum());
    }

    /// Part of a block.
    fn absorb_singly(&mut self, samples: Samples<'_>, count: usize) {
        let block = self.oscillator.block(self.end).start();
        for at in 0..count {
            self.ring.store(self.end, self.total.sum());
            let place = self.end as usize % BLOCK;
            let wave = WAVE[self.oscillator.cell(block, place)];
            self.total.add(samples.mixed(at, self.layout, wave));
            self.end += 1;
        }
    }

    pub(crate) fn level(&self) -> Level {
        self.level
    }

    pub(crate) fn ring(&self) -> &Ring {
        &self.ring
    }

    /// Oscillator beyond nominal, stretch by stretch, and the first sample after each.
    pub(crate) fn detunings(&self) -> impl Iterator<Item = (Detuning, u64)> + '_ {
        let ends = self.detunings[1..].iter().map(|next| next.from);
        let ends = ends.chain(std::iter::once(i64::MAX as u64));
        self.detunings.iter().copied().zip(ends)
    }

    /// Step of the oscillator beyond nominal at a sample, 2^-64 cycles.
    pub(crate) fn detuning_step(&self, sample: u64) -> u64 {
        let mut latest = self.detunings.iter().rev();
        let at = latest.find(|d| d.from <= sample);
        at.unwrap_or(&self.detunings[0]).step
    }

    /// What the sums are multiples of, in units of the samples.
    pub(crate) fn gain(&self) -> f64 {
        self.gain
    }
}
