//! One transmitted signal component as the antenna receives it: the truth, in f64.

use std::sync::Arc;

use super::data::Data;
use super::profile::Profile;
use super::random::hash;
use super::spline::Spline;
use crate::signal::SignalSpec;
use crate::{Error, Result};

/// Speed of light in m/s.
pub const SPEED_OF_LIGHT: f64 = 299_792_458.0;

/// Stream of the wrong symbols.
const ERRORS: u64 = 0x6775_6573_7365_6421;
const TWO_64: f64 = 18_446_744_073_709_551_616.0;

/// A signal component of one transmitter. A spoofer is more emitters.
///
/// Time `t` is seconds since sample 0. With `D(t) = doppler_hz t + doppler_rate_hz_s t^2 / 2` and
/// `R(t)` the value of `range_m`, 0 where there is none:
/// - code phase in chips: `chip_rate (t - R(t)/c - delay_s - code_offset_m(t)/c) +
///   chip_rate/carrier D(t)`, chip 0 of code period 0 of symbol 0 starting at phase 0;
/// - received carrier phase in cycles, over the nominal carrier: `phase_cycles - carrier/c R(t) +
///   D(t) +` the integral of `carrier_offset_hz` from 0 to t.
///
/// Code phase 0 is the start of the secondary code, and of data symbol 0. So with a range that is a
/// pseudorange, `delay_s` is the satellite's time at which all of these begin together (a whole
/// multiple of 18 s of its week does for B1I, B1C and L1 C/A), less the receiver's time of sample 0.
///
/// In the samples, code and carrier move linearly and the power is constant over segments of 16384
/// samples of a grid on the absolute sample index; `start_s` and `end_s` are exact to the sample.
#[derive(Debug, Clone)]
pub struct Emitter {
    /// What is sent.
    pub signal: &'static SignalSpec,
    /// By which satellite (or in whose name).
    pub prn: u16,
    /// C/N0 of this component where `power_db` is 0.
    pub cn0_dbhz: f64,
    /// Motion along the line of sight: moves code and carrier. Components that share it move as one.
    pub range_m: Option<Arc<Spline>>,
    /// Code delay at t = 0, of any size and sign.
    pub delay_s: f64,
    /// Carrier phase at t = 0.
    pub phase_cycles: f64,
    /// Doppler at t = 0, positive when approaching.
    pub doppler_hz: f64,
    /// Rate of change of the Doppler.
    pub doppler_rate_hz_s: f64,
    /// Data symbols.
    pub data: Data,
    /// Delay of the data symbols against the code (rounded to whole chips): a spoofer that repeats
    /// what it hears with its code already aligned.
    pub data_delay_s: f64,
    /// Share of the symbols that are wrong, chosen by a hash of (seed, symbol index).
    pub data_error_rate: f64,
    /// Power over `cn0_dbhz`.
    pub power_db: Profile,
    /// Extra code delay in metres; does not move the carrier.
    pub code_offset_m: Profile,
    /// Extra Doppler; does not move the code.
    pub carrier_offset_hz: Profile,
    /// On the air from this time on.
    pub start_s: f64,
    /// Off the air from this time on.
    pub end_s: f64,
}

impl Emitter {
    /// A steady emitter with everything else at zero, on the air for ever.
    pub fn new(signal: &'static SignalSpec, prn: u16, cn0_dbhz: f64) -> Self {
        Emitter {
            signal,
            prn,
            cn0_dbhz,
            range_m: None,
            delay_s: 0.0,
            phase_cycles: 0.0,
            doppler_hz: 0.0,
            doppler_rate_hz_s: 0.0,
            data: Data::None,
            data_delay_s: 0.0,
            data_error_rate: 0.0,
            power_db: Profile::default(),
            code_offset_m: Profile::default(),
            carrier_offset_hz: Profile::default(),
            start_s: f64::NEG_INFINITY,
            end_s: f64::INFINITY,
        }
    }

