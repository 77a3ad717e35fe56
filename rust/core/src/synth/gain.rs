//! Automatic gain control: what the quantiser's input is multiplied by.
//!
//! The control follows the mean power at the quantiser's input, which is known beforehand: that of
//! the noise and of all that is on the air, behind the filter. So the gain is a function of time
//! alone, and any piece of the recording can be made without those before it. What a real detector
//! would add is the noise of its measurement: 10 000 samples in 1 ms leave 0.04 dB, of which a time
//! constant of 0.1 s leaves 0.003.
//!
//! With g the gain and p the input power, both in dB against the noise alone,
//! `dg/dt = (-p - g) / time constant`, within the range: a first-order law in dB, as of a detector
//! with a logarithmic scale before an integrator and an amplifier whose control is linear in dB.

use std::sync::Arc;

use rayon::prelude::*;

use super::emitter::Emitter;
use super::filter::Filter;
use super::profile::Profile;
use super::SynthConfig;
use crate::signal::spectrum::spectrum;
use crate::signal::SignalSpec;
use crate::{Error, Result};

/// Most steps of a recording: ten hours at 1 ms.
const MOST_STEPS: f64 = 36e6;
/// Step of the integral over a spectrum, and how far it goes, in rates of the fastest sub-chips.
const STEP_HZ: f64 = 50e3;
const LOBES: f64 = 8.0;
/// 2-bit samples begin a byte at multiples of this.
const WHOLE_BYTES: i64 = 4;

/// What reaches the quantiser beside the signals, and how it is amplified.
#[derive(Debug, Clone, Default)]
pub struct Drive {
    /// Noise over its nominal density, dB.
    pub noise_db: Profile,
    /// Gain; none is a fixed one.
    pub gain: Option<Arc<GainControl>>,
}

impl Drive {
    /// Noise power at a time over the nominal one.
    pub(crate) fn noise_power(&self, time_s: f64) -> f64 {
        10f64.powf(0.1 * self.noise_db.value(time_s))
    }

    /// Whether the noise has its nominal density all the time.
    pub(super) fn noise_is_steady(&self) -> bool {
        self.noise_db == Profile::default()
    }
}

/// How a gain follows the power.
#[derive(Debug, Clone, Copy)]
pub struct GainSettings {
    /// In which a step of the power is followed to 1 - 1/e, in dB.
    pub time_constant_s: f64,
    /// The gain is set so often, and constant in between.
    pub update_s: f64,
    /// Least and largest gain, dB; at 0 dB the noise alone has its nominal level.
    pub range_db: [f64; 2],
    /// Length of the recording; the last gain holds beyond.
    pub duration_s: f64,
}

/// The gain over a recording.
#[derive(Debug)]
pub struct GainControl {
    sample_rate_hz: f64,
    /// Samples between two settings of the gain.
    step: i64,
    input_db: Vec<f64>,
    gain_db: Vec<f64>,
}

impl GainControl {
    /// The gain for `emitters`, and noise of the level `noise_db`. It has settled at sample 0.
    ///
    /// # Errors
    /// [`Error::Invalid`] for settings out of range.
    pub fn new(
        config: &SynthConfig,
        settings: GainSettings,
        emitters: &[Emitter],
        noise_db: &Profile,
    ) -> Result<Self> {
        check(&settings)?;
        let step = steps(settings.update_s * config.sample_rate_hz);
        let step_s = step as f64 / config.sample_rate_hz;
        let count = (settings.duration_s / step_s).ceil() + 1.0;
        if count > MOST_STEPS {
            return Err(Error::Invalid(format!(
                "the gain is set {count:.0} times; the limit is {MOST_STEPS:.0}: set it less often"
            )));
        }
        let drive = Drive {
            noise_db: noise_db.clone(),
            gain: None,
        };
        let powers = Powers::new(config, emitters);
        let middle = |k: usize| (k as f64 + 0.5) * step_s;
        let input_db: Vec<f64> = (0..count as usize)
            .into_par_iter()
            .map(|k| decibels(drive.noise_power(middle(k)) + powers.at(middle(k))))
            .collect();
        let [low, high] = settings.range_db;
        let share = -(-step_s / settings.time_constant_s).exp_m1();
        let mut gain = (-input_db[0]).clamp(low, high);
        let followed = |&input: &f64| {
            let now = gain;
            gain = (gain + share * (-input - gain)).clamp(low, high);
            now
        };
        let gain_db = input_db.iter().map(followed).collect();
        Ok(GainControl {
            sample_rate_hz: config.sample_rate_hz,
            step,
            input_db,
            gain_db,
        })
    }

