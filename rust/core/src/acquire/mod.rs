//! FFT parallel code search.
//!
//! The band of one signal is resampled to a whole, smooth number of samples per code period
//! ([`replica::search_rate_hz`]). A correlation spans one code period and starts anywhere in a
//! period, so that the one that fits the received code holds no sign change of data or secondary
//! code: an FFT over B + 1 periods of samples against one zero-padded period of replica gives all
//! lags of B periods. Doppler is searched in steps of 1/(2T) (T: the code period) by shifting the
//! samples' spectrum, which all PRNs share; powers of K periods add up, lags following the code
//! Doppler. Akos/Borre et al., "A Software-Defined GPS and Galileo Receiver", section 6.4.

mod cancel;
mod estimate;
mod fft;
mod grid;
mod library;
mod lines;
#[cfg(test)]
mod reference;
pub mod replica;
mod transform;
mod zone;

use std::ops::RangeInclusive;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::dsp::raw::RawSamples;
use crate::signal::SignalSpec;
use crate::simd::Level;
use crate::{Error, Result};
use estimate::{Fitter, DELAY_REACH, WIDTH};
use fft::{CodeSpectrum, Correlator};
use grid::{Pair, Summary, Worker};
use replica::{PeakShape, Replicas};
use transform::{best_span, padded_spectrum};
use zone::{Common, Zone};

pub use cancel::Known;

/// Root mean square of spectra, an eleventh of what 16 bits hold.
const SPECTRUM_RMS: f32 = 3000.0;
/// Doppler bins that one worker goes through at a time.
const BINS: usize = 16;

/// Where the samples come from.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// The samples.
    pub raw: RawSamples<'a>,
    /// Their rate.
    pub sample_rate_hz: f64,
    /// Sample at which the search starts; earlier ones only feed the filter.
    pub first: usize,
    /// Frequency of the signal's carrier in the samples.
    pub if_hz: f64,
}

/// One search: a PRN and a range of Doppler bins of 1/(2T), both ends included.
#[derive(Debug, Clone, Copy)]
pub struct Job {
    /// Satellite.
    pub prn: u16,
    /// First Doppler bin.
    pub low: i64,
    /// Last Doppler bin.
    pub high: i64,
}

/// The largest cell of one search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Satellite.
    pub prn: u16,
    /// Power sum over half the grid's mean: chi-square of 2K degrees of freedom in noise.
    pub statistic: f64,
    /// Cells of the grid.
    pub cells: usize,
    /// Doppler, interpolated.
    pub doppler_hz: f64,
    /// From the first sample to the first following start of a code period, interpolated.
    pub code_delay_s: f64,
    /// C/N0 of the whole signal component; -inf where the estimate is not positive.
    pub cn0_dbhz: f64,
}

/// The samples of one signal, ready to be searched for any PRN.
pub struct Search {
    common: Common,
    plan: Correlator,
    replicas: Replicas,
    fitter: Fitter,
    /// Number of the first zone.
    first_zone: i64,
    zones: Vec<Zone>,
    pool: rayon::ThreadPool,
    /// Those not at work.
    workers: Mutex<Vec<Worker>>,
}

impl Search {
    /// Takes in `blocks` + 1 code periods from `input`, for searches in the Doppler bins of
    /// `bins` with `threads` threads.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is nothing to search: no block, no bin, no thread, or silence.
    pub fn new(
        spec: &'static SignalSpec,
        input: Input<'_>,
        blocks: usize,
        bins: RangeInclusive<i64>,
        threads: usize,
    ) -> Result<Self> {
        if blocks == 0 || threads == 0 || bins.is_empty() {
            return Err(Error::Invalid(
                "a search needs at least 1 block, 1 Doppler bin and 1 thread".into(),
            ));
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| Error::Invalid(format!("cannot start {threads} threads: {e}")))?;
        let common = Common::new(spec, blocks, best_span(blocks));
        let first_zone = common.zone_of(*bins.start());
        let zones = (first_zone..=common.zone_of(*bins.end()))
            .map(|number| pool.install(|| Zone::new(&common, number, input)))
            .collect::<Result<_>>()?;
        let mut search = Search {
            plan: Correlator::new(Level::best(), common.period, common.span)?,
            replicas: pool.install(|| Replicas::new(spec, common.period)),
            fitter: Fitter::new(PeakShape::new(spec)),
            common,
            first_zone,
            zones,
            pool,
            workers: Mutex::default(),
        };
        search.transform();
        Ok(search)
    }

    /// Takes known signals out of the samples, one after the other.
    ///
    /// # Errors
    /// [`Error::UnknownPrn`].
    pub fn cancel(&mut self, known: &[Known]) -> Result<()> {
        for k in known {
            let spectrum = self.replicas.spectrum(k.prn)?;
            for zone in &mut self.zones {
                self.pool
                    .install(|| zone.cancel(&self.common, k, &spectrum));
            }
        }
        self.transform();
        Ok(())
    }

    fn transform(&mut self) {
        let (common, plan, zones) = (&self.common, &self.plan, &mut self.zones);
        self.pool
            .install(|| zones.par_iter_mut().for_each(|z| z.transform(common, plan)));
    }

