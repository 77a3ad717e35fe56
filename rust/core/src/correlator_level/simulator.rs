//! All satellites of a simulation, and the threads to run them.

use rayon::prelude::*;

use super::{Setting, Simulated};
use crate::synth::Emitter;
use crate::track::channel::Channel;
use crate::track::config::TrackConfig;
use crate::track::engine::Target;
use crate::track::epoch::Seed;
use crate::track::grouping::{self, group};
use crate::track::log::State;
use crate::track::sideband::Sideband;
use crate::track::source::{Feed, Source};
use crate::{Error, Result};

/// Channels are run so far at a time, s: on a grid of the sample index, so that it does not
/// matter how far they are asked to run.
const STEP_S: f64 = 1e-3;

/// Tracks satellites whose correlator outputs are simulated.
pub struct Simulator {
    sample_rate_hz: f64,
    channels: Vec<Channel>,
    /// None: this thread alone.
    pool: Option<rayon::ThreadPool>,
    /// Lost signals are searched for at whole seconds.
    reacquire: bool,
    position: u64,
}

impl Simulator {
    /// Tracks the given signals of satellites, from sample 0 on. The pairs of the configuration are
    /// tracked together.
    ///
    /// # Errors
    /// Unknown signals or PRNs, settings out of range, no thread pool.
    pub fn new(
        setting: &Setting,
        config: &TrackConfig,
        emitters: &[Emitter],
        targets: &[(String, u16)],
        reacquire: bool,
        threads: usize,
    ) -> Result<Self> {
        config.check()?;
        let sideband = |(signal, prn): &(String, u16)| {
            let sideband = sideband(setting, config, emitters, signal, *prn)?;
            Ok((*prn, sideband))
        };
        let sidebands: Result<Vec<_>> = targets.iter().map(sideband).collect();
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = (threads > 1).then(|| builder.build()).transpose();
        Ok(Simulator {
            sample_rate_hz: setting.sample_rate_hz,
            channels: group(sidebands?, config, setting.sample_rate_hz),
            pool: pool
                .map_err(|e| Error::Invalid(format!("cannot start {threads} threads: {e}")))?,
            reacquire,
            position: 0,
        })
    }

    /// Runs all channels to the last whole step before sample `end`.
    pub fn advance(&mut self, end: u64) {
        let plan = Plan {
            step: (STEP_S * self.sample_rate_hz).ceil().max(1.0) as u64,
            sample_rate_hz: self.sample_rate_hz,
            reacquire: self.reacquire,
        };
        let (from, to) = (self.position, end / plan.step * plan.step);
        let channels = &mut self.channels;
        match &self.pool {
            Some(pool) => pool.install(|| {
                channels
                    .par_iter_mut()
                    .for_each(|channel| plan.run(channel, from, to));
            }),
            None => channels.iter_mut().for_each(|c| plan.run(c, from, to)),
        }
        self.position = from.max(to);
    }

    /// As [`Tracker::isolate`](crate::track::engine::Tracker::isolate).
    ///
    /// # Errors
    /// [`Error::Invalid`] if the signal is not tracked here.
    pub fn isolate(&mut self, system: char, prn: u16, signal: &str) -> Result<()> {
        let (channel, i) = grouping::place(self.channels.iter_mut(), system, prn, signal)?;
        channel.isolate(i);
        Ok(())
    }

    /// As [`Tracker::rejoin`](crate::track::engine::Tracker::rejoin).
    ///
    /// # Errors
    /// [`Error::Invalid`] if the satellite is not tracked here.
    pub fn rejoin(&mut self, system: char, prn: u16) -> Result<()> {
        grouping::rejoin(self.channels.iter_mut(), system, prn)
    }

    /// All satellites, so that rows may be taken out.
    pub fn channels_mut(&mut self) -> impl Iterator<Item = &mut Channel> {
        self.channels.iter_mut()
    }

    /// Samples that have been simulated.
    pub fn position(&self) -> u64 {
        self.position
    }
}

/// How a channel is run.
struct Plan {
    step: u64,
    sample_rate_hz: f64,
    reacquire: bool,
}

impl Plan {
    fn run(&self, channel: &mut Channel, from: u64, to: u64) {
        let mut at = from;
        while at < to {
            let second = (at as f64 / self.sample_rate_hz + 1e-9).floor() + 1.0;
            let second = (second * self.sample_rate_hz).round() as u64;
            let next = (at / self.step + 1) * self.step;
            channel.advance(Feed::Until(next));
            // The search is of the first whole step of a second.
            if self.reacquire && next >= second {
                search(channel, next);
            }
            at = next;
        }
    }
}

/// Restarts the signals that are lost, where a search finds them.
fn search(channel: &mut Channel, sample: u64) {
    for sideband in &mut channel.sidebands {
        if sideband.state() == State::Lost {
            if let Some(seed) = sideband.found(sample) {
                sideband.restart(seed, sample);
            }
        }
    }
}

fn sideband(
    setting: &Setting,
    config: &TrackConfig,
    emitters: &[Emitter],
    signal: &str,
    prn: u16,
) -> Result<Sideband> {
    let seed = Seed {
        sample: 0,
        doppler_hz: 0.0,
        code_delay_s: 0.0,
    };
    let signal = signal.to_owned();
    let spec = Target { signal, prn, seed }.check(setting.sample_rate_hz)?;
    let fs = setting.sample_rate_hz;
    let mut sideband = Sideband::with_source(spec, prn, fs, config, |modulation, taps| {
        let replica = (modulation, taps);
        Simulated::new(setting, spec, prn, replica, config.data_component, emitters)
            .map(|simulated| Source::Simulated(Box::new(simulated)))
    })?;
    // What cannot be found at all is given up soon enough.
    let found = sideband.found(0).unwrap_or(seed);
    sideband.restart(found, 0);
    Ok(sideband)
}
