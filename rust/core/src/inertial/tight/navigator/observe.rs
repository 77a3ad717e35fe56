//! What the navigator expects of an epoch's measurements, and what it takes from them.

use nalgebra::Vector3;

use super::super::covariance::Row;
use super::super::epoch::{Deviations, Epoch, Kind};
use super::super::filter::Innovation;
use super::super::measure::{change_row, range_row, rate_row, Antenna};
use super::super::motion::local_axes;
use super::Navigator;
use crate::inertial::earth::ROTATION_RATE;
use crate::nav_math::geodesy::WGS84;

impl Navigator {
    /// Antenna and clock now.
    pub fn antenna(&self) -> Antenna {
        let state = self.strapdown.state();
        let axes = local_axes(state);
        let lever = state.attitude * self.settings.lever_arm;
        let earth = state.attitude.inverse()
            * Vector3::new(
                ROTATION_RATE * state.place.latitude.cos(),
                0.0,
                -ROTATION_RATE * state.place.latitude.sin(),
            );
        let turn = self.turn.unwrap_or(earth) - earth;
        let swing = state.attitude * turn.cross(&self.settings.lever_arm);
        Antenna {
            position: WGS84.ecef(state.place) + axes * lever,
            velocity: axes * (state.velocity + swing),
            lever,
            axes,
            clock: self.clock,
            drift: self.drift,
        }
    }

    /// Predicted minus measured of every satellite.
    pub fn deviate(&mut self, epoch: &Epoch<'_>, out: &mut Deviations) {
        self.know_clock(epoch);
        let antenna = self.antenna();
        // Before the first increment nobody knows how fast a lever arm swings.
        let swings = self.turn.is_none() && self.settings.lever_arm != Vector3::zeros();
        for k in 0..epoch.range.len() {
            let (place, velocity) = (epoch.place[k].into(), epoch.velocity[k].into());
            let sight = antenna.sight(&place, &velocity);
            let system = epoch.system[k];
            let offset = if system > 0 {
                self.offsets[system - 1]
            } else {
                0.0
            };
            out.sight[k] = sight;
            out.range[k] = sight.range + self.wander[k] + offset - epoch.range[k];
            let rate = sight.rate - epoch.rate[k];
            out.rate[k] = if swings { f64::NAN } else { rate };
            out.scale[k] = self.scale(epoch.cn0[k]);
        }
    }

    /// Remembers what the next epoch's change begins with, and forms this epoch's.
    pub fn changes(&self, epoch: &Epoch<'_>, before: Option<&Epoch<'_>>, out: &mut Deviations) {
        out.change.fill(f64::NAN);
        let (Some(past), Some(before)) = (self.past, before) else {
            return;
        };
        for k in 0..epoch.range.len() {
            let (range, towards) = past.range(&before.place[k].into());
            out.before[k] = towards;
            out.change[k] = out.sight[k].range - range - epoch.change[k];
        }
    }

    fn scale(&self, cn0: f64) -> f64 {
        let reference = self.settings.receiver.reference_cn0;
        if reference > 0.0 && cn0 < reference {
            10f64.powf((reference - cn0) / 10.0)
        } else {
            1.0
        }
    }

    /// Takes the clock from the first epoch with ranges: the median of what they say.
    fn know_clock(&mut self, epoch: &Epoch<'_>) {
        if self.clock_known {
            return;
        }
        let antenna = self.antenna();
        let mut says = Vec::new();
        for k in 0..epoch.range.len() {
            let (place, velocity) = (epoch.place[k].into(), epoch.velocity[k].into());
            let sight = antenna.sight(&place, &velocity);
            if epoch.range[k].is_finite() && epoch.system[k] == 0 {
                says.push([epoch.range[k] - sight.range, epoch.rate[k] - sight.rate]);
            }
        }
        let Some(clock) = median(says.iter().map(|s| s[0])) else {
            return;
        };
        self.clock += clock;
        self.drift += median(says.iter().map(|s| s[1])).unwrap_or(0.0);
        self.clock_known = true;
    }

    /// Row, deviation and variance of a satellite's measurement.
    pub fn observe(
        &self,
        kind: Kind,
        k: usize,
        system: usize,
        dev: &Deviations,
    ) -> Option<(Row, f64, f64)> {
        let (noise, sight, layout) = (&self.settings.receiver, &dev.sight[k], self.filter.layout);
        let (row, value, sigma) = match kind {
            Kind::Rate => (rate_row(sight), dev.rate[k], noise.rate),
            Kind::Range => {
                let lever = self.strapdown.state().attitude * self.settings.lever_arm;
                let row = range_row(sight, &lever, &layout, k, system);
                (row, dev.range[k], noise.code)
            }
            Kind::Change => {
                let row = change_row(sight, &dev.before[k], layout.past?);
                (row, dev.change[k], noise.change * std::f64::consts::SQRT_2)
            }
        };
        let variance = sigma * sigma * dev.scale[k];
        value.is_finite().then_some((row, value, variance))
    }

    /// Innovation of a satellite's measurement; `used`: it also moves the states.
    pub fn measure(
        &mut self,
        kind: Kind,
        k: usize,
        system: usize,
        dev: &Deviations,
        used: bool,
    ) -> Option<Innovation> {
        let (row, value, variance) = self.observe(kind, k, system, dev)?;
        let robust = self.settings.testing.robust;
        Some(match used {
            true => self.filter.update_by(k, &row, value, variance, robust),
            false => self.filter.look(&row, value, variance),
        })
    }
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}
