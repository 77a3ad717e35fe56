//! Error control of the navigation messages.

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sdr_spoof_core::fec::{cnav1, crc24q as crc, estimate_noise, ldpc64, Level};

use crate::to_py;

type Bits<'py> = Bound<'py, PyArray1<u8>>;
pub(crate) type Rows<'py> = Bound<'py, PyArray2<u8>>;

/// CRC-24Q of bits of 0 and 1.
#[pyfunction]
fn crc24q(bits: PyReadonlyArray1<'_, u8>) -> PyResult<u32> {
    Ok(crc::crc24q(bits.as_slice()?))
}

fn code(name: &str) -> PyResult<&'static ldpc64::Code> {
    match name {
        "subframe2" => Ok(ldpc64::subframe2()),
        "subframe3" => Ok(ldpc64::subframe3()),
        _ => Err(PyValueError::new_err(format!(
            "unknown code '{name}'; known codes: subframe2, subframe3"
        ))),
    }
}

/// Code word of one of B-CNAV1's LDPC codes from its information bits.
#[pyfunction]
fn ldpc64_encode<'py>(
    py: Python<'py>,
    name: &str,
    information: PyReadonlyArray1<'py, u8>,
) -> PyResult<Bits<'py>> {
    let (code, bits) = (code(name)?, information.as_slice()?);
    same("bits of information", bits.len(), code.information())?;
    Ok(code.encode(bits).into_pyarray(py))
}

/// (bits, corrected, iterations, converged) of logarithms of likelihood ratios, positive for 0.
#[pyfunction]
#[pyo3(signature = (name, likelihoods, iterations=cnav1::ITERATIONS))]
fn ldpc64_decode<'py>(
    py: Python<'py>,
    name: &str,
    likelihoods: PyReadonlyArray1<'py, f32>,
    iterations: usize,
) -> PyResult<(Bits<'py>, usize, usize, bool)> {
    let (code, values) = (code(name)?, likelihoods.as_slice()?);
    same("likelihoods", values.len(), code.length())?;
    let d = py.detach(|| code.decode(values, iterations));
    Ok((
        d.bits.into_pyarray(py),
        d.corrected,
        d.iterations,
        d.converged,
    ))
}

/// (amplitude, standard deviation of the noise) of symbols of unknown sign; zeros do not count.
#[pyfunction]
fn symbol_level(values: PyReadonlyArray1<'_, f32>) -> PyResult<(f32, f32)> {
    let level = estimate_noise(values.as_slice()?);
    Ok((level.amplitude, level.noise))
}

/// 1800 symbols +1 and -1 of a frame of B-CNAV1 from 576 and 240 bits without their checks.
#[pyfunction]
fn cnav1_encode<'py>(
    py: Python<'py>,
    prn: usize,
    soh: usize,
    data2: PyReadonlyArray1<'py, u8>,
    data3: PyReadonlyArray1<'py, u8>,
) -> PyResult<Bound<'py, PyArray1<i8>>> {
    let symbols = cnav1::encode(prn, soh, data2.as_slice()?, data3.as_slice()?);
    Ok(symbols.map_err(to_py)?.into_pyarray(py))
}

/// 72 symbols +1 and -1 of subframe 1 of B-CNAV1.
#[pyfunction]
fn cnav1_first(py: Python<'_>, prn: usize, soh: usize) -> PyResult<Bound<'_, PyArray1<i8>>> {
    Ok(cnav1::first(prn, soh).map_err(to_py)?.into_pyarray(py))
}

/// (first symbol, inverted, number in the hour, score) of the likeliest starts of frames.
#[pyfunction]
#[pyo3(signature = (values, prn, limit=3))]
fn cnav1_find(
    py: Python<'_>,
    values: PyReadonlyArray1<'_, f32>,
    prn: usize,
    limit: usize,
) -> PyResult<Vec<(usize, bool, usize, f32)>> {
    let values = values.as_slice()?;
    let starts = py.detach(|| cnav1::find(values, prn, limit));
    Ok(starts
        .iter()
        .map(|s| (s.offset, s.inverted, s.soh, s.score))
        .collect())
}

/// One frame of B-CNAV1 as decoded.
#[pyclass(frozen, get_all, module = "sdr_spoof._core")]
struct Cnav1Frame {
    prn: usize,
    soh: usize,
    first_errors: usize,
    ok2: bool,
    ok3: bool,
    corrected2: usize,
    corrected3: usize,
    iterations2: usize,
    iterations3: usize,
    amplitude: f32,
    noise: f32,
    bits2: Py<PyArray1<u8>>,
    bits3: Py<PyArray1<u8>>,
}

/// Frames from soft symbols of known sign, (F, 1800), 0 where one is missing.
#[pyfunction]
#[pyo3(signature = (values, iterations=cnav1::ITERATIONS, amplitude=None, noise=None))]
fn cnav1_decode(
    py: Python<'_>,
    values: PyReadonlyArray2<'_, f32>,
    iterations: usize,
    amplitude: Option<f32>,
    noise: Option<f32>,
) -> PyResult<Vec<Cnav1Frame>> {
    let rows = rows_of::<f32, { cnav1::FRAME }>(&values)?;
    let level = amplitude.zip(noise);
    let level = level.map(|(amplitude, noise)| Level { amplitude, noise });
    let decode = |row: &[f32; cnav1::FRAME]| cnav1::decode(row, level, iterations);
    let frames: Vec<_> = py.detach(|| rows.iter().map(decode).collect());
    Ok(frames.into_iter().map(|f| frame(py, f)).collect())
}

fn frame(py: Python<'_>, f: cnav1::Frame) -> Cnav1Frame {
    Cnav1Frame {
        prn: f.prn.value,
        soh: f.soh.value,
        first_errors: f.prn.errors + f.soh.errors,
        ok2: f.second.ok,
        ok3: f.third.ok,
        corrected2: f.second.corrected,
        corrected3: f.third.corrected,
        iterations2: f.second.iterations,
        iterations3: f.third.iterations,
        amplitude: f.level.amplitude,
        noise: f.level.noise,
        bits2: f.second.bits.into_pyarray(py).unbind(),
        bits3: f.third.bits.into_pyarray(py).unbind(),
    }
}

pub(crate) fn rows_of<T: numpy::Element + Copy, const N: usize>(
    array: &PyReadonlyArray2<'_, T>,
) -> PyResult<Vec<[T; N]>> {
    same("columns", array.shape()[1], N)?;
    let row = |r: &[T]| r.try_into().expect("as many as there are columns");
    Ok(array.as_slice()?.chunks_exact(N).map(row).collect())
}

pub(crate) fn table<T: numpy::Element>(
    py: Python<'_>,
    values: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = values.len() / columns;
    values.into_pyarray(py).reshape([rows, columns])
}

pub(crate) fn same(what: &str, found: usize, wanted: usize) -> PyResult<()> {
    if found == wanted {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{found} {what}, must be {wanted}"
    )))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Cnav1Frame>()?;
    m.add_function(wrap_pyfunction!(crc24q, m)?)?;
    m.add_function(wrap_pyfunction!(ldpc64_encode, m)?)?;
    m.add_function(wrap_pyfunction!(ldpc64_decode, m)?)?;
    m.add_function(wrap_pyfunction!(symbol_level, m)?)?;
    m.add_function(wrap_pyfunction!(cnav1_encode, m)?)?;
    m.add_function(wrap_pyfunction!(cnav1_first, m)?)?;
    m.add_function(wrap_pyfunction!(cnav1_find, m)?)?;
    m.add_function(wrap_pyfunction!(cnav1_decode, m)?)?;
    Ok(())
}
