//! Inertial navigation: arrays of increments and states in, arrays of states out.
//!
//! A state is a row of nine numbers: Earth-fixed position and velocity, then yaw, pitch, roll.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use numpy::ndarray::{Array1, Array2, Array3, ArrayView1, ArrayView2, ArrayView3, Axis};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sdr_spoof_core::inertial::alignment::{self, Epoch, Reading};
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

/// Numbers of increments and whether a gap follows them, and the states then.
type Realigned<'py> = (Vec<(usize, bool)>, PyReadonlyArray2<'py, f64>);

fn resets((after, states): &Realigned<'_>) -> PyResult<Vec<Reset>> {
    wide(states.as_array().nrows(), after.len(), "states of resets")?;
    let reset = |(&(after, gap), row)| {
        let state = state(row)?;
        Ok(Reset { after, state, gap })
    };
    after
        .iter()
        .zip(states.as_array().rows())
        .map(reset)
        .collect()
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
/// they are. `realigned`: numbers of increments, whether a gap follows, and the states then. `vertical`: height and velocity
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
    realigned: Option<Realigned<'py>>,
    vertical: Option<PyReadonlyArray2<'py, f64>>,
    earth_fixed: bool,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let increments = increments(
        rotation.as_array(),
        velocity.as_array(),
        interval.as_array(),
    )?;
    let resets = realigned.as_ref().map_or(Ok(Vec::new()), resets)?;
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

/// Eight rows of three: matrices of gyros and accelerometers, then their biases.
fn reading(rows: ArrayView2<'_, f64>) -> Reading {
    let row = |k: usize| three(rows.row(k), 0).transpose();
    Reading {
        gyro: Matrix3::from_rows(&[row(0), row(1), row(2)]),
        accelerometer: Matrix3::from_rows(&[row(3), row(4), row(5)]),
        gyro_bias: three(rows.row(6), 0),
        accelerometer_bias: three(rows.row(7), 0),
    }
}

/// Time since the first increment's start, Earth-fixed position and velocity.
fn epoch(row: ArrayView1<'_, f64>) -> Epoch {
    let place = WGS84.geodetic(three(row, 1));
    Epoch {
        time: row[0],
        place,
        velocity: to_earth(place).inverse() * three(row, 4),
    }
}

/// What fits measured velocities: epochs (K, 7) and readings (C, 8, 3) in; rows (C, 14) out of yaw,
/// pitch, roll at the last epoch, scatter in m/s, scale, and the nine numbers of the information.
#[pyfunction]
fn inertial_fit<'py>(
    py: Python<'py>,
    rotation: PyReadonlyArray2<'py, f64>,
    velocity: PyReadonlyArray2<'py, f64>,
    interval: PyReadonlyArray1<'py, f64>,
    epochs: PyReadonlyArray2<'py, f64>,
    readings: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let increments = increments(
        rotation.as_array(),
        velocity.as_array(),
        interval.as_array(),
    )?;
    let (epochs, readings) = (epochs.as_array(), readings.as_array());
    wide(epochs.ncols(), 7, "columns of epochs")?;
    wide(readings.len_of(Axis(1)), 8, "rows of a reading")?;
    wide(readings.len_of(Axis(2)), 3, "columns of a reading")?;
    let epochs: Vec<Epoch> = epochs.rows().into_iter().map(epoch).collect();
    let readings: Vec<Reading> = readings.outer_iter().map(reading).collect();
    let fits = py.detach(|| alignment::fit_all(&increments, &epochs, &readings));
    let mut rows = Array2::zeros((fits.len(), 14));
    for (mut row, fit) in rows.rows_mut().into_iter().zip(&fits) {
        let (roll, pitch, yaw) = fit.attitude.euler_angles();
        let first = [yaw, pitch, roll, fit.scatter, fit.scale];
        let values = first.iter().chain(fit.information.iter());
        row.iter_mut()
            .zip(values)
            .for_each(|(to, from)| *to = *from);
    }
    Ok(rows.into_pyarray(py))
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
    m.add_function(wrap_pyfunction!(inertial_fit, m)?)?;
    m.add_function(wrap_pyfunction!(normal_gravity, m)?)
}
