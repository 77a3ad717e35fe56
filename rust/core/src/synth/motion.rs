//! How code and carrier of an emitter move over one segment: linearly in the sample index.

use super::emitter::Emitter;
use super::wave::Rotation;
use crate::nco::{phase_from_cycles, step_from_frequency};

/// Samples of one linear piece of motion; a grid on the absolute sample index.
pub(super) const SEGMENT: i64 = 1 << 14;

/// Fractional bits of a position in samples.
pub(super) const FRACTION: u32 = 40;
const ONE: f64 = (1u64 << FRACTION) as f64;

/// Motion over one segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// Chip being received at the segment's first sample.
    pub(super) first_chip: i64,
    /// Where that chip starts, in 2^-FRACTION samples from the segment's start.
    pub(super) position: i64,
    /// Length of a chip, in the same units.
    pub(super) chip_length: i64,
    /// Carrier at the middle of that chip and its advance per chip.
    pub(super) carrier: Rotation,
    /// Amplitude over that at `power_db` = 0.
    pub(super) gain: f64,
    /// Samples of the segment on the air.
    pub(super) on: i64,
    pub(super) off: i64,
}

impl Motion {
    pub(super) fn new(e: &Emitter, segment: i64, sample_rate_hz: f64) -> Self {
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
            carrier: Rotation {
                phase: phase_from_cycles(p0 + (0.5 - into) * per_chip),
                step: step_from_frequency(per_chip),
            },
            gain: 10f64.powf(e.power_db.value(0.5 * (t0 + t1)) / 20.0),
            on: edge(e.start_s),
            off: edge(e.end_s),
        }
    }
}
