//! Kalman filter of the error states: navigation, coloured errors of codes, systems, the past.

use super::covariance::{take_off, Row, Square, Transition, WORK_ROWS};
use super::settings::{ReceiverNoise, Settings};
use super::subsets::Subsets;
use super::tape::Tape;
use super::{ACCELEROMETER, ATTITUDE, CLOCK, DRIFT, GYRO, NAV, POSITION, VELOCITY};

/// Where the states behind the navigation states begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// First of the coloured code errors, one a satellite; none where they are not modelled.
    pub wander: Option<usize>,
    /// First of the offsets of other systems' clocks from the first one's.
    pub systems: usize,
    /// Position and clock of the epoch before; none where changes are not used.
    pub past: Option<usize>,
    /// Number of all states.
    pub count: usize,
}

impl Layout {
    /// For so many satellites and systems.
    pub fn new(receiver: &ReceiverNoise, satellites: usize, systems: usize) -> Self {
        let wander = (receiver.wander > 0.0).then_some(NAV);
        let behind = NAV + wander.map_or(0, |_| satellites);
        let others = systems.saturating_sub(1);
        let past = (receiver.change > 0.0).then_some(behind + others);
        Layout {
            wander,
            systems: behind,
            past,
            count: behind + others + past.map_or(0, |_| 4),
        }
    }
}

/// What a scalar measurement said before it was used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Innovation {
    /// Predicted minus measured.
    pub value: f64,
    /// Its standard deviation as the filter has it.
    pub sigma: f64,
    /// Whether it was weighted down.
    pub weakened: bool,
}

impl Innovation {
    /// In standard deviations.
    pub fn normalised(&self) -> f64 {
        self.value / self.sigma
    }
}

/// Covariance, and errors found since the last correction.
#[derive(Debug, Clone)]
pub struct ErrorFilter {
    /// Where the states are.
    pub layout: Layout,
    /// Covariance, row by row.
    pub p: Vec<f64>,
    /// Errors found.
    pub x: Vec<f64>,
    /// Where the run is recorded for the smoother, if it is.
    pub tape: Option<Box<Tape>>,
    /// The same without one satellite each, if they are asked for.
    pub subsets: Option<Box<Subsets>>,
    gain: Vec<f64>,
    work: Vec<f64>,
    wander: f64,
    wander_time: f64,
}

/// Variance of the offset between two systems' clocks before it is known, m^2.
const SYSTEM_VARIANCE: f64 = 1e6;

impl ErrorFilter {
    /// With the uncertainties of the start.
    pub fn new(settings: &Settings, satellites: usize, systems: usize) -> Self {
        let layout = Layout::new(&settings.receiver, satellites, systems);
        let n = layout.count;
        let mut filter = ErrorFilter {
            layout,
            p: vec![0.0; n * n],
            x: vec![0.0; n],
            tape: None,
            subsets: None,
            gain: vec![0.0; n],
            work: vec![0.0; n * WORK_ROWS],
            wander: settings.receiver.wander,
            wander_time: settings.receiver.wander_time,
        };
        filter.begin(settings);
        filter
    }

    fn begin(&mut self, settings: &Settings) {
        let s = &settings.start;
        for k in 0..3 {
            self.set(POSITION + k, s.position);
            self.set(VELOCITY + k, s.velocity);
            self.set(ATTITUDE + k, if k < 2 { s.level } else { s.heading });
            self.set(GYRO + k, s.gyro_bias);
            self.set(ACCELEROMETER + k, s.accelerometer_bias);
        }
        self.set(CLOCK, s.clock);
        self.set(DRIFT, s.drift);
        self.forget_behind();
    }

    fn set(&mut self, k: usize, sigma: f64) {
        let n = self.layout.count;
        self.p[k * n + k] = sigma * sigma;
    }

    /// Coloured errors of codes and offsets of systems as if nothing were known of them.
    pub fn forget_behind(&mut self) {
        let n = self.layout.count;
        for row in 0..n {
            for column in 0..n {
                if row >= NAV || column >= NAV {
                    self.p[row * n + column] = 0.0;
                }
            }
        }
        let end = self.layout.past.unwrap_or(n);
        for k in NAV..end {
            let coloured = k < self.layout.systems;
            self.p[k * n + k] = match coloured {
                true => self.wander * self.wander,
                false => SYSTEM_VARIANCE,
            };
        }
        self.x.fill(0.0);
    }

    /// The same as it is now, without a record and without subsets.
    pub fn alone(&self) -> Self {
        ErrorFilter {
            p: self.p.clone(),
            x: self.x.clone(),
            tape: None,
            subsets: None,
            gain: self.gain.clone(),
            work: self.work.clone(),
            ..*self
        }
    }

