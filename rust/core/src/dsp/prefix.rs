//! Shared front end of a band: one fixed local oscillator and running (prefix) sums.
//!
//! All satellites of a band lie within a few kHz of one frequency. The band is mixed once and
//! summed once; a run of equal chips of any channel, at any delay, is then the difference of two
//! prefix values at its sample-exact edges, and the channel's Doppler a slow rotation of it.

use std::sync::LazyLock;

use crate::nco;

const TABLE_BITS: u32 = 10;
/// Amplitude of the oscillator table; correlator outputs are divided by it.
pub(super) const LO_AMPLITUDE: f64 = 16384.0;

/// exp(-j 2 pi phase) at the middle of each table cell, scaled.
static LO_TABLE: LazyLock<Vec<[i32; 2]>> = LazyLock::new(|| {
    let cells = 1usize << TABLE_BITS;
    (0..cells)
        .map(|i| {
            let (s, c) = (std::f64::consts::TAU * (i as f64 + 0.5) / cells as f64).sin_cos();
            [
                (LO_AMPLITUDE * c).round() as i32,
                (-LO_AMPLITUDE * s).round() as i32,
            ]
        })
        .collect()
});

/// Running sums of one band of the recording, mixed to zero by the band's oscillator.
#[derive(Debug)]
pub struct PrefixBand {
    step: u64,
    complex: bool,
    ring: Vec<[i64; 2]>,
    mask: usize,
    sum: [i64; 2],
    end: u64,
}

impl PrefixBand {
    /// A band at `frequency` (cycles per sample, of the recording) from absolute sample `start`.
    ///
    /// The ring keeps at least `history` prefix values.
    pub fn new(frequency: f64, complex: bool, start: u64, history: usize) -> Self {
        let length = history.next_power_of_two();
        PrefixBand {
            step: nco::step_from_frequency(frequency),
            complex,
            ring: vec![[0; 2]; length],
            mask: length - 1,
            sum: [0; 2],
            end: start,
        }
    }

    /// One past the last sample absorbed: prefix values up to this index exist.
    pub fn end(&self) -> u64 {
        self.end
    }

    /// Absorbs samples (I and Q interleaved if the band is complex).
    pub fn feed(&mut self, samples: &[i16]) {
        if self.complex {
            self.absorb(
                samples
                    .chunks_exact(2)
                    .map(|v| (i32::from(v[0]), i32::from(v[1]))),
                |v, lo| [v.0 * lo[0] - v.1 * lo[1], v.0 * lo[1] + v.1 * lo[0]],
            );
        } else {
            self.absorb(samples.iter().map(|&v| i32::from(v)), |v, lo| {
                [v * lo[0], v * lo[1]]
            });
        }
    }

    #[inline(always)]
    fn absorb<T>(
        &mut self,
        samples: impl Iterator<Item = T>,
        mix: impl Fn(T, [i32; 2]) -> [i32; 2],
    ) {
        let table: &[[i32; 2]] = &LO_TABLE;
        let (mut sum, mut at) = (self.sum, self.end);
        let mut phase = self.step.wrapping_mul(at);
        for v in samples {
            let m = mix(v, table[(phase >> (64 - TABLE_BITS)) as usize]);
            sum = [
                sum[0].wrapping_add(i64::from(m[0])),
                sum[1].wrapping_add(i64::from(m[1])),
            ];
            phase = phase.wrapping_add(self.step);
            at += 1;
            self.ring[at as usize & self.mask] = sum;
        }
        (self.sum, self.end) = (sum, at);
    }

    /// Sum of all mixed samples before absolute index `at` (wrapping; only differences mean
    /// anything). `at` must lie within the ring's history.
    #[inline(always)]
    pub(super) fn prefix(&self, at: i64) -> [i64; 2] {
        debug_assert!(at as u64 <= self.end && at as u64 + self.ring.len() as u64 > self.end);
        self.ring[at as usize & self.mask]
    }
}
