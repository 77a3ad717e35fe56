//! IF synthesis.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::{signal, synth};

use crate::to_py;

pub(crate) type Knots = Vec<(f64, f64)>;

/// A range through knots: cubic Hermite, shared by the emitters that take it.
#[pyclass(frozen, module = "sdr_spoof._core")]
struct Spline(Arc<synth::Spline>);

#[pymethods]
impl Spline {
    #[new]
    fn new(
        time_s: PyReadonlyArray1<'_, f64>,
        value: PyReadonlyArray1<'_, f64>,
        rate: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let (t, x, v) = (time_s.as_array(), value.as_array(), rate.as_array());
        if t.len() != x.len() || t.len() != v.len() {
            let text = "a spline needs as many values and rates as times";
            return Err(PyValueError::new_err(text));
        }
        let knots = t.iter().zip(x).zip(v).map(|((&t, &x), &v)| (t, x, v));
        let spline = synth::Spline::new(knots.collect()).map_err(to_py)?;
        Ok(Spline(Arc::new(spline)))
    }

    /// Values at times in seconds.
    fn value<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        map(py, &time_s, |t| self.0.value(t))
    }

    /// Rates of change at times in seconds.
    fn rate<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        map(py, &time_s, |t| self.0.rate(t))
    }
}

/// A signal component of one transmitter; a spoofer is more emitters.
#[pyclass(frozen, module = "sdr_spoof._core")]
pub(crate) struct Emitter(pub(crate) synth::Emitter);

#[pymethods]
impl Emitter {
    #[new]
    #[pyo3(signature = (signal, prn, cn0_dbhz, *, range_m=None, delay_s=0.0, phase_cycles=0.0, doppler_hz=0.0,
        doppler_rate_hz_s=0.0, data_seed=None, symbols=None, first_symbol=0, data_delay_s=0.0, data_error_rate=0.0, power_db=vec![],
        code_offset_m=vec![], carrier_offset_hz=vec![], start_s=f64::NEG_INFINITY, end_s=f64::INFINITY))]
    #[allow(clippy::too_many_arguments)] // keyword arguments in Python
    fn new(
        signal: &str,
        prn: u16,
        cn0_dbhz: f64,
        range_m: Option<PyRef<'_, Spline>>,
        delay_s: f64,
        phase_cycles: f64,
        doppler_hz: f64,
        doppler_rate_hz_s: f64,
        data_seed: Option<u64>,
        symbols: Option<PyReadonlyArray1<'_, i8>>,
        first_symbol: i64,
        data_delay_s: f64,
        data_error_rate: f64,
        power_db: Knots,
        code_offset_m: Knots,
        carrier_offset_hz: Knots,
        start_s: f64,
        end_s: f64,
    ) -> PyResult<Self> {
        let profile = |knots| synth::Profile::new(knots).map_err(to_py);
        Ok(Emitter(synth::Emitter {
            range_m: range_m.map(|r| r.0.clone()),
            delay_s,
            phase_cycles,
            doppler_hz,
            doppler_rate_hz_s,
            data: data(data_seed, symbols.as_ref(), first_symbol)?,
            data_delay_s,
            data_error_rate,
            power_db: profile(power_db)?,
            code_offset_m: profile(code_offset_m)?,
            carrier_offset_hz: profile(carrier_offset_hz)?,
            start_s,
            end_s,
            ..synth::Emitter::new(signal::find(signal).map_err(to_py)?, prn, cn0_dbhz)
        }))
    }

    /// Registry name of the signal.
    #[getter]
    fn signal(&self) -> &'static str {
        self.0.signal.id
    }

    /// Satellite (or in whose name).
    #[getter]
    fn prn(&self) -> u16 {
        self.0.prn
    }

    /// Total received code phase in chips at times in seconds.
    fn code_phase_chips<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        map(py, &time_s, |t| self.0.code_phase_chips(t))
    }

    /// Received carrier phase over the nominal carrier; grows when approaching.
    fn received_phase_cycles<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        map(py, &time_s, |t| self.0.received_phase_cycles(t))
    }

    /// Doppler of the carrier, positive when approaching.
    fn doppler_hz<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        map(py, &time_s, |t| self.0.carrier_doppler_hz(t))
    }

    /// C/N0 with the power profile; minus infinity when off the air.
    fn cn0_dbhz<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        map(py, &time_s, |t| self.0.cn0_at_dbhz(t))
    }

    /// Delay of the data symbols against the code, as sent: a whole number of chips.
    #[getter]
    fn data_delay_s(&self) -> f64 {
        self.0.data_delay_chips() as f64 / self.0.signal.chip_rate_hz
    }

    /// Data symbols (+1 or -1) of these indices.
    fn data_symbols<'py>(
        &self,
        py: Python<'py>,
        index: PyReadonlyArray1<'py, i64>,
    ) -> Bound<'py, PyArray1<i8>> {
        let symbols: Vec<i8> = index
            .as_array()
            .iter()
            .map(|&i| self.0.data_symbol(i))
            .collect();
        symbols.into_pyarray(py)
    }
}