    /// Moves on in time.
    pub fn predict(&mut self, step: &Transition) {
        if let Some(subsets) = &mut self.subsets {
            subsets.predict(step);
        }
        let n = self.layout.count;
        let (navigation, behind) = self.x.split_at_mut(NAV);
        step.carry(navigation.try_into().expect("navigation states"));
        if self.layout.wander.is_some() {
            let keeps = (-step.interval / self.wander_time).exp();
            let coloured = self.layout.systems - NAV;
            behind[..coloured].iter_mut().for_each(|x| *x *= keeps);
        }
        step.spread(&mut self.p, n, &mut self.work);
        if let Some(first) = self.layout.wander {
            let keeps = (-step.interval / self.wander_time).exp();
            let adds = self.wander * self.wander * (1.0 - keeps * keeps);
            for k in first..self.layout.systems {
                for other in 0..n {
                    self.p[k * n + other] *= keeps;
                    self.p[other * n + k] *= keeps;
                }
                self.p[k * n + k] += adds;
            }
        }
    }

    /// How far coloured errors of codes have faded after `interval`.
    pub fn fading(&self, interval: f64) -> f64 {
        (-interval / self.wander_time).exp()
    }

    /// Innovation of `deviation` (predicted minus measured before anything was found), not used.
    pub fn look(&mut self, row: &Row, deviation: f64, variance: f64) -> Innovation {
        let n = self.layout.count;
        let spread = row.through(&self.p, n, &mut self.gain);
        Innovation {
            value: deviation - row.times(&self.x),
            sigma: (spread + variance).sqrt(),
            weakened: false,
        }
    }

    /// Uses a scalar measurement; beyond `robust` standard deviations (0: never) its variance is
    /// raised so far that it moves the states no more than at that bound (P. J. Huber, "Robust
    /// Statistics" (1981)).
    pub fn update(&mut self, row: &Row, deviation: f64, variance: f64, robust: f64) -> Innovation {
        let mut found = self.look(row, deviation, variance);
        let mut s = found.sigma * found.sigma;
        let beyond = found.normalised().abs() / robust;
        if robust > 0.0 && beyond > 1.0 {
            s *= beyond;
            found.weakened = true;
        }
        let n = self.layout.count;
        for (x, g) in self.x.iter_mut().zip(&self.gain) {
            *x += g * found.value / s;
        }
        take_off(&mut self.p, n, &self.gain, s);
        if let Some(tape) = &mut self.tape {
            tape.used(row, &self.gain, s, found.value);
        }
        found
    }

    /// The same by a certain satellite, which one of the subsets does without.
    pub fn update_by(
        &mut self,
        satellite: usize,
        row: &Row,
        deviation: f64,
        variance: f64,
        robust: f64,
    ) -> Innovation {
        if let Some(mut subsets) = self.subsets.take() {
            subsets.used(satellite, self, (row, deviation, variance), robust);
            self.subsets = Some(subsets);
        }
        self.update(row, deviation, variance, robust)
    }

    /// The errors found have been taken off the navigator.
    pub fn taken_off(&mut self) {
        if let Some(subsets) = &mut self.subsets {
            subsets.corrected(&self.x);
        }
        self.x.fill(0.0);
    }

    /// Remembers position and clock for the change to the next epoch.
    pub fn remember(&mut self) {
        if let Some(subsets) = &mut self.subsets {
            subsets.each().for_each(ErrorFilter::remember);
        }
        let Some(past) = self.layout.past else {
            return;
        };
        let n = self.layout.count;
        let source = [POSITION, POSITION + 1, POSITION + 2, CLOCK];
        for (k, from) in source.into_iter().enumerate() {
            self.x[past + k] = self.x[from];
            for column in 0..past {
                let value = self.p[from * n + column];
                self.p[(past + k) * n + column] = value;
                self.p[column * n + past + k] = value;
            }
        }
        for (k, from) in source.into_iter().enumerate() {
            for (j, column) in source.into_iter().enumerate() {
                self.p[(past + k) * n + past + j] = self.p[from * n + column];
            }
        }
    }

    /// Covariance of the navigation states.
    pub fn navigation(&self) -> Square {
        let n = self.layout.count;
        std::array::from_fn(|r| std::array::from_fn(|c| self.p[r * n + c]))
    }

    /// Puts another covariance of the navigation states, independent of all others.
    pub fn replace(&mut self, square: &Square) {
        let n = self.layout.count;
        for (row, values) in square.iter().enumerate() {
            self.p[row * n..row * n + NAV].copy_from_slice(values);
        }
        self.forget_behind();
    }

    /// Adds to the variances of three states from `first` on.
    pub fn widen(&mut self, first: usize, count: usize, variance: f64) {
        if let Some(subsets) = &mut self.subsets {
            let each = subsets.each();
            each.for_each(|filter| filter.widen(first, count, variance));
        }
        let n = self.layout.count;
        for k in first..first + count {
            self.p[k * n + k] += variance;
        }
    }
}
