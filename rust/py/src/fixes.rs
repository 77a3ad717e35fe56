//! Positions of all epochs of a recording: settings and arrays in, columns out.

use numpy::ndarray::{Array1, Array2, Array3};
use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sdr_spoof_core::nav_math::batch::{Batch, Column, Epochs, Filter};
use sdr_spoof_core::nav_math::ekf::EkfSettings;
use sdr_spoof_core::nav_math::fix::Fix;
use sdr_spoof_core::nav_math::ionosphere::Ionosphere;
use sdr_spoof_core::nav_math::least_squares::Failure;
use sdr_spoof_core::nav_math::measurement::Settings;
use sdr_spoof_core::nav_math::search::Search;
use sdr_spoof_core::nav_math::snapshot::{CodePhase, Problem};

use crate::navigation::orbits;
use crate::to_py;

fn get<'py, T: FromPyObject<'py>>(values: &Bound<'py, PyDict>, key: &str) -> PyResult<T> {
    values.as_any().get_item(key)?.extract()
}

/// Reads what all epochs share from a dict.
pub(crate) fn settings(values: &Bound<'_, PyDict>) -> PyResult<Settings> {
    let models: Vec<(String, Vec<f64>)> = get(values, "ionosphere")?;
    let ionosphere: Result<_, _> = models.iter().map(|(n, p)| Ionosphere::new(n, p)).collect();
    Ok(Settings {
        elevation_mask: get(values, "elevation_mask")?,
        zenith_sigma_m: get(values, "zenith_sigma_m")?,
        ionosphere: ionosphere.map_err(to_py)?,
        troposphere: get(values, "troposphere")?,
        max_pdop: get(values, "max_pdop")?,
        thresholds: get(values, "thresholds")?,
        exclusions: get(values, "exclusions")?,
    })
}

fn filter(values: Option<&Bound<'_, PyDict>>) -> PyResult<Filter> {
    let Some(values) = values else {
        return Ok(Filter::LeastSquares);
    };
    Ok(Filter::Ekf(EkfSettings {
        acceleration: get(values, "acceleration")?,
        clock: get(values, "clock")?,
        clock_drift: get(values, "clock_drift")?,
        bias: get(values, "bias")?,
        coast_s: get(values, "coast_s")?,
    }))
}

/// Solves all epochs; `columns` are (satellite, system, group, carrier_hz).
#[pyfunction]
#[pyo3(signature = (table, reference_s, columns, groups, systems, settings_values, time_s, orbit,
                    range_m, variance, rate_m_s, rate_variance, *, ekf=None, threads=1))]
#[allow(clippy::too_many_arguments)]
fn solve_fixes<'py>(
    py: Python<'py>,
    table: PyReadonlyArray2<'py, f64>,
    reference_s: f64,
    columns: Vec<(usize, usize, usize, f64)>,
    groups: Vec<(usize, usize)>,
    systems: usize,
    settings_values: &Bound<'py, PyDict>,
    time_s: PyReadonlyArray1<'py, f64>,
    orbit: PyReadonlyArray2<'py, i32>,
    range_m: PyReadonlyArray2<'py, f64>,
    variance: PyReadonlyArray2<'py, f64>,
    rate_m_s: PyReadonlyArray2<'py, f64>,
    rate_variance: PyReadonlyArray2<'py, f64>,
    ekf: Option<&Bound<'py, PyDict>>,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    if range_m.as_array().ncols() != columns.len() {
        return Err(PyValueError::new_err(
            "observations and signals differ in number",
        ));
    }
    let columns: Vec<Column> = columns
        .into_iter()
        .map(|(satellite, system, group, carrier_hz)| Column {
            satellite,
            system,
            group,
            carrier_hz,
        })
        .collect();
    let (orbits, settings, filter) = (orbits(&table)?, settings(settings_values)?, filter(ekf)?);
    let batch = Batch {
        orbits: &orbits,
        reference_s,
        columns: &columns,
        groups: &groups,
        systems,
        settings: &settings,
    };
    let epochs = Epochs {
        time_s: time_s.as_slice()?,
        orbit: orbit.as_slice()?,
        range_m: range_m.as_slice()?,
        variance: variance.as_slice()?,
        rate_m_s: rate_m_s.as_slice()?,
        rate_variance: rate_variance.as_slice()?,
    };
    let fixes = py
        .detach(|| batch.solve(epochs, &filter, threads))
        .map_err(to_py)?;
    to_dict(py, &fixes, columns.len(), systems, groups.len())
}

fn failure_code(failure: Option<Failure>) -> u8 {
    match failure {
        None => 0,
        Some(Failure::TooFew) => 1,
        Some(Failure::Geometry) => 2,
        Some(Failure::Divergence) => 3,
    }
}

fn table<T: Clone>(fixes: &[Fix], width: usize, row: impl Fn(&Fix) -> Vec<T>) -> Array2<T> {
    let flat: Vec<T> = fixes.iter().flat_map(row).collect();
    Array2::from_shape_vec((fixes.len(), width), flat).expect("rows of that width")
}

