//! Stands in for a sideband's correlator: slices without samples.

use super::emission::{Arrival, Emission, Span};
use super::lags::CodeLags;
use super::noise::{key, TapNoise};
use super::others::{disturbance, plus, Disturbance, OtherCodes};
use super::pulse::Pulse;
use super::{missing_s, FrontEnd, Gap, Setting};
use crate::acquire::replica::search_rate_hz;
use crate::dsp::clock::Clock;
use crate::dsp::correlator::Slice;
use crate::dsp::replica::SLICE_S;
use crate::nco::CYCLE;
use crate::signal::{Layer, Modulation, SignalSpec};
use crate::synth::random::hash;
use crate::synth::{Drive, Emitter};
use crate::track::epoch::Seed;
use crate::track::taps::Taps;
use crate::{Result, C64};

/// An emitter's code is near within this, chips: that and the noise tap's delay are within the
/// lags that are known.
const REACH: f64 = 8.0;

/// Where a tap is.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Delay of the replica.
    chips: f64,
    /// It hears the main subcarrier layer only.
    outer: bool,
}

/// One code and its emitters, as one replica hears them.
struct Heard {
    lags: CodeLags,
    emissions: Vec<Emission>,
}

/// A correlator that makes up its slices.
pub(crate) struct Simulated {
    clock: Clock,
    sample_rate_hz: f64,
    /// Amplitude per sample of a C/N0 of 1 Hz, and noise power per sample.
    amplitude: f64,
    noise_power: f64,
    spec: &'static SignalSpec,
    search_key: u64,
    gaps: Vec<Gap>,
    /// Carrier in the recording's band.
    intermediate_hz: f64,
    chips_per_slice: u64,
    slices: usize,
    index: usize,
    taps: Vec<Place>,
    latest: u64,
    main: Heard,
    inner: Pulse,
    outer: Pulse,
    companion: Option<(Heard, Pulse)>,
    others: OtherCodes,
    /// Noise power of the signal's own code far off, at 1 Hz of C/N0.
    own_noise_share: Disturbance,
    noise: TapNoise,
    drive: Drive,
    slice: Slice,
}

/// The main subcarrier layer alone, at unit power.
fn main_layer(modulation: Modulation) -> [Layer; 1] {
    let subchips = modulation.layers()[0].subchips;
    [Layer {
        subchips,
        re: 1.0,
        im: 0.0,
    }]
}

impl Heard {
    fn new(spec: &SignalSpec, prn: u16, emitters: &[Emitter]) -> Result<Self> {
        let of = |e: &&Emitter| e.signal.id == spec.id && e.prn == prn;
        let emissions = emitters.iter().filter(of).cloned().map(Emission::new);
        Ok(Heard {
            lags: CodeLags::new(&spec.code(prn)?, chips_per_slice(spec)),
            emissions: emissions.collect::<Result<_>>()?,
        })
    }
}

fn chips_per_slice(spec: &SignalSpec) -> usize {
    (spec.chip_rate_hz * SLICE_S).round() as usize
}