    /// Checks what the synthesis relies on.
    pub(crate) fn check(&self) -> Result<()> {
        let numbers = [
            ("cn0_dbhz", self.cn0_dbhz),
            ("delay_s", self.delay_s),
            ("phase_cycles", self.phase_cycles),
            ("doppler_hz", self.doppler_hz),
            ("doppler_rate_hz_s", self.doppler_rate_hz_s),
            ("data_delay_s", self.data_delay_s),
            ("data_error_rate", self.data_error_rate),
        ];
        let bad = numbers.iter().find(|(_, v)| !v.is_finite());
        match bad {
            Some((name, v)) => Err(Error::Invalid(format!(
                "emitter {} PRN {}: {name} is {v}, must be a finite number",
                self.signal.id, self.prn
            ))),
            None if self.start_s.is_nan() || self.end_s.is_nan() => Err(Error::Invalid(format!(
                "emitter {} PRN {}: start_s and end_s must be numbers",
                self.signal.id, self.prn
            ))),
            None => self.data.check(),
        }
    }

    fn doppler_cycles(&self, t: f64) -> f64 {
        (self.doppler_hz + 0.5 * self.doppler_rate_hz_s * t) * t
    }

    /// Total received code phase, in chips.
    pub fn code_phase_chips(&self, t: f64) -> f64 {
        let s = self.signal;
        let mut delay = self.delay_s + self.code_offset_m.value(t) / SPEED_OF_LIGHT;
        if let Some(range) = &self.range_m {
            delay += range.value(t) / SPEED_OF_LIGHT;
        }
        s.chip_rate_hz * (t - delay) + self.doppler_cycles(t) * (s.chip_rate_hz / s.carrier_hz)
    }

    /// Received carrier phase over the nominal carrier, in cycles; grows when approaching.
    pub fn received_phase_cycles(&self, t: f64) -> f64 {
        let phase = self.phase_cycles + self.doppler_cycles(t) + self.carrier_offset_hz.integral(t);
        match &self.range_m {
            Some(range) => phase - self.cycles_per_metre() * range.value(t),
            None => phase,
        }
    }

    /// Doppler of the carrier.
    pub fn carrier_doppler_hz(&self, t: f64) -> f64 {
        let doppler =
            self.doppler_hz + self.doppler_rate_hz_s * t + self.carrier_offset_hz.value(t);
        match &self.range_m {
            Some(range) => doppler - self.cycles_per_metre() * range.rate(t),
            None => doppler,
        }
    }

    fn cycles_per_metre(&self) -> f64 {
        self.signal.carrier_hz / SPEED_OF_LIGHT
    }

    /// C/N0 with the power profile; minus infinity when off the air.
    pub fn cn0_at_dbhz(&self, t: f64) -> f64 {
        if t >= self.start_s && t < self.end_s {
            self.cn0_dbhz + self.power_db.value(t)
        } else {
            f64::NEG_INFINITY
        }
    }

    /// Data symbol (+1 or -1) of this index.
    pub fn data_symbol(&self, index: i64) -> i8 {
        let right = self.data.symbol(index);
        let Some(seed) = self.data.seed() else {
            return right;
        };
        let wrong = (hash(hash(seed, ERRORS), index as u64) as f64) < self.data_error_rate * TWO_64;
        if wrong {
            -right
        } else {
            right
        }
    }

    /// Sign of the data while chip number `chip` is received, of symbols of so many code periods.
    pub fn data_sign(&self, chip: i64, periods_per_symbol: i64) -> i8 {
        let length = self.signal.code_length as i64 * periods_per_symbol;
        self.data_symbol((chip - self.data_delay_chips()).div_euclid(length))
    }

    /// The delay of the data in chips.
    pub fn data_delay_chips(&self) -> i64 {
        (self.data_delay_s * self.signal.chip_rate_hz).round() as i64
    }
}
