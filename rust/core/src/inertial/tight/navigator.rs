//! Closed loop of strapdown navigator and error filter, without any judgement.

use nalgebra::Vector3;

use super::covariance::{Square, Transition};
use super::filter::ErrorFilter;
use super::measure::Antenna;
use super::motion::Motion;
use super::settings::Settings;
use super::{ACCELEROMETER, ATTITUDE, CLOCK, DRIFT, GYRO, NAV, POSITION, VELOCITY};
use crate::inertial::{Increment, NavState, StateError, Strapdown};

mod observe;

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
        if let Some(subsets) = &mut self.filter.subsets {
            // They do not go back: each has never used what the estimate may have used wrongly.
            let mut off = errors.to_vec();
            if self.filter.layout.wander.is_some() {
                off.extend(&self.wander);
            }
            subsets.corrected(&off);
        }
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