impl Simulated {
    /// The correlator of a satellite's signal; `companion` whether that of the data component
    /// beside it is wanted too.
    pub fn new(
        setting: &Setting,
        spec: &'static SignalSpec,
        prn: u16,
        (modulation, taps): (Modulation, &Taps),
        companion: bool,
        emitters: &[Emitter],
    ) -> Result<Self> {
        let samples_per_chip = setting.sample_rate_hz / spec.chip_rate_hz;
        let front = FrontEnd::new(setting, spec.carrier_hz, samples_per_chip);
        let main = Heard::new(spec, prn, emitters)?;
        let beside = spec.companion().filter(|_| companion);
        let companion = beside.map(|data| {
            let pulse = Pulse::new(data.modulation.layers(), data.modulation.layers());
            Ok((Heard::new(data, prn, emitters)?, front.signal(pulse)))
        });
        let marked = taps.offsets.iter().zip(taps.outer());
        let place = |(&offset, outer): (&i64, bool)| Place {
            chips: offset as f64 / samples_per_chip,
            outer,
        };
        let places: Vec<Place> = marked.map(place).collect();
        let covariance = covariance(&front, modulation, &places, &main.lags);
        let outer_layer = main_layer(modulation);
        let replicas = [modulation.layers(), &outer_layer];
        let heard = |layers| front.signal(Pulse::new(layers, spec.modulation.layers()));
        Ok(Simulated {
            clock: Clock::new(0.0),
            sample_rate_hz: setting.sample_rate_hz,
            amplitude: (setting.noise_power / setting.sample_rate_hz).sqrt(),
            noise_power: setting.noise_power,
            spec,
            search_key: !key(setting.seed, spec.system, prn, spec.id),
            gaps: setting.gaps.clone(),
            intermediate_hz: spec.carrier_hz - setting.lo_hz,
            chips_per_slice: chips_per_slice(spec) as u64,
            slices: spec.code_length / chips_per_slice(spec),
            index: 0,
            latest: taps.offsets.iter().copied().max().unwrap_or(0).max(0) as u64,
            others: OtherCodes::new(&front, spec, prn, replicas, emitters),
            own_noise_share: disturbance(&front, spec, replicas, spec),
            inner: heard(modulation.layers()),
            outer: heard(&outer_layer),
            noise: TapNoise::new(
                key(setting.seed, spec.system, prn, spec.id),
                places.iter().map(|p| p.outer).collect(),
                &covariance,
            ),
            slice: Slice {
                taps: vec![C64::default(); places.len()],
                ..Slice::default()
            },
            taps: places,
            drive: setting.drive.clone(),
            main,
            companion: companion.transpose()?,
        })
    }

    /// Starts afresh at the start of a code period, at `start` samples.
    pub fn start_at(&mut self, start: f64) {
        self.clock = Clock::new(start);
        self.index = 0;
    }

    /// The next slice, if it ends before sample `end` at every tap.
    pub fn advance(&mut self, end: u64) -> Option<&Slice> {
        let chips = self.chips_per_slice;
        let mut after = self.clock.clone();
        let samples = after.pass(chips);
        if after.base() + self.latest > end {
            return None;
        }
        let span = self.span(&after);
        let length = chips as f64 * self.clock.samples_per_chip();
        let slice = &mut self.slice;
        (slice.index, slice.start, slice.samples) = (self.index, self.clock.base(), samples);
        slice.taps.fill(C64::default());
        slice.companion = C64::default();
        let other_codes = self.others.noise(span.time_s[0]);
        let other_codes = self.hear_main(&span, length, other_codes);
        self.hear_companion(&span, length);
        let slice = &mut self.slice;
        let thermal = self.drive.noise_power(span.time_s[0]);
        let [inner, outer] = other_codes.map(|o| thermal + o);
        let power = self.noise_power * length * inner;
        let companion = self.noise.add(power, outer / inner, &mut slice.taps);
        if self.companion.is_some() {
            slice.companion += companion;
        }
        if let Some(gain) = &self.drive.gain {
            let gain = gain.ratio(span.time_s[0]);
            slice.taps.iter_mut().for_each(|tap| *tap *= gain);
            slice.companion *= gain;
        }
        self.clock = after;
        self.index = (self.index + 1) % self.slices;
        Some(&self.slice)
    }

    /// From the present clock to that after the slice, in the time of the transmissions. A gap takes
    /// effect with the first slice that begins after it.
    fn span(&self, after: &Clock) -> Span {
        let start_s = self.clock.start() / self.sample_rate_hz;
        let missing_s = missing_s(&self.gaps, start_s);
        let time_s = |clock: &Clock| clock.start() / self.sample_rate_hz + missing_s;
        let turned = self.intermediate_hz * missing_s + self.spec.phase_offset_cycles;
        let carrier = |clock: &Clock| clock.carrier_at_start() - turned;
        let chips = self.chips_per_slice as f64;
        Span {
            time_s: [time_s(&self.clock), time_s(after)],
            chips: [self.index as f64 * chips, chips],
            carrier_cycles: [carrier(&self.clock), carrier(after)],
        }
    }

