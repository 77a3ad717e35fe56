//! One signal of one satellite: correlator, loops, synchronisation and lock as a state machine.
//!
//! ```text
//! PullIn --phase lock--> Tracking --symbol or secondary sync--> Synced
//!    ^                       |                                     |
//!    +---- restart ---- Lost <------------- loss of lock ----------+
//! ```

use super::config::TrackConfig;
use super::epoch::{Epoch, Seed};
use super::frequency::FrequencyBlock;
use super::log::{SignalRows, State};
use super::loop_filter::LoopFilter;
use super::period_count::{Break, PeriodCount};
use super::quality::{Cn0, Lock, RunningMean};
use super::source::{Feed, Source};
use super::sync::{SecondarySync, SymbolSync};
use super::taps::Taps;
use crate::dsp::replica::{Replica, SLICE_S};
use crate::signal::{Modulation, SignalSpec};
use crate::{Result, C64};

pub(super) enum Sync {
    Symbol(SymbolSync),
    Secondary(SecondarySync),
    Known,
}

/// One signal of one satellite.
pub struct Sideband {
    /// The signal.
    pub spec: &'static SignalSpec,
    /// Which of its front end's bands it is in.
    pub band: usize,
    /// How the replica's chips are shaped.
    pub modulation: Modulation,
    /// The taps.
    pub taps: Taps,
    /// Rows recorded so far.
    pub rows: SignalRows,
    /// Marked as captured by a spoofer.
    pub captured: bool,
    pub(super) config: TrackConfig,
    pub(super) sample_rate_hz: f64,
    pub(super) correlator: Source,
    pub(super) state: State,
    /// Known sign: pilot with its secondary code found.
    pub(super) signed: bool,
    overlay: Vec<i8>,
    /// Code periods per symbol; none for a pilot.
    symbol: Option<usize>,
    pub(super) sync: Sync,
    pub(super) count: PeriodCount,
    /// Where the count of code periods broke since they were taken out.
    pub breaks: Vec<Break>,
    /// Slice counter, meaningful modulo what is synchronised.
    pub(super) position: usize,
    chips: u64,
    pub(super) length: usize,
    partial: Option<Epoch>,
    pub(super) carrier: LoopFilter,
    pub(super) code: LoopFilter,
    doppler_hz: f64,
    pub(super) frequency: FrequencyBlock,
    /// The phase loop runs.
    pub(super) phase_loop: bool,
    pub(super) cn0: Cn0,
    pub(super) lock: Lock,
    pub(super) side_peaks: [RunningMean; 3],
    pub(super) in_state_s: f64,
    /// Since the last start.
    pub(super) pull_in_s: f64,
}

impl Sideband {
    /// A sideband that starts to pull in at the first code period that begins at or after
    /// `earliest` samples.
    ///
    /// # Errors
    /// [`crate::Error::UnknownPrn`]
    pub fn new(
        spec: &'static SignalSpec,
        prn: u16,
        sample_rate_hz: f64,
        config: &TrackConfig,
        seed: Seed,
        earliest: u64,
    ) -> Result<Self> {
        Self::with_source(spec, prn, sample_rate_hz, config, |modulation, taps| {
            let mut replica = Replica::new(spec, prn, modulation)?;
            if let Some(companion) = spec.companion().filter(|_| config.data_component) {
                replica = replica.with_companion(spec, companion, prn)?;
            }
            Ok(Source::samples(replica, taps))
        })
        .map(|mut sideband| {
            sideband.restart(seed, earliest);
            sideband
        })
    }

