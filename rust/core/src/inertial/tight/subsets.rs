//! What the filter would say without one satellite, for each of them: solution separation.
//!
//! M. Brenner, "Integrated GPS/Inertial Fault Detection Availability", Navigation 43 (1996),
//! 111-130. If one satellite is wrong, the filter without it is right: the error of the whole one
//! is at most their distance and what the other one's covariance allows. Like the shadow, a filter
//! without a satellite needs no navigator of its own: its errors are those of the common one.

use super::covariance::{Row, Transition};
use super::filter::ErrorFilter;
use super::POSITION;

/// Distance and standard deviation, horizontal and vertical, m.
pub type Apart = [f64; 4];

/// A filter for each satellite that has been used.
#[derive(Debug, Clone)]
pub struct Subsets {
    without: Vec<Option<ErrorFilter>>,
}

impl Subsets {
    /// No satellite has been used.
    pub fn new(satellites: usize) -> Self {
        Subsets {
            without: vec![None; satellites],
        }
    }

    /// All that are there.
    pub fn each(&mut self) -> impl Iterator<Item = &mut ErrorFilter> {
        self.without.iter_mut().flatten()
    }

    /// Moves on in time.
    pub fn predict(&mut self, step: &Transition) {
        self.each().for_each(|filter| filter.predict(step));
    }

    /// The whole filter is about to use a measurement of a satellite; so do all but its own.
    pub fn used(
        &mut self,
        satellite: usize,
        whole: &ErrorFilter,
        measured: (&Row, f64, f64),
        robust: f64,
    ) {
        let (row, deviation, variance) = measured;
        // Until now the whole filter has done without it.
        self.without[satellite].get_or_insert_with(|| whole.alone());
        for (k, filter) in self.without.iter_mut().enumerate() {
            if let Some(filter) = filter.as_mut().filter(|_| k != satellite) {
                filter.update(row, deviation, variance, robust);
            }
        }
    }

    /// These errors were taken off the navigator.
    pub fn corrected(&mut self, found: &[f64]) {
        for filter in self.each() {
            for (x, f) in filter.x.iter_mut().zip(found) {
                *x -= f;
            }
        }
    }

    /// What each is apart from the whole filter; NaN for satellites that were not used.
    pub fn apart(&self) -> impl Iterator<Item = Apart> + '_ {
        self.without.iter().map(|filter| match filter {
            Some(filter) => apart(filter),
            None => [f64::NAN; 4],
        })
    }
}

fn apart(filter: &ErrorFilter) -> Apart {
    let (n, x) = (filter.layout.count, &filter.x[POSITION..POSITION + 3]);
    let p = |r: usize, c: usize| filter.p[(POSITION + r) * n + POSITION + c];
    let (half, skew) = (0.5 * (p(0, 0) + p(1, 1)), 0.5 * (p(0, 0) - p(1, 1)));
    let largest = half + skew.hypot(p(0, 1));
    [x[0].hypot(x[1]), largest.sqrt(), x[2].abs(), p(2, 2).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::closed_form;
    use crate::inertial::tight::covariance::{at_rest, zeros};
    use crate::inertial::tight::navigator::Navigator;
    use crate::inertial::tight::run::tests::{noise, settings};
    use crate::inertial::tight::settings::Mode;
    use crate::inertial::tight::NAV;

    fn row(satellite: usize, epoch: usize) -> Row {
        let mut made = Row::default();
        for k in 0..3 {
            made.push(POSITION + k, noise(7 * satellite + k));
        }
        made.push(NAV + satellite, 1.0);
        made.push(3 + epoch % 3, 0.5);
        made
    }

    /// The whole filter in closed loop, and one that never hears of the second satellite.
    #[test]
    fn each_is_the_filter_that_never_used_its_satellite() {
        let mut whole = ErrorFilter::new(&settings(Mode::Off), 3, 1);
        let mut without = whole.alone();
        whole.subsets = Some(Box::new(Subsets::new(3)));
        // What was taken off the navigator, as an error of the open loop.
        let mut off = vec![0.0; whole.x.len()];
        let step = Transition {
            phi: at_rest(1.0),
            noise: zeros(),
            interval: 1.0,
        };
        for epoch in 0..6 {
            whole.predict(&step);
            without.predict(&step);
            let keeps = whole.fading(1.0);
            off[NAV..NAV + 3].iter_mut().for_each(|x| *x *= keeps);
            off[15] += off[16];
            for satellite in 0..3 {
                let row = row(satellite, epoch);
                let open = noise(100 * epoch + satellite);
                let closed = open - row.times(&off);
                whole.update_by(satellite, &row, closed, 0.25, 0.0);
                if satellite != 1 {
                    without.update(&row, open, 0.25, 0.0);
                }
            }
            off.iter_mut().zip(&whole.x).for_each(|(o, x)| *o += x);
            whole.taken_off();
        }
        let subsets = whole.subsets.as_mut().unwrap();
        let found = subsets.each().nth(1).unwrap();
        for (k, (x, wanted)) in found.x.iter().zip(&without.x).enumerate() {
            assert!((x + off[k] - wanted).abs() < 1e-9, "{k}");
        }
        let pairs = found.p.iter().zip(&without.p);
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(subsets.apart().all(|a| a.iter().all(|v| *v > 0.0)));
    }

    #[test]
    fn they_stay_where_they_are_when_the_navigator_goes_back() {
        let ship = closed_form::ship().state(0.0);
        let mut nav = Navigator::new(ship, &settings(Mode::Off), 3, 1);
        nav.filter.subsets = Some(Box::new(Subsets::new(3)));
        let use_all = |nav: &mut Navigator| {
            for satellite in 0..3 {
                let (row, said) = (row(satellite, 1), noise(satellite));
                nav.filter.update_by(satellite, &row, said, 0.25, 0.0);
            }
        };
        // The second time there are coloured errors of codes to be shifted too.
        use_all(&mut nav);
        nav.correct();
        use_all(&mut nav);
        nav.correct();
        let errors = std::array::from_fn(|k| 1e-3 * (k + 1) as f64);
        let mut shifted = nav.filter.alone();
        nav.left_behind(&errors, &mut shifted);
        assert!(shifted.x[NAV] != 0.0);
        let before = nav.filter.subsets.clone().unwrap();
        nav.take_back(&errors, &zeros());
        let after = nav.filter.subsets.unwrap();
        for (old, new) in before.without.iter().zip(&after.without) {
            let (old, new) = (old.as_ref().unwrap(), new.as_ref().unwrap());
            assert_eq!(old.p, new.p);
            for ((o, n), by) in old.x.iter().zip(&new.x).zip(&shifted.x) {
                assert!((o + by - n).abs() < 1e-12);
            }
        }
    }
}