fn cube(fixes: &[Fix], of: impl Fn(&Fix) -> [f64; 9]) -> Array3<f64> {
    let flat: Vec<f64> = fixes.iter().flat_map(of).collect();
    Array3::from_shape_vec((fixes.len(), 3, 3), flat).expect("nine values each")
}

fn to_dict<'py>(
    py: Python<'py>,
    fixes: &[Fix],
    signals: usize,
    systems: usize,
    groups: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let codes = |of: fn(&Fix) -> u8| {
        fixes
            .iter()
            .map(of)
            .collect::<Array1<u8>>()
            .into_pyarray(py)
    };
    let values = |of: fn(&Fix) -> f64| {
        fixes
            .iter()
            .map(of)
            .collect::<Array1<f64>>()
            .into_pyarray(py)
    };
    dict.set_item("status", codes(|f| f.status as u8))?;
    dict.set_item("failure", codes(|f| failure_code(f.failure)))?;
    dict.set_item(
        "position_m",
        table(fixes, 3, |f| f.position.to_vec()).into_pyarray(py),
    )?;
    dict.set_item(
        "velocity_m_s",
        table(fixes, 3, |f| f.velocity.to_vec()).into_pyarray(py),
    )?;
    dict.set_item(
        "clock_m",
        table(fixes, systems, |f| f.clock_m.clone()).into_pyarray(py),
    )?;
    dict.set_item(
        "bias_m",
        table(fixes, groups, |f| f.bias_m.clone()).into_pyarray(py),
    )?;
    dict.set_item("drift_m_s", values(|f| f.drift_m_s))?;
    dict.set_item(
        "covariance_m2",
        cube(fixes, |f| f.covariance).into_pyarray(py),
    )?;
    dict.set_item(
        "velocity_covariance",
        cube(fixes, |f| f.velocity_covariance).into_pyarray(py),
    )?;
    let dop = |f: &Fix| vec![f.dop.gdop, f.dop.pdop, f.dop.hdop, f.dop.vdop, f.dop.tdop];
    dict.set_item("dop", table(fixes, 5, dop).into_pyarray(py))?;
    let usage = |f: &Fix| f.usage.iter().map(|u| *u as u8).collect();
    dict.set_item("usage", table::<u8>(fixes, signals, usage).into_pyarray(py))?;
    dict.set_item(
        "residual_m",
        table(fixes, signals, |f| f.residual_m.clone()).into_pyarray(py),
    )?;
    dict.set_item("square_sum", values(|f| f.square_sum))?;
    let freedom: Array1<i64> = fixes.iter().map(|f| f.freedom as i64).collect();
    dict.set_item("freedom", freedom.into_pyarray(py))?;
    Ok(dict)
}

/// (satellite, system, group, carrier_hz, row, range_m, period_m, variance)
type PhaseTuple = (usize, usize, usize, f64, usize, f64, f64, f64);

/// Place and time from code phases; None where there is none.
///
/// Gives status, place (3), time, covariance of both (4 x 4), residuals, square sum, freedom and the
/// satellite left out.
#[pyfunction]
#[pyo3(signature = (table, reference_s, phases, settings_values, place_m, time_s,
                    place_uncertainty_m, time_uncertainty_s))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
fn solve_snapshot<'py>(
    py: Python<'py>,
    table: PyReadonlyArray2<'py, f64>,
    reference_s: f64,
    phases: Vec<PhaseTuple>,
    settings_values: &Bound<'py, PyDict>,
    place_m: [f64; 3],
    time_s: f64,
    place_uncertainty_m: f64,
    time_uncertainty_s: f64,
) -> PyResult<
    Option<(
        u8,
        [f64; 3],
        f64,
        Vec<f64>,
        Vec<f64>,
        f64,
        usize,
        Option<usize>,
    )>,
> {
    let (orbits, settings) = (orbits(&table)?, settings(settings_values)?);
    if phases
        .iter()
        .any(|p| p.4 >= orbits.len() || p.1 >= settings.ionosphere.len())
    {
        return Err(PyValueError::new_err(
            "code phases and orbits do not fit together",
        ));
    }
    let phases: Vec<CodePhase> = phases.into_iter().map(code_phase).collect();
    let problem = Problem {
        orbits: &orbits,
        phases: &phases,
        settings: &settings,
    };
    let search = Search {
        place: place_m.into(),
        place_uncertainty_m,
        time_s,
        time_uncertainty_s,
        reference_s,
    };
    let found = py.detach(|| problem.solve(&search));
    Ok(found.map(|s| {
        let covariance = s.covariance.as_slice().to_vec();
        let place: [f64; 3] = s.position.into();
        (
            s.status as u8,
            place,
            s.time_s,
            covariance,
            s.residual_m,
            s.square_sum,
            s.freedom,
            s.excluded,
        )
    }))
}

fn code_phase(
    (satellite, system, group, carrier_hz, orbit, range_m, period_m, variance): PhaseTuple,
) -> CodePhase {
    let column = Column {
        satellite,
        system,
        group,
        carrier_hz,
    };
    CodePhase {
        column,
        orbit,
        range_m,
        period_m,
        variance,
    }
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(solve_fixes, m)?)?;
    m.add_function(wrap_pyfunction!(solve_snapshot, m)?)
}
