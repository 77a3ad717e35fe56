//! Paths of sequential statistics over rows of samples.

use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sdr_spoof_core::decision::likelihood::Mixture;
use sdr_spoof_core::decision::sprt::{Form, Sprt, Variance};
use sdr_spoof_core::decision::windows::{glr, squares, student, LocalMean};
use sdr_spoof_core::decision::{cusum, paths};

type Samples<'py> = PyReadonlyArray2<'py, f64>;
type Path<'py> = PyResult<Bound<'py, PyArray2<f64>>>;

fn run<'py>(
    py: Python<'py>,
    samples: &Samples<'py>,
    kernel: impl Fn(&[f64], &mut [f64]) + Sync + Send,
) -> Path<'py> {
    let (rows, columns) = samples.as_array().dim();
    let values = samples.as_slice()?;
    let path = py.detach(|| paths(values, columns, kernel));
    let shaped = Array2::from_shape_vec((rows, columns), path).expect("as many as the samples");
    Ok(shaped.into_pyarray(py))
}

fn variance_of(name: &str) -> PyResult<Variance> {
    match name {
        "known" => Ok(Variance::Known),
        "sample" => Ok(Variance::Sample),
        "as-printed" => Ok(Variance::Printed),
        _ => Err(PyValueError::new_err(format!("unknown variance '{name}'"))),
    }
}

/// Wald's test with an estimated mean; form: classic, floored, as-printed.
#[pyfunction]
fn sprt_path<'py>(
    py: Python<'py>,
    samples: Samples<'py>,
    form: &str,
    variance: &str,
    risk: f64,
    guard: usize,
) -> Path<'py> {
    let form = match form {
        "classic" => Form::Classic,
        "floored" => Form::Floored { risk },
        "as-printed" => Form::Printed { risk },
        _ => return Err(PyValueError::new_err(format!("unknown form '{form}'"))),
    };
    let variance = variance_of(variance)?;
    let test = Sprt {
        form,
        variance,
        guard,
    };
    run(py, &samples, |z, path| test.path(z, path))
}

/// Page's cumulative sums to both sides, the largest of all shifts.
#[pyfunction]
fn cusum_path<'py>(py: Python<'py>, samples: Samples<'py>, shifts: Vec<f64>) -> Path<'py> {
    run(py, &samples, |z, path| cusum::path(&shifts, z, path))
}

/// Largest likelihood ratio of a mean over several windows.
#[pyfunction]
fn glr_path<'py>(py: Python<'py>, samples: Samples<'py>, windows: Vec<usize>) -> Path<'py> {
    run(py, &samples, |z, path| glr(&windows, z, path))
}

/// Sum of squares over a window.
#[pyfunction]
fn squares_path<'py>(py: Python<'py>, samples: Samples<'py>, window: usize) -> Path<'py> {
    run(py, &samples, |z, path| squares(window, z, path))
}

/// Mean over a window over its standard error.
#[pyfunction]
fn student_path<'py>(
    py: Python<'py>,
    samples: Samples<'py>,
    window: usize,
    known: bool,
) -> Path<'py> {
    run(py, &samples, |z, path| student(window, known, z, path))
}

/// Mean over a window against a line through the samples before it.
#[pyfunction]
fn local_mean_path<'py>(
    py: Python<'py>,
    samples: Samples<'py>,
    window: usize,
    baseline: usize,
    slope: bool,
    known: bool,
) -> Path<'py> {
    let test = LocalMean {
        window,
        baseline,
        slope,
        known,
    };
    run(py, &samples, |z, path| test.path(z, path))
}

/// ln of the likelihood of a mixture of changes against none.
#[pyfunction]
fn change_log_ratio<'py>(
    py: Python<'py>,
    samples: Samples<'py>,
    shifts: Vec<(f64, f64)>,
    energy: bool,
    from_start: bool,
) -> Path<'py> {
    let mixture = Mixture {
        shifts,
        energy,
        from_start,
    };
    run(py, &samples, |z, path| mixture.log_ratio(z, path))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(sprt_path, m)?)?;
    m.add_function(wrap_pyfunction!(cusum_path, m)?)?;
    m.add_function(wrap_pyfunction!(glr_path, m)?)?;
    m.add_function(wrap_pyfunction!(squares_path, m)?)?;
    m.add_function(wrap_pyfunction!(student_path, m)?)?;
    m.add_function(wrap_pyfunction!(local_mean_path, m)?)?;
    m.add_function(wrap_pyfunction!(change_log_ratio, m)?)?;
    Ok(())
}
