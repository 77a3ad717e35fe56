//! Closed loop of strapdown navigator and error filter, without any judgement.

use nalgebra::Vector3;

use super::covariance::{Row, Square, Transition};
use super::epoch::{Deviations, Epoch, Kind};
use super::filter::{ErrorFilter, Innovation};
use super::measure::{change_row, range_row, rate_row, Antenna};
use super::motion::{local_axes, Motion};
use super::settings::Settings;
use super::{ACCELEROMETER, ATTITUDE, CLOCK, DRIFT, GYRO, NAV, POSITION, VELOCITY};
use crate::inertial::earth::ROTATION_RATE;
use crate::inertial::{Increment, NavState, StateError, Strapdown};
use crate::nav_math::geodesy::WGS84;

/// Strapdown navigator, sensor biases, clock and their filter.
#[derive(Debug, Clone)]
pub struct Navigator {
    settings: Settings,
    strapdown: Strapdown,
    motion: Motion,
    /// Rotation rate of the last increment; none before the first.
    turn: Option<Vector3<f64>>,
    gyro_bias: Vector3<f64>,
    force_bias: Vector3<f64>,
    clock: f64,
    drift: f64,
    clock_known: bool,
    wander: Vec<f64>,
    offsets: Vec<f64>,
    /// Antenna of the epoch before, where its change can be used.
    past: Option<Antenna>,
    /// Of the error states.
    pub filter: ErrorFilter,
}

impl Navigator {
    /// From a state, for so many satellites and systems.
    pub fn new(start: NavState, settings: &Settings, satellites: usize, systems: usize) -> Self {
        Navigator {
            settings: settings.clone(),
            strapdown: Strapdown::new(start),
            motion: Motion::new(),
            turn: None,
            gyro_bias: Vector3::zeros(),
            force_bias: Vector3::zeros(),
            clock: 0.0,
            drift: 0.0,
            clock_known: false,
            wander: vec![0.0; satellites],
            offsets: vec![0.0; systems.max(1) - 1],
            past: None,
            filter: ErrorFilter::new(settings, satellites, systems),
        }
    }

    /// Where it is.
    pub fn state(&self) -> &NavState {
        self.strapdown.state()
    }

    /// Clock in m and drift in m/s.
    pub fn clock(&self) -> [f64; 2] {
        [self.clock, self.drift]
    }

    /// Biases of gyros and accelerometers found so far.
    pub fn biases(&self) -> [Vector3<f64>; 2] {
        [self.gyro_bias, self.force_bias]
    }

    /// Time since the filter was propagated, s.
    pub fn elapsed(&self) -> f64 {
        self.motion.elapsed
    }

    /// Moves on by one increment as the IMU gave it.
    #[inline]
    pub fn advance(&mut self, raw: &Increment) {
        let corrected = Increment {
            rotation: raw.rotation - self.gyro_bias * raw.interval,
            velocity: raw.velocity - self.force_bias * raw.interval,
            interval: raw.interval,
        };
        self.strapdown.advance(&corrected);
        let state = self.strapdown.state();
        self.motion.add(state, &corrected.velocity, raw.interval);
        self.turn = Some(corrected.rotation / raw.interval);
    }

    /// Time that nothing measured: moves on as if nothing turned or accelerated the body, and
    /// knows attitude and velocity the less.
    pub fn bridge(&mut self, raw: &Increment, turn_sigma: f64, velocity_sigma: f64) {
        self.advance(raw);
        self.strapdown.interrupt();
        self.motion.blind[0] += velocity_sigma * velocity_sigma;
        self.motion.blind[1] += turn_sigma * turn_sigma;
    }

    /// Brings the filter up to the navigator's time; gives the transition.
    pub fn predict(&mut self) -> Transition {
        let step = self
            .motion
            .transition(self.strapdown.state(), &self.settings);
        self.filter.predict(&step);
        if let Some(tape) = &mut self.filter.tape {
            tape.moved(self.motion, self.strapdown.state());
        }
        self.clock += self.drift * step.interval;
        let keeps = self.filter.fading(step.interval);
        self.wander.iter_mut().for_each(|w| *w *= keeps);
        self.motion = Motion::new();
        step
    }

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

    /// What `take_back` by these errors makes of the errors of an estimate that does not go back.
    pub fn left_behind(&self, errors: &[f64; NAV], filter: &mut ErrorFilter) {
        filter.p.clone_from(&self.filter.p);
        filter.x.fill(0.0);
        for (x, e) in filter.x.iter_mut().zip(errors) {
            *x = -e;
        }
        if let Some(first) = filter.layout.wander {
            for (x, w) in filter.x[first..].iter_mut().zip(&self.wander) {
                *x = -w;
            }
        }
    }

    /// Takes what the filter has found off the navigator; gives the errors of the navigation
    /// states that were taken off.
    pub fn correct(&mut self) -> [f64; NAV] {
        let mut found = [0.0; NAV];
        found.copy_from_slice(&self.filter.x[..NAV]);
        self.shift(&found);
        let layout = self.filter.layout;
        if let Some(first) = layout.wander {
            for (value, x) in self.wander.iter_mut().zip(&self.filter.x[first..]) {
                *value -= x;
            }
        }
        for (value, x) in self
            .offsets
            .iter_mut()
            .zip(&self.filter.x[layout.systems..])
        {
            *value -= x;
        }
        self.filter.taken_off();
        found
    }

    /// After the last correction of an epoch: its antenna is where the next change begins.
    pub fn close_epoch(&mut self) {
        if self.filter.layout.past.is_some() {
            self.filter.remember();
            self.past = Some(self.antenna());
        }
    }

    /// Goes back to another estimate, `errors` away from this one, with its covariance.
    pub fn take_back(&mut self, errors: &[f64; NAV], covariance: &Square) {
        self.shift(errors);
        self.filter.replace(covariance);
        self.wander.fill(0.0);
        self.past = None;
    }

    /// The clock may have jumped: nothing is known of it until the next epoch.
    pub fn lose_clock(&mut self) {
        self.filter.widen(CLOCK, 1, 1e12);
        self.filter.widen(DRIFT, 1, 1e6);
        self.past = None;
    }

    fn shift(&mut self, errors: &[f64; NAV]) {
        let three =
            |first: usize| Vector3::new(errors[first], errors[first + 1], errors[first + 2]);
        self.strapdown.correct(&StateError {
            position: three(POSITION),
            velocity: three(VELOCITY),
            attitude: three(ATTITUDE),
        });
        self.gyro_bias += three(GYRO);
        self.force_bias += three(ACCELEROMETER);
        self.clock -= errors[CLOCK];
        self.drift -= errors[DRIFT];
    }
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}
