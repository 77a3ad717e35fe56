//! Orbits, geodesy, the atmosphere and positions: arrays in, arrays out.

use numpy::ndarray::{Array1, Array2};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sdr_spoof_core::nav_math::geodesy::{azimuth_elevation as look, enu, Ellipsoid, Geodetic};
use sdr_spoof_core::nav_math::geodesy::{CGCS2000, WGS84};
use sdr_spoof_core::nav_math::hatch;
use sdr_spoof_core::nav_math::ionosphere::{Ionosphere, Ray};
use sdr_spoof_core::nav_math::orbit::{Orbit, COLUMNS};
use sdr_spoof_core::nav_math::troposphere;

use crate::to_py;

type Vector3 = nalgebra::Vector3<f64>;
type Rows<'py> = Bound<'py, PyArray2<f64>>;
type Values<'py> = Bound<'py, PyArray1<f64>>;

/// Reads a table of ephemerides.
pub(crate) fn orbits(table: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Orbit>> {
    table
        .as_slice()?
        .chunks_exact(COLUMNS)
        .map(|row| Orbit::from_row(row).map_err(to_py))
        .collect()
}

fn rows3(flat: Vec<f64>) -> Array2<f64> {
    Array2::from_shape_vec((flat.len() / 3, 3), flat).expect("three values a row")
}

fn vectors(rows: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Vector3>> {
    if rows.as_array().ncols() != 3 {
        return Err(PyValueError::new_err("coordinates must have three columns"));
    }
    Ok(rows
        .as_slice()?
        .chunks_exact(3)
        .map(Vector3::from_column_slice)
        .collect())
}

fn ellipsoid(name: &str) -> PyResult<Ellipsoid> {
    match name {
        "WGS-84" => Ok(WGS84),
        "CGCS2000" => Ok(CGCS2000),
        _ => Err(PyValueError::new_err(format!("unknown ellipsoid '{name}'"))),
    }
}

/// Position, velocity, clock and drift by rows of the table at instants of system time.
#[pyfunction]
#[allow(clippy::type_complexity)]
fn satellite_states<'py>(
    py: Python<'py>,
    table: PyReadonlyArray2<'py, f64>,
    row: PyReadonlyArray1<'py, i64>,
    time_s: PyReadonlyArray1<'py, f64>,
) -> PyResult<(Rows<'py>, Rows<'py>, Values<'py>, Values<'py>)> {
    let (orbits, row, time_s) = (orbits(&table)?, row.as_slice()?, time_s.as_slice()?);
    let known = |r: &i64| (0..orbits.len() as i64).contains(r);
    if row.len() != time_s.len() || !row.iter().all(known) {
        return Err(PyValueError::new_err(
            "rows, times and table do not fit together",
        ));
    }
    let states: Vec<_> = py.detach(|| {
        row.iter()
            .zip(time_s)
            .map(|(r, t)| orbits[*r as usize].state(*t))
            .collect()
    });
    let gather = |of: fn(&sdr_spoof_core::nav_math::orbit::SatelliteState) -> Vector3| {
        rows3(
            states
                .iter()
                .flat_map(|s| <[f64; 3]>::from(of(s)))
                .collect(),
        )
        .into_pyarray(py)
    };
    let clock: Array1<f64> = states.iter().map(|s| s.clock_s).collect();
    let drift: Array1<f64> = states.iter().map(|s| s.clock_drift).collect();
    Ok((
        gather(|s| s.position),
        gather(|s| s.velocity),
        clock.into_pyarray(py),
        drift.into_pyarray(py),
    ))
}

/// Earth-fixed (N, 3) to latitude, longitude (rad) and height (N, 3).
#[pyfunction]
fn geodetic<'py>(
    py: Python<'py>,
    ecef_m: PyReadonlyArray2<'py, f64>,
    ellipsoid_name: &str,
) -> PyResult<Rows<'py>> {
    let (points, shape) = (vectors(&ecef_m)?, ellipsoid(ellipsoid_name)?);
    let flat = points.into_iter().flat_map(|p| {
        let place = shape.geodetic(p);
        [place.latitude, place.longitude, place.height]
    });
    Ok(rows3(flat.collect()).into_pyarray(py))
}

fn places(rows: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Geodetic>> {
    let place = |v: Vector3| Geodetic {
        latitude: v.x,
        longitude: v.y,
        height: v.z,
    };
    Ok(vectors(rows)?.into_iter().map(place).collect())
}

/// The opposite of [`geodetic`].
#[pyfunction]
fn ecef<'py>(
    py: Python<'py>,
    place: PyReadonlyArray2<'py, f64>,
    ellipsoid_name: &str,
) -> PyResult<Rows<'py>> {
    let shape = ellipsoid(ellipsoid_name)?;
    let flat = places(&place)?
        .into_iter()
        .flat_map(|p| <[f64; 3]>::from(shape.ecef(p)));
    Ok(rows3(flat.collect()).into_pyarray(py))
}

