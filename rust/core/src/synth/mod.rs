//! IF synthesis: emitters, noise, front end and quantiser.
//!
//! The output is a pure function of the configuration and the sample index: it does not depend on
//! how it is cut into blocks, nor on the number of threads or the vector instructions. For files
//! only.

mod composite;
mod data;
mod emitter;
pub(crate) mod filter;
mod gain;
mod motion;
mod pair;
mod piece;
mod profile;
mod quantile;
pub(crate) mod random;
pub(crate) mod render;
mod spline;
pub(crate) mod wave;

use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

pub use data::Data;
pub use emitter::{Emitter, SPEED_OF_LIGHT};
pub use filter::Filter;
pub use gain::{Drive, GainControl, GainSettings};
pub use profile::Profile;
pub use spline::{Knot, Spline};

use crate::nco::step_from_frequency;
use crate::sample::SampleFormat;
use crate::simd::Level;
use crate::{Error, Result};
use composite::Composite;
use motion::SEGMENT;
use piece::Workspace;
use random::Noise;

/// Samples that one thread makes at a time; a grid on the absolute sample index.
const PIECE: i64 = 8 * SEGMENT;

/// Sum of all amplitudes over the noise's standard deviation that the integers can hold.
const MAX_AMPLITUDE: f64 = 2000.0;

/// What is recorded, apart from who transmits.
#[derive(Debug, Clone)]
pub struct SynthConfig {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Radio frequency that becomes frequency 0 in the recording.
    pub lo_hz: f64,
    /// Sample format of the output.
    pub format: SampleFormat,
    /// Standard deviation of the quantised noise (of I and of Q), in units of the output.
    pub noise_rms_lsb: f64,
    /// False leaves the noise out; the scaling stays.
    pub noise: bool,
    /// Seed of the noise.
    pub seed: u64,
    /// Front-end filter, if any.
    pub filter: Option<Filter>,
    /// Threads; 0 for one per core.
    pub threads: usize,
}

/// Components around one carrier.
struct Band {
    step: u64,
    composites: Vec<Composite>,
}

/// Generates the samples of a recording.
pub struct Synthesizer {
    config: SynthConfig,
    bands: Vec<Band>,
    noise: [Noise; 2],
    pool: rayon::ThreadPool,
    level: Level,
    drive: Drive,
    /// Buffers that no thread is using.
    spare: Mutex<Vec<Workspace>>,
}

