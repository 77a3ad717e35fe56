//! Inertial navigation: arrays of increments and states in, arrays of states out.
//!
//! A state is a row of nine numbers: Earth-fixed position and velocity, then yaw, pitch, roll.

use nalgebra::{UnitQuaternion, Vector3};
use numpy::ndarray::{Array1, Array3, ArrayView1, ArrayView2, ArrayView3, Axis};
use numpy::{IntoPyArray, PyArray1, PyArray3};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sdr_spoof_core::inertial::batch::{self, Mechanisation, Plan, Reset, Run, Vertical, COLUMNS};
use sdr_spoof_core::inertial::covariance::{self, SensorNoise, Uncertainty};
use sdr_spoof_core::inertial::ecef::to_earth;
use sdr_spoof_core::inertial::errors::ImuErrors;
use sdr_spoof_core::inertial::{gravity, Increment, NavState, StateError};
use sdr_spoof_core::nav_math::geodesy::WGS84;

use crate::imu;

fn three(row: ArrayView1<'_, f64>, first: usize) -> Vector3<f64> {
    Vector3::new(row[first], row[first + 1], row[first + 2])
}

fn wide(given: usize, wanted: usize, name: &str) -> PyResult<()> {
    if given == wanted {
        return Ok(());
    }
    let message = format!("{name}: {wanted} are needed, not {given}");
    Err(PyValueError::new_err(message))
}

/// Increments (N, 3), (N, 3) and their intervals (N,).
pub(crate) fn increments(
    rotation: ArrayView2<'_, f64>,
    velocity: ArrayView2<'_, f64>,
    interval: ArrayView1<'_, f64>,
) -> PyResult<Vec<Increment>> {
    wide(rotation.ncols(), 3, "columns of rotation")?;
    wide(velocity.ncols(), 3, "columns of velocity")?;
    wide(velocity.nrows(), rotation.nrows(), "rows of velocity")?;
    wide(interval.len(), rotation.nrows(), "intervals")?;
    let rows = rotation.rows().into_iter().zip(velocity.rows());
    Ok(rows
        .zip(interval)
        .map(|((rotation, velocity), &interval)| Increment {
            rotation: three(rotation, 0),
            velocity: three(velocity, 0),
            interval,
        })
        .collect())
}

/// A state from a row.
pub(crate) fn state(row: ArrayView1<'_, f64>) -> PyResult<NavState> {
    wide(row.len(), COLUMNS, "numbers of a state")?;
    let place = WGS84.geodetic(three(row, 0));
    Ok(NavState {
        place,
        velocity: to_earth(place).inverse() * three(row, 3),
        attitude: UnitQuaternion::from_euler_angles(row[8], row[7], row[6]),
    })
}

/// Errors of the alignments of each run (R, K, 9): position, velocity, attitude in local axes.
fn alignments(values: Option<ArrayView3<'_, f64>>) -> PyResult<Vec<Vec<StateError>>> {
    let Some(values) = values else {
        return Ok(Vec::new());
    };
    wide(values.len_of(Axis(2)), COLUMNS, "numbers of an alignment")?;
    let error = |row: ArrayView1<'_, f64>| StateError {
        position: three(row, 0),
        velocity: three(row, 3),
        attitude: three(row, 6),
    };
    let run = |rows: ArrayView2<'_, f64>| rows.rows().into_iter().map(error).collect();
    Ok(values.outer_iter().map(run).collect())
}

fn resets(after: &[usize], states: ArrayView2<'_, f64>) -> PyResult<Vec<Reset>> {
    wide(states.nrows(), after.len(), "states of resets")?;
    let reset = |(&after, row)| {
        Ok(Reset {
            after,
            state: state(row)?,
        })
    };
    after.iter().zip(states.rows()).map(reset).collect()
}

fn verticals(values: ArrayView2<'_, f64>, rows: usize) -> PyResult<Vec<Vertical>> {
    wide(values.ncols(), 2, "columns of the vertical channel")?;
    wide(values.nrows(), rows, "rows of the vertical channel")?;
    Ok(values
        .rows()
        .into_iter()
        .map(|row| Vertical {
            height: row[0],
            down: row[1],
        })
        .collect())
}

/// States (R, M, 9) of all runs at the start and after each `every` increments.
///
/// `errors`: an `aiding.imu.errors.ImuErrors` for each run; empty: one run over the increments as
/// they are. `realigned`: numbers of increments and the states then. `vertical`: height and velocity
/// downwards after each increment.
#[pyfunction]
#[pyo3(signature = (rotation, velocity, interval, start, *, every, errors, alignments=None,
                    realigned=None, vertical=None, earth_fixed=false))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
