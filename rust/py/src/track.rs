//! The tracker: plain arguments in, dicts of arrays out.

use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::signal::Modulation;
use sdr_spoof_core::track::channel::Channel;
use sdr_spoof_core::track::config::TrackConfig;
use sdr_spoof_core::track::discriminator;
use sdr_spoof_core::track::engine::{Input, Target, Tracker as CoreTracker};
use sdr_spoof_core::track::epoch::Seed;
use sdr_spoof_core::track::sideband::Sideband;

use crate::to_py;

/// (signal, prn, sample, doppler_hz, code_delay_s)
type TargetTuple = (String, u16, u64, f64, f64);

fn target((signal, prn, sample, doppler_hz, code_delay_s): TargetTuple) -> Target {
    Target {
        signal,
        prn,
        seed: Seed {
            sample,
            doppler_hz,
            code_delay_s,
        },
    }
}

/// Reads every field of the core's configuration from a dict.
pub(crate) fn config(values: &Bound<'_, PyDict>) -> PyResult<TrackConfig> {
    fn get<'py, T: FromPyObject<'py>>(values: &Bound<'py, PyDict>, key: &str) -> PyResult<T> {
        values.as_any().get_item(key)?.extract()
    }
    Ok(TrackConfig {
        pll_bandwidth_hz: get(values, "pll_bandwidth_hz")?,
        pull_in_pll_bandwidth_hz: get(values, "pull_in_pll_bandwidth_hz")?,
        fll_bandwidth_hz: get(values, "fll_bandwidth_hz")?,
        dll_bandwidth_hz: get(values, "dll_bandwidth_hz")?,
        main_bandwidth_hz: get(values, "main_bandwidth_hz")?,
        subcarrier_bandwidth_hz: get(values, "subcarrier_bandwidth_hz")?,
        code_bias_bandwidth_hz: get(values, "code_bias_bandwidth_hz")?,
        integration_ms: get(values, "integration_ms")?,
        cn0_min_dbhz: get(values, "cn0_min_dbhz")?,
        qmboc: get(values, "qmboc")?,
        combo: get(values, "combo")?,
        pairs: get(values, "pairs")?,
        data_component: get(values, "data_component")?,
    })
}

/// Tracks any number of satellites through a recording fed in pieces of any length.
#[pyclass]
struct Tracker(CoreTracker);

#[pymethods]
impl Tracker {
    #[new]
    #[pyo3(signature = (sample_format, sample_rate_hz, lo_hz, config_values, targets, *,
                        conjugate=false, float_scale=1.0, start_sample=0, threads=1))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        sample_format: &str,
        sample_rate_hz: f64,
        lo_hz: f64,
        config_values: &Bound<'_, PyDict>,
        targets: Vec<TargetTuple>,
        conjugate: bool,
        float_scale: f32,
        start_sample: u64,
        threads: usize,
    ) -> PyResult<Self> {
        let input = Input {
            format: SampleFormat::parse(sample_format).map_err(to_py)?,
            conjugate,
            float_scale,
            sample_rate_hz,
            lo_hz,
            start: start_sample,
        };
        let targets: Vec<Target> = targets.into_iter().map(target).collect();
        CoreTracker::new(input, &config(config_values)?, &targets, threads)
            .map(Tracker)
            .map_err(to_py)
    }

    /// Absorbs raw bytes of whole samples.
    fn feed(&mut self, py: Python<'_>, raw: PyReadonlyArray1<'_, u8>) -> PyResult<()> {
        let bytes = raw.as_slice()?;
        py.detach(|| self.0.feed(bytes));
        Ok(())
    }

    /// Next sample to be fed.
    fn position(&self) -> u64 {
        self.0.position()
    }

    /// Lost signals: (signal, prn, last Doppler in Hz).
    fn lost(&self) -> Vec<(String, u16, f64)> {
        self.0.lost()
    }

    /// Restarts a lost signal from a new acquisition.
    fn restart(&mut self, seed: TargetTuple) -> PyResult<()> {
        self.0.restart(&target(seed)).map_err(to_py)
    }

    /// Marks a signal as captured: its pair is parted, both go on by themselves.
    fn isolate(&mut self, system: char, prn: u16, signal: &str) -> PyResult<()> {
        self.0.isolate(system, prn, signal).map_err(to_py)
    }

    /// Takes such marks of a satellite away.
    fn rejoin(&mut self, system: char, prn: u16) -> PyResult<()> {
        self.0.rejoin(system, prn).map_err(to_py)
    }

    /// Rows recorded since the last call: one dict per signal.
    fn take_signals<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        all_signal_rows(py, self.0.channels_mut())
    }

    /// Where counts of code periods broke since the last call: (signal, prn, from, until), s.
    fn take_breaks(&mut self) -> Vec<BreakTuple> {
        all_breaks(self.0.channels_mut())
    }

    /// Rows recorded since the last call: one dict per satellite with two sidebands.
    fn take_combos<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        all_combo_rows(py, self.0.channels_mut())
    }
}

