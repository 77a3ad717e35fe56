//! One emitter as a replica's slices meet it.

use std::f64::consts::{PI, TAU};

use super::pulse::split;
use crate::synth::Emitter;
use crate::{Result, C64};

/// A slice of a replica: its first and last instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// Seconds since sample 0.
    pub time_s: [f64; 2],
    /// Replica's code phase at the start, in chips of the code period, and chips passed.
    pub chips: [f64; 2],
    /// Replica's carrier phase over the nominal carrier.
    pub carrier_cycles: [f64; 2],
}

/// What a slice receives of an emitter.
#[derive(Debug, Clone, Copy)]
pub(super) enum Arrival {
    /// It is off the air.
    Silent,
    /// Its code is near the replica's.
    Near(Near),
    /// Its code is far off, and its power (C/N0 in Hz) noise.
    Far(f64),
}

/// A signal whose code is near that of a replica.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    /// Code phase received, less that of the replica, in the middle of the slice.
    pub delay_chips: f64,
    /// Amplitude, sign and phase of a full correlation: mean per sample over the slice, where
    /// 1 is a C/N0 of 1 Hz.
    pub phasor: C64,
}

/// What a search would find.
#[derive(Debug, Clone, Copy)]
pub(super) struct Truth {
    pub cn0_dbhz: f64,
    pub code_phase_chips: f64,
    pub doppler_hz: f64,
}

/// Where an emitter is at an instant.
#[derive(Debug, Clone, Copy)]
struct Point {
    time_s: f64,
    chips: f64,
    cycles: f64,
}

/// An emitter, with what need not be looked up in every slice.
pub(super) struct Emission {
    emitter: Emitter,
    code_length: f64,
    secondary: Vec<i8>,
    periods_per_symbol: Option<i64>,
    /// Where it was at the end of the last slice.
    last: Point,
    /// A power over `cn0_dbhz`, and the amplitude there.
    amplitude: [f64; 2],
    /// A code period and its sign.
    sign: (i64, f64),
}

impl Emission {
    pub fn new(emitter: Emitter) -> Result<Self> {
        emitter.check()?;
        let (spec, prn) = (emitter.signal, emitter.prn);
        Ok(Emission {
            code_length: spec.code_length as f64,
            secondary: spec.secondary(prn)?,
            periods_per_symbol: spec.periods_per_symbol(prn)?.map(|n| n as i64),
            last: Point {
                time_s: f64::NAN,
                chips: 0.0,
                cycles: 0.0,
            },
            amplitude: [f64::NAN, 0.0],
            sign: (i64::MIN, 0.0),
            emitter,
        })
    }

    /// What a slice receives; `reach` is how far off in code it is still near, in chips.
    pub fn arrival(&mut self, span: &Span, reach: f64) -> Arrival {
        let on_air = self.on_air(span.time_s);
        let [from, to] = self.points(span.time_s);
        if on_air <= 0.0 {
            return Arrival::Silent;
        }
        let late = from.chips - span.chips[0];
        let late = late - self.code_length * split(late / self.code_length + 0.5).0 as f64;
        let passed = to.chips - from.chips;
        let delay_chips = late + 0.5 * (passed - span.chips[1]);
        let amplitude = self.amplitude(0.5 * (from.time_s + to.time_s));
        if delay_chips.abs() > reach {
            return Arrival::Far(on_air * amplitude * amplitude);
        }
        let sign = self.mean_sign(from.chips, passed);
        let [first, last] = [
            from.cycles - span.carrier_cycles[0],
            to.cycles - span.carrier_cycles[1],
        ];
        let turn = last - first;
        let size = on_air * sign * amplitude * sinc(turn);
        Arrival::Near(Near {
            delay_chips,
            phasor: size * unit(0.5 * (first + last)),
        })
    }

    /// The truth at an instant.
    pub fn truth(&self, time_s: f64) -> Truth {
        Truth {
            cn0_dbhz: self.emitter.cn0_at_dbhz(time_s),
            code_phase_chips: self.emitter.code_phase_chips(time_s),
            doppler_hz: self.emitter.carrier_doppler_hz(time_s),
        }
    }

