//! Tracking on simulated correlator outputs.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use sdr_spoof_core::correlator_level::{Gap, Setting, Simulator as CoreSimulator};
use sdr_spoof_core::synth;

use crate::synth::{drive, filter, Emitter, GainControl, Knots};
use crate::to_py;
use crate::track::{all_breaks, all_combo_rows, all_signal_rows, config, BreakTuple};

/// Tracks satellites whose correlator outputs are made up from their emitters.
#[pyclass(module = "sdr_spoof._core")]
struct Simulator(CoreSimulator);

#[pymethods]
impl Simulator {
    #[new]
    #[pyo3(signature = (sample_rate_hz, lo_hz, config_values, emitters, targets, *, noise_power,
        seed=0, complex_samples=true, bandwidth_hz=None, centre_hz=None, filter_taps=63,
        reacquire=true, threads=1, gaps=Vec::new(), noise_db=Vec::new(), gain=None))]
    #[allow(clippy::too_many_arguments)] // keyword arguments in Python
    fn new(
        sample_rate_hz: f64,
        lo_hz: f64,
        config_values: &Bound<'_, PyDict>,
        emitters: Vec<PyRef<'_, Emitter>>,
        targets: Vec<(String, u16)>,
        noise_power: f64,
        seed: u64,
        complex_samples: bool,
        bandwidth_hz: Option<f64>,
        centre_hz: Option<f64>,
        filter_taps: usize,
        reacquire: bool,
        threads: usize,
        gaps: Vec<(f64, f64)>,
        noise_db: Knots,
        gain: Option<PyRef<'_, GainControl>>,
    ) -> PyResult<Self> {
        let band = (bandwidth_hz, centre_hz.unwrap_or(lo_hz) - lo_hz);
        let setting = Setting {
            sample_rate_hz,
            lo_hz,
            filter: filter(sample_rate_hz, band, filter_taps, complex_samples)?,
            noise_power,
            seed,
            gaps: gaps.into_iter().map(gap).collect(),
            drive: drive(noise_db, gain)?,
        };
        let config = config(config_values)?;
        let emitters: Vec<synth::Emitter> = emitters.iter().map(|e| e.0.clone()).collect();
        CoreSimulator::new(&setting, &config, &emitters, &targets, reacquire, threads)
            .map(Simulator)
            .map_err(to_py)
    }

    /// Runs to the last whole step before sample `end`.
    fn advance(&mut self, py: Python<'_>, end: u64) {
        py.detach(|| self.0.advance(end));
    }

    /// Samples that have been simulated.
    fn position(&self) -> u64 {
        self.0.position()
    }

    /// Marks a signal as captured: its pair is parted, both go on by themselves.
    fn isolate(&mut self, system: char, prn: u16, signal: &str) -> PyResult<()> {
        self.0.isolate(system, prn, signal).map_err(to_py)
    }

    /// Takes such marks of a satellite away.
    fn rejoin(&mut self, system: char, prn: u16) -> PyResult<()> {
        self.0.rejoin(system, prn).map_err(to_py)
    }

    /// Rows recorded since the last call: one dict per signal.
    fn take_signals<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        all_signal_rows(py, self.0.channels_mut())
    }

    /// Where counts of code periods broke since the last call: (signal, prn, from, until), s.
    fn take_breaks(&mut self) -> Vec<BreakTuple> {
        all_breaks(self.0.channels_mut())
    }

    /// Rows recorded since the last call: one dict per satellite with two sidebands.
    fn take_combos<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        all_combo_rows(py, self.0.channels_mut())
    }
}

fn gap((at_s, missing_s): (f64, f64)) -> Gap {
    Gap { at_s, missing_s }
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Simulator>()
}