    /// A sideband whose slices come from what `source` makes for its modulation and taps; to be
    /// started by [`Sideband::restart`].
    pub(crate) fn with_source(
        spec: &'static SignalSpec,
        prn: u16,
        sample_rate_hz: f64,
        config: &TrackConfig,
        source: impl FnOnce(Modulation, &Taps) -> Result<Source>,
    ) -> Result<Self> {
        let modulation = match spec.modulation {
            Modulation::Qmboc if !config.qmboc => Modulation::Boc11,
            m => m,
        };
        let (overlay, symbol) = (spec.secondary(prn)?, spec.periods_per_symbol(prn)?);
        let samples_per_chip = sample_rate_hz / spec.chip_rate_hz;
        let taps = Taps::new(modulation, &spec.code(prn)?, samples_per_chip);
        Ok(Sideband {
            spec,
            band: 0,
            modulation,
            rows: SignalRows::default(),
            captured: false,
            config: config.clone(),
            sample_rate_hz,
            correlator: source(modulation, &taps)?,
            taps,
            state: State::PullIn,
            signed: false,
            count: PeriodCount::new(&overlay, symbol, spec.period_s()),
            breaks: Vec::new(),
            overlay,
            symbol,
            sync: Sync::Known,
            position: 0,
            chips: 0,
            length: 1,
            partial: None,
            carrier: LoopFilter::new(3, config.pull_in_pll_bandwidth_hz, SLICE_S),
            code: LoopFilter::new(1, 2.0 * config.dll_bandwidth_hz, SLICE_S),
            doppler_hz: 0.0,
            frequency: FrequencyBlock::default(),
            phase_loop: false,
            cn0: Cn0::new(0.5),
            lock: Lock::new(0.05),
            side_peaks: Default::default(),
            in_state_s: 0.0,
            pull_in_s: 0.0,
        })
    }

    /// Starts afresh from a new acquisition, at or after `earliest` samples.
    pub fn restart(&mut self, seed: Seed, earliest: u64) {
        let earliest = earliest as f64 + self.taps.reach() as f64;
        let rate = self.spec.chip_rate_hz * (1.0 + seed.doppler_hz / self.spec.carrier_hz);
        let period = self.spec.code_length as f64 / rate * self.sample_rate_hz;
        let mut start = seed.sample as f64 + seed.code_delay_s * self.sample_rate_hz;
        start += ((earliest - start) / period).ceil().max(0.0) * period;
        self.correlator.start_at(start, &self.taps);
        self.unsynchronise();
        self.position = 0;
        self.chips = 0;
        self.doppler_hz = seed.doppler_hz;
        self.carrier.rate = seed.doppler_hz;
        self.carrier.acceleration = 0.0;
        self.code.rate = 0.0;
        self.cn0.forget_signal();
        self.pull_in_s = 0.0;
        self.side_peaks = Default::default();
        self.enter(State::PullIn);
        self.steer(seed.doppler_hz, 0.0);
    }

    /// Forgets where symbols and secondary code are.
    pub(super) fn unsynchronise(&mut self) {
        self.sync = match self.symbol {
            None => Sync::Secondary(SecondarySync::new(self.overlay.clone())),
            Some(1) => Sync::Known,
            Some(n) => Sync::Symbol(SymbolSync::of(&self.overlay, n)),
        };
        self.signed = false;
    }

    /// Where a search at a sample would find the signal, if it is simulated.
    pub(crate) fn found(&self, sample: u64) -> Option<Seed> {
        self.correlator.search(sample, self.config.cn0_min_dbhz)
    }

    /// Replica delay of each tap, seconds.
    pub fn tap_offsets_s(&self) -> Vec<f64> {
        self.taps
            .offsets
            .iter()
            .map(|&o| o as f64 / self.sample_rate_hz)
            .collect()
    }

    /// Its state.
    pub fn state(&self) -> State {
        self.state
    }

    /// Its Doppler oscillator.
    pub fn doppler_hz(&self) -> f64 {
        self.doppler_hz
    }

    /// Its own loop's smoothed Doppler, without the proportional part.
    pub fn smooth_doppler_hz(&self) -> f64 {
        self.carrier.rate
    }

    /// Change of Doppler per second, as its own loop sees it.
    pub fn doppler_rate_hz_s(&self) -> f64 {
        self.carrier.acceleration
    }

    /// C/N0 estimate.
    pub fn cn0_dbhz(&self) -> f64 {
        self.cn0.dbhz()
    }

    /// Amplitude of a coherent sum over `interval_s`.
    pub fn amplitude(&self, interval_s: f64) -> f64 {
        self.cn0.signal_power(interval_s).sqrt()
    }

    /// Variance of the code discriminator over `interval_s`, from the C/N0 estimate, s^2.
    pub fn code_variance_s2(&self, interval_s: f64) -> f64 {
        let snr = 10f64.powf(0.1 * self.cn0.dbhz()) * interval_s;
        let chips2 = self.taps.code_variance / snr * (1.0 + 1.0 / snr);
        chips2 / (self.spec.chip_rate_hz * self.spec.chip_rate_hz)
    }