/// Data symbols of a seed or given ones.
fn data(
    seed: Option<u64>,
    symbols: Option<&PyReadonlyArray1<'_, i8>>,
    first_index: i64,
) -> PyResult<synth::Data> {
    match (seed, symbols) {
        (Some(_), Some(_)) => Err(PyValueError::new_err(
            "data_seed and symbols say the same; give one of them",
        )),
        (Some(seed), None) => Ok(synth::Data::Seeded(seed)),
        (None, None) => Ok(synth::Data::None),
        (None, Some(symbols)) => Ok(synth::Data::Given {
            first_index,
            symbols: symbols.as_array().iter().copied().collect(),
        }),
    }
}

fn map<'py>(
    py: Python<'py>,
    time_s: &PyReadonlyArray1<'py, f64>,
    f: impl Fn(f64) -> f64,
) -> Bound<'py, PyArray1<f64>> {
    let values: Vec<f64> = time_s.as_array().iter().map(|&t| f(t)).collect();
    values.into_pyarray(py)
}

/// The gain of an automatic gain control over a recording.
#[pyclass(frozen, module = "sdr_spoof._core")]
pub(crate) struct GainControl(Arc<synth::GainControl>);

#[pymethods]
impl GainControl {
    #[new]
    #[pyo3(signature = (sample_format, sample_rate_hz, lo_hz, emitters, *, duration_s,
        time_constant_s, update_s, range_db, noise_db=vec![], bandwidth_hz=None, centre_hz=None,
        filter_taps=63))]
    #[allow(clippy::too_many_arguments)] // keyword arguments in Python
    fn new(
        sample_format: &str,
        sample_rate_hz: f64,
        lo_hz: f64,
        emitters: Vec<PyRef<'_, Emitter>>,
        duration_s: f64,
        time_constant_s: f64,
        update_s: f64,
        range_db: (f64, f64),
        noise_db: Knots,
        bandwidth_hz: Option<f64>,
        centre_hz: Option<f64>,
        filter_taps: usize,
    ) -> PyResult<Self> {
        let format = SampleFormat::parse(sample_format).map_err(to_py)?;
        let band = (bandwidth_hz, centre_hz.unwrap_or(lo_hz) - lo_hz);
        let config = synth::SynthConfig {
            sample_rate_hz,
            lo_hz,
            format,
            noise_rms_lsb: 1.0,
            noise: true,
            seed: 0,
            filter: filter(sample_rate_hz, band, filter_taps, format.is_complex())?,
            threads: 0,
        };
        let settings = synth::GainSettings {
            time_constant_s,
            update_s,
            range_db: range_db.into(),
            duration_s,
        };
        let emitters: Vec<synth::Emitter> = emitters.iter().map(|e| e.0.clone()).collect();
        let noise = synth::Profile::new(noise_db).map_err(to_py)?;
        let gain = synth::GainControl::new(&config, settings, &emitters, &noise).map_err(to_py)?;
        Ok(GainControl(Arc::new(gain)))
    }

    /// Gain at times in seconds, dB; at 0 dB the noise alone has its nominal level.
    fn gain_db<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        map(py, &time_s, |t| self.0.gain_db(t))
    }

    /// Power at the quantiser's input over that of the nominal noise, dB.
    fn input_db<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        map(py, &time_s, |t| self.0.input_db(t))
    }
}