    /// Gain at a time, as a ratio of amplitudes.
    pub fn ratio(&self, time_s: f64) -> f64 {
        amplitude(self.gain_db(time_s))
    }

    /// Gain at a time, dB.
    pub fn gain_db(&self, time_s: f64) -> f64 {
        self.gain_db[self.index(time_s)]
    }

    /// Power at the input over that of the nominal noise, dB.
    pub fn input_db(&self, time_s: f64) -> f64 {
        self.input_db[self.index(time_s)]
    }

    /// Gain of a sample as a ratio of amplitudes, and for how many samples from it on.
    pub(super) fn at_sample(&self, sample: i64) -> (f64, usize) {
        let (step, within) = (sample.div_euclid(self.step), sample.rem_euclid(self.step));
        let index = (step.max(0) as usize).min(self.gain_db.len() - 1);
        (
            amplitude(self.gain_db[index]),
            (self.step - within) as usize,
        )
    }

    fn index(&self, time_s: f64) -> usize {
        let step = time_s * self.sample_rate_hz / self.step as f64;
        // A time that is a multiple of the step is in the step that begins there.
        ((step + 1e-9).max(0.0) as usize).min(self.gain_db.len() - 1)
    }
}

fn amplitude(gain_db: f64) -> f64 {
    10f64.powf(gain_db / 20.0)
}

fn decibels(power: f64) -> f64 {
    10.0 * power.log10()
}

/// Whole bytes of samples next to a number of them.
fn steps(samples: f64) -> i64 {
    ((samples / WHOLE_BYTES as f64).round() as i64).max(1) * WHOLE_BYTES
}

fn check(settings: &GainSettings) -> Result<()> {
    let positive = |x: f64| x.is_finite() && x > 0.0;
    let GainSettings {
        time_constant_s,
        update_s,
        range_db: [low, high],
        duration_s,
    } = *settings;
    if !(positive(time_constant_s) && positive(update_s) && positive(duration_s)) {
        return Err(Error::Invalid(format!(
            "gain control: time constant {time_constant_s} s, update {update_s} s and duration \
             {duration_s} s must be positive"
        )));
    }
    if !(low.is_finite() && high.is_finite() && low <= high) {
        return Err(Error::Invalid(format!(
            "gain control: the range {low} to {high} dB must ascend"
        )));
    }
    Ok(())
}

/// Powers of emitters behind the filter, over that of the nominal noise there.
struct Powers {
    steady: f64,
    /// With the power of 1 Hz of C/N0.
    varying: Vec<(Emitter, f64)>,
}

impl Powers {
    fn new(config: &SynthConfig, emitters: &[Emitter]) -> Self {
        let band_hz = if config.format.is_complex() {
            config.sample_rate_hz
        } else {
            0.5 * config.sample_rate_hz
        };
        let mut known: Vec<(&'static str, f64)> = Vec::new();
        let mut share = |signal: &'static SignalSpec| {
            if let Some(found) = known.iter().find(|k| k.0 == signal.id) {
                return found.1;
            }
            let share = config.filter.as_ref().map_or(1.0, |filter| {
                passed(filter, signal, config.lo_hz, config.sample_rate_hz)
            });
            known.push((signal.id, share / band_hz));
            share / band_hz
        };
        let all = emitters.iter().map(|e| (e.clone(), share(e.signal)));
        let (steady, varying): (Vec<_>, Vec<_>) = all.partition(|(e, _)| is_steady(e));
        Powers {
            steady: steady.iter().map(|e| power(e, 0.0)).sum(),
            varying,
        }
    }

    fn at(&self, time_s: f64) -> f64 {
        self.steady + self.varying.iter().map(|e| power(e, time_s)).sum::<f64>()
    }
}

