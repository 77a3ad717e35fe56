//! A slice by the double-precision reference, from what the correlator says of its oscillators.

use sdr_spoof_core::dsp::correlator::Correlator;
use sdr_spoof_core::dsp::reference::ReferenceReplica;
use sdr_spoof_core::nco;
use sdr_spoof_core::signal::{self, Modulation};
use sdr_spoof_core::C64;

use crate::kinds::{Kind, KINDS, PRN};

/// What a slice gives: taps and companion.
pub type Sums = (Vec<C64>, C64);

/// A slice as it begins: which one, and the oscillators.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Begun {
    pub index: usize,
    /// Whole sample, and code phase from there.
    pub base: u64,
    pub fraction: f64,
    pub samples_per_chip: f64,
    /// Beyond the band's nominal frequency, at `base` and per sample.
    pub carrier_cycles: f64,
    pub carrier: f64,
}

impl Begun {
    pub fn of(channel: &Correlator, index: usize, carrier: f64) -> Self {
        Begun {
            index,
            base: channel.base(),
            fraction: channel.fraction(),
            samples_per_chip: channel.samples_per_chip(),
            carrier_cycles: channel.carrier_cycles(),
            carrier,
        }
    }
}

/// Samples from `origin` on, with a band at `intermediate` cycles per sample.
pub struct Heard<'a> {
    pub samples: &'a [C64],
    pub origin: u64,
    pub intermediate: f64,
}

impl Heard<'_> {
    /// The reference's replica of a slice, and that of the companion, on a time axis that begins
    /// at the origin; the replica's main layer alone, if `main`.
    pub fn replicas(
        &self,
        kind: &Kind,
        begun: &Begun,
        main: bool,
    ) -> [Option<ReferenceReplica>; 2] {
        // The band's oscillator counts from sample 0.
        let band = nco::step_from_frequency(self.intermediate).wrapping_mul(self.origin);
        let lead = begun.base as f64 - self.origin as f64;
        let carrier = begun.carrier_cycles.fract() - (begun.carrier * lead).fract();
        let replica = |id: &str, modulation, turn: f64| ReferenceReplica {
            code: signal::find(id).unwrap().code(PRN).unwrap(),
            modulation,
            start: lead + begun.fraction - first_chip(kind, begun) * begun.samples_per_chip,
            samples_per_chip: begun.samples_per_chip,
            frequency: self.intermediate + begun.carrier,
            phase: nco::cycles_from_phase(band) + carrier + turn,
        };
        let modulation = match kind.modulation {
            Modulation::Qmboc if main => Modulation::Boc11,
            m => m,
        };
        let companion = kind.companion.map(|id| {
            let spec = signal::find(id).unwrap();
            let turn = spec.phase_offset_cycles - kind.spec().phase_offset_cycles;
            replica(id, spec.modulation, turn)
        });
        [Some(replica(kind.id, modulation, 0.0)), companion]
    }

    /// A slice; samples that are not there count as zeros.
    pub fn slice(&self, kind: usize, begun: &Begun, taps: &[i64], outer: &[bool]) -> Sums {
        let kind = &KINDS[kind];
        let sample = |k: i64| {
            let at = usize::try_from(k).ok().and_then(|k| self.samples.get(k));
            at.copied().unwrap_or_default()
        };
        let from = first_chip(kind, begun);
        let [whole, companion] = self.replicas(kind, begun, false);
        let [main, _] = self.replicas(kind, begun, true);
        let correlate = |replica: &Option<ReferenceReplica>, tap| {
            let sum = |r: &ReferenceReplica| r.correlate(sample, from, from + kind.chips(), tap);
            replica.as_ref().map(sum).unwrap_or_default()
        };
        let tap = |(&tap, &outer)| correlate(if outer { &main } else { &whole }, tap);
        let taps = taps.iter().zip(outer).map(tap).collect();
        (taps, correlate(&companion, 0))
    }
}

/// Where in the code period a slice begins.
fn first_chip(kind: &Kind, begun: &Begun) -> f64 {
    (begun.index % kind.replica.slices_per_period()) as f64 * kind.chips()
}
