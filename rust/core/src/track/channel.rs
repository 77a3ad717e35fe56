//! One satellite: its sidebands, and the combo of two of them.
//!
//! ```text
//! single --both synchronised for a while--> combo --one lost, or they disagree--> single
//!    ^                                        |
//!    +-- rejoin -- single by alarm <--isolate-+
//! ```

use super::combo::{wiped, JointLoops, ALIGNMENT_S};
use super::config::TrackConfig;
use super::epoch::{Epoch, Measured};
use super::joint_code::JointCode;
use super::log::{ComboRows, State};
use super::pair_rows::{PairEpoch, PairRecorder};
use super::sideband::Sideband;
use super::source::Feed;

/// Two integrations belong together if they begin within this, s.
const PAIRED_S: f64 = 0.4e-3;
/// One sideband waits for the other, to be steered together, if that is no later than this, s.
pub(super) const WAIT_S: f64 = 50e-6;
/// Both sidebands must have run by themselves this long before they are joined, s.
const SETTLED_S: f64 = 0.5;
/// Joined loops whose sidebands disagree are parted: below this subcarrier lock, less two standard
/// deviations of its noise.
const PARTED: f64 = 0.4;

/// One satellite.
pub struct Channel {
    /// Its number.
    pub prn: u16,
    /// One signal, or two to be coupled, the lower carrier first.
    pub sidebands: Vec<Sideband>,
    /// Rows of the pair; empty where there is one sideband.
    pub combo: ComboRows,
    pending: Vec<Option<Epoch>>,
    /// Of sidebands too far apart to wait for each other: what has no partner yet.
    apart: [Option<(Epoch, Measured)>; 2],
    joint: Option<Joint>,
    recorder: PairRecorder,
    settled_s: f64,
    config: TrackConfig,
    sample_rate_hz: f64,
}

/// The loops of a combo.
struct Joint {
    carrier: JointLoops,
    code: JointCode,
}

impl Channel {
    /// A satellite with one sideband, or two that may be coupled, the lower carrier first.
    pub fn new(
        prn: u16,
        mut sidebands: Vec<Sideband>,
        config: &TrackConfig,
        sample_rate_hz: f64,
    ) -> Self {
        // Those that are steered together are integrated alike: 20 ms of one are 10 ms if that is
        // a symbol of the other.
        let shortest = sidebands.iter().map(Sideband::synced_length).min();
        for sideband in &mut sidebands {
            sideband.config.integration_ms = shortest.unwrap_or(config.integration_ms);
        }
        Channel {
            prn,
            pending: sidebands.iter().map(|_| None).collect(),
            sidebands,
            apart: [None, None],
            combo: ComboRows::default(),
            joint: None,
            recorder: PairRecorder::default(),
            settled_s: 0.0,
            config: config.clone(),
            sample_rate_hz,
        }
    }

    /// Marks a sideband as captured: the pair is parted until [`Channel::rejoin`], and each goes on
    /// with loops of its own.
    pub fn isolate(&mut self, sideband: usize) {
        self.sidebands[sideband].captured = true;
        self.part();
    }

    /// Takes all such marks away, so that the pair may be joined again.
    pub fn rejoin(&mut self) {
        for sideband in &mut self.sidebands {
            sideband.captured = false;
        }
        self.settled_s = 0.0;
    }