impl Synthesizer {
    /// Plans the synthesis of `emitters`.
    ///
    /// # Errors
    /// [`Error::Invalid`] for numbers out of range or a carrier outside the sampled band,
    /// [`Error::UnknownPrn`] for a satellite that does not transmit the signal.
    pub fn new(config: SynthConfig, emitters: Vec<Emitter>) -> Result<Self> {
        check(&config)?;
        let mut bands: Vec<Band> = Vec::new();
        let mut total = 0.0;
        for emitter in emitters {
            let step = step_from_frequency(intermediate_frequency(&config, &emitter)?);
            let amplitude = amplitude(&config, emitter.cn0_dbhz);
            total += amplitude * 10f64.powf(emitter.power_db.max().max(0.0) / 20.0);
            let known = bands.iter().position(|b| b.step == step);
            let band = known.unwrap_or_else(|| {
                let composites = vec![];
                bands.push(Band { step, composites });
                bands.len() - 1
            });
            Composite::add_to(&mut bands[band].composites, emitter, amplitude)?;
        }
        if total.is_nan() || total > MAX_AMPLITUDE {
            return Err(Error::Invalid(format!(
                "the emitters' amplitudes add up to {total:.0} times the noise; \
                 the limit is {MAX_AMPLITUDE}"
            )));
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(config.threads)
            .build()
            .map_err(|e| Error::Invalid(format!("cannot start threads: {e}")))?;
        let noise = [Noise::new(config.seed, 0), Noise::new(config.seed, 1)];
        Ok(Synthesizer {
            config,
            bands,
            noise,
            pool,
            level: Level::best(),
            drive: Drive::default(),
            spare: Mutex::default(),
        })
    }

    /// The same samples, made at most at this level of vector instructions.
    pub fn at_level(self, level: Level) -> Self {
        Synthesizer { level, ..self }
    }

    /// With another level of noise or gain than the constant ones.
    pub fn driven(self, drive: Drive) -> Self {
        Synthesizer { drive, ..self }
    }

    /// Bytes of the samples `start..start + count`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the range does not start and end on whole bytes.
    pub fn generate(&self, start: u64, count: usize) -> Result<Vec<u8>> {
        let bits = self.config.format.bits_per_sample();
        let whole = |n: u64| n.is_multiple_of(8) || (n * bits as u64).is_multiple_of(8);
        if start > 1 << 48 || count > 1 << 31 || !whole(start) || !whole(count as u64) {
            return Err(Error::Invalid(format!(
                "cannot generate {count} samples of {bits} bits from sample {start}: \
                 begin and end on a whole byte, begin before sample 2^48, \
                 and ask for at most 2^31 samples at a time"
            )));
        }
        let mut bytes = vec![0u8; count * bits / 8];
        let mut pieces = Vec::new();
        let (mut at, end) = (start as i64, start as i64 + count as i64);
        let mut rest = bytes.as_mut_slice();
        while at < end {
            let to = ((at / PIECE + 1) * PIECE).min(end);
            let (piece, tail) = rest.split_at_mut((to - at) as usize * bits / 8);
            pieces.push((at, to, piece));
            (at, rest) = (to, tail);
        }
        self.pool.install(|| {
            pieces.into_par_iter().for_each(|(at, to, out)| {
                let mut workspace = self.spare().pop().unwrap_or_default();
                self.piece(&mut workspace, at, to, out);
                self.spare().push(workspace);
            });
        });
        Ok(bytes)
    }

    fn spare(&self) -> MutexGuard<'_, Vec<Workspace>> {
        self.spare.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn check(config: &SynthConfig) -> Result<()> {
    let SynthConfig {
        sample_rate_hz,
        lo_hz,
        noise_rms_lsb,
        ..
    } = *config;
    if !(sample_rate_hz.is_finite() && sample_rate_hz > 0.0 && lo_hz.is_finite()) {
        return Err(Error::Invalid(
            "sample rate must be positive, lo_hz finite".into(),
        ));
    }
    if !(noise_rms_lsb.is_finite() && noise_rms_lsb > 0.0) {
        return Err(Error::Invalid(format!(
            "noise_rms_lsb is {noise_rms_lsb}, must be positive"
        )));
    }
    Ok(())
}

/// Intermediate frequency in cycles per sample.
fn intermediate_frequency(config: &SynthConfig, emitter: &Emitter) -> Result<f64> {
    let frequency = (emitter.signal.carrier_hz - config.lo_hz) / config.sample_rate_hz;
    let lowest = if config.format.is_complex() {
        -0.5
    } else {
        0.0
    };
    if (lowest..0.5).contains(&frequency) {
        return Ok(frequency);
    }
    Err(Error::Invalid(format!(
        "{} at {:.3} MHz falls at {:.3} MHz in the recording, outside the sampled band",
        emitter.signal.id,
        emitter.signal.carrier_hz / 1e6,
        frequency * config.sample_rate_hz / 1e6
    )))
}

/// Amplitude of a component over the noise's standard deviation (of I or Q).
///
/// White noise of variance s^2 has N0 = s^2 / (fs/2), real or, in each of I and Q, complex. A real
/// signal A cos has the power A^2 / 2 (of A^2 in the complex case, where N0 doubles with I and Q).
fn amplitude(config: &SynthConfig, cn0_dbhz: f64) -> f64 {
    let ratio = 10f64.powf(cn0_dbhz / 10.0) / config.sample_rate_hz;
    if config.format.is_complex() {
        (2.0 * ratio).sqrt()
    } else {
        2.0 * ratio.sqrt()
    }
}
