//! A linear filter in closed loop that is recorded, and the same as one batch of measurements.

use nalgebra::{DMatrix, DVector};

use crate::inertial::tight::adjoint::Adjoint;
use crate::inertial::tight::covariance::{at_rest, zeros, Row, Transition};
use crate::inertial::tight::filter::ErrorFilter;
use crate::inertial::tight::run::tests::noise;
use crate::inertial::tight::settings::Settings;
use crate::inertial::tight::tape::Used;
use crate::inertial::tight::{CLOCK, NAV};

const SATELLITES: usize = 3;
pub const EPOCHS: usize = 7;
const EACH: usize = 5;

/// What happened between two covariances.
pub enum Event {
    Moved(Box<Transition>),
    Used {
        columns: Vec<u16>,
        values: Vec<f64>,
        gain: Vec<f64>,
        s: f64,
        innovation: f64,
    },
    Remembered,
}

/// A filter in closed loop, its record, and the same as one big linear problem: true errors are
/// `mix` times independent variables of variances `spread`, less what was taken off.
pub struct Linear {
    filter: ErrorFilter,
    /// Of each epoch.
    pub events: Vec<Vec<Event>>,
    rows: Vec<Vec<f64>>,
    spread: DMatrix<f64>,
    mix: DMatrix<f64>,
    off: DVector<f64>,
    /// Of each epoch: `mix` and `off`.
    ways: Vec<(DMatrix<f64>, DVector<f64>)>,
    measured: Vec<(DVector<f64>, f64, f64)>,
}

fn pseudo(number: usize) -> f64 {
    noise(number + 77)
}

fn transition(number: usize, quiet: bool) -> Transition {
    let mut phi = at_rest(0.7);
    let mut root = DMatrix::zeros(NAV, NAV);
    for (row, values) in phi.iter_mut().take(9).enumerate() {
        for (column, value) in values.iter_mut().take(15).enumerate() {
            *value += 0.1 * pseudo(1000 * number + 20 * row + column);
        }
    }
    for k in 0..NAV {
        // The second half of the biases is constant.
        let moves = !(quiet && (12..15).contains(&k));
        root[(k, k)] = if moves { 0.3 } else { 0.0 };
    }
    root[(CLOCK, CLOCK + 1)] = 0.1;
    let noise = &root * root.transpose();
    let mut made = zeros();
    for (r, row) in made.iter_mut().enumerate() {
        for (c, value) in row.iter_mut().enumerate() {
            *value = noise[(r, c)];
        }
    }
    Transition {
        phi,
        noise: made,
        interval: 0.7,
    }
}

/// The offset of a system's clock is known to 2 m, so that no digits of the batch are lost.
pub fn begin(settings: &Settings) -> ErrorFilter {
    let mut filter = ErrorFilter::new(settings, SATELLITES, 2);
    let (n, system) = (filter.layout.count, filter.layout.systems);
    filter.p[system * n + system] = 4.0;
    filter
}

impl Linear {
    pub fn new(settings: &Settings) -> Self {
        let filter = begin(settings);
        let n = filter.layout.count;
        Linear {
            spread: DMatrix::from_row_slice(n, n, &filter.p),
            mix: DMatrix::identity(n, n),
            off: DVector::zeros(n),
            filter,
            events: Vec::new(),
            rows: Vec::new(),
            ways: Vec::new(),
            measured: Vec::new(),
        }
    }

    pub fn count(&self) -> usize {
        self.filter.layout.count
    }

    /// Transition of all states, and the covariance that comes up.
    pub fn dense(&self, step: &Transition) -> (DMatrix<f64>, DMatrix<f64>) {
        let (n, layout) = (self.count(), self.filter.layout);
        let mut phi = DMatrix::identity(n, n);
        let mut noise = DMatrix::zeros(n, n);
        for r in 0..NAV {
            for c in 0..NAV {
                phi[(r, c)] = step.phi[r][c];
                noise[(r, c)] = step.noise[r][c];
            }
        }
        let keeps = self.filter.fading(step.interval);
        for k in layout.wander.unwrap()..layout.systems {
            phi[(k, k)] = keeps;
            noise[(k, k)] = 0.25 * (1.0 - keeps * keeps);
        }
        (phi, noise)
    }

    fn moved(&mut self, step: Transition) {
        let n = self.count();
        let (phi, noise) = self.dense(&step);
        self.mix = &phi * &self.mix;
        self.off = &phi * &self.off;
        let (old, new) = (self.mix.ncols(), self.mix.ncols() + n);
        self.mix = self.mix.clone().resize_horizontally(new, 0.0);
        self.mix.view_mut((0, old), (n, n)).fill_with_identity();
        self.spread = self.spread.clone().resize(new, new, 0.0);
        self.spread.view_mut((old, old), (n, n)).copy_from(&noise);
        self.filter.predict(&step);
        self.events
            .last_mut()
            .unwrap()
            .push(Event::Moved(Box::new(step)));
    }

