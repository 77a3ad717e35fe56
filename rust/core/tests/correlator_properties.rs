//! The fast correlator against the reference on whatever proptest comes up with: taps, rates,
//! starts, attach times and cuts of the input.

use std::sync::{Arc, LazyLock};

use proptest::prelude::*;
use sdr_spoof_core::dsp::band::{Band, Layout, Samples};
use sdr_spoof_core::dsp::correlator::{Correlator, Slice};
use sdr_spoof_core::dsp::reference::ReferenceReplica;
use sdr_spoof_core::dsp::replica::Replica;
use sdr_spoof_core::signal::{self, Modulation};
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::C64;

const PRN: u16 = 20;
const SIGNALS: [(&str, Modulation); 4] = [
    ("L1CA", Modulation::Bpsk),
    ("B1I", Modulation::Bpsk),
    ("B1CD", Modulation::Boc11),
    ("B1CP", Modulation::Qmboc),
];
/// Replicas are the same for every case: build them once.
static REPLICAS: LazyLock<Vec<Arc<Replica>>> = LazyLock::new(|| {
    SIGNALS
        .iter()
        .map(|&(id, m)| Arc::new(Replica::new(signal::find(id).unwrap(), PRN, m).unwrap()))
        .collect()
});

/// Everything that a channel and its input can differ in.
#[derive(Debug, Clone)]
struct Case {
    signal: usize,
    complex: bool,
    samples_per_chip: f64,
    intermediate: f64,
    doppler_hz: f64,
    /// First sample of the recording that the band absorbs.
    origin: u64,
    /// The channel's start after the origin, in samples.
    lead: f64,
    index: usize,
    taps: Vec<i64>,
    cuts: Vec<usize>,
}

fn case() -> impl Strategy<Value = Case> {
    let input = (0..SIGNALS.len(), any::<bool>(), 4.0..40.0, -0.45..0.45);
    let channel = (-6e3..6e3, 0..1u64 << 36, 64.0..900.0, 0..10usize);
    let taps = prop::collection::vec(-60..60i64, 1..7);
    let cuts = prop::collection::vec(0..9000usize, 1..6);
    (input, channel, taps, cuts).prop_map(|(input, channel, taps, cuts)| Case {
        signal: input.0,
        complex: input.1,
        samples_per_chip: input.2,
        intermediate: input.3,
        doppler_hz: channel.0,
        origin: channel.1,
        lead: channel.2,
        index: channel.3,
        taps,
        cuts,
    })
}

/// Deterministic noise of +-`level`.
fn noise(index: u64, level: i32) -> i16 {
    let mut z = index.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z >> 33) as i32 % (2 * level + 1) - level) as i16
}

impl Case {
    fn width(&self) -> usize {
        1 + usize::from(self.complex)
    }

    fn chips_per_slice(&self) -> f64 {
        signal::find(SIGNALS[self.signal].0).unwrap().chip_rate_hz * 1e-3
    }

    /// A millisecond and a bit of noise.
    fn samples(&self) -> Vec<i16> {
        let slice = self.chips_per_slice() * self.samples_per_chip;
        let count = (self.lead + slice) as usize + 200;
        (0..count * self.width())
            .map(|k| noise(self.origin.wrapping_add(k as u64), 40))
            .collect()
    }

    /// Cycles per sample.
    fn doppler(&self) -> f64 {
        self.doppler_hz * 1e-3 / (self.chips_per_slice() * self.samples_per_chip)
    }

    /// Rms phase error of the fast correlator in radians, by design: the oscillator's 128 cells,
    /// dithered, and the turning of the Doppler within a group of runs, whose length is chosen so
    /// that it loses 0.025 dB at most (half the square of the phase).
    fn design_error(&self) -> f64 {
        let oscillator = std::f64::consts::TAU / 128.0 / 6f64.sqrt();
        let turning = std::f64::consts::TAU * self.doppler_hz * 20e-6 / 12f64.sqrt();
        let most = (2.0 * 0.025 / (20.0 * std::f64::consts::LOG10_E)).sqrt();
        oscillator.hypot(turning.abs().min(most))
    }

    fn start(&self) -> f64 {
        self.origin as f64 + self.lead
    }

    fn channel(&self) -> Correlator {
        let replica = Arc::clone(&REPLICAS[self.signal]);
        let mut channel = Correlator::new(replica, &self.taps, self.index, self.start());
        channel.set_rates(self.doppler(), self.samples_per_chip);
        channel
    }