    /// Works off what there is.
    pub fn advance<'a>(&mut self, feed: impl Into<Feed<'a>>) {
        let feed = feed.into();
        loop {
            for (sideband, pending) in self.sidebands.iter_mut().zip(&mut self.pending) {
                if pending.is_none() {
                    *pending = sideband.advance(feed);
                }
            }
            if !self.close() {
                return;
            }
        }
    }

    /// Closes one integration, or two that belong together; false if all wait for data.
    fn close(&mut self) -> bool {
        if self.pairs() {
            match &self.pending[..] {
                [Some(lower), Some(upper)] if self.within(WAIT_S, lower, upper.first) => {
                    let (lower, upper) = (lower.clone(), upper.clone());
                    self.pending = vec![None, None];
                    self.close_pair(&lower, &upper);
                    return true;
                }
                [Some(epoch), None] if self.within(WAIT_S, epoch, self.sidebands[1].begins()) => {
                    return false;
                }
                [None, Some(epoch)] if self.within(WAIT_S, epoch, self.sidebands[0].begins()) => {
                    return false;
                }
                _ => {}
            }
        }
        let earliest = (0..self.pending.len())
            .filter_map(|i| self.pending[i].as_ref().map(|e| (e.end(), i)))
            .min();
        let Some((_, i)) = earliest else {
            return false;
        };
        self.part();
        if let Some(epoch) = self.pending[i].take() {
            if self.pairs() {
                self.record_apart(i, &epoch);
            } else {
                self.recorder.forget();
            }
            self.sidebands[i].close_own(&epoch);
        }
        true
    }

    /// Whether an integration and one of the other sideband begin within `span_s`.
    fn within(&self, span_s: f64, epoch: &Epoch, other_first: u64) -> bool {
        (epoch.first.abs_diff(other_first) as f64) < span_s * self.sample_rate_hz
    }

    /// Records sidebands that are steered by themselves, once both have been measured.
    fn record_apart(&mut self, i: usize, epoch: &Epoch) {
        let measured = self.sidebands[i].measure(epoch);
        self.apart[i] = Some((epoch.clone(), measured));
        let [lower, upper] = self.apart.each_mut().map(Option::take);
        match (lower, upper) {
            (Some(lower), Some(upper)) if self.within(PAIRED_S, &lower.0, upper.0.first) => {
                let (epochs, measured) = ([&lower.0, &upper.0], [lower.1, upper.1]);
                self.record(epochs, measured);
            }
            (Some(lower), Some(upper)) => {
                // The later one may yet find its partner.
                if lower.0.first < upper.0.first {
                    self.apart[1] = Some(upper);
                } else {
                    self.apart[0] = Some(lower);
                }
            }
            one => self.apart = one.into(),
        }
    }

    /// Two sidebands, both synchronised.
    fn pairs(&self) -> bool {
        self.sidebands.len() == 2 && self.sidebands.iter().all(|s| s.state() == State::Synced)
    }

    fn part(&mut self) {
        self.joint = None;
        self.settled_s = 0.0;
    }

    fn close_pair(&mut self, lower: &Epoch, upper: &Epoch) {
        self.apart = [None, None];
        let epochs = [lower, upper];
        let measured = [0, 1].map(|i| self.sidebands[i].measure(epochs[i]));
        self.record(epochs, measured);
        let least = self.least_lock(upper.interval_s());
        let parted =
            |j: &Joint| j.carrier.elapsed_s() > ALIGNMENT_S && j.carrier.subcarrier_lock() < least;
        if self.joint.as_ref().is_some_and(parted) {
            self.part();
        }
        if let Some(joint) = &mut self.joint {
            joint.close(&mut self.sidebands, epochs, measured);
        } else {
            for (sideband, epoch) in self.sidebands.iter_mut().zip(epochs) {
                sideband.close_own(epoch);
            }
            self.join_if_settled(upper.interval_s());
        }
    }

    /// Subcarrier lock below which sidebands disagree, and not only by noise.
    fn least_lock(&self, interval_s: f64) -> f64 {
        let noise = |s: &Sideband| 10f64.powf(-0.1 * s.cn0_dbhz()) / interval_s;
        let [a, b] = [0, 1].map(|i| noise(&self.sidebands[i]));
        let variance = 0.5 * (a + b + a * b) * interval_s / ALIGNMENT_S;
        (PARTED - 2.0 * variance.sqrt()).max(0.0)
    }

    fn join_if_settled(&mut self, interval_s: f64) {
        self.settled_s += interval_s;
        let captured = self.sidebands.iter().any(|s| s.captured);
        if self.config.combo && !captured && self.settled_s >= SETTLED_S && self.pairs() {
            self.joint = Some(Joint::new(&self.sidebands, &self.config, interval_s));
        }
    }

    fn record(&mut self, epochs: [&Epoch; 2], measured: [Measured; 2]) {
        let lock = |j: &Joint| j.carrier.subcarrier_lock();
        let pair = PairEpoch {
            epochs,
            measured,
            state: self.state(),
            subcarrier_lock: self.joint.as_ref().map_or(0.0, lock),
        };
        let sidebands = [&self.sidebands[0], &self.sidebands[1]];
        self.recorder.record(&mut self.combo, sidebands, &pair);
    }

    /// State of the pair, both of which are synchronised.
    fn state(&self) -> State {
        if self.joint.is_some() {
            State::Combo
        } else if self.sidebands.iter().any(|s| s.captured) {
            State::Captured
        } else {
            State::Synced
        }
    }
}

impl Joint {
    /// Loops that continue what the sidebands do on their own.
    fn new(sidebands: &[Sideband], config: &TrackConfig, interval_s: f64) -> Self {
        let of = |f: fn(&Sideband) -> f64| [f(&sidebands[0]), f(&sidebands[1])];
        Joint {
            carrier: JointLoops::new(
                of(|s| s.spec.carrier_hz),
                [config.main_bandwidth_hz, config.subcarrier_bandwidth_hz],
                interval_s,
                of(Sideband::smooth_doppler_hz),
                of(Sideband::doppler_rate_hz_s),
            ),
            code: JointCode::new(
                [config.dll_bandwidth_hz, config.code_bias_bandwidth_hz],
                interval_s,
            ),
        }
    }

    /// Closes an integration of both sidebands.
    fn close(&mut self, sidebands: &mut [Sideband], epochs: [&Epoch; 2], measured: [Measured; 2]) {
        let interval_s = epochs[1].interval_s();
        let of = |f: &dyn Fn(&Sideband, usize) -> f64| [0, 1].map(|i| f(&sidebands[i], i));
        let prompts = [0, 1].map(|i| {
            let s = &sidebands[i];
            epochs[i].taps[s.taps.prompt] / s.amplitude(interval_s)
        });
        let noise = of(&|s, _| s.cn0.noise_power(interval_s) / s.amplitude(interval_s).powi(2));
        let prompts = wiped(prompts, [0, 1].map(|i| sidebands[i].signed));
        let steering = self.carrier.update(prompts, noise, interval_s);
        let errors_s = of(&|s, i| measured[i].code_error_chips / s.spec.chip_rate_hz);
        let rates = self
            .code
            .update(errors_s, of(&|s, _| s.code_variance_s2(interval_s)));
        let locks = of(&|s, _| s.lock.phase());
        for (i, sideband) in sidebands.iter_mut().enumerate() {
            let code_rate = rates[i] * sideband.spec.chip_rate_hz;
            sideband.close_joint(epochs[i], &steering, i, code_rate, locks[1 - i]);
        }
    }
}
