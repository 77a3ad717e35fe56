//! Where a sideband's slices come from: samples, or a simulation of what samples would give.

use std::sync::Arc;

use super::epoch::Seed;
use super::taps::Taps;
use crate::correlator_level::Simulated;
use crate::dsp::band::Band;
use crate::dsp::correlator::{Correlator, Slice};
use crate::dsp::replica::Replica;

/// What there is to work off.
#[derive(Clone, Copy)]
pub enum Feed<'a> {
    /// The bands of a front end.
    Bands(&'a [Band]),
    /// All samples before this one, which are simulated.
    Until(u64),
}

impl<'a> From<&'a [Band]> for Feed<'a> {
    fn from(bands: &'a [Band]) -> Self {
        Feed::Bands(bands)
    }
}

/// A correlator of either kind; the loops see no difference.
pub(crate) enum Source {
    /// Works on samples.
    Samples(Arc<Replica>, Box<Correlator>),
    /// Makes up its slices.
    Simulated(Box<Simulated>),
}

/// Calls a method of the same name of either kind.
macro_rules! either {
    ($self:ident, $correlator:ident => $call:expr) => {
        match $self {
            Source::Samples(_, $correlator) => $call,
            Source::Simulated($correlator) => $call,
        }
    };
}

impl Source {
    /// A correlator of samples; [`Source::start_at`] comes before its first slice.
    pub(super) fn samples(replica: Replica, taps: &Taps) -> Self {
        let replica = Arc::new(replica);
        let correlator = correlator(&replica, taps, 0.0);
        Source::Samples(replica, Box::new(correlator))
    }

    /// Starts afresh at the start of a code period, at `start` samples.
    pub(super) fn start_at(&mut self, start: f64, taps: &Taps) {
        match self {
            Source::Samples(replica, c) => **c = correlator(replica, taps, start),
            Source::Simulated(simulated) => simulated.start_at(start),
        }
    }

    /// The next slice, if all of it is there. `band` is that of the sideband.
    #[inline]
    pub(super) fn advance(&mut self, feed: Feed<'_>, band: usize) -> Option<&Slice> {
        match (self, feed) {
            (Source::Samples(_, c), Feed::Bands(bands)) => c.advance(&bands[band]),
            (Source::Simulated(simulated), Feed::Until(end)) => simulated.advance(end),
            _ => None,
        }
    }

    /// Where a search would find the signal, if it is simulated.
    pub(super) fn search(&self, sample: u64, cn0_min_dbhz: f64) -> Option<Seed> {
        match self {
            Source::Samples(..) => None,
            Source::Simulated(simulated) => simulated.search(sample, cn0_min_dbhz),
        }
    }

    pub(super) fn chips_per_slice(&self) -> u64 {
        match self {
            Source::Samples(replica, _) => replica.chips_per_slice(),
            Source::Simulated(simulated) => simulated.chips_per_slice(),
        }
    }

    pub(super) fn slices_per_period(&self) -> usize {
        match self {
            Source::Samples(replica, _) => replica.slices_per_period(),
            Source::Simulated(simulated) => simulated.slices_per_period(),
        }
    }

    pub(super) fn set_rates(&mut self, carrier: f64, samples_per_chip: f64) {
        either!(self, c => c.set_rates(carrier, samples_per_chip));
    }

    pub(super) fn shift_carrier(&mut self, cycles: f64) {
        either!(self, c => c.shift_carrier(cycles));
    }

    pub(super) fn shift_code(&mut self, samples: f64) {
        either!(self, c => c.shift_code(samples));
    }

    pub(super) fn carrier_cycles(&self) -> f64 {
        either!(self, c => c.carrier_cycles())
    }

    pub(super) fn samples_per_chip(&self) -> f64 {
        either!(self, c => c.samples_per_chip())
    }

    pub(super) fn fraction(&self) -> f64 {
        either!(self, c => c.fraction())
    }

    pub(super) fn base(&self) -> u64 {
        either!(self, c => c.base())
    }
}

/// At the start of a code period.
fn correlator(replica: &Arc<Replica>, taps: &Taps, start: f64) -> Correlator {
    let replica = Arc::clone(replica);
    Correlator::with_outer_taps(replica, &taps.offsets, &taps.outer(), 0, start)
}