    /// First sample of the integration in progress.
    pub fn begins(&self) -> u64 {
        self.partial
            .as_ref()
            .map_or(self.correlator.base(), |e| e.first)
    }

    /// Whether the signal has a secondary code.
    pub(super) fn has_overlay(&self) -> bool {
        !self.overlay.is_empty()
    }

    /// Slices in a code period.
    pub(super) fn period(&self) -> usize {
        self.correlator.slices_per_period()
    }

    /// Longest integration that stays within a symbol once all is known, slices.
    pub(super) fn synced_length(&self) -> usize {
        let symbol = self.symbol.unwrap_or(self.overlay.len()) * self.period();
        (1..=self.config.integration_ms)
            .rev()
            .find(|n| symbol.is_multiple_of(*n))
            .unwrap_or(1)
    }

    pub(super) fn enter(&mut self, state: State) {
        self.state = state;
        self.in_state_s = 0.0;
        self.partial = None;
        self.frequency = FrequencyBlock::default();
        self.phase_loop = !matches!(state, State::Lost | State::PullIn);
        let acceleration = match state {
            State::Lost | State::PullIn => 0.0,
            _ => self.carrier.acceleration,
        };
        let plan = self.config.plan(state, self.period(), self.synced_length());
        self.length = plan.length;
        let interval = plan.length as f64 * SLICE_S;
        self.lock = Lock::new(plan.lock_memory_s);
        self.carrier = LoopFilter::new(plan.pll_order, plan.pll_bandwidth_hz, interval)
            .starting(self.carrier.rate, acceleration);
        self.code = LoopFilter::new(1, plan.dll_bandwidth_hz, interval);
    }

    /// Sets both oscillators: carrier, and code aided by it.
    pub(super) fn steer(&mut self, doppler_hz: f64, code_rate: f64) {
        self.doppler_hz = doppler_hz;
        let chips = self.spec.chip_rate_hz * (1.0 + doppler_hz / self.spec.carrier_hz) + code_rate;
        self.correlator.set_rates(
            doppler_hz / self.sample_rate_hz,
            self.sample_rate_hz / chips,
        );
    }

    /// Works off what there is, up to the end of an integration.
    pub fn advance(&mut self, feed: Feed<'_>) -> Option<Epoch> {
        let chips_per_slice = self.correlator.chips_per_slice();
        if self.state == State::Lost {
            return None;
        }
        loop {
            let carrier_cycles = self.correlator.carrier_cycles();
            let samples_per_chip = self.correlator.samples_per_chip();
            let code_chips = self.chips as f64 - self.correlator.fraction() / samples_per_chip;
            let sign = self.overlay_sign();
            let slice = self.correlator.advance(feed, self.band)?;
            self.cn0.add_noise(slice.taps[self.taps.noise], SLICE_S);
            let prompt = slice.taps[self.taps.prompt];
            let slice_end = slice.start + slice.samples;
            let epoch = self.partial.get_or_insert_with(|| Epoch {
                taps: vec![C64::default(); slice.taps.len()],
                companion: C64::default(),
                slices: 0,
                first: slice.start,
                samples: 0,
                carrier_cycles,
                code_chips,
            });
            for (sum, tap) in epoch.taps.iter_mut().zip(&slice.taps) {
                *sum += tap * sign;
            }
            epoch.companion += slice.companion;
            epoch.slices += 1;
            epoch.samples += slice.samples;
            self.chips += chips_per_slice;
            self.position += 1;
            if self.state == State::Synced {
                self.count.pass(prompt, self.position, slice_end);
            }
            if self.position.is_multiple_of(self.length) {
                // One that started half-way is of no use to the loops.
                if let Some(mut e) = self.partial.take().filter(|e| e.slices == self.length) {
                    let half = 0.5 * (e.samples as f64 - 1.0);
                    e.carrier_cycles += self.doppler_hz / self.sample_rate_hz * half;
                    e.code_chips += half / samples_per_chip;
                    return Some(e);
                }
            }
        }
    }

    fn overlay_sign(&self) -> f64 {
        if matches!(self.sync, Sync::Known) && !self.overlay.is_empty() {
            f64::from(self.overlay[self.position / self.period() % self.overlay.len()])
        } else {
            1.0
        }
    }
}
