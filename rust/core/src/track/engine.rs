//! The tracker: shared front ends, all satellites, and the threads to run them.

use rayon::prelude::*;

use super::channel::Channel;
use super::config::TrackConfig;
use super::epoch::Seed;
use super::log::State;
use super::sideband::Sideband;
use crate::dsp::prefix::PrefixBand;
use crate::sample::SampleFormat;
use crate::signal;
use crate::{Error, Result};

/// Samples per round of front ends and channels.
const CHUNK: usize = 1 << 16;

/// What a recording's samples are.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// Sample format.
    pub format: SampleFormat,
    /// Negate Q.
    pub conjugate: bool,
    /// Factor from float samples to integers.
    pub float_scale: f32,
    /// Sample rate.
    pub sample_rate_hz: f64,
    /// Radio frequency at 0 Hz in the file.
    pub lo_hz: f64,
    /// First sample that will be fed.
    pub start: u64,
}

/// A signal to track.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Registry name.
    pub signal: String,
    /// Satellite.
    pub prn: u16,
    /// Where it was found.
    pub seed: Seed,
}

impl Target {
    fn check(&self, sample_rate_hz: f64) -> Result<()> {
        let Seed {
            doppler_hz,
            code_delay_s,
            ..
        } = self.seed;
        if doppler_hz.abs() < 0.5 * sample_rate_hz && (0.0..1e3).contains(&code_delay_s) {
            return Ok(());
        }
        Err(Error::Invalid(format!(
            "{} {}: a Doppler of {doppler_hz} Hz and a code delay of {code_delay_s} s cannot be",
            self.signal, self.prn
        )))
    }
}

/// Tracks any number of satellites through a recording fed in pieces of any length.
pub struct Tracker {
    input: Input,
    pool: rayon::ThreadPool,
    carriers_hz: Vec<f64>,
    bands: Vec<PrefixBand>,
    channels: Vec<Channel>,
    samples: Vec<i16>,
    position: u64,
}

impl Tracker {
    /// A tracker for the given targets. Two signals of one satellite on different carriers are
    /// tracked together.
    ///
    /// # Errors
    /// Unknown signals or PRNs, settings out of range, no thread pool.
    pub fn new(
        input: Input,
        config: &TrackConfig,
        targets: &[Target],
        threads: usize,
    ) -> Result<Self> {
        config.check()?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| Error::Invalid(format!("cannot start {threads} threads: {e}")))?;
        let mut carriers_hz: Vec<f64> = Vec::new();
        for target in targets {
            let carrier = signal::find(&target.signal)?.carrier_hz;
            if !carriers_hz.contains(&carrier) {
                carriers_hz.push(carrier);
            }
        }
        let fs = input.sample_rate_hz;
        // A chunk, a millisecond for a sideband that waits for its partner, and the far taps.
        let history = CHUNK + (1.2e-3 * fs) as usize + 4096;
        let bands = carriers_hz
            .iter()
            .map(|c| {
                let frequency = (c - input.lo_hz) / fs;
                PrefixBand::new(frequency, input.format.is_complex(), input.start, history)
            })
            .collect();
        let mut tracker = Tracker {
            position: input.start,
            input,
            pool,
            carriers_hz,
            bands,
            channels: vec![],
            samples: vec![],
        };
        tracker.channels = tracker.build_channels(config, targets)?;
        Ok(tracker)
    }

    fn build_channels(&self, config: &TrackConfig, targets: &[Target]) -> Result<Vec<Channel>> {
        let mut satellites: Vec<((char, u16), Vec<Sideband>)> = Vec::new();
        for target in targets {
            let sideband = self.build_sideband(config, target)?;
            let key = (sideband.spec.system, target.prn);
            match satellites.iter_mut().find(|s| s.0 == key) {
                Some(satellite) => satellite.1.push(sideband),
                None => satellites.push((key, vec![sideband])),
            }
        }
        let fs = self.input.sample_rate_hz;
        Ok(satellites
            .into_iter()
            .flat_map(|((_, prn), sidebands)| {
                let channel = move |s| Channel::new(prn, s, config, fs);
                coupled(sidebands).into_iter().map(channel)
            })
            .collect())
    }

    fn build_sideband(&self, config: &TrackConfig, target: &Target) -> Result<Sideband> {
        let spec = signal::find(&target.signal)?;
        target.check(self.input.sample_rate_hz)?;
        let band = self
            .carriers_hz
            .iter()
            .position(|&c| c == spec.carrier_hz)
            .unwrap_or(0);
        let (fs, start) = (self.input.sample_rate_hz, self.input.start);
        Sideband::new(spec, target.prn, band, fs, config, target.seed, start)
    }

    /// Absorbs raw bytes of whole samples.
    pub fn feed(&mut self, bytes: &[u8]) {
        let Input {
            format,
            conjugate,
            float_scale,
            ..
        } = self.input;
        self.position += (bytes.len() * 8 / format.bits_per_sample()) as u64;
        let (samples, bands, channels) = (&mut self.samples, &mut self.bands, &mut self.channels);
        self.pool.install(|| {
            for chunk in bytes.chunks(CHUNK * format.bits_per_sample() / 8) {
                samples.clear();
                format.unpack(chunk, float_scale, conjugate, samples);
                bands.par_iter_mut().for_each(|band| band.feed(samples));
                channels
                    .par_iter_mut()
                    .for_each(|channel| channel.advance(bands));
            }
        });
    }

    /// All satellites with what they recorded; the rows may be taken out.
    pub fn channels_mut(&mut self) -> &mut [Channel] {
        &mut self.channels
    }

    /// Next sample to be fed.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// Signals that are lost now, with their last Doppler.
    pub fn lost(&self) -> Vec<(String, u16, f64)> {
        self.channels
            .iter()
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
        target.check(self.input.sample_rate_hz)?;
        let earliest = self.position();
        self.channels
            .iter_mut()
            .filter(|c| c.prn == target.prn)
            .flat_map(|c| &mut c.sidebands)
            .find(|s| s.spec.id == target.signal)
            .ok_or_else(|| {
                Error::Invalid(format!("{} {} is not tracked", target.signal, target.prn))
            })?
            .restart(target.seed, earliest);
        Ok(())
    }
}

/// Groups a satellite's sidebands: first the two to be coupled, of its lowest and its highest
/// carrier (the stronger where a carrier has several), then the others one by one.
fn coupled(mut sidebands: Vec<Sideband>) -> Vec<Vec<Sideband>> {
    sidebands.sort_by(|a, b| {
        let key = |s: &Sideband| (s.spec.carrier_hz, -s.spec.power_share);
        key(a)
            .partial_cmp(&key(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let highest = sidebands
        .iter()
        .map(|s| s.spec.carrier_hz)
        .fold(0.0, f64::max);
    let upper = sidebands
        .iter()
        .position(|s| s.spec.carrier_hz == highest)
        .unwrap_or(0);
    let mut groups = Vec::new();
    if upper > 0 {
        let upper = sidebands.remove(upper);
        groups.push(vec![sidebands.remove(0), upper]);
    }
    groups.extend(sidebands.into_iter().map(|s| vec![s]));
    groups
}