/// (signal, prn, from_s, until_s)
pub(crate) type BreakTuple = (&'static str, u16, f64, f64);

/// Breaks of channels since the last call.
pub(crate) fn all_breaks<'a>(
    channels: impl IntoIterator<Item = &'a mut Channel>,
) -> Vec<BreakTuple> {
    let mut all = Vec::new();
    for channel in channels {
        for sideband in &mut channel.sidebands {
            let taken = sideband.breaks.drain(..);
            all.extend(taken.map(|b| (sideband.spec.id, channel.prn, b.from_s, b.until_s)));
        }
    }
    all
}

/// What channels recorded since the last call: one dict per signal.
pub(crate) fn all_signal_rows<'a, 'py>(
    py: Python<'py>,
    channels: impl IntoIterator<Item = &'a mut Channel>,
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for channel in channels {
        for sideband in &mut channel.sidebands {
            list.append(signal_rows(py, channel.prn, sideband)?)?;
        }
    }
    Ok(list)
}

/// What channels recorded since the last call: one dict per satellite with two sidebands.
pub(crate) fn all_combo_rows<'a, 'py>(
    py: Python<'py>,
    channels: impl IntoIterator<Item = &'a mut Channel>,
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for channel in channels {
        if channel.sidebands.len() == 2 {
            list.append(combo_rows(py, channel)?)?;
        }
    }
    Ok(list)
}

/// Fills a dict with a column of each named field; the columns move to Python without a copy.
macro_rules! set_columns {
    ($dict:ident, $rows:ident, $($name:ident),+) => {
        $($dict.set_item(stringify!($name), $rows.$name.into_pyarray($dict.py()))?;)+
    };
}

fn signal_rows<'py>(py: Python<'py>, prn: u16, s: &mut Sideband) -> PyResult<Bound<'py, PyDict>> {
    let (d, rows, offsets) = (PyDict::new(py), s.rows.take(), s.tap_offsets_s());
    d.set_item("signal", s.spec.id)?;
    d.set_item("prn", prn)?;
    d.set_item("modulation", format!("{:?}", s.modulation))?;
    d.set_item("prompt_tap", s.taps.prompt)?;
    let taps = Array2::from_shape_vec((rows.time_s.len(), offsets.len()), rows.taps)
        .map_err(|e| pyo3::exceptions::PyRuntimeError::new_err(e.to_string()))?;
    d.set_item("taps", taps.into_pyarray(py))?;
    d.set_item("tap_offsets_s", offsets.into_pyarray(py))?;
    set_columns!(
        d,
        rows,
        time_s,
        integration_s,
        state,
        carrier_phase_cycles,
        doppler_hz,
        code_phase_chips,
        phase_error_cycles,
        code_error_chips,
        cn0_dbhz,
        phase_lock,
        noise_power,
        data_prompt
    );
    Ok(d)
}

fn combo_rows<'py>(py: Python<'py>, channel: &mut Channel) -> PyResult<Bound<'py, PyDict>> {
    let (d, rows) = (PyDict::new(py), channel.combo.take());
    d.set_item("prn", channel.prn)?;
    d.set_item("lower", channel.sidebands[0].spec.id)?;
    d.set_item("upper", channel.sidebands[1].spec.id)?;
    set_columns!(
        d,
        rows,
        time_s,
        integration_s,
        state,
        phase_lower_cycles,
        phase_upper_cycles,
        main_phase_cycles,
        subcarrier_phase_cycles,
        subcarrier_range_m,
        code_delay_lower_s,
        code_delay_upper_s,
        cn0_lower_dbhz,
        cn0_upper_dbhz,
        code_difference_s,
        subcarrier_lock
    );
    Ok(d)
}

/// Autocorrelation between an early and a late tap at +-`half_chips`, and the slope of early
/// minus late per chip.
#[pyfunction]
fn early_late(modulation: &str, half_chips: f64) -> PyResult<(f64, f64)> {
    let modulation = Modulation::parse(modulation).map_err(to_py)?;
    let correlation = discriminator::autocorrelation(modulation, 2.0 * half_chips);
    Ok((
        correlation,
        discriminator::early_late_slope(modulation, half_chips),
    ))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Tracker>()?;
    m.add_function(wrap_pyfunction!(early_late, m)?)
}
