//! Thin Python bindings: convert, release the GIL, map errors. No algorithm lives here.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

mod acquire;
mod bench;
mod decision;
mod fec;
mod fixes;
mod imu;
mod inertial;
mod navigation;
mod signals;
mod simulate;
mod subframes;
mod synth;
mod tight;
mod track;

/// Core errors become ValueError; Python wraps them where it can say more.
fn to_py(error: sdr_spoof_core::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

#[pymodule]
fn _core(m: &Bound<'_, PyModule>) -> PyResult<()> {
    signals::register(m)?;
    synth::register(m)?;
    acquire::register(m)?;
    track::register(m)?;
    simulate::register(m)?;
    bench::register(m)?;
    fec::register(m)?;
    subframes::register(m)?;
    navigation::register(m)?;
    fixes::register(m)?;
    imu::register(m)?;
    inertial::register(m)?;
    tight::register(m)?;
    decision::register(m)?;
    // Load numpy's C interface here, where an error can be raised: loaded on first use, it would
    // panic when Ctrl-C comes in between.
    m.py().import("numpy")?;
    numpy::PyArray1::<u8>::zeros(m.py(), 0, false);
    Ok(())
}
