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
mod lines;
#[cfg(test)]
mod reference;
pub mod replica;
mod transform;

use std::sync::Arc;

use num_complex::Complex32;
use rayon::prelude::*;
use rustfft::{Fft, FftPlanner};

use crate::dsp::resample::{RawSamples, Resampler};
use crate::signal::SignalSpec;
use crate::{Error, Result};
use estimate::{Fit, Neighbourhood, DELAY_REACH, WIDTH};
use replica::{replica, search_rate_hz, PeakShape};
use transform::{add_power, best_span, multiply, normalise, padded_spectrum};

pub use cancel::Known;

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
    spec: &'static SignalSpec,
    shape: PeakShape,
    /// Samples per code period.
    period: usize,
    /// Non-coherent sums.
    blocks: usize,
    /// Periods whose lags one FFT gives.
    span: usize,
    /// Resampled to [`replica::search_rate_hz`], unit power.
    samples: Vec<Complex32>,
    spectra: Vec<Vec<Complex32>>,
    forward: Arc<dyn Fft<f32>>,
    inverse: Arc<dyn Fft<f32>>,
    pool: rayon::ThreadPool,
}

/// Buffers of one worker.
struct Work {
    product: Vec<Complex32>,
    scratch: Vec<Complex32>,
    row: Vec<f32>,
}

impl Search {
    /// Takes in `blocks` + 1 code periods from `input`, for use with `threads` threads.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is nothing to search: no block, no thread, or silence.
    pub fn new(
        spec: &'static SignalSpec,
        input: Input<'_>,
        blocks: usize,
        threads: usize,
    ) -> Result<Self> {
        if blocks == 0 || threads == 0 {
            return Err(Error::Invalid(
                "a search needs at least 1 block and 1 thread".into(),
            ));
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| Error::Invalid(format!("cannot start {threads} threads: {e}")))?;
        let rate = search_rate_hz(spec);
        let period = (rate * spec.period_s()).round() as usize;
        let resampler = Resampler::new(input.sample_rate_hz, rate, input.if_hz)?;
        let count = (blocks + 1) * period;
        let mut samples = pool.install(|| resampler.run(input.raw, input.first as f64, count));
        normalise(&mut samples)?;
        lines::limit_lines(&mut samples);
        let span = best_span(blocks);
        let size = (span + 1) * period;
        let mut planner = FftPlanner::new();
        let forward = planner.plan_fft_forward(size);
        let inverse = planner.plan_fft_inverse(size);
        let shape = PeakShape::new(spec);
        let spectra = Vec::new();
        let mut search = Search {
            spec,
            shape,
            period,
            blocks,
            span,
            samples,
            spectra,
            forward,
            inverse,
            pool,
        };
        search.transform();
        Ok(search)
    }

    /// Takes known signals out of the samples, one after the other.
    ///
    /// # Errors
    /// [`Error::UnknownPrn`].
    pub fn cancel(&mut self, known: &[Known]) -> Result<()> {
        known
            .iter()
            .try_for_each(|k| cancel::cancel(self.spec, self.period, k, &mut self.samples))?;
        self.transform();
        Ok(())
    }

    fn transform(&mut self) {
        let size = (self.span + 1) * self.period;
        self.spectra = (0..self.blocks.div_ceil(self.span))
            .map(|g| {
                let from = &self.samples[g * self.span * self.period..];
                padded_spectrum(&self.forward, from, size)
            })
            .collect();
    }

    /// Runs searches; the result is in the order of `jobs`, the same for any number of threads.
    ///
    /// # Errors
    /// [`Error::UnknownPrn`]; [`Error::Invalid`] for an empty Doppler range.
    pub fn run(&self, jobs: &[Job]) -> Result<Vec<Peak>> {
        self.pool
            .install(|| jobs.par_iter().map(|job| self.search(job)).collect())
    }

    /// Width of a Doppler bin, 1/(2T).
    pub fn doppler_bin_hz(&self) -> f64 {
        0.5 / self.spec.period_s()
    }