    /// A measurement of any value.
    fn used(&mut self, number: usize) {
        let n = self.count();
        let mut row = Row::default();
        let mut dense = DVector::zeros(n);
        for k in 0..6 {
            let column = (7 * k + 5 * number) % n;
            if dense[column] == 0.0 {
                let value = pseudo(50_000 + 10 * number + k);
                row.push(column, value);
                dense[column] = value;
            }
        }
        let (value, variance) = (3.0 * pseudo(90_000 + number), 0.5);
        // What an open loop would have measured.
        let open = value + dense.dot(&self.off);
        let said = self.mix.transpose() * &dense;
        self.measured.push((said, open, variance));
        let before = self.filter.p.clone();
        let innovation = self.filter.look(&row, value, variance);
        let mut gain = vec![0.0; n];
        row.through(&before, n, &mut gain);
        self.filter.update(&row, value, variance, 0.0);
        let (columns, values) = row.entries().map(|(c, v)| (c as u16, v)).unzip();
        self.events.last_mut().unwrap().push(Event::Used {
            columns,
            values,
            gain,
            s: innovation.sigma.powi(2),
            innovation: innovation.value,
        });
    }

    /// Takes off what was found, and remembers.
    fn close(&mut self) {
        self.off += DVector::from_column_slice(&self.filter.x);
        self.filter.x.fill(0.0);
        self.filter.remember();
        if let Some(past) = self.filter.layout.past {
            for (k, source) in [0, 1, 2, CLOCK].into_iter().enumerate() {
                let row = self.mix.row(source).clone_owned();
                self.mix.set_row(past + k, &row);
                self.off[past + k] = self.off[source];
            }
            self.events.last_mut().unwrap().push(Event::Remembered);
        }
        self.rows.push(self.filter.p[..NAV * self.count()].to_vec());
        self.ways.push((self.mix.clone(), self.off.clone()));
    }

    pub fn run(&mut self, quiet: bool) {
        for epoch in 0..EPOCHS {
            self.events.push(Vec::new());
            for part in 0..2 {
                self.moved(transition(2 * epoch + part, quiet));
            }
            for k in 0..EACH {
                self.used(epoch * EACH + k);
            }
            self.close();
        }
    }

    /// Of each epoch, from all measurements at once: errors and covariance.
    pub fn batch(&self) -> Vec<(DVector<f64>, DMatrix<f64>)> {
        let (m, all) = (self.measured.len(), self.spread.ncols());
        let h = DMatrix::from_fn(m, all, |r, c| {
            self.measured[r].0.get(c).copied().unwrap_or(0.0)
        });
        let z = DVector::from_fn(m, |r, _| self.measured[r].1);
        let noise = DMatrix::from_fn(m, m, |r, c| f64::from(r == c) * self.measured[r].2);
        let root = (&h * &self.spread * h.transpose() + noise)
            .cholesky()
            .unwrap();
        let gain = &self.spread * h.transpose() * root.inverse();
        let (found, left) = (&gain * z, &self.spread - &gain * &h * &self.spread);
        let of = |(mix, off): &(DMatrix<f64>, DVector<f64>)| {
            let mix = mix.clone().resize_horizontally(all, 0.0);
            (&mix * &found - off, &mix * &left * mix.transpose())
        };
        self.ways.iter().map(of).collect()
    }

    /// Of each epoch by the adjoint, backwards.
    pub fn adjoint(&self, mut see: impl FnMut(usize, [f64; NAV], [[f64; 9]; 3])) {
        let layout = self.filter.layout;
        let coloured = layout.wander.unwrap()..layout.systems;
        let mut back = Adjoint::new(self.count());
        for epoch in (0..EPOCHS).rev() {
            let rows = &self.rows[epoch];
            see(epoch, back.errors(rows), back.covariance(rows, [0, 3, 6]));
            for event in self.events[epoch].iter().rev() {
                match event {
                    Event::Moved(step) => {
                        back.moved(step, coloured.clone(), self.filter.fading(step.interval));
                    }
                    Event::Used {
                        columns,
                        values,
                        gain,
                        s,
                        innovation,
                    } => back.used(&Used {
                        columns,
                        values,
                        gain,
                        s: *s,
                        innovation: *innovation,
                    }),
                    Event::Remembered => back.remembered(layout.past.unwrap()),
                }
            }
        }
    }
}