    /// Adds the power of what is as good as another code to that of other codes.
    fn hear_main(&mut self, span: &Span, length: f64, mut other_codes: Disturbance) -> Disturbance {
        let lags = |lag| self.main.lags.slice(self.index, lag);
        for emission in &mut self.main.emissions {
            let arrival = match emission.arrival(span, REACH) {
                Arrival::Silent => continue,
                Arrival::Far(power_hz) => {
                    other_codes = plus(other_codes, self.own_noise_share, power_hz);
                    continue;
                }
                Arrival::Near(near) => near,
            };
            let phasor = arrival.phasor * (self.amplitude * length);
            for (tap, place) in self.slice.taps.iter_mut().zip(&self.taps) {
                let pulse = if place.outer {
                    &self.outer
                } else {
                    &self.inner
                };
                *tap += phasor * pulse.train(arrival.delay_chips + place.chips, lags);
            }
        }
        other_codes
    }

    fn hear_companion(&mut self, span: &Span, length: f64) {
        let Some((heard, pulse)) = &mut self.companion else {
            return;
        };
        let lags = |lag| heard.lags.slice(self.index, lag);
        for emission in &mut heard.emissions {
            if let Arrival::Near(arrival) = emission.arrival(span, REACH) {
                let correlation = pulse.train(arrival.delay_chips, lags);
                self.slice.companion += arrival.phasor * (self.amplitude * length) * correlation;
            }
        }
    }

    /// Where a search that begins at a sample finds the strongest of the emitters that reach a
    /// C/N0: somewhere within half a cell of delay and a quarter of one of Doppler. (The search
    /// reads both from between its cells; at half a cell of 1/(2 ms) a frequency can no longer be
    /// told from its alias in 1 ms integrations.)
    pub fn search(&self, sample: u64, cn0_min_dbhz: f64) -> Option<Seed> {
        let time_s = sample as f64 / self.sample_rate_hz;
        let time_s = time_s + missing_s(&self.gaps, time_s);
        let truths = self.main.emissions.iter().map(|e| e.truth(time_s));
        let strongest = truths.max_by(|a, b| a.cn0_dbhz.total_cmp(&b.cn0_dbhz))?;
        if strongest.cn0_dbhz < cn0_min_dbhz {
            return None;
        }
        // Uniform within +-1/2.
        let error = |n: u64| hash(hash(self.search_key, sample), n) as f64 / CYCLE - 0.5;
        let period_s = self.spec.period_s();
        let delay_s = -strongest.code_phase_chips / self.spec.chip_rate_hz
            + error(0) / search_rate_hz(self.spec);
        Some(Seed {
            sample,
            doppler_hz: strongest.doppler_hz + error(1) * 0.25 / period_s,
            code_delay_s: delay_s.rem_euclid(period_s),
        })
    }

    pub fn chips_per_slice(&self) -> u64 {
        self.chips_per_slice
    }

    pub fn slices_per_period(&self) -> usize {
        self.slices
    }

    pub fn set_rates(&mut self, carrier: f64, samples_per_chip: f64) {
        self.clock.set_rates(carrier, samples_per_chip);
    }

    pub fn shift_carrier(&mut self, cycles: f64) {
        self.clock.shift_carrier(cycles);
    }

    pub fn shift_code(&mut self, samples: f64) {
        self.clock.shift_code(samples);
    }

    pub fn carrier_cycles(&self) -> f64 {
        self.clock.carrier_cycles()
    }

    pub fn samples_per_chip(&self) -> f64 {
        self.clock.samples_per_chip()
    }

    pub fn fraction(&self) -> f64 {
        self.clock.fraction()
    }

    pub fn base(&self) -> u64 {
        self.clock.base()
    }
}

/// Covariance of the taps' noise, row by row, for unit noise power and one sample.
fn covariance(
    front: &FrontEnd,
    modulation: Modulation,
    taps: &[Place],
    lags: &CodeLags,
) -> Vec<C64> {
    let layer = main_layer(modulation);
    let layers = [modulation.layers(), &layer];
    let pulse = |a: usize, b: usize| front.noise(Pulse::new(layers[a], layers[b]));
    let pulses = [[pulse(0, 0), pulse(0, 1)], [pulse(1, 0), pulse(1, 1)]];
    let pair = |a: &Place, b: &Place| {
        let pulse = &pulses[usize::from(a.outer)][usize::from(b.outer)];
        pulse.train(a.chips - b.chips, |lag| lags.whole(lag))
    };
    taps.iter()
        .flat_map(|a| taps.iter().map(move |b| (a, b)))
        .map(|(a, b)| pair(a, b))
        .collect()
}