/// Level of the noise, and gain.
pub(crate) fn drive(
    noise_db: Knots,
    gain: Option<PyRef<'_, GainControl>>,
) -> PyResult<synth::Drive> {
    Ok(synth::Drive {
        noise_db: synth::Profile::new(noise_db).map_err(to_py)?,
        gain: gain.map(|g| g.0.clone()),
    })
}

/// Generates the samples of a recording, as a pure function of the sample index.
#[pyclass(frozen, module = "sdr_spoof._core")]
struct Synthesizer(synth::Synthesizer);

#[pymethods]
impl Synthesizer {
    #[new]
    #[pyo3(signature = (sample_format, sample_rate_hz, lo_hz, emitters, *, noise_rms_lsb,
        noise=true, seed=0, bandwidth_hz=None, centre_hz=None, filter_taps=63, noise_db=vec![],
        gain=None, threads=0))]
    #[allow(clippy::too_many_arguments)] // keyword arguments in Python
    fn new(
        sample_format: &str,
        sample_rate_hz: f64,
        lo_hz: f64,
        emitters: Vec<PyRef<'_, Emitter>>,
        noise_rms_lsb: f64,
        noise: bool,
        seed: u64,
        bandwidth_hz: Option<f64>,
        centre_hz: Option<f64>,
        filter_taps: usize,
        noise_db: Knots,
        gain: Option<PyRef<'_, GainControl>>,
        threads: usize,
    ) -> PyResult<Self> {
        let format = SampleFormat::parse(sample_format).map_err(to_py)?;
        let band = (bandwidth_hz, centre_hz.unwrap_or(lo_hz) - lo_hz);
        let filter = filter(sample_rate_hz, band, filter_taps, format.is_complex())?;
        let config = synth::SynthConfig {
            sample_rate_hz,
            lo_hz,
            format,
            noise_rms_lsb,
            noise,
            seed,
            filter,
            threads,
        };
        let emitters = emitters.iter().map(|e| e.0.clone()).collect();
        let drive = drive(noise_db, gain)?;
        synth::Synthesizer::new(config, emitters)
            .map(|s| Synthesizer(s.driven(drive)))
            .map_err(to_py)
    }

    /// Raw bytes of the samples `start_sample..start_sample + count`.
    fn generate<'py>(
        &self,
        py: Python<'py>,
        start_sample: u64,
        count: usize,
    ) -> PyResult<Bound<'py, PyArray1<u8>>> {
        let bytes = py
            .detach(|| self.0.generate(start_sample, count))
            .map_err(to_py)?;
        Ok(bytes.into_pyarray(py))
    }
}

/// The front-end filter of a bandwidth, if there is one, and a centre in the recording.
pub(crate) fn filter(
    sample_rate_hz: f64,
    (bandwidth_hz, centre_hz): (Option<f64>, f64),
    taps: usize,
    complex_samples: bool,
) -> PyResult<Option<synth::Filter>> {
    let relative = |hz: f64| hz / sample_rate_hz;
    bandwidth_hz
        .map(|b| synth::Filter::new(relative(centre_hz), relative(b), taps, complex_samples))
        .transpose()
        .map_err(to_py)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Spline>()?;
    m.add_class::<Emitter>()?;
    m.add_class::<GainControl>()?;
    m.add_class::<Synthesizer>()?;
    Ok(())
}
