//! Loss and phase against the double-precision reference on the same samples. Every test prints
//! its table: `cargo test --test engine accuracy -- --nocapture`.

use sdr_spoof_core::simd::Level;
use sdr_spoof_core::C64;

use crate::format::FORMATS;
use crate::kinds::KINDS;
use crate::reference::Sums;
use crate::setting::{Setting, LEAD_CYCLES};

const LOSS_DB: f64 = 0.05;
const PHASE_CYCLES: f64 = 0.002;
/// Error of a tap in parts of the prompt: both limits together,
const TAP: f64 = 0.0138;
/// and what the residual carrier turns in this part of a run. A signal that is not aligned with a
/// tap fills only a part of each run of its replica, and not the middle, for which it is turned.
const OFF_CENTRE: f64 = 0.25;

const RATES: [f64; 5] = [5e6, 25e6, 60e6, 120e6, 16.367_667e6];
/// Frequencies of the band in parts of the sample rate, for complex samples and for real ones,
/// which need some distance from their image. Some are at simple ratios, for which a table of the
/// oscillator would always be read at the same cells.
const INTERMEDIATES: [[f64; 6]; 2] = [
    [0.0, 0.25, 0.125, 0.499_999, 0.190_325, -0.309_675],
    [0.0625, 0.25, 0.125, 0.47, 0.190_325, 0.309_675],
];
/// 5 ppm of 1575.42 MHz.
const CLOCK_HZ: f64 = 7877.1;

/// How far off the signal is: name, Doppler and receiver clock error in Hz, whether the band's
/// oscillator follows the clock.
const OFFSETS: [(&str, [f64; 2], f64, bool); 6] = [
    ("none", [0.0, 0.0], 0.0, false),
    ("5 kHz", [5e3, -5e3], 0.0, false),
    ("50 kHz", [50e3, -50e3], 0.0, false),
    ("5 kHz + 5 ppm", [5e3, -5e3], CLOCK_HZ, false),
    ("5 kHz + 5 ppm, retuned", [5e3, -5e3], CLOCK_HZ, true),
    ("50 kHz + 5 ppm", [50e3, -50e3], CLOCK_HZ, false),
];

/// Odd, on the raster, alone, and in several groups, the prompt among them.
const TAPS: [&[i64]; 4] = [
    &[-12, -5, 0, 5, 12],
    &[-16, -8, 0, 8, 16],
    &[0],
    &[-61, -7, 0, 1, 203],
];
const OUTER: i64 = 10;

/// The worst of a row of the table.
#[derive(Default)]
struct Worst {
    cases: usize,
    loss_db: f64,
    phase: f64,
    tap: f64,
    companion: f64,
}

impl Worst {
    fn add(&mut self, setting: &Setting) {
        let Setting { format, .. } = setting;
        let bytes = setting.bytes(format.signal, format.noise);
        let fast = setting.fast(&bytes, Level::best());
        let slow = setting.slow(&bytes);
        assert_eq!(fast.len(), setting.slices, "{setting:?}");
        let sum = |of: &dyn Fn(usize) -> C64| (0..setting.slices).map(of).sum::<C64>();
        let prompt = setting.taps.iter().position(|&t| t == 0).unwrap();
        let tap = |s: &Sums, t: usize| s.0[t];
        let expected = sum(&|s| tap(&slow[s], prompt));
        let ratio = sum(&|s| fast[s].taps[prompt]) / expected;
        let loss_db = (20.0 * ratio.norm().log10()).abs();
        let phase = (ratio.arg() / std::f64::consts::TAU).abs();
        let miss = |t: usize| {
            let miss = sum(&|s| fast[s].taps[t] - tap(&slow[s], t));
            miss.norm() / expected.norm()
        };
        let taps = (0..setting.taps.len()).map(miss).fold(0.0, f64::max);
        let companion = sum(&|s| fast[s].companion - slow[s].1).norm() / expected.norm();
        assert!(loss_db <= LOSS_DB, "loss {loss_db} dB: {setting:?}");
        assert!(phase <= PHASE_CYCLES, "phase {phase} cycle: {setting:?}");
        let run = setting.kind().run_chips() * setting.samples_per_chip;
        let turn = std::f64::consts::TAU * (setting.carrier - setting.retuned.0).abs() * run;
        assert!(taps <= TAP + OFF_CENTRE * turn, "taps {taps}: {setting:?}");
        assert!(companion <= TAP, "companion {companion}: {setting:?}");
        // What both see is the signal.
        let lead = (expected.arg() / std::f64::consts::TAU - LEAD_CYCLES).abs();
        assert!(lead < 0.03, "the signal leads by {lead} more: {setting:?}");
        self.cases += 1;
        self.loss_db = self.loss_db.max(loss_db);
        self.phase = self.phase.max(phase);
        self.tap = self.tap.max(taps);
        self.companion = self.companion.max(companion);
    }
}

/// A case of every offset and rate; format, frequency and taps by the number of the case.
fn setting(kind: usize, n: usize, rate: f64, offset: usize) -> Setting {
    let (_, doppler, clock, retuned) = OFFSETS[offset];
    let spec = KINDS[kind].spec();
    let hz = doppler[n % 2] + clock;
    let taps = TAPS[n / 2 % TAPS.len()];
    let format = FORMATS[n % FORMATS.len()];
    let intermediates = INTERMEDIATES[usize::from(!format.parsed().is_complex())];
    Setting {
        kind,
        format,
        samples_per_chip: rate / (spec.chip_rate_hz * (1.0 + hz / spec.carrier_hz)),
        intermediate: intermediates[n / 3 % intermediates.len()],
        carrier: hz / rate,
        retuned: (if retuned { clock / rate } else { 0.0 }, 0),
        origin: 1000 * n as u64,
        lead: 400.37 + 0.1 * n as f64,
        index: n,
        taps: taps.to_vec(),
        outer: taps
            .iter()
            .map(|t| t.abs() > OUTER && n.is_multiple_of(3))
            .collect(),
        slices: if rate > 50e6 { 1 } else { 3 },
    }
}

/// Runs and prints a kind's table, `rounds` cases for each rate and offset.
fn table(kind: usize, rounds: usize) {
    let mut n = 0;
    let mut lines = String::new();
    for (offset, (name, ..)) in OFFSETS.iter().enumerate() {
        let mut worst = Worst::default();
        for _ in 0..rounds {
            for rate in RATES {
                worst.add(&setting(kind, n, rate, offset));
                n += 1;
            }
        }
        let Worst {
            cases,
            loss_db,
            phase,
            tap,
            companion,
        } = worst;
        lines += &format!(
            "| {} | {name} | {cases} | {loss_db:.4} | {phase:.5} | {tap:.4} | {companion:.4} |\n",
            KINDS[kind].name
        );
    }
    print!("{lines}");
}

macro_rules! tables {
    ($($name:ident, $all:ident: $kind:literal;)*) => {$(
        #[test]
        fn $name() {
            table($kind, 1);
        }

        #[test]
        #[ignore = "a minute and more"]
        fn $all() {
            table($kind, 66);
        }
    )*};
}

tables! {
    b1i, all_b1i: 0;
    b1c_boc11, all_b1c_boc11: 1;
    b1c_qmboc, all_b1c_qmboc: 2;
    b1c_qmboc_and_data, all_b1c_qmboc_and_data: 3;
    l1ca, all_l1ca: 4;
}
