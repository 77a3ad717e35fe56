//! Signal components that move as one.

use std::sync::Arc;

use super::emitter::Emitter;
use super::wave::unit_vector;
use crate::nco::phase_from_cycles;
use crate::Result;

/// The components of one transmitter that share code timing, carrier and power profile, as data
/// and pilot of a satellite do: their code edges are at the same places, their carriers parallel.
pub(super) struct Composite {
    /// Whose motion all of them have.
    pub(super) lead: Emitter,
    pub(super) components: Vec<Component>,
    /// The different numbers of sub-chips per chip among the components' layers.
    pub(super) subchips: Vec<i64>,
}

/// An emitter with its code looked up.
pub(super) struct Component {
    emitter: Emitter,
    code: Vec<i8>,
    secondary: Vec<i8>,
    periods_per_symbol: Option<i64>,
    pub(super) layers: Vec<Layer>,
}

/// A layer of a component's subcarrier.
pub(super) struct Layer {
    /// Index in [`Composite::subchips`].
    pub(super) shape: usize,
    /// At `power_db` = 0, over the noise's standard deviation.
    pub(super) amplitude: f64,
    /// Direction against the carrier, a unit vector.
    pub(super) direction: [f32; 2],
}

impl Composite {
    /// Adds an emitter to the composite that it belongs to, a new one if need be. `amplitude` is
    /// that at `power_db` = 0, over the noise's standard deviation.
    pub(super) fn add_to(all: &mut Vec<Composite>, emitter: Emitter, amplitude: f64) -> Result<()> {
        emitter.check()?;
        let known = all.iter().position(|c| move_as_one(&c.lead, &emitter));
        let index = known.unwrap_or_else(|| {
            all.push(Composite {
                lead: emitter.clone(),
                components: vec![],
                subchips: vec![],
            });
            all.len() - 1
        });
        all[index].add(emitter, amplitude)
    }

    fn add(&mut self, emitter: Emitter, amplitude: f64) -> Result<()> {
        let (signal, prn) = (emitter.signal, emitter.prn);
        let layer = |l: &crate::signal::Layer| {
            let subchips = l.subchips as i64;
            let known = self.subchips.iter().position(|&n| n == subchips);
            let turn = l.im.atan2(l.re) / std::f64::consts::TAU + signal.phase_offset_cycles;
            Layer {
                shape: known.unwrap_or_else(|| {
                    self.subchips.push(subchips);
                    self.subchips.len() - 1
                }),
                amplitude: amplitude * l.re.hypot(l.im),
                direction: unit_vector(phase_from_cycles(turn)),
            }
        };
        let layers = signal.modulation.layers().iter().map(layer).collect();
        self.components.push(Component {
            code: signal.code(prn)?,
            secondary: signal.secondary(prn)?,
            periods_per_symbol: signal.periods_per_symbol(prn)?.map(|n| n as i64),
            layers,
            emitter,
        });
        Ok(())
    }
}

/// Whether code edges, carrier and power of two emitters are the same functions of time.
fn move_as_one(a: &Emitter, b: &Emitter) -> bool {
    let numbers = |e: &Emitter| {
        let signal = [e.signal.carrier_hz, e.signal.chip_rate_hz];
        let motion = [e.delay_s, e.phase_cycles, e.doppler_hz, e.doppler_rate_hz_s];
        (signal, motion, [e.start_s, e.end_s])
    };
    numbers(a) == numbers(b)
        && share_range(a, b)
        && a.power_db == b.power_db
        && a.code_offset_m == b.code_offset_m
        && a.carrier_offset_hz == b.carrier_offset_hz
}

fn share_range(a: &Emitter, b: &Emitter) -> bool {
    match (&a.range_m, &b.range_m) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a == b,
        (None, None) => true,
        _ => false,
    }
}

impl Component {
    /// Signs of the chips from number `chip` on: code, secondary code and data.
    pub(super) fn signs(&self, chip: i64, signs: &mut [i8]) {
        let length = self.code.len();
        // Where in a code period the data may change.
        let change = self.emitter.data_delay_chips().rem_euclid(length as i64) as usize;
        let mut first = chip.rem_euclid(length as i64) as usize;
        let (mut chip, mut rest) = (chip, signs);
        while !rest.is_empty() {
            let end = if first < change { change } else { length };
            let (run, after) = rest.split_at_mut((end - first).min(rest.len()));
            let sign = self.sign(chip);
            for (out, chip) in run.iter_mut().zip(&self.code[first..]) {
                *out = sign * chip;
            }
            chip += run.len() as i64;
            (rest, first) = (after, end % length);
        }
    }

    /// Secondary code times data symbol at a chip.
    fn sign(&self, chip: i64) -> i8 {
        let secondary = match self.secondary.len() as i64 {
            0 => 1,
            n => self.secondary[chip.div_euclid(self.code.len() as i64).rem_euclid(n) as usize],
        };
        let symbol = match self.periods_per_symbol {
            Some(n) => self.emitter.data_sign(chip, n),
            None => 1,
        };
        secondary * symbol
    }
}