    /// One slice; the input cut at `cuts` (cyclically), the channel asked after each piece.
    fn fast(&self, samples: &[i16], cuts: &[usize]) -> Slice {
        let layout = Layout {
            complex: self.complex,
            conjugate: false,
        };
        let mut band = Band::new(
            self.intermediate,
            layout,
            self.origin,
            1 << 17,
            Level::best(),
        );
        let mut channel = self.channel();
        let (mut rest, mut cuts) = (samples, cuts.iter().cycle());
        loop {
            let length = (cuts.next().unwrap() + 1) * self.width();
            let (piece, after) = rest.split_at(length.min(rest.len()));
            band.feed(Samples::Int16(piece));
            if let Some(slice) = channel.advance(&band) {
                return slice.clone();
            }
            assert!(!after.is_empty(), "the slice never came");
            rest = after;
        }
    }

    /// The same slice by the reference, on a time axis that begins at the origin.
    fn slow(&self, samples: &[i16]) -> Vec<C64> {
        let (id, modulation) = SIGNALS[self.signal];
        let chips = self.chips_per_slice();
        let spec = signal::find(id).unwrap();
        let first = (self.index % REPLICAS[self.signal].slices_per_period()) as f64 * chips;
        let lead = self.channel().start() - self.origin as f64;
        // The band's oscillator counts from sample 0; beyond it the channel's is 0 at its base.
        let band = self.intermediate * (self.origin as f64 % 1e6)
            + (self.intermediate * 1e6).fract() * (self.origin as f64 / 1e6).floor();
        let replica = ReferenceReplica {
            code: spec.code(PRN).unwrap(),
            modulation,
            start: lead - first * self.samples_per_chip,
            samples_per_chip: self.samples_per_chip,
            frequency: self.intermediate + self.doppler(),
            phase: band - self.doppler() * lead.floor(),
        };
        let width = self.width();
        let at = |k: i64| {
            let v = &samples[k as usize * width..][..width];
            C64::new(f64::from(v[0]), v.get(1).map_or(0.0, |&q| f64::from(q)))
        };
        self.taps
            .iter()
            .map(|&t| replica.correlate(at, first, first + chips, t))
            .collect()
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..Default::default() })]

    /// Noise in, so nothing but agreement at every chip edge makes the two agree. The rest is
    /// noise of the known size; 6 sigma leaves room for groups longer than the mean.
    #[test]
    fn every_tap_is_the_references(case in case()) {
        let samples = case.samples();
        let fast = case.fast(&samples, &[usize::MAX / 4]);
        let slow = case.slow(&samples);
        let power: f64 = samples.iter().map(|&v| f64::from(v).powi(2)).sum();
        let rms = power.sqrt();
        for ((f, s), tap) in fast.taps.iter().zip(&slow).zip(&case.taps) {
            let miss = (f - s).norm() / rms / case.design_error();
            prop_assert!(miss < 6.0, "tap {tap}: {f} against {s}, {miss} sigma");
        }
    }

    /// However the input is cut, the sums are the same bits.
    #[test]
    fn cuts_change_nothing(case in case()) {
        let samples = case.samples();
        let whole = case.fast(&samples, &[usize::MAX / 4]);
        let cut = case.fast(&samples, &case.cuts);
        prop_assert_eq!(&whole.taps, &cut.taps);
        prop_assert_eq!((whole.start, whole.samples, whole.index), (cut.start, cut.samples, cut.index));
    }

    /// Slices follow each other without gap or overlap, at the rate of the code.
    #[test]
    fn slices_meet(case in case(), slices in 1..30usize) {
        let layout = Layout {
            complex: false,
            conjugate: false,
        };
        let mut band = Band::new(0.0, layout, case.origin, 1 << 21, Level::best());
        let mut channel = case.channel();
        let slice = case.chips_per_slice() * case.samples_per_chip;
        let count = (case.lead + slice * slices as f64) as usize + 200;
        band.feed(Samples::Int16(&vec![0; count]));
        let mut end = channel.base();
        for k in 0..slices {
            let got = channel.advance(&band).expect("enough samples");
            prop_assert_eq!(got.start, end);
            prop_assert_eq!(got.index, (case.index + k) % REPLICAS[case.signal].slices_per_period());
            end += got.samples;
        }
        let expected = case.start() + slice * slices as f64;
        prop_assert!((channel.start() - expected).abs() < 1e-3, "{} {expected}", channel.start());
    }
}