fn inertial_navigate<'py>(
    py: Python<'py>,
    rotation: PyReadonlyArray2<'py, f64>,
    velocity: PyReadonlyArray2<'py, f64>,
    interval: PyReadonlyArray1<'py, f64>,
    start: PyReadonlyArray1<'py, f64>,
    every: usize,
    errors: Vec<Bound<'py, PyAny>>,
    alignments: Option<PyReadonlyArray3<'py, f64>>,
    realigned: Option<(Vec<usize>, PyReadonlyArray2<'py, f64>)>,
    vertical: Option<PyReadonlyArray2<'py, f64>>,
    earth_fixed: bool,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let increments = increments(
        rotation.as_array(),
        velocity.as_array(),
        interval.as_array(),
    )?;
    let resets = match &realigned {
        Some((after, states)) => resets(after, states.as_array())?,
        None => Vec::new(),
    };
    let vertical = vertical
        .map(|v| verticals(v.as_array(), increments.len()))
        .transpose()?;
    let plan = Plan {
        increments: &increments,
        start: state(start.as_array())?,
        resets: &resets,
        vertical: vertical.as_deref(),
        every: every.max(1),
        mechanisation: if earth_fixed {
            Mechanisation::EarthFixed
        } else {
            Mechanisation::Local
        },
    };
    let given: Vec<Option<(ImuErrors, u64)>> = if errors.is_empty() {
        vec![None]
    } else {
        let each = errors.iter().map(|e| imu::errors(e).map(Some));
        each.collect::<PyResult<_>>()?
    };
    let alignments = self::alignments(alignments.as_ref().map(PyReadonlyArray3::as_array))?;
    let runs: Vec<Run<'_>> = given
        .into_iter()
        .enumerate()
        .map(|(k, errors)| Run {
            errors,
            alignments: alignments.get(k).map_or(&[], Vec::as_slice),
        })
        .collect();
    let shape = (runs.len(), plan.rows(), COLUMNS);
    let out = py.detach(|| {
        let mut out = vec![0.0; shape.0 * shape.1 * shape.2];
        batch::navigate(&plan, &runs, &mut out);
        out
    });
    let states = Array3::from_shape_vec(shape, out);
    Ok(states
        .map_err(|e| PyValueError::new_err(e.to_string()))?
        .into_pyarray(py))
}

/// Bias, wander, its time, density.
fn noise([bias, wander, wander_time, density]: [f64; 4]) -> SensorNoise {
    SensorNoise {
        bias,
        wander,
        wander_time,
        density,
    }
}

/// Covariances (M, 9, 9) of position, velocity and attitude in local axes: at the start and after each
/// `every` increments.
#[pyfunction]
#[pyo3(signature = (rotation, velocity, interval, start, *, every, gyro, accelerometer, alignment))]
#[allow(clippy::too_many_arguments)]
fn inertial_covariance<'py>(
    py: Python<'py>,
    rotation: PyReadonlyArray2<'py, f64>,
    velocity: PyReadonlyArray2<'py, f64>,
    interval: PyReadonlyArray1<'py, f64>,
    start: PyReadonlyArray1<'py, f64>,
    every: usize,
    gyro: [f64; 4],
    accelerometer: [f64; 4],
    alignment: [[f64; 3]; 3],
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let increments = increments(
        rotation.as_array(),
        velocity.as_array(),
        interval.as_array(),
    )?;
    let start = state(start.as_array())?;
    let uncertainty = Uncertainty {
        gyro: noise(gyro),
        accelerometer: noise(accelerometer),
        alignment: alignment.map(Vector3::from),
    };
    let every = every.max(1);
    let out = py.detach(|| {
        let mut out = Vec::with_capacity((1 + increments.len() / every) * COLUMNS * COLUMNS);
        covariance::propagate(&increments, start, &uncertainty, every, |p| {
            out.extend(p.fixed_view::<COLUMNS, COLUMNS>(0, 0).iter());
        });
        out
    });
    let shape = (out.len() / (COLUMNS * COLUMNS), COLUMNS, COLUMNS);
    let rows = Array3::from_shape_vec(shape, out);
    Ok(rows
        .map_err(|e| PyValueError::new_err(e.to_string()))?
        .into_pyarray(py))
}

/// Normal gravity (N,) in m/s^2 at latitudes in rad and heights in m (N,), straight down.
#[pyfunction]
fn normal_gravity<'py>(
    py: Python<'py>,
    latitude: PyReadonlyArray1<'py, f64>,
    height: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (latitude, height) = (latitude.as_array(), height.as_array());
    wide(height.len(), latitude.len(), "heights")?;
    let at = |(&b, &h): (&f64, &f64)| gravity::normal(b.sin(), h);
    let values: Array1<f64> = latitude.iter().zip(height).map(at).collect();
    Ok(values.into_pyarray(py))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(inertial_navigate, m)?)?;
    m.add_function(wrap_pyfunction!(inertial_covariance, m)?)?;
    m.add_function(wrap_pyfunction!(normal_gravity, m)?)
}
