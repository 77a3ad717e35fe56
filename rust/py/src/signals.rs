//! The signal registry and sample formats.

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sdr_spoof_core::{sample::SampleFormat, signal};

use crate::to_py;

/// Registry names of all signals.
#[pyfunction]
fn signal_ids() -> Vec<&'static str> {
    signal::SIGNALS.iter().map(|s| s.id).collect()
}

/// The specification of a signal as a dict.
#[pyfunction]
fn signal_spec<'py>(py: Python<'py>, id: &str) -> PyResult<Bound<'py, PyDict>> {
    let s = signal::find(id).map_err(to_py)?;
    let d = PyDict::new(py);
    d.set_item("id", s.id)?;
    d.set_item("composite", s.composite)?;
    d.set_item("description", s.description)?;
    d.set_item("rinex", s.rinex)?;
    d.set_item("system", s.system)?;
    d.set_item("carrier_hz", s.carrier_hz)?;
    d.set_item("chip_rate_hz", s.chip_rate_hz)?;
    d.set_item("code_length", s.code_length)?;
    d.set_item("modulation", format!("{:?}", s.modulation))?;
    d.set_item("power_share", s.power_share)?;
    d.set_item("phase_offset_cycles", s.phase_offset_cycles)?;
    d.set_item("min_half_bandwidth_hz", s.min_half_bandwidth_hz)?;
    d.set_item("prns", (s.prns)())?;
    Ok(d)
}

/// Registry names of the components of a composite signal.
#[pyfunction]
fn signal_components(name: &str) -> PyResult<Vec<&'static str>> {
    Ok(signal::components(name)
        .map_err(to_py)?
        .iter()
        .map(|s| s.id)
        .collect())
}

/// Pairs of signals with coherent carriers, as tracked by default.
#[pyfunction]
fn signal_pairs() -> Vec<(&'static str, &'static str)> {
    signal::PAIRS.to_vec()
}

/// Primary code chips, +1/-1.
#[pyfunction]
fn code_chips<'py>(py: Python<'py>, id: &str, prn: u16) -> PyResult<Bound<'py, PyArray1<i8>>> {
    let chips = signal::find(id).and_then(|s| s.code(prn)).map_err(to_py)?;
    Ok(chips.into_pyarray(py))
}

/// Secondary code chips, one per code period; empty if there is none.
#[pyfunction]
fn secondary_chips<'py>(py: Python<'py>, id: &str, prn: u16) -> PyResult<Bound<'py, PyArray1<i8>>> {
    let chips = signal::find(id)
        .and_then(|s| s.secondary(prn))
        .map_err(to_py)?;
    Ok(chips.into_pyarray(py))
}

/// Code periods per data symbol; None for a pilot.
#[pyfunction]
fn periods_per_symbol(id: &str, prn: u16) -> PyResult<Option<usize>> {
    signal::find(id)
        .and_then(|s| s.periods_per_symbol(prn))
        .map_err(to_py)
}

/// Names of the sample formats.
#[pyfunction]
fn sample_formats() -> Vec<&'static str> {
    SampleFormat::names()
}

/// (bits per sample, is complex) of a sample format.
#[pyfunction]
fn sample_format(name: &str) -> PyResult<(usize, bool)> {
    let f = SampleFormat::parse(name).map_err(to_py)?;
    Ok((f.bits_per_sample(), f.is_complex()))
}

/// Raw bytes of a recording to int16 values, I and Q interleaved if the format is complex.
#[pyfunction]
#[pyo3(signature = (name, raw, scale=1.0, conjugate=false))]
fn unpack<'py>(
    py: Python<'py>,
    name: &str,
    raw: numpy::PyReadonlyArray1<'py, u8>,
    scale: f32,
    conjugate: bool,
) -> PyResult<Bound<'py, PyArray1<i16>>> {
    let format = SampleFormat::parse(name).map_err(to_py)?;
    let bytes = raw.as_slice()?;
    let values = py.detach(|| {
        let mut out = Vec::new();
        format.unpack(bytes, scale, conjugate, &mut out);
        out
    });
    Ok(values.into_pyarray(py))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(signal_ids, m)?)?;
    m.add_function(wrap_pyfunction!(signal_spec, m)?)?;
    m.add_function(wrap_pyfunction!(signal_components, m)?)?;
    m.add_function(wrap_pyfunction!(signal_pairs, m)?)?;
    m.add_function(wrap_pyfunction!(code_chips, m)?)?;
    m.add_function(wrap_pyfunction!(secondary_chips, m)?)?;
    m.add_function(wrap_pyfunction!(periods_per_symbol, m)?)?;
    m.add_function(wrap_pyfunction!(sample_formats, m)?)?;
    m.add_function(wrap_pyfunction!(sample_format, m)?)?;
    m.add_function(wrap_pyfunction!(unpack, m)?)?;
    Ok(())
}
