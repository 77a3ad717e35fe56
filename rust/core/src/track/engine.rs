//! The tracker: all satellites, and the threads to run them.
//!
//! Each thread has front ends and satellites of its own, so that threads share nothing but the
//! samples: to mix and sum a band again costs less than to fetch its sums from another core.

use rayon::prelude::*;

use super::channel::{Channel, WAIT_S};
use super::config::TrackConfig;
use super::grouping;
pub use super::input::{Input, Target};
use super::log::State;
use super::sideband::Sideband;
use crate::dsp::front_end::FrontEnd;
use crate::simd::Level;
use crate::{Error, Result};

/// The oscillators follow the satellites' common frequency if it is farther off than this, Hz.
const DETUNED_HZ: f64 = 500.0;

/// Front ends and satellites of one thread.
struct Unit {
    /// Carriers of the front end's bands.
    carriers_hz: Vec<f64>,
    front: FrontEnd,
    channels: Vec<Channel>,
}

impl Unit {
    fn new(channels: Vec<Channel>, input: &Input, level: Level) -> Self {
        let mut unit = Unit {
            carriers_hz: Vec::new(),
            front: FrontEnd::new(input.stream(), &[], 0, level),
            channels,
        };
        let mut reach = 0;
        for sideband in unit.channels.iter_mut().flat_map(|c| &mut c.sidebands) {
            let carrier = sideband.spec.carrier_hz;
            let known = unit.carriers_hz.iter().position(|&c| c == carrier);
            sideband.band = known.unwrap_or(unit.carriers_hz.len());
            if known.is_none() {
                unit.carriers_hz.push(carrier);
            }
            reach = reach.max(sideband.taps.reach() as usize);
        }
        let fs = input.sample_rate_hz;
        let frequencies: Vec<f64> = unit
            .carriers_hz
            .iter()
            .map(|c| (c - input.lo_hz) / fs)
            .collect();
        // And for a sideband that waits for its partner.
        let history = FrontEnd::history(reach) + (WAIT_S * fs) as usize;
        unit.front = FrontEnd::new(input.stream(), &frequencies, history, level);
        unit
    }

    fn feed(&mut self, bytes: &[u8]) {
        let channels = &mut self.channels;
        self.front.feed(bytes, |bands| {
            for channel in channels.iter_mut() {
                channel.advance(bands);
            }
        });
    }

    /// Moves the oscillators to the given Doppler of each carrier.
    fn retune(&mut self, doppler_hz: &[(f64, f64)], sample_rate_hz: f64) {
        for (carrier, band) in self.carriers_hz.iter().zip(self.front.bands_mut()) {
            let wanted = doppler_hz.iter().find(|d| d.0 == *carrier);
            if let Some((_, doppler_hz)) = wanted {
                if (doppler_hz - band.offset() * sample_rate_hz).abs() > DETUNED_HZ {
                    band.retune(doppler_hz / sample_rate_hz);
                }
            }
        }
    }
}

/// Tracks any number of satellites through a recording fed in pieces of any length.
pub struct Tracker {
    input: Input,
    pool: rayon::ThreadPool,
    units: Vec<Unit>,
    /// Unit and place of each channel, in the order of the targets.
    order: Vec<(usize, usize)>,
    position: u64,
}

impl Tracker {
    /// A tracker for the given targets. The pairs of the configuration are tracked
    /// together.
    ///
    /// # Errors
    /// Unknown signals or PRNs, settings out of range, no thread pool.
    pub fn new(
        input: Input,
        config: &TrackConfig,
        targets: &[Target],
        threads: usize,
    ) -> Result<Self> {
        Self::with_level(input, config, targets, threads, Level::best())
    }

