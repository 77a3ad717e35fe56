//! Chips to band-base signal: each code edge is one addition to a difference array.
//!
//! A component's complex envelope is constant between code edges, but for the Doppler, which turns
//! it by well under 0.01 cycle in a chip. So a chip costs one phasor and one addition per edge,
//! whatever the sample rate, and the running sum of the differences, taken once per band, is the
//! sum of all its components. Everything is integer arithmetic: exact in any order.

use super::emitter::Emitter;
use super::wave::{phasor, UNIT};
use crate::nco::{phase_from_cycles, step_from_frequency};
use crate::Result;

/// Samples of one linear piece of motion; a grid on the absolute sample index.
pub(super) const SEGMENT: i64 = 1 << 14;

/// Fractional bits of an edge position in samples.
const FRACTION: u32 = 40;
const ONE: f64 = (1u64 << FRACTION) as f64;

/// Envelope I and Q in one word, (Q << 32) + I: sums of words are words of sums.
#[inline(always)]
fn pack(re: f32, im: f32) -> i64 {
    // Truncation of a value within i32; the caller bounds the sum of all amplitudes.
    ((im as i32 as i64) << 32).wrapping_add(re as i32 as i64)
}

/// An emitter with its code looked up.
pub(super) struct Component {
    pub(super) emitter: Emitter,
    code: Vec<i8>,
    secondary: Vec<i8>,
    periods_per_symbol: Option<i64>,
    /// Sub-chips per chip, amplitude share and phase in 2^-64 cycles of each subcarrier layer.
    layers: Vec<(i64, f64, u64)>,
    /// Amplitude at `power_db` = 0 over the noise's standard deviation.
    pub(super) amplitude: f64,
}

/// Motion of a component over one segment, linear in the sample index.
struct Motion {
    /// Chip being received at the segment's first sample.
    first_chip: i64,
    /// Where that chip starts and how long chips are, in 2^-FRACTION samples from segment start.
    position: i64,
    chip_length: i64,
    /// Carrier phase at the middle of that chip and advance per chip.
    phase: u64,
    phase_per_chip: u64,
    amplitude: f64,
    /// Samples of the segment on the air.
    on: i64,
    off: i64,
}

impl Component {
    pub(super) fn new(emitter: Emitter, amplitude: f64) -> Result<Self> {
        emitter.check()?;
        let (signal, prn) = (emitter.signal, emitter.prn);
        let layer = |l: &crate::signal::Layer| {
            let turn = l.im.atan2(l.re) / std::f64::consts::TAU + signal.phase_offset_cycles;
            (l.subchips as i64, l.re.hypot(l.im), phase_from_cycles(turn))
        };
        Ok(Component {
            code: signal.code(prn)?,
            secondary: signal.secondary(prn)?,
            periods_per_symbol: signal.periods_per_symbol(prn)?.map(|n| n as i64),
            layers: signal.modulation.layers().iter().map(layer).collect(),
            amplitude,
            emitter,
        })
    }

    /// Sign of a code period: secondary code times data symbol.
    fn period_sign(&self, period: i64) -> i8 {
        let secondary = match self.secondary.len() as i64 {
            0 => 1,
            n => self.secondary[period.rem_euclid(n) as usize],
        };
        let symbol = match self.periods_per_symbol {
            Some(n) => self.emitter.data_symbol(period.div_euclid(n)),
            None => 1,
        };
        secondary * symbol
    }

    fn motion(&self, segment: i64, sample_rate_hz: f64) -> Motion {
        let e = &self.emitter;
        let time = |sample: i64| sample as f64 / sample_rate_hz;
        let first = segment * SEGMENT;
        let (t0, t1) = (time(first), time(first + SEGMENT));
        let nominal = e.signal.chip_rate_hz / sample_rate_hz;
        let (c0, c1) = (e.code_phase_chips(t0), e.code_phase_chips(t1));
        let mut rate = (c1 - c0) / SEGMENT as f64;
        if !((0.9 * nominal)..(1.1 * nominal)).contains(&rate) {
            rate = nominal; // the profile jumps inside this segment: move at its end
        }
        let (p0, p1) = (e.received_phase_cycles(t0), e.received_phase_cycles(t1));
        let per_chip = (p1 - p0) / (SEGMENT as f64 * rate);
        let into = c0 - c0.floor();
        let edge = |s: f64| ((s * sample_rate_hz).ceil() - first as f64) as i64; // saturates
        Motion {
            first_chip: c0.floor() as i64,
            position: (-into / rate * ONE).round() as i64,
            chip_length: (ONE / rate).round() as i64,
            phase: phase_from_cycles(p0 + (0.5 - into) * per_chip),
            phase_per_chip: step_from_frequency(per_chip),
            amplitude: self.amplitude * 10f64.powf(e.power_db.value(0.5 * (t0 + t1)) / 20.0),
            on: edge(e.start_s),
            off: edge(e.end_s),
        }
    }

    /// Adds samples `from..to` of a segment (counted from its start) to a difference array whose
    /// entry 0 is sample `from`; the array has one entry more than samples.
    pub(super) fn render(&self, segment: i64, from: i64, to: i64, fs_hz: f64, out: &mut [i64]) {
        let motion = self.motion(segment, fs_hz);
        let (lo, hi) = (from.max(motion.on), to.min(motion.off));
        if lo < hi && motion.amplitude > 0.0 {
            for &layer in &self.layers {
                self.render_layer(&motion, layer, (lo, hi), &mut out[(lo - from) as usize..]);
            }
        }
    }

    fn render_layer(
        &self,
        motion: &Motion,
        (subchips, share, turn): (i64, f64, u64),
        (lo, hi): (i64, i64),
        out: &mut [i64],
    ) {
        // First sample at or after a position; edges outside land on the ends.
        let index = |position: i64| {
            (((position + (1 << FRACTION) - 1) >> FRACTION).clamp(lo, hi) - lo) as usize
        };
        let length = self.code.len() as i64;
        let scale = (motion.amplitude * share * UNIT) as f32;
        let skip = ((lo << FRACTION) - motion.position).div_euclid(motion.chip_length);
        let chip = motion.first_chip + skip;
        let (mut period, mut k) = (chip.div_euclid(length), chip.rem_euclid(length) as usize);
        let mut sign = self.period_sign(period);
        let mut position = motion.position + skip * motion.chip_length;
        let mut phase = motion
            .phase
            .wrapping_add(turn)
            .wrapping_add(motion.phase_per_chip.wrapping_mul(skip as u64));
        let subchip = motion.chip_length / subchips;
        let mut last = 0i64;
        while position < hi << FRACTION {
            let [re, im] = phasor(phase);
            let signed = scale * f32::from(sign * self.code[k]);
            let value = pack(re * signed, im * signed);
            let at = index(position);
            out[at] = out[at].wrapping_add(value.wrapping_sub(last));
            last = value;
            for m in 1..subchips {
                let at = index(position + m * subchip);
                out[at] = out[at].wrapping_sub(last.wrapping_mul(2));
                last = last.wrapping_neg();
            }
            position += motion.chip_length;
            phase = phase.wrapping_add(motion.phase_per_chip);
            k += 1;
            if k == self.code.len() {
                k = 0;
                period += 1;
                sign = self.period_sign(period);
            }
        }
        let end = (hi - lo) as usize;
        out[end] = out[end].wrapping_sub(last);
    }
}