    fn search(&self, job: &Job) -> Result<Peak> {
        if job.low > job.high {
            return Err(Error::Invalid(format!(
                "PRN {}: empty Doppler range",
                job.prn
            )));
        }
        let code = replica(self.spec, job.prn, self.period)?;
        let mut code = padded_spectrum(&self.forward, &code, (self.span + 1) * self.period);
        code.iter_mut().for_each(|v| *v = v.conj());
        let mut work = self.work();
        let (mut total, mut top, mut peak) = (0f64, f32::NEG_INFINITY, (0, 0));
        for bin in job.low..=job.high {
            self.fill_row(&code, bin, &mut work);
            total += work.row.iter().map(|&p| f64::from(p)).sum::<f64>();
            for (lag, &power) in work.row.iter().enumerate() {
                if power > top {
                    (top, peak) = (power, (bin, lag));
                }
            }
        }
        let cells = (job.high - job.low + 1) as usize * self.period;
        Ok(self.peak(job, &code, peak, total, cells, &mut work))
    }

    fn work(&self) -> Work {
        let zero = Complex32::default();
        Work {
            product: vec![zero; (self.span + 1) * self.period],
            scratch: vec![zero; self.inverse.get_inplace_scratch_len()],
            row: vec![0.0; self.period],
        }
    }

    /// Samples by which the lag of block `block` is later than that of block 0.
    fn drift(&self, bin: i64, block: usize) -> f64 {
        let doppler_hz = bin as f64 * self.doppler_bin_hz();
        -((block * self.period) as f64) * doppler_hz / self.spec.carrier_hz
    }

    /// Sums the power of all blocks at every lag of one Doppler bin into `work.row`.
    fn fill_row(&self, code: &[Complex32], bin: i64, work: &mut Work) {
        let size = code.len();
        let shift = (bin * (self.span as i64 + 1) / 2).rem_euclid(size as i64) as usize;
        work.row.fill(0.0);
        for (g, spectrum) in self.spectra.iter().enumerate() {
            let (low, high) = work.product.split_at_mut(size - shift);
            multiply(low, &spectrum[shift..], &code[..size - shift]);
            multiply(high, &spectrum[..shift], &code[size - shift..]);
            self.inverse
                .process_with_scratch(&mut work.product, &mut work.scratch);
            for b in 0..self.span.min(self.blocks - g * self.span) {
                let drift = self.drift(bin, g * self.span + b).round() as i64;
                let lags = &work.product[b * self.period..(b + 1) * self.period];
                add_power(&mut work.row, lags, drift);
            }
        }
    }

    /// Reads the estimates off the neighbourhood of the largest cell.
    fn peak(
        &self,
        job: &Job,
        code: &[Complex32],
        (bin, lag): (i64, usize),
        total: f64,
        cells: usize,
        work: &mut Work,
    ) -> Peak {
        let mut near = Neighbourhood::default();
        let (mut excluded, mut excluded_cells) = (0.0, 0);
        for (i, b) in (bin - 1..=bin + 1).enumerate() {
            self.fill_row(code, b, work);
            for (l, cell) in near[i].iter_mut().enumerate() {
                let at = (lag + self.period + l - DELAY_REACH) % self.period;
                *cell = f64::from(work.row[at]);
            }
            if (job.low..=job.high).contains(&b) {
                excluded += near[i].iter().sum::<f64>();
                excluded_cells += WIDTH;
            }
        }
        let floor = (total - excluded) / (cells - excluded_cells) as f64;
        let top = near[1][DELAY_REACH];
        near.iter_mut()
            .flatten()
            .for_each(|cell| *cell = *cell / floor - 1.0);
        let fit = estimate::fit(&self.shape, &near);
        let snr = fit.snr.max(0.0);
        let period_s = self.spec.period_s();
        Peak {
            prn: job.prn,
            statistic: 2.0 * self.blocks as f64 * top / floor,
            cells,
            doppler_hz: (bin as f64 + fit.doppler) * self.doppler_bin_hz(),
            code_delay_s: self.code_delay_s(bin, lag, fit),
            cn0_dbhz: 10.0 * (snr / (period_s * self.shape.power_in_band)).log10(),
        }
    }

    /// Delay of block 0; the sums follow the drift in whole samples, the mean rest is put back.
    fn code_delay_s(&self, bin: i64, lag: usize, fit: Fit) -> f64 {
        let rest = |k: usize| self.drift(bin, k) - self.drift(bin, k).round();
        let mean = (0..self.blocks).map(rest).sum::<f64>() / self.blocks as f64;
        let samples = lag as f64 + fit.delay - mean;
        samples.rem_euclid(self.period as f64) / search_rate_hz(self.spec)
    }
}
