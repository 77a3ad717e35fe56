//! Tightly coupled filter: arrays and settings in, columns of every run out.

use nalgebra::{UnitQuaternion, Vector3};
use numpy::ndarray::Array;
use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sdr_spoof_core::inertial::tight::guard::Rules;
use sdr_spoof_core::inertial::tight::output::Output;
use sdr_spoof_core::inertial::tight::run::{navigate, ImuLog, Measured, Run, Sky};
use sdr_spoof_core::inertial::tight::settings::{
    Form, ImuNoise, Mode, Published, ReceiverNoise, Settings, StartSigma, Testing,
};
use sdr_spoof_core::inertial::tight::smooth::Smoothed;
use sdr_spoof_core::inertial::NavState;
use sdr_spoof_core::nav_math::geodesy::{Geodetic, WGS84};

use crate::to_py;

fn get<'py, T: FromPyObject<'py>>(values: &Bound<'py, PyDict>, key: &str) -> PyResult<T> {
    values.as_any().get_item(key)?.extract()
}

fn mode(name: &str) -> PyResult<Mode> {
    match name {
        "off" => Ok(Mode::Off),
        "printed" => Ok(Mode::Printed),
        "robust" => Ok(Mode::Robust),
        _ => Err(PyValueError::new_err(format!("no exclusion '{name}'"))),
    }
}

fn form(name: &str) -> PyResult<Form> {
    match name {
        "mean-square" => Ok(Form::MeanSquare),
        "lag-1" => Ok(Form::Lag1),
        "coherent" => Ok(Form::Coherent),
        _ => Err(PyValueError::new_err(format!("no form '{name}' of R"))),
    }
}

fn settings(v: &Bound<'_, PyDict>, lever_arm: [f64; 3]) -> PyResult<Settings> {
    let [gyro, accelerometer, gyro_walk, accelerometer_walk]: [f64; 4] = get(v, "imu")?;
    let [code, wander, wander_time, rate, change, reference_cn0, clock, drift]: [f64; 8] =
        get(v, "receiver")?;
    let s: [f64; 8] = get(v, "start")?;
    Ok(Settings {
        imu: ImuNoise {
            gyro,
            accelerometer,
            gyro_walk,
            accelerometer_walk,
        },
        receiver: ReceiverNoise {
            code,
            wander,
            wander_time,
            rate,
            change,
            reference_cn0,
            clock,
            drift,
        },
        start: StartSigma {
            position: s[0],
            velocity: s[1],
            level: s[2],
            heading: s[3],
            gyro_bias: s[4],
            accelerometer_bias: s[5],
            clock: s[6],
            drift: s[7],
        },
        published: Published {
            length: get(v, "length")?,
            form: form(&get::<String>(v, "form")?)?,
            divisors: get(v, "divisors")?,
        },
        mode: mode(&get::<String>(v, "exclusion")?)?,
        testing: Testing {
            thresholds: get(v, "thresholds")?,
            power_rise: get(v, "power_rise_db")?,
            robust: get(v, "robust")?,
            slack: get(v, "slack")?,
            most_excluded: get(v, "most_excluded")?,
            heed_receiver: get(v, "heed_receiver")?,
        },
        lever_arm: Vector3::from(lever_arm),
        outages: get(v, "outages")?,
        bridge: get(v, "bridge_s")?,
        smooth: get(v, "smooth")?,
        subsets: get(v, "subsets")?,
    })
}

fn rules(v: &Bound<'_, PyDict>) -> PyResult<Rules> {
    Ok(Rules {
        settle: get(v, "settle_s")?,
        pardon: get(v, "pardon_s")?,
        dwell: get(v, "dwell_s")?,
        dwell_after_step: get(v, "dwell_after_step_s")?,
        dwell_satellite: get(v, "dwell_satellite_s")?,
        ..Rules::default()
    })
}

/// Place and velocity Earth-fixed, yaw, pitch, roll.
fn state(row: &[f64]) -> NavState {
    let position = Vector3::new(row[0], row[1], row[2]);
    let place: Geodetic = WGS84.geodetic(position);
    let local =
        sdr_spoof_core::nav_math::geodesy::enu(place) * Vector3::new(row[3], row[4], row[5]);
    NavState {
        place,
        velocity: Vector3::new(local.y, local.x, -local.z),
        attitude: UnitQuaternion::from_euler_angles(row[8], row[7], row[6]),
    }
}

fn triples(values: &[f64]) -> PyResult<&[[f64; 3]]> {
    let (rows, rest) = values.as_chunks::<3>();
    match rest {
        [] => Ok(rows),
        _ => Err(PyValueError::new_err("vectors must have three components")),
    }
}

/// Navigates runs: ``starts`` (R, 9), measurements (R, E, S), the rest shared; a dict a run.
#[pyfunction]
#[pyo3(signature = (imu_time, interval, rotation, velocity, time, system, place, place_velocity,
                    cn0, spoofed, range_m, rate_m_s, change_m, starts, start_time, lever_arm,
                    settings_values, *, errors=None, detailed=true, threads=1))]