/// Azimuth and elevation (N, 2) in rad of targets seen from receivers, both Earth-fixed (N, 3).
#[pyfunction]
fn azimuth_elevation<'py>(
    py: Python<'py>,
    receiver_m: PyReadonlyArray2<'py, f64>,
    target_m: PyReadonlyArray2<'py, f64>,
) -> PyResult<Rows<'py>> {
    let (from, to) = (vectors(&receiver_m)?, vectors(&target_m)?);
    if from.len() != to.len() {
        return Err(PyValueError::new_err(
            "receivers and targets differ in number",
        ));
    }
    let flat: Vec<f64> = from
        .into_iter()
        .zip(to)
        .flat_map(|(r, t)| <[f64; 2]>::from(look(&enu(WGS84.geodetic(r)), t - r)))
        .collect();
    Ok(Array2::from_shape_vec((flat.len() / 2, 2), flat)
        .expect("two values a row")
        .into_pyarray(py))
}

/// N rays: receiver's latitude, longitude, height (N, 3), then azimuth and elevation (N, 2).
fn rays(place: &PyReadonlyArray2<'_, f64>, look: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Ray>> {
    let (places, looks) = (places(place)?, look.as_slice()?);
    if looks.len() != 2 * places.len() {
        return Err(PyValueError::new_err(
            "places and directions differ in number",
        ));
    }
    let ray = |(place, look): (Geodetic, &[f64])| Ray {
        place,
        azimuth: look[0],
        elevation: look[1],
    };
    Ok(places
        .into_iter()
        .zip(looks.chunks_exact(2))
        .map(ray)
        .collect())
}

/// Ionospheric delay of N rays, m.
#[pyfunction]
fn ionosphere_m<'py>(
    py: Python<'py>,
    model: &str,
    parameters: Vec<f64>,
    place: PyReadonlyArray2<'py, f64>,
    direction: PyReadonlyArray2<'py, f64>,
    gpst_s: PyReadonlyArray1<'py, f64>,
    carrier_hz: f64,
) -> PyResult<Values<'py>> {
    let model = Ionosphere::new(model, &parameters).map_err(to_py)?;
    let (rays, times) = (rays(&place, &direction)?, gpst_s.as_slice()?);
    let pairs = rays.iter().zip(times);
    let delays: Array1<f64> = pairs
        .map(|(r, t)| model.delay_m(r, *t, carrier_hz))
        .collect();
    Ok(delays.into_pyarray(py))
}

/// Tropospheric delay of N rays, m.
#[pyfunction]
fn troposphere_m<'py>(
    py: Python<'py>,
    place: PyReadonlyArray2<'py, f64>,
    direction: PyReadonlyArray2<'py, f64>,
    gpst_s: PyReadonlyArray1<'py, f64>,
) -> PyResult<Values<'py>> {
    let (rays, times) = (rays(&place, &direction)?, gpst_s.as_slice()?);
    let delays: Array1<f64> = rays
        .iter()
        .zip(times)
        .map(|(r, t)| troposphere::delay_m(r, *t))
        .collect();
    Ok(delays.into_pyarray(py))
}

/// Code of one signal smoothed by its carrier, m.
#[pyfunction]
fn smooth_code<'py>(
    py: Python<'py>,
    range_m: PyReadonlyArray1<'py, f64>,
    carrier_m: PyReadonlyArray1<'py, f64>,
    broken: PyReadonlyArray1<'py, bool>,
    epochs: usize,
) -> PyResult<Values<'py>> {
    let mut range = range_m.as_slice()?.to_vec();
    hatch::smooth(
        &mut range,
        carrier_m.as_slice()?,
        broken.as_slice()?,
        epochs,
    );
    Ok(range.into_pyarray(py))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(satellite_states, m)?)?;
    m.add_function(wrap_pyfunction!(geodetic, m)?)?;
    m.add_function(wrap_pyfunction!(ecef, m)?)?;
    m.add_function(wrap_pyfunction!(azimuth_elevation, m)?)?;
    m.add_function(wrap_pyfunction!(ionosphere_m, m)?)?;
    m.add_function(wrap_pyfunction!(troposphere_m, m)?)?;
    m.add_function(wrap_pyfunction!(smooth_code, m)?)
}