fn is_steady(e: &Emitter) -> bool {
    let for_ever = e.start_s == f64::NEG_INFINITY && e.end_s == f64::INFINITY;
    for_ever && e.power_db == Profile::default()
}

fn power((emitter, share): &(Emitter, f64), time_s: f64) -> f64 {
    share * 10f64.powf(0.1 * emitter.cn0_at_dbhz(time_s))
}

/// Share of a signal's power that a filter lets pass, over its share of white noise.
fn passed(filter: &Filter, signal: &SignalSpec, lo_hz: f64, sample_rate_hz: f64) -> f64 {
    let layers = signal.modulation.layers();
    let fastest = layers.iter().map(|l| l.subchips).max().unwrap_or(1) as f64;
    let reach = (LOBES * fastest * signal.chip_rate_hz / STEP_HZ).ceil() as i64;
    let at = |i: i64| {
        let beside_hz = i as f64 * STEP_HZ;
        let gain = filter.gain((signal.carrier_hz - lo_hz + beside_hz) / sample_rate_hz);
        let density = spectrum(layers, signal.chip_rate_hz, beside_hz);
        [density * gain * gain, density]
    };
    let sums = (-reach..=reach)
        .map(at)
        .fold([0.0; 2], |s, d| [s[0] + d[0], s[1] + d[1]]);
    sums[0] / sums[1] / filter.noise_gain().powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::SampleFormat;
    use crate::signal;

    fn config(filter: Option<Filter>) -> SynthConfig {
        SynthConfig {
            sample_rate_hz: 10e6,
            lo_hz: 1_561.098e6,
            format: SampleFormat::parse("ci8").unwrap(),
            noise_rms_lsb: 16.0,
            noise: true,
            seed: 1,
            filter,
            threads: 1,
        }
    }

    fn settings() -> GainSettings {
        GainSettings {
            time_constant_s: 0.05,
            update_s: 1e-3,
            range_db: [-40.0, 20.0],
            duration_s: 1.0,
        }
    }

    #[test]
    fn a_step_is_followed_by_the_first_order_law() {
        let rise = Profile::new(vec![(0.3, 0.0), (0.3, 10.0)]).unwrap();
        let gain = GainControl::new(&config(None), settings(), &[], &rise).unwrap();
        assert_eq!(gain.gain_db(0.2), 0.0);
        for t in [0.31f64, 0.35, 0.4, 0.6] {
            let expected = -10.0 * (1.0 - (-(t - 0.3) / 0.05).exp());
            assert!((gain.gain_db(t) - expected).abs() < 1e-6, "{t}");
            assert!((gain.input_db(t) - 10.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_range_ends_it() {
        let fall = Profile::new(vec![(0.0, -60.0), (0.5, -60.0), (0.5, 60.0)]).unwrap();
        let gain = GainControl::new(&config(None), settings(), &[], &fall).unwrap();
        assert_eq!(gain.gain_db(0.1), 20.0);
        assert_eq!(gain.gain_db(0.99), -40.0);
    }

    #[test]
    fn powers_of_emitters_count_as_they_come_through_the_filter() {
        let b1i = signal::find("B1I").unwrap();
        // C/N0 of the whole noise: 70 dB-Hz in 10 MHz.
        let mut e = Emitter::new(b1i, 20, 70.0);
        let of =
            |filter, e: &Emitter| Powers::new(&config(filter), std::slice::from_ref(e)).at(0.5);
        assert!((of(None, &e) - 1.0).abs() < 1e-12);
        // Half of the band has nearly all of the signal, and half of the noise.
        let half = Filter::new(0.0, 0.5, 63, true).unwrap();
        assert!((of(Some(half), &e) - 1.9).abs() < 0.06);
        e.start_s = 0.6;
        assert_eq!(of(None, &e), 0.0);
    }

    #[test]
    fn settings_out_of_range_are_refused() {
        let refused =
            |settings| GainControl::new(&config(None), settings, &[], &Profile::default()).is_err();
        let good = settings();
        assert!(refused(GainSettings {
            time_constant_s: 0.0,
            ..good
        }));
        assert!(refused(GainSettings {
            range_db: [1.0, 0.0],
            ..good
        }));
        assert!(refused(GainSettings {
            update_s: 1e-9,
            duration_s: 1e9,
            ..good
        }));
    }
}
