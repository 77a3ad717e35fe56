//! The correlator engine without loops, for measuring its speed.

use std::sync::Arc;
use std::thread;

use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sdr_spoof_core::dsp::correlator::Correlator;
use sdr_spoof_core::dsp::engine::Engine;
use sdr_spoof_core::dsp::front_end::Stream;
use sdr_spoof_core::dsp::replica::Replica;
use sdr_spoof_core::sample::SampleFormat;
use sdr_spoof_core::signal::{self, Modulation, SignalSpec};
use sdr_spoof_core::simd::Level;
use sdr_spoof_core::Result;

use crate::to_py;

/// (signal, prn, modulation, companion, Doppler in Hz, first sample)
type ChannelTuple = (String, u16, String, bool, f64, f64);

/// What a recording's samples are.
struct Input {
    stream: Stream,
    sample_rate_hz: f64,
    lo_hz: f64,
}

/// One engine per thread, with channels of its own.
#[pyclass(module = "sdr_spoof._core")]
struct EngineBench(Vec<Engine>);

#[pymethods]
impl EngineBench {
    /// `threads` lists the channels of each thread; `bands` are the carriers (Hz) that every
    /// thread mixes, besides those of its channels.
    #[new]
    #[pyo3(signature = (sample_format, sample_rate_hz, lo_hz, threads, taps, *, bands=vec![]))]
    fn new(
        sample_format: &str,
        sample_rate_hz: f64,
        lo_hz: f64,
        threads: Vec<Vec<ChannelTuple>>,
        taps: Vec<i64>,
        bands: Vec<f64>,
    ) -> PyResult<Self> {
        let input = Input {
            stream: Stream {
                format: SampleFormat::parse(sample_format).map_err(to_py)?,
                conjugate: false,
                float_scale: 1.0,
                start: 0,
            },
            sample_rate_hz,
            lo_hz,
        };
        let engines = threads
            .iter()
            .map(|channels| engine(&input, channels, &taps, bands.clone()));
        let engines = engines.collect::<Result<Vec<_>>>().map_err(to_py)?;
        Ok(EngineBench(engines))
    }

    /// Feeds the same samples `times` times to every thread; gives the slices (1 ms of a channel)
    /// that were correlated.
    fn feed(
        &mut self,
        py: Python<'_>,
        raw: PyReadonlyArray1<'_, u8>,
        times: usize,
    ) -> PyResult<u64> {
        let bytes = raw.as_slice()?;
        py.detach(|| feed_all(&mut self.0, bytes, times))
            .ok_or_else(|| PyValueError::new_err("a thread of the benchmark has failed"))
    }
}

/// Runs every engine in a thread of its own; nothing if one of them panics.
fn feed_all(engines: &mut [Engine], bytes: &[u8], times: usize) -> Option<u64> {
    thread::scope(|scope| {
        let threads: Vec<_> = engines
            .iter_mut()
            .map(|engine| scope.spawn(move || feed(engine, bytes, times)))
            .collect();
        threads.into_iter().map(|t| t.join().ok()).sum()
    })
}

fn feed(engine: &mut Engine, bytes: &[u8], times: usize) -> u64 {
    let mut slices = 0;
    for _ in 0..times {
        engine.feed(bytes, |_, _, _| slices += 1);
    }
    slices
}

fn engine(
    input: &Input,
    channels: &[ChannelTuple],
    taps: &[i64],
    mut carriers_hz: Vec<f64>,
) -> Result<Engine> {
    let mut placed = Vec::new();
    for channel in channels {
        let spec = signal::find(&channel.0)?;
        let known = carriers_hz.iter().position(|&c| c == spec.carrier_hz);
        placed.push((known.unwrap_or(carriers_hz.len()), spec, channel));
        if known.is_none() {
            carriers_hz.push(spec.carrier_hz);
        }
    }
    let frequencies: Vec<f64> = carriers_hz
        .iter()
        .map(|carrier| (carrier - input.lo_hz) / input.sample_rate_hz)
        .collect();
    let reach = taps.iter().map(|t| t.unsigned_abs() as usize).max();
    let reach = reach.unwrap_or(0);
    let mut engine = Engine::new(input.stream, &frequencies, reach, Level::best());
    for (band, spec, channel) in placed {
        engine.attach(band, correlator(input, spec, channel, taps, reach)?);
    }
    Ok(engine)
}

fn correlator(
    input: &Input,
    spec: &SignalSpec,
    (_, prn, modulation, companion, doppler_hz, start): &ChannelTuple,
    taps: &[i64],
    reach: usize,
) -> Result<Correlator> {
    let mut replica = Replica::new(spec, *prn, Modulation::parse(modulation)?)?;
    if let Some(data) = spec.companion().filter(|_| *companion) {
        replica = replica.with_companion(spec, data, *prn)?;
    }
    // No tap lies before the first sample.
    let mut channel = Correlator::new(Arc::new(replica), taps, 0, start + reach as f64);
    let chip_rate_hz = spec.chip_rate_hz * (1.0 + doppler_hz / spec.carrier_hz);
    let rate = input.sample_rate_hz;
    channel.set_rates(doppler_hz / rate, rate / chip_rate_hz);
    Ok(channel)
}

/// Name of the vector instructions in use; the environment variable `SDR_SPOOF_SIMD` sets less
/// than the best.
#[pyfunction]
fn simd_level() -> &'static str {
    Level::best().name()
}

/// Names of those that this processor has, lowest first.
#[pyfunction]
fn simd_levels() -> Vec<&'static str> {
    Level::available().into_iter().map(Level::name).collect()
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<EngineBench>()?;
    m.add_function(wrap_pyfunction!(simd_level, m)?)?;
    m.add_function(wrap_pyfunction!(simd_levels, m)?)
}