    /// Share of the span that it is on the air.
    fn on_air(&self, [from, to]: [f64; 2]) -> f64 {
        let (start, end) = (self.emitter.start_s, self.emitter.end_s);
        if start <= from && end >= to {
            return 1.0;
        }
        (end.min(to) - start.max(from)) / (to - from)
    }

    /// Where it is at either end of a span, which mostly begins where the last one ended.
    fn points(&mut self, [from, to]: [f64; 2]) -> [Point; 2] {
        let first = if self.last.time_s == from {
            self.last
        } else {
            self.point(from)
        };
        self.last = self.point(to);
        [first, self.last]
    }

    fn point(&self, time_s: f64) -> Point {
        Point {
            time_s,
            chips: self.emitter.code_phase_chips(time_s),
            cycles: self.emitter.received_phase_cycles(time_s),
        }
    }

    fn amplitude(&mut self, time_s: f64) -> f64 {
        let power_db = self.emitter.power_db.value(time_s);
        if power_db != self.amplitude[0] {
            let level = 0.05 * (self.emitter.cn0_dbhz + power_db);
            self.amplitude = [power_db, 10f64.powf(level)];
        }
        self.amplitude[1]
    }

    /// Mean of secondary code times data from a code phase on, for so many chips: one code period
    /// or the end of one and the beginning of the next.
    fn mean_sign(&mut self, chips: f64, passed: f64) -> f64 {
        let (period, _) = split(chips / self.code_length);
        let here = self.sign(period);
        let left = (period + 1) as f64 * self.code_length - chips;
        if left >= passed {
            return here;
        }
        let share = left / passed;
        share * here + (1.0 - share) * self.sign(period + 1)
    }

    /// Of a code period; mostly that of the last call.
    fn sign(&mut self, period: i64) -> f64 {
        if self.sign.0 != period {
            self.sign = (period, self.period_sign(period));
        }
        self.sign.1
    }

    fn period_sign(&self, period: i64) -> f64 {
        let secondary = match self.secondary.len() as i64 {
            0 => 1,
            n => self.secondary[period.rem_euclid(n) as usize],
        };
        let symbol = match self.periods_per_symbol {
            Some(n) => self.mean_symbol(period, n),
            None => 1.0,
        };
        f64::from(secondary) * symbol
    }

    /// Mean of the data over a code period, within which late data may change.
    fn mean_symbol(&self, period: i64, periods_per_symbol: i64) -> f64 {
        let length = self.code_length as i64;
        let change = self.emitter.data_delay_chips().rem_euclid(length);
        let data = |chip| {
            f64::from(
                self.emitter
                    .data_sign(period * length + chip, periods_per_symbol),
            )
        };
        let share = change as f64 / self.code_length;
        share * data(0) + (1.0 - share) * data(change)
    }
}

/// sin(pi x) / (pi x)
fn sinc(x: f64) -> f64 {
    let y = (PI * x).powi(2);
    if y < 0.01 {
        1.0 - y / 6.0 * (1.0 - y / 20.0 * (1.0 - y / 42.0))
    } else {
        (PI * x).sin() / (PI * x)
    }
}

/// exp(j 2 pi cycles)
fn unit(cycles: f64) -> C64 {
    let (sin, cos) = (split(cycles).1 * TAU).sin_cos();
    C64::new(cos, sin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal;
    use crate::synth::Data;

    #[test]
    fn late_data_change_within_a_period() {
        let b1i = Emitter {
            data: Data::Seeded(3),
            data_delay_s: 0.007_3,
            ..Emitter::new(signal::find("B1I").unwrap(), 27, 45.0)
        };
        let mut emission = Emission::new(b1i.clone()).unwrap();
        for period in -50..200 {
            let mean = (0..2046).map(|chip| f64::from(b1i.data_sign(period * 2046 + chip, 20)));
            let expected = mean.sum::<f64>() / 2046.0;
            let secondary = f64::from(emission.secondary[period.rem_euclid(20) as usize]);
            let found = emission.mean_sign(period as f64 * 2046.0, 2046.0);
            assert!(
                (found - expected * secondary).abs() < 1e-9,
                "period {period}"
            );
        }
    }
}
