//! What is tracked: samples, and the signals to be found in them.

use super::epoch::Seed;
use crate::dsp::band::LAST_SAMPLE;
use crate::dsp::correlator::SAMPLES_PER_CHIP;
use crate::dsp::front_end::Stream;
use crate::dsp::ring::BLOCK;
use crate::sample::SampleFormat;
use crate::signal::{self, SignalSpec};
use crate::{Error, Result};

/// The bands' oscillators are moved at this interval, s.
const RETUNED_S: f64 = 1.0;
/// A recording begins before this sample, which leaves room for it.
const LATEST_START: u64 = LAST_SAMPLE / 2;

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

impl Input {
    pub(super) fn stream(&self) -> Stream {
        Stream {
            format: self.format,
            conjugate: self.conjugate,
            float_scale: self.float_scale,
            start: self.start,
        }
    }

    /// First sample after `sample` at which oscillators may be retuned.
    pub(super) fn next_retuning(&self, sample: u64) -> u64 {
        let interval = (RETUNED_S * self.sample_rate_hz) as u64;
        let interval = interval.next_multiple_of(BLOCK as u64).max(BLOCK as u64);
        (sample / interval + 1) * interval
    }

    pub(super) fn check(&self) -> Result<()> {
        let Input {
            sample_rate_hz,
            lo_hz,
            start,
            ..
        } = *self;
        if (lo_hz / sample_rate_hz).is_finite() && start <= LATEST_START {
            return Ok(());
        }
        Err(Error::Invalid(format!(
            "{sample_rate_hz} samples per second around {lo_hz} Hz from sample {start} on cannot be"
        )))
    }
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
    /// The signal, if it can be tracked at a sample rate.
    pub(crate) fn check(&self, sample_rate_hz: f64) -> Result<&'static SignalSpec> {
        let spec = signal::find(&self.signal)?;
        let Seed {
            sample,
            doppler_hz,
            code_delay_s,
        } = self.seed;
        let sane = doppler_hz.abs() < 0.5 * sample_rate_hz
            && (0.0..1e3).contains(&code_delay_s)
            && sample <= LATEST_START;
        if !sane {
            return Err(Error::Invalid(format!(
                "{} {}: a Doppler of {doppler_hz} Hz and a code delay of {code_delay_s} s at \
                 sample {sample} cannot be",
                self.signal, self.prn
            )));
        }
        let chip_rate_hz = spec.chip_rate_hz * (1.0 + doppler_hz / spec.carrier_hz);
        let samples_per_chip = sample_rate_hz / chip_rate_hz;
        // The loops will move it a little.
        let extremes = [0.99 * samples_per_chip, 1.01 * samples_per_chip];
        if extremes.iter().all(|s| SAMPLES_PER_CHIP.contains(s)) {
            return Ok(spec);
        }
        Err(Error::Invalid(format!(
            "{} cannot be correlated at {sample_rate_hz} samples per second: a chip must have {} \
             to {} samples",
            self.signal,
            SAMPLES_PER_CHIP.start(),
            SAMPLES_PER_CHIP.end()
        )))
    }
}