    /// The same, with given vector instructions.
    ///
    /// # Errors
    /// As [`Tracker::new`].
    pub fn with_level(
        input: Input,
        config: &TrackConfig,
        targets: &[Target],
        threads: usize,
        level: Level,
    ) -> Result<Self> {
        config.check()?;
        input.check()?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| Error::Invalid(format!("cannot start {threads} threads: {e}")))?;
        let channels = grouping::channels(&input, config, targets)?;
        let (groups, order) = grouping::shared_out(channels, threads);
        let units = groups.into_iter().map(|g| Unit::new(g, &input, level));
        let mut tracker = Tracker {
            position: input.start,
            units: units.collect(),
            input,
            pool,
            order,
        };
        tracker.retune();
        Ok(tracker)
    }

    /// Absorbs raw bytes of whole samples.
    ///
    /// # Panics
    /// If they are not.
    pub fn feed(&mut self, bytes: &[u8]) {
        let bits = self.input.format.bits_per_sample();
        let mut rest = bytes;
        while !rest.is_empty() {
            let next = self.input.next_retuning(self.position);
            // To the end of a byte, where that holds several samples.
            let length = ((next - self.position) as usize * bits).div_ceil(8);
            let (piece, after) = rest.split_at(length.min(rest.len()));
            let units = &mut self.units;
            self.pool
                .install(|| units.par_iter_mut().for_each(|unit| unit.feed(piece)));
            self.position += (piece.len() * 8 / bits) as u64;
            if self.position >= next {
                self.retune();
            }
            rest = after;
        }
    }

    /// Moves the bands' oscillators to the middle of the satellites' Doppler frequencies, which a
    /// receiver's clock error moves as a whole.
    fn retune(&mut self) {
        let mut middle: Vec<(f64, f64)> = Vec::new();
        let sidebands = || {
            self.units
                .iter()
                .flat_map(|u| &u.channels)
                .flat_map(|c| &c.sidebands)
        };
        for carrier in self.units.iter().flat_map(|u| &u.carriers_hz) {
            let held = sidebands()
                .filter(|s| s.spec.carrier_hz == *carrier && s.state() != State::Lost)
                .map(Sideband::doppler_hz);
            let (low, high) = held.fold((f64::MAX, f64::MIN), |(l, h), d| (l.min(d), h.max(d)));
            if low <= high {
                middle.push((*carrier, 0.5 * (low + high)));
            }
        }
        for unit in &mut self.units {
            unit.retune(&middle, self.input.sample_rate_hz);
        }
    }

    /// All satellites with what they recorded, in the order of the targets.
    pub fn channels(&self) -> impl Iterator<Item = &Channel> {
        self.order.iter().map(|&(u, c)| &self.units[u].channels[c])
    }

    /// The same, so that rows may be taken out.
    pub fn channels_mut(&mut self) -> Vec<&mut Channel> {
        let order = &self.order;
        let mut placed: Vec<_> = (self.units.iter_mut().enumerate())
            .flat_map(|(u, unit)| (0..).map(move |c| (u, c)).zip(&mut unit.channels))
            .collect();
        placed.sort_by_key(|(place, _)| order.iter().position(|o| o == place));
        placed.into_iter().map(|(_, channel)| channel).collect()
    }

    /// Next sample to be fed.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// Signals that are lost now, with their last Doppler.
    pub fn lost(&self) -> Vec<(String, u16, f64)> {
        self.channels()
            .flat_map(|c| c.sidebands.iter().map(move |s| (c.prn, s)))
            .filter(|(_, s)| s.state() == State::Lost)
            .map(|(prn, s)| (s.spec.id.to_owned(), prn, s.doppler_hz()))
            .collect()
    }

    /// Restarts a lost signal from a new acquisition.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is not tracked here, or the acquisition makes no sense.
    pub fn restart(&mut self, target: &Target) -> Result<()> {
        let system = target.check(self.input.sample_rate_hz)?.system;
        let earliest = self.position();
        let (channel, i) = self.place(system, target.prn, &target.signal)?;
        channel.sidebands[i].restart(target.seed, earliest);
        Ok(())
    }

    /// Marks a signal as captured: the pair that it belongs to is parted, the other sideband goes on
    /// by itself, and so does this one, its rows marked.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is not tracked here.
    pub fn isolate(&mut self, system: char, prn: u16, signal: &str) -> Result<()> {
        let (channel, i) = self.place(system, prn, signal)?;
        channel.isolate(i);
        Ok(())
    }

    /// Takes such marks of a satellite away: its pairs may be joined again.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the satellite is not tracked here.
    pub fn rejoin(&mut self, system: char, prn: u16) -> Result<()> {
        let channels = self.units.iter_mut().flat_map(|u| &mut u.channels);
        grouping::rejoin(channels, system, prn)
    }

    /// The channel of a signal, and which of its sidebands it is.
    fn place(&mut self, system: char, prn: u16, signal: &str) -> Result<(&mut Channel, usize)> {
        let channels = self.units.iter_mut().flat_map(|u| &mut u.channels);
        grouping::place(channels, system, prn, signal)
    }
}