    /// Runs searches; the result is in the order of `jobs`, the same for any number of threads.
    ///
    /// # Errors
    /// [`Error::UnknownPrn`]; [`Error::Invalid`] for a Doppler range that is empty or not in that
    /// of [`Search::new`].
    pub fn run(&self, jobs: &[Job]) -> Result<Vec<Peak>> {
        self.pool
            .install(|| jobs.par_iter().map(|job| self.search(job)).collect())
    }

    /// Width of a Doppler bin, 1/(2T).
    pub fn doppler_bin_hz(&self) -> f64 {
        self.common.doppler_bin_hz()
    }

    fn search(&self, job: &Job) -> Result<Peak> {
        let (low, high) = (self.zone(job.low), self.zone(job.high));
        if job.low > job.high || low.is_none() || high.is_none() {
            return Err(Error::Invalid(format!(
                "PRN {}: no Doppler bins, or other ones than the search is for",
                job.prn
            )));
        }
        let code = self.code(job.prn)?;
        let summaries: Vec<Summary> = self
            .parts(job)
            .into_par_iter()
            .filter_map(|(low, high)| {
                let pair = self.pair(&code, low)?;
                Some(self.with_worker(|w| w.summarise(pair, low, high)))
            })
            .collect();
        let summary = summaries.into_iter().reduce(Summary::joined);
        let found = summary.and_then(|s| Some((s, self.pair(&code, s.bin)?)));
        found
            .map(|(summary, pair)| self.peak(job, pair, summary))
            .ok_or_else(|| Error::Invalid("an empty search".into()))
    }

    /// Ranges of bins, none of them in two zones.
    fn parts(&self, job: &Job) -> Vec<(i64, i64)> {
        let mut parts = Vec::new();
        let mut low = job.low;
        while low <= job.high {
            let last = self.common.last_of(self.common.zone_of(low)).min(job.high);
            let count = (last + 1 - low) as usize;
            let size = count.div_ceil(count.div_ceil(BINS));
            let starts = (low..=last).step_by(size);
            parts.extend(starts.map(|from| (from, (from + size as i64 - 1).min(last))));
            low = last + 1;
        }
        parts
    }

    /// Conjugate spectrum of a code.
    fn code(&self, prn: u16) -> Result<CodeSpectrum> {
        let samples = self.replicas.samples(prn)?;
        let spectrum = padded_spectrum(&samples, self.plan.size());
        let scale = SPECTRUM_RMS / (self.common.period as f32).sqrt();
        Ok(self.plan.code_spectrum(&spectrum, scale))
    }

    fn zone(&self, bin: i64) -> Option<&Zone> {
        let number = self.common.zone_of(bin) - self.first_zone;
        self.zones.get(usize::try_from(number).ok()?)
    }

    /// The code and the samples of a bin's zone.
    fn pair<'a>(&'a self, code: &'a CodeSpectrum, bin: i64) -> Option<Pair<'a>> {
        Some(Pair {
            common: &self.common,
            plan: &self.plan,
            zone: self.zone(bin)?,
            code,
        })
    }

    /// Lends a worker, a new one if all are at work.
    fn with_worker<T>(&self, work: impl FnOnce(&mut Worker) -> T) -> T {
        let idle = || self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let held = idle().pop();
        let mut worker = held.unwrap_or_else(|| Worker::new(&self.plan, self.common.period));
        let result = work(&mut worker);
        idle().push(worker);
        result
    }

    /// Reads the estimates off the neighbourhood of the largest cell.
    fn peak(&self, job: &Job, pair: Pair<'_>, summary: Summary) -> Peak {
        let (bin, lag) = (summary.bin, summary.lag);
        let cells = (job.high - job.low + 1) as usize * self.common.period;
        let mut near = [[0.0; WIDTH]; 3];
        let (mut excluded, mut excluded_cells) = (0.0, 0);
        for (i, b) in (bin - 1..=bin + 1).enumerate() {
            let look = || self.with_worker(|w| w.cells(pair, b, lag));
            near[i] = summary.near[i].unwrap_or_else(look);
            if (job.low..=job.high).contains(&b) {
                excluded += near[i].iter().sum::<f64>();
                excluded_cells += WIDTH;
            }
        }
        let floor = (summary.total - excluded) / (cells - excluded_cells) as f64;
        let top = near[1][DELAY_REACH];
        let fit = self
            .fitter
            .fit(&near.map(|row| row.map(|cell| cell / floor - 1.0)));
        let snr = fit.snr.max(0.0);
        let period_s = self.common.spec.period_s();
        // The sums follow the drift in whole samples; the mean rest is put back.
        let blocks = self.common.blocks;
        let drifts = (0..blocks).map(|k| pair.zone.drift(&self.common, bin, k));
        let rest = drifts.map(|d| d - d.round()).sum::<f64>() / blocks as f64;
        let delay = (lag as f64 + fit.delay - rest).rem_euclid(self.common.period as f64);
        Peak {
            prn: job.prn,
            statistic: 2.0 * blocks as f64 * top / floor,
            cells,
            doppler_hz: pair.zone.doppler_hz(&self.common, bin as f64 + fit.doppler),
            code_delay_s: delay / pair.zone.rate_hz(&self.common),
            cn0_dbhz: 10.0 * (snr / (period_s * self.fitter.power_in_band())).log10(),
        }
    }
}
