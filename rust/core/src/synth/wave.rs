//! The sine table, the carrier of a chain of chips, and the mixing of a band to its intermediate
//! frequency.

use std::f64::consts::TAU;
use std::mem::take;
use std::sync::LazyLock;

use super::pair;
use crate::simd::synth::Loops;

/// Integer value of one standard deviation of the noise in the bands' sums.
pub(super) const UNIT: f64 = (1u64 << 20) as f64;

const BITS: u32 = 11;
const LEN: usize = 1 << BITS;

/// Cosine and sine of 2^11 phases.
pub(crate) type Table = [u64; LEN];

static TABLE: LazyLock<Box<Table>> = LazyLock::new(|| {
    let mut table = Box::new([0; LEN]);
    // From the first quarter, so that quarter turns are exact.
    for k in 0..LEN / 4 {
        let (sin, cos) = (k as f64 / LEN as f64 * TAU).sin_cos();
        let mut wave = [cos as f32, sin as f32];
        for quarter in table.chunks_exact_mut(LEN / 4) {
            quarter[k] = pair::join(wave);
            wave = [-wave[1], wave[0]];
        }
    }
    table
});

/// A phase that moves linearly, in 2^-64 cycles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rotation {
    pub(crate) phase: u64,
    pub(crate) step: u64,
}

impl Rotation {
    /// The same motion, counted from `n` steps later.
    pub(super) fn after(self, n: i64) -> Rotation {
        let phase = self.phase.wrapping_add(self.step.wrapping_mul(n as u64));
        Rotation { phase, ..self }
    }
}

/// Table index nearest to a phase.
#[inline(always)]
fn nearest(phase: u64) -> u64 {
    phase.wrapping_add(1 << (63 - BITS)) >> (64 - BITS)
}

/// exp(j 2 pi phase), phase in 2^-64 cycles; error below 2e-6 (first-order interpolation), exact
/// at quarter turns.
#[inline(always)]
fn interpolated(table: &Table, phase: u64) -> [f32; 2] {
    let k = nearest(phase);
    let rest = phase.wrapping_sub(k << (64 - BITS)) as i64;
    let angle = (rest as f64 * (TAU / 18_446_744_073_709_551_616.0)) as f32;
    let [c, s] = pair::split(table[k as usize]);
    [c - s * angle, s + c * angle]
}

/// exp(j 2 pi phase), as accurate as [`unit_vectors`].
pub(super) fn unit_vector(phase: u64) -> [f32; 2] {
    interpolated(&TABLE, phase)
}

/// exp(j 2 pi phase) over a rotation; error below 2e-6, exact at quarter turns.
pub(super) fn unit_vectors(loops: Loops, rotation: Rotation, re: &mut [f32], im: &mut [f32]) {
    loops.unit_vectors(&TABLE, rotation, re, im);
}

/// The loop of [`unit_vectors`].
#[inline(always)]
pub(crate) fn interpolate(table: &Table, rotation: Rotation, re: &mut [f32], im: &mut [f32]) {
    let mut phase = rotation.phase;
    for (re, im) in re.iter_mut().zip(im) {
        [*re, *im] = interpolated(table, phase);
        phase = phase.wrapping_add(rotation.step);
    }
}

/// Takes the running sum of a difference array, mixes it with exp(j 2 pi phase) and adds it to
/// `re` (and `im`, unless empty). The array is zero afterwards.
///
/// Phases are those nearest in a table of 2048: spurs 60 dB below the (already weak) signals.
pub(super) fn mix(
    loops: Loops,
    diff: &mut [i64],
    rotation: Rotation,
    re: &mut [f32],
    im: &mut [f32],
) {
    loops.running_sum(diff);
    if im.is_empty() {
        loops.mix_real(&TABLE, rotation, diff, re);
    } else {
        loops.mix_complex(&TABLE, rotation, diff, re, im);
    }
}

/// I and Q of a word, in [`UNIT`]ths.
#[inline(always)]
fn unpack(word: i64) -> [f32; 2] {
    let q = word.wrapping_add(1 << 31) >> 32;
    [word as i32 as f32, q as i32 as f32]
}

/// The loop of [`mix`] for real samples; takes the words.
#[inline(always)]
pub(crate) fn mix_real(table: &Table, rotation: Rotation, words: &mut [i64], re: &mut [f32]) {
    let mut phase = rotation.phase;
    for (word, re) in words.iter_mut().zip(re) {
        let [i, q] = unpack(take(word));
        let [c, s] = pair::split(table[nearest(phase) as usize]);
        *re += (i * c - q * s) * (1.0 / UNIT as f32);
        phase = phase.wrapping_add(rotation.step);
    }
}

/// The loop of [`mix`] for complex samples; takes the words.
#[inline(always)]
pub(crate) fn mix_complex(
    table: &Table,
    rotation: Rotation,
    words: &mut [i64],
    re: &mut [f32],
    im: &mut [f32],
) {
    let mut phase = rotation.phase;
    for ((word, re), im) in words.iter_mut().zip(re).zip(im) {
        let [i, q] = unpack(take(word));
        let [c, s] = pair::split(table[nearest(phase) as usize]);
        *re += (i * c - q * s) * (1.0 / UNIT as f32);
        *im += (i * s + q * c) * (1.0 / UNIT as f32);
        phase = phase.wrapping_add(rotation.step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nco::phase_from_cycles;
    use crate::simd::Level;

    #[test]
    fn unit_vectors_are_accurate() {
        for k in 0..10_000 {
            let cycles = f64::from(k) * 0.000_237_1;
            let (s, c) = (cycles * TAU).sin_cos();
            let [re, im] = unit_vector(phase_from_cycles(cycles));
            assert!((f64::from(re) - c).abs() < 2e-6 && (f64::from(im) - s).abs() < 2e-6);
        }
    }

    /// The oscillator's spurs: what differs from the exact product, in dB of it.
    #[test]
    fn mixing_errs_by_60_db() {
        let rotation = Rotation {
            phase: phase_from_cycles(0.3),
            step: phase_from_cycles(0.190_325_4),
        };
        let (i, q) = (3.0 * UNIT, -4.0 * UNIT);
        for loops in Level::available().into_iter().map(Loops::new) {
            let mut diff = vec![0i64; 50_000];
            diff[0] = ((q as i64) << 32) + i as i64;
            let (mut re, mut im) = (vec![0f32; 50_000], vec![0f32; 50_000]);
            mix(loops, &mut diff, rotation, &mut re, &mut im);
            assert!(diff.iter().all(|d| *d == 0));
            let error = |(n, (re, im)): (usize, (&f32, &f32))| {
                let cycles = 0.3 + 0.190_325_4 * n as f64;
                let (s, c) = (cycles * TAU).sin_cos();
                let (x, y) = ((i * c - q * s) / UNIT, (i * s + q * c) / UNIT);
                (f64::from(*re) - x).powi(2) + (f64::from(*im) - y).powi(2)
            };
            let power: f64 = re.iter().zip(&im).enumerate().map(error).sum();
            let spurs_db = 10.0 * (power / 50_000.0 / 25.0).log10();
            // Phase errors are uniform within half a cell: pi / 2048 / sqrt(3) rms.
            assert!((spurs_db + 61.05).abs() < 0.3, "{spurs_db}");
        }
    }
}
