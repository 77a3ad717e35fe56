//! The samples as a signal of some Doppler has them.
//!
//! Doppler moves the carrier and stretches the code. Within a coherent integration the stretch
//! smears the correlation peak: at 40 kHz, B1C's code moves by a quarter of a chip in 10 ms. The
//! Doppler range is therefore cut into zones, each with samples of its own, resampled so that a
//! signal in the middle of the zone has its nominal code rate.

use num_complex::Complex32;
use rayon::prelude::*;

use super::cancel::{cancel, Known, Track};
use super::fft::{Correlator, SampleSpectrum};
use super::replica::search_rate_hz;
use super::transform::{normalise, padded_spectrum};
use super::{lines, Input};
use crate::dsp::resample::Resampler;
use crate::signal::SignalSpec;
use crate::Result;

/// Movement of the code in one period, in samples, of a signal at the edge of a zone. It costs
/// at most 0.1 dB.
const STRETCH: f64 = 1.0 / 7.0;

/// What all zones of a search have in common.
pub(super) struct Common {
    pub spec: &'static SignalSpec,
    /// Samples per code period.
    pub period: usize,
    /// Non-coherent sums.
    pub blocks: usize,
    /// Periods whose lags one transform gives.
    pub span: usize,
    /// Doppler bins of a zone on either side of the middle.
    pub half_width: i64,
}

/// Doppler bins around `centre`.
pub(super) struct Zone {
    pub centre: i64,
    /// Unit power, spectral lines limited.
    pub samples: Vec<Complex32>,
    /// Of each `span` + 1 periods.
    pub spectra: Vec<SampleSpectrum>,
}

impl Common {
    pub fn new(spec: &'static SignalSpec, blocks: usize, span: usize) -> Self {
        let period = (search_rate_hz(spec) * spec.period_s()).round() as usize;
        let edge_hz = STRETCH * spec.carrier_hz / period as f64;
        Common {
            spec,
            period,
            blocks,
            span,
            half_width: (edge_hz * 2.0 * spec.period_s()) as i64,
        }
    }

    /// Width of a Doppler bin, 1/(2T).
    pub fn doppler_bin_hz(&self) -> f64 {
        0.5 / self.spec.period_s()
    }

    /// Number of the zone that a bin is in; 0 is around bin 0.
    pub fn zone_of(&self, bin: i64) -> i64 {
        (bin + self.half_width).div_euclid(2 * self.half_width + 1)
    }

    /// Last bin of a zone.
    pub fn last_of(&self, zone: i64) -> i64 {
        zone * (2 * self.half_width + 1) + self.half_width
    }
}

impl Zone {
    /// Takes in the samples of zone `number`.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] for silence, or rates that cannot be.
    pub fn new(common: &Common, number: i64, input: Input<'_>) -> Result<Self> {
        let mut zone = Zone {
            centre: common.last_of(number) - common.half_width,
            samples: Vec::new(),
            spectra: Vec::new(),
        };
        let if_hz = input.if_hz + zone.centre_hz(common);
        let resampler = Resampler::new(input.sample_rate_hz, zone.rate_hz(common), if_hz)?;
        let count = (common.blocks + 1) * common.period;
        zone.samples = resampler.run(input.raw, input.first as f64, count);
        normalise(&mut zone.samples)?;
        lines::limit_lines(&mut zone.samples);
        Ok(zone)
    }

    /// Makes the spectra anew.
    pub fn transform(&mut self, common: &Common, plan: &Correlator) {
        let step = common.span * common.period;
        // Neighbours of a peak may lie a bin outside.
        let reach = self.shift(common, self.centre + common.half_width + 1) as usize;
        let scale = super::SPECTRUM_RMS / (plan.size() as f32).sqrt();
        self.spectra = (0..common.blocks.div_ceil(common.span))
            .into_par_iter()
            .map(|g| padded_spectrum(&self.samples[g * step..], plan.size()))
            .map(|spectrum| plan.sample_spectrum(&spectrum, reach, scale))
            .collect();
    }

    /// Points of the spectrum by which the samples are moved down for a Doppler bin.
    pub fn shift(&self, common: &Common, bin: i64) -> i64 {
        (bin - self.centre) * (common.span as i64 + 1) / 2
    }

    /// Samples by which the lag of block `block` is later than that of block 0.
    pub fn drift(&self, common: &Common, bin: i64, block: usize) -> f64 {
        let doppler_hz = (bin - self.centre) as f64 * common.doppler_bin_hz();
        -((block * common.period) as f64) * doppler_hz / common.spec.carrier_hz
    }

    /// Doppler of a bin, or of a point between bins.
    pub fn doppler_hz(&self, common: &Common, bin: f64) -> f64 {
        let from_centre = (bin - self.centre as f64) * common.doppler_bin_hz();
        self.centre_hz(common) + from_centre * self.stretch(common)
    }

    /// Rate of the samples.
    pub fn rate_hz(&self, common: &Common) -> f64 {
        search_rate_hz(common.spec) * self.stretch(common)
    }

    /// Removes a signal whose period of replica has the Fourier coefficients `spectrum`.
    pub fn cancel(&mut self, common: &Common, known: &Known, spectrum: &[Complex32]) {
        let rate = self.rate_hz(common);
        let doppler_hz = known.doppler_hz - self.centre_hz(common);
        let track = Track {
            start: known.code_delay_s * rate,
            step: common.period as f64 * (1.0 - doppler_hz / common.spec.carrier_hz),
            cycles_per_sample: doppler_hz / rate,
        };
        cancel(spectrum, &track, &mut self.samples);
    }

    fn centre_hz(&self, common: &Common) -> f64 {
        self.centre as f64 * common.doppler_bin_hz()
    }

    /// Received code rate of the middle over the nominal.
    fn stretch(&self, common: &Common) -> f64 {
        1.0 + self.centre_hz(common) / common.spec.carrier_hz
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acquire::replica::PeakShape;
    use crate::signal::SIGNALS;

    #[test]
    fn stretch_at_the_edge_of_a_zone_costs_a_tenth_of_a_decibel() {
        for spec in SIGNALS {
            let shape = PeakShape::new(spec);
            let at = |i: i32| shape.correlation(STRETCH * f64::from(i) / 100.0);
            let mean = (-50..=50).map(at).sum::<f64>() / 101.0;
            assert!(20.0 * mean.log10() > -0.1, "{} {mean}", spec.id);
        }
    }

    #[test]
    fn every_bin_is_in_one_zone() {
        for spec in SIGNALS {
            let common = Common::new(spec, 5, 5);
            assert!(common.half_width as f64 * common.doppler_bin_hz() >= 5e3);
            for bin in -1000..1000 {
                let zone = common.zone_of(bin);
                assert!(bin <= common.last_of(zone) && bin > common.last_of(zone - 1));
            }
        }
    }
}
