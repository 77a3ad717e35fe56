//! One satellite: its sidebands, and the combo of two of them.

use super::combo::JointLoops;
use super::config::TrackConfig;
use super::epoch::{Epoch, Measured};
use super::log::{ComboRows, State};
use super::sideband::Sideband;
use super::source::Feed;

/// Two integrations belong together if they begin within this, s.
const PAIRED_S: f64 = 0.4e-3;
/// One sideband waits for the other, to be steered together, if that is no later than this, s.
pub(super) const WAIT_S: f64 = 50e-6;
/// Both sidebands must have run by themselves this long before they are joined, s.
const SETTLED_S: f64 = 0.5;
/// Joined loops whose sidebands disagree are parted.
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
    joint: Option<JointLoops>,
    settled_s: f64,
    config: TrackConfig,
    sample_rate_hz: f64,
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
            settled_s: 0.0,
            config: config.clone(),
            sample_rate_hz,
        }
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
                self.record([&lower.0, &upper.0], [lower.1, upper.1]);
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
        let interval = upper.interval_s();
        self.apart = [None, None];
        let epochs = [lower, upper];
        let measured = [0, 1].map(|i| self.sidebands[i].measure(epochs[i]));
        self.record(epochs, measured);
        if self
            .joint
            .as_ref()
            .is_some_and(|j| j.elapsed_s() > 0.2 && j.subcarrier_lock() < PARTED)
        {
            self.part();
        }
        if let Some(joint) = &mut self.joint {
            let prompts = [0, 1].map(|i| {
                let s = &self.sidebands[i];
                s.wiped(epochs[i].taps[s.taps.prompt]) / s.amplitude(interval)
            });
            let steering = joint.update(prompts[0], prompts[1], interval);
            for (i, sideband) in self.sidebands.iter_mut().enumerate() {
                let (doppler_hz, rate) = (steering.doppler_hz[i], steering.rate_hz_s[i]);
                sideband.close_joint(epochs[i], doppler_hz, rate);
            }
        } else {
            for (sideband, epoch) in self.sidebands.iter_mut().zip(epochs) {
                sideband.close_own(epoch);
            }
            self.settled_s += interval;
            if self.config.combo && self.settled_s >= SETTLED_S && self.pairs() {
                self.join(interval);
            }
        }
    }

    fn join(&mut self, interval_s: f64) {
        let of = |f: fn(&Sideband) -> f64| [f(&self.sidebands[0]), f(&self.sidebands[1])];
        self.joint = Some(JointLoops::new(
            of(|s| s.spec.carrier_hz),
            [
                self.config.main_bandwidth_hz,
                self.config.subcarrier_bandwidth_hz,
            ],
            interval_s,
            of(Sideband::smooth_doppler_hz),
            of(Sideband::doppler_rate_hz_s),
        ));
    }

    fn record(&mut self, [lower, upper]: [&Epoch; 2], [ml, mu]: [Measured; 2]) {
        let [sl, su] = [&self.sidebands[0], &self.sidebands[1]];
        // The lower sideband's values are brought to the middle of the upper one's epoch.
        let wait_s = (upper.middle() - lower.middle()) / self.sample_rate_hz;
        let code_lower = ml.code_chips / sl.spec.chip_rate_hz + wait_s;
        let code_upper = mu.code_chips / su.spec.chip_rate_hz;
        let period = sl.spec.period_s().min(su.spec.period_s());
        let ahead = (code_upper - code_lower) / period;
        let rows = &mut self.combo;
        rows.time_s.push(upper.middle() / self.sample_rate_hz);
        rows.integration_s.push(upper.interval_s());
        rows.state.push(if self.joint.is_some() {
            State::Combo
        } else {
            State::Synced
        } as u8);
        rows.phase_lower_cycles
            .push(ml.phase_cycles - sl.doppler_hz() * wait_s);
        rows.phase_upper_cycles.push(mu.phase_cycles);
        rows.cn0_lower_dbhz.push(sl.cn0_dbhz());
        rows.cn0_upper_dbhz.push(su.cn0_dbhz());
        // Received later = code phase behind.
        rows.code_difference_s
            .push(-(ahead - ahead.round()) * period);
        rows.subcarrier_lock
            .push(self.joint.as_ref().map_or(0.0, JointLoops::subcarrier_lock));
    }
}
