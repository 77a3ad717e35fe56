//! The FFT search.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use sdr_spoof_core::acquire::replica::{search_rate_hz as rate_hz, PeakShape};
use sdr_spoof_core::acquire::{Input, Job, Known, Peak, Search};
use sdr_spoof_core::dsp::raw::RawSamples;
use sdr_spoof_core::{sample::SampleFormat, signal};

use crate::to_py;

/// The largest cell of one search.
#[pyclass(name = "SearchPeak", module = "sdr_spoof._core", frozen, get_all)]
struct PyPeak {
    prn: u16,
    statistic: f64,
    cells: usize,
    doppler_hz: f64,
    code_delay_s: f64,
    cn0_dbhz: f64,
}

impl From<Peak> for PyPeak {
    fn from(p: Peak) -> Self {
        PyPeak {
            prn: p.prn,
            statistic: p.statistic,
            cells: p.cells,
            doppler_hz: p.doppler_hz,
            code_delay_s: p.code_delay_s,
            cn0_dbhz: p.cn0_dbhz,
        }
    }
}

/// The samples of one signal, ready to be searched for any PRN.
#[pyclass(name = "Search", module = "sdr_spoof._core")]
struct PySearch(Search);

#[pymethods]
impl PySearch {
    /// Takes in `blocks` + 1 code periods of `raw` from sample `first` on, for searches in the
    /// Doppler bins from the first to the last of `bins`.
    #[new]
    #[pyo3(signature = (signal, raw, sample_format, *, sample_rate_hz, if_hz, blocks, bins, threads,
                        first=0, scale=1.0, conjugate=false))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        signal: &str,
        raw: PyReadonlyArray1<'_, u8>,
        sample_format: &str,
        sample_rate_hz: f64,
        if_hz: f64,
        blocks: usize,
        bins: (i64, i64),
        threads: usize,
        first: usize,
        scale: f32,
        conjugate: bool,
    ) -> PyResult<Self> {
        let spec = signal::find(signal).map_err(to_py)?;
        let format = SampleFormat::parse(sample_format).map_err(to_py)?;
        let raw = RawSamples {
            bytes: raw.as_slice()?,
            format,
            scale,
            conjugate,
        };
        let input = Input {
            raw,
            sample_rate_hz,
            first,
            if_hz,
        };
        py.detach(|| Search::new(spec, input, blocks, bins.0..=bins.1, threads))
            .map(PySearch)
            .map_err(to_py)
    }

    /// Takes signals out of the samples: (prn, Doppler in Hz, code delay in seconds) of each.
    fn cancel(&mut self, py: Python<'_>, known: Vec<(u16, f64, f64)>) -> PyResult<()> {
        let known: Vec<Known> = known
            .into_iter()
            .map(|(prn, doppler_hz, code_delay_s)| Known {
                prn,
                doppler_hz,
                code_delay_s,
            })
            .collect();
        py.detach(|| self.0.cancel(&known)).map_err(to_py)
    }

    /// Searches each (prn, first Doppler bin, last Doppler bin).
    fn run(&self, py: Python<'_>, jobs: Vec<(u16, i64, i64)>) -> PyResult<Vec<PyPeak>> {
        let jobs: Vec<Job> = jobs
            .into_iter()
            .map(|(prn, low, high)| Job { prn, low, high })
            .collect();
        let peaks = py.detach(|| self.0.run(&jobs)).map_err(to_py)?;
        Ok(peaks.into_iter().map(PyPeak::from).collect())
    }
}

/// Samples per second at which a signal is searched.
#[pyfunction]
fn search_rate_hz(signal: &str) -> PyResult<f64> {
    signal::find(signal).map(rate_hz).map_err(to_py)
}

/// (share of the signal's power in the search band, correlation at the given delays in samples
/// of the search).
#[pyfunction]
fn search_peak_shape(signal: &str, delays: Vec<f64>) -> PyResult<(f64, Vec<f64>)> {
    let shape = PeakShape::new(signal::find(signal).map_err(to_py)?);
    Ok((
        shape.power_in_band,
        delays.iter().map(|&d| shape.correlation(d)).collect(),
    ))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<PyPeak>()?;
    m.add_class::<PySearch>()?;
    m.add_function(wrap_pyfunction!(search_rate_hz, m)?)?;
    m.add_function(wrap_pyfunction!(search_peak_shape, m)?)?;
    Ok(())
}
