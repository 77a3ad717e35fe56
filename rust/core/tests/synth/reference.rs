//! The signal model written down sample by sample, in f64.

use std::f64::consts::TAU;

use num_complex::Complex64;
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::signal::{find, Modulation};
use sdr_spoof_core::synth::{Emitter, SynthConfig};

/// A configuration without filter or noise, in 32-bit floats.
pub fn config(format: &str, sample_rate_hz: f64, lo_hz: f64) -> SynthConfig {
    SynthConfig {
        sample_rate_hz,
        lo_hz,
        format: SampleFormat::parse(format).unwrap(),
        noise_rms_lsb: 1.0,
        noise: false,
        seed: 1,
        filter: None,
        threads: 2,
    }
}

pub fn emitter(signal: &str, prn: u16, cn0_dbhz: f64) -> Emitter {
    Emitter::new(find(signal).unwrap(), prn, cn0_dbhz)
}

/// The values in a recording: real ones with a zero imaginary part.
pub fn samples(config: &SynthConfig, bytes: &[u8]) -> Vec<Complex64> {
    let mut values: Vec<f64> = Vec::new();
    if config.format.bits_per_sample() >= 32
        && config.format != SampleFormat::parse("ci16").unwrap()
    {
        let floats = bytes
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        values.extend(floats.map(f64::from));
    } else {
        let mut integers = Vec::new();
        config.format.unpack(bytes, 1.0, false, &mut integers);
        values.extend(integers.iter().map(|&v| f64::from(v)));
    }
    if config.format.is_complex() {
        values
            .chunks_exact(2)
            .map(|v| Complex64::new(v[0], v[1]))
            .collect()
    } else {
        values.iter().map(|&v| Complex64::new(v, 0.0)).collect()
    }
}

/// Unit-power replica with its carrier at the intermediate frequency, and the distance of the
/// sample to the nearest code edge in chips.
pub struct Reference {
    code: Vec<i8>,
    secondary: Vec<i8>,
    symbol: Option<usize>,
    emitter: Emitter,
    fs_hz: f64,
    lo_hz: f64,
}

impl Reference {
    pub fn new(emitter: &Emitter, config: &SynthConfig) -> Self {
        let (signal, prn) = (emitter.signal, emitter.prn);
        Reference {
            code: signal.code(prn).unwrap(),
            secondary: signal.secondary(prn).unwrap(),
            symbol: signal.periods_per_symbol(prn).unwrap(),
            emitter: emitter.clone(),
            fs_hz: config.sample_rate_hz,
            lo_hz: config.lo_hz,
        }
    }

    pub fn sample(&self, index: u64) -> (Complex64, f64) {
        let e = &self.emitter;
        let t = index as f64 / self.fs_hz;
        let phase = e.code_phase_chips(t);
        let chip = phase.floor();
        let into = phase - chip;
        let period = (chip as i64).div_euclid(self.code.len() as i64);
        let mut sign =
            f64::from(self.code[(chip as i64).rem_euclid(self.code.len() as i64) as usize]);
        if !self.secondary.is_empty() {
            sign *=
                f64::from(self.secondary[period.rem_euclid(self.secondary.len() as i64) as usize]);
        }
        if let Some(n) = self.symbol {
            let late = (e.data_delay_s * e.signal.chip_rate_hz).round();
            let period = ((chip - late) as i64).div_euclid(self.code.len() as i64);
            sign *= f64::from(e.data_symbol(period.div_euclid(n as i64)));
        }
        let square = |n: f64| {
            if (into * n).floor() % 2.0 == 0.0 {
                1.0
            } else {
                -1.0
            }
        };
        let (shape, subchips) = match e.signal.modulation {
            Modulation::Bpsk => (Complex64::new(1.0, 0.0), 1.0),
            Modulation::Boc11 => (Complex64::new(square(2.0), 0.0), 2.0),
            Modulation::Qmboc => {
                let a = (29.0f64 / 33.0).sqrt() * square(2.0);
                (
                    Complex64::new(a, -(4.0f64 / 33.0).sqrt() * square(12.0)),
                    12.0,
                )
            }
        };
        let frequency = e.signal.carrier_hz - self.lo_hz;
        // Whole cycles are taken off before they cost precision.
        let whole = (frequency / self.fs_hz * index as f64).fract();
        let turn = whole + e.received_phase_cycles(t) + e.signal.phase_offset_cycles;
        let edge = (into * subchips - (into * subchips).round()).abs() / subchips;
        (
            shape * sign * Complex64::from_polar(1.0, TAU * turn.fract()),
            edge,
        )
    }
}

/// Amplitude that stands for a C/N0, by the definition: N0 = s^2 / (fs/2) with s = 1.
pub fn amplitude(config: &SynthConfig, cn0_dbhz: f64) -> f64 {
    let cn0 = 10f64.powf(cn0_dbhz / 10.0);
    if config.format.is_complex() {
        let n0 = 2.0 / config.sample_rate_hz; // I and Q
        (cn0 * n0).sqrt()
    } else {
        let n0 = 1.0 / (config.sample_rate_hz / 2.0);
        (2.0 * cn0 * n0).sqrt()
    }
}
