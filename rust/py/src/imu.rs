//! Perfect increments along a motion, and errors of an IMU: arrays and dataclasses in, increments out.

use nalgebra::{Matrix3, Vector3};
use numpy::ndarray::{Array2, ArrayView2};
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sdr_spoof_core::inertial::errors::{ErrorStream, ImuErrors, SensorErrors};
use sdr_spoof_core::inertial::ideal::{self, Knot};
use sdr_spoof_core::inertial::Increment;
use sdr_spoof_core::nav_math::geodesy::Geodetic;

/// Attributes of `aiding.imu.errors.SensorErrors`.
#[derive(FromPyObject)]
struct Sensor {
    bias: [f64; 3],
    wander: f64,
    wander_s: f64,
    density: f64,
    scale: [f64; 3],
    misalignment_rad: [f64; 6],
    limit: f64,
    quantum: f64,
}

impl From<Sensor> for SensorErrors {
    fn from(s: Sensor) -> Self {
        let ([x, y, z], [xy, xz, yx, yz, zx, zy]) = (s.scale, s.misalignment_rad);
        SensorErrors {
            bias: Vector3::from(s.bias),
            wander: s.wander,
            wander_time: s.wander_s,
            density: s.density,
            distortion: Matrix3::new(x, xy, xz, yx, y, yz, zx, zy, z),
            limit: s.limit,
            quantum: s.quantum,
        }
    }
}

#[derive(FromPyObject)]
struct Imu {
    gyro: Sensor,
    accelerometer: Sensor,
    seed: u64,
    run: u64,
}

/// Errors and number of the run of an `aiding.imu.errors.ImuErrors`.
pub(crate) fn errors(values: &Bound<'_, PyAny>) -> PyResult<(ImuErrors, u64)> {
    let imu: Imu = values.extract()?;
    let errors = ImuErrors {
        gyro: imu.gyro.into(),
        accelerometer: imu.accelerometer.into(),
        seed: imu.seed,
    };
    Ok((errors, imu.run))
}

fn row(values: &ArrayView2<'_, f64>, k: usize) -> Vector3<f64> {
    Vector3::new(values[(k, 0)], values[(k, 1)], values[(k, 2)])
}

type Columns<'py> = [Bound<'py, PyArray2<f64>>; 4];

/// Rotations and velocities (N, 3) as they are read, and the biases (N, 3) of both then; the first
/// is increment number `first` of the run.
#[pyfunction]
#[pyo3(signature = (rotation, velocity, interval, errors, *, first=0))]
fn imu_readings<'py>(
    py: Python<'py>,
    rotation: PyReadonlyArray2<'py, f64>,
    velocity: PyReadonlyArray2<'py, f64>,
    interval: f64,
    errors: &Bound<'py, PyAny>,
    first: usize,
) -> PyResult<Columns<'py>> {
    let (errors, run) = self::errors(errors)?;
    let (rotation, velocity) = (rotation.as_array(), velocity.as_array());
    let rows = rotation.nrows();
    if rotation.ncols() != 3 || velocity.dim() != (rows, 3) {
        return Err(PyValueError::new_err(
            "rotation and velocity must have the same shape (N, 3)",
        ));
    }
    let columns = py.detach(|| {
        let mut columns = [(); 4].map(|()| Array2::zeros((rows, 3)));
        let mut stream = ErrorStream::new(&errors, run);
        stream.skip(first, interval);
        for k in 0..rows {
            let mut increment = Increment {
                rotation: row(&rotation, k),
                velocity: row(&velocity, k),
                interval,
            };
            stream.apply(&mut increment);
            let [gyro, accelerometer] = stream.biases();
            let values = [increment.rotation, increment.velocity, gyro, accelerometer];
            for (column, value) in columns.iter_mut().zip(values) {
                (0..3).for_each(|axis| column[(k, axis)] = value[axis]);
            }
        }
        columns
    });
    Ok(columns.map(|c| c.into_pyarray(py)))
}

/// Perfect rotations and velocities (N, 3) of a motion through knots (K, 12) about a place: offsets
/// of latitude, longitude, height; yaw, pitch, roll; the rates of the six.
#[pyfunction]
fn imu_increments<'py>(
    py: Python<'py>,
    origin: [f64; 3],
    knots: PyReadonlyArray2<'py, f64>,
    step: f64,
    per: usize,
) -> PyResult<[Bound<'py, PyArray2<f64>>; 2]> {
    let rows = knots.as_slice()?;
    if knots.as_array().ncols() != 12 || per == 0 {
        return Err(PyValueError::new_err("knots must have the shape (K, 12)"));
    }
    let knots: Vec<Knot> = rows.as_chunks().0.to_vec();
    let [latitude, longitude, height] = origin;
    let origin = Geodetic {
        latitude,
        longitude,
        height,
    };
    let columns = py.detach(|| {
        let increments = ideal::increments(origin, &knots, step, per);
        [|i: &Increment| i.rotation, |i: &Increment| i.velocity].map(|of| {
            let values = increments.iter().flat_map(|i| <[f64; 3]>::from(of(i)));
            Array2::from_shape_vec((increments.len(), 3), values.collect())
        })
    });
    let [rotation, velocity] = columns;
    let array = |c: Result<Array2<f64>, _>| match c {
        Ok(c) => Ok(c.into_pyarray(py)),
        Err(e) => Err(PyValueError::new_err(format!("{e}"))),
    };
    Ok([array(rotation)?, array(velocity)?])
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(imu_increments, m)?)?;
    m.add_function(wrap_pyfunction!(imu_readings, m)?)
}