#[allow(clippy::too_many_arguments)]
fn navigate_tight<'py>(
    py: Python<'py>,
    imu_time: PyReadonlyArray1<'py, f64>,
    interval: f64,
    rotation: PyReadonlyArray2<'py, f64>,
    velocity: PyReadonlyArray2<'py, f64>,
    time: PyReadonlyArray1<'py, f64>,
    system: Vec<usize>,
    place: PyReadonlyArray3<'py, f64>,
    place_velocity: PyReadonlyArray3<'py, f64>,
    cn0: PyReadonlyArray2<'py, f64>,
    spoofed: PyReadonlyArray2<'py, bool>,
    range_m: PyReadonlyArray3<'py, f64>,
    rate_m_s: PyReadonlyArray3<'py, f64>,
    change_m: PyReadonlyArray3<'py, f64>,
    starts: PyReadonlyArray2<'py, f64>,
    start_time: f64,
    lever_arm: [f64; 3],
    settings_values: &Bound<'py, PyDict>,
    errors: Option<Vec<Bound<'py, PyAny>>>,
    detailed: bool,
    threads: usize,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let (settings, rules) = (
        settings(settings_values, lever_arm)?,
        rules(settings_values)?,
    );
    let log = ImuLog {
        time: imu_time.as_slice()?,
        interval,
        rotation: triples(rotation.as_slice()?)?,
        velocity: triples(velocity.as_slice()?)?,
    };
    let sky = Sky {
        time: time.as_slice()?,
        system: &system,
        place: triples(place.as_slice()?)?,
        velocity: triples(place_velocity.as_slice()?)?,
        cn0: cn0.as_slice()?,
        spoofed: spoofed.as_slice()?,
    };
    let cells = sky.cn0.len();
    let all = [
        range_m.as_slice()?,
        rate_m_s.as_slice()?,
        change_m.as_slice()?,
    ];
    let starts = starts.as_slice()?;
    let count = starts.len() / 9;
    if all.iter().any(|a| a.len() != count * cells)
        || errors.as_ref().is_some_and(|e| e.len() != count)
    {
        return Err(PyValueError::new_err(
            "runs, starts and errors differ in number",
        ));
    }
    let mut runs = Vec::with_capacity(count);
    for r in 0..count {
        let of = |k: usize| &all[k][r * cells..(r + 1) * cells];
        let errors = errors
            .as_ref()
            .map(|e| crate::imu::errors(&e[r]))
            .transpose()?;
        runs.push(Run {
            start: state(&starts[9 * r..9 * r + 9]),
            errors,
            measured: Measured {
                range: of(0),
                rate: of(1),
                change: of(2),
            },
        });
    }
    let made = py
        .detach(|| {
            navigate(
                log, sky, &runs, start_time, &settings, rules, detailed, threads,
            )
        })
        .map_err(to_py)?;
    let satellites = system.len();
    made.into_iter()
        .map(|one| to_dict(py, one, satellites))
        .collect()
}

fn to_dict(py: Python<'_>, made: Output, satellites: usize) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    let (e, t) = (made.valid.len(), made.tests);
    let s = made.usage.len() / e.max(1);
    debug_assert!(s == 0 || s == satellites);
    macro_rules! put {
        ($name:literal, $values:expr, $shape:expr) => {{
            let flat: Vec<_> = $values;
            let array = Array::from_shape_vec($shape, flat).expect("a row an epoch");
            dict.set_item($name, array.into_pyarray(py))?;
        }};
    }
    put!("position_m", earth_fixed(&made.place), (e, 3));
    put!("velocity_ned", made.velocity.into_flattened(), (e, 3));
    put!("attitude_rad", made.attitude.into_flattened(), (e, 3));
    put!("covariance", made.covariance.into_flattened(), (e, 3, 3, 3));
    put!("clock", made.clock.into_flattened(), (e, 2));
    put!("bias", made.bias.into_flattened(), (e, 6));
    put!("range", made.range.into_flattened(), (e, s, 2));
    put!("rate", made.rate.into_flattened(), (e, s, 2));
    put!("usage", made.usage, (e, s));
    put!(
        "solution_statistic",
        made.solution.into_flattened().into_flattened(),
        (e, 2, 3)
    );
    put!(
        "channel_statistic",
        made.channel.into_flattened().into_flattened(),
        (e, s, 2, 3)
    );
    let asked = made.apart.len() / satellites.max(1);
    put!("apart", made.apart.into_flattened(), (asked, satellites, 4));
    put!("threat", made.threat.iter().map(|t| t.0).collect(), e);
    put!("severity", made.threat.iter().map(|t| t.1).collect(), e);
    put!("deviates", made.deviates, (e, t));
    put!("state", made.state, e);
    put!("valid", made.valid, e);
    let events: Vec<_> = made
        .events
        .iter()
        .map(|v| {
            (
                v.time,
                v.state as u8,
                v.test,
                v.deviate,
                v.excluded,
                v.back,
                v.apart,
            )
        })
        .collect();
    dict.set_item("events", events)?;
    let smoothed = made.smoothed.map(|s| smoothed_dict(py, s)).transpose()?;
    dict.set_item("smoothed", smoothed)?;
    Ok(dict)
}

fn smoothed_dict(py: Python<'_>, made: Smoothed) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    let e = made.place.len();
    let rows = |flat: Vec<f64>| Array::from_shape_vec((e, 3), flat).expect("a row an epoch");
    let position = rows(earth_fixed(&made.place));
    dict.set_item("position_m", position.into_pyarray(py))?;
    let velocity = rows(made.velocity.into_flattened());
    dict.set_item("velocity_ned", velocity.into_pyarray(py))?;
    let attitude = rows(made.attitude.into_flattened());
    dict.set_item("attitude_rad", attitude.into_pyarray(py))?;
    let covariance = Array::from_shape_vec((e, 3, 3, 3), made.covariance.into_flattened());
    let covariance = covariance.expect("a row an epoch");
    dict.set_item("covariance", covariance.into_pyarray(py))?;
    Ok(dict)
}

/// Latitude, longitude, height as coordinates in m, one after another.
fn earth_fixed(places: &[[f64; 3]]) -> Vec<f64> {
    let position = |p: &[f64; 3]| {
        let place = Geodetic {
            latitude: p[0],
            longitude: p[1],
            height: p[2],
        };
        <[f64; 3]>::from(WGS84.ecef(place))
    };
    places.iter().flat_map(position).collect()
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(navigate_tight, m)?)
}
