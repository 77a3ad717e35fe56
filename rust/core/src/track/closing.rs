//! What a sideband does at the end of an integration: measure, steer, judge lock, record.

use num_complex::Complex;

use super::combo::Steering;
use super::discriminator as disc;
use super::epoch::{Epoch, Measured};
use super::frequency::BlockError;
use super::log::State;
use super::period_count::Break;
use super::sideband::{Sideband, Sync};
use crate::dsp::replica::SLICE_S;
use crate::signal::Modulation;
use crate::C64;

/// The assisting frequency loop counts a block as so many prompts.
const FLL_PROMPTS: f64 = 20.0;
/// A phase lock that has not come after this is tried again from frequency lock, s.
const PLL_TRY_S: f64 = 0.3;
/// Phase lock is judged after this, s.
const JUDGED_S: f64 = 0.03;
/// Pull-in is given up after this, s.
const PULL_IN_S: f64 = 2.0;
/// Phase-lock indicators that count as locked, and as lost.
const LOCKED: f64 = 0.7;
const UNLOCKED: f64 = 0.2;
/// A signal is gone if a smaller share of its prompts has a signal's power.
const ABSENT: f64 = 0.3;
/// Lock must have been judged for this long before it can be lost, s.
const GRACE_S: f64 = 0.3;
/// A secondary code must be found within this, s.
const SYNC_S: f64 = 5.0;

impl Sideband {
    /// Reads the carrier and code discriminators, without touching the loops.
    pub fn measure(&self, epoch: &Epoch) -> Measured {
        let prompt = epoch.taps[self.taps.prompt];
        let phase_error = if self.signed {
            disc::phase(prompt)
        } else {
            disc::costas(prompt)
        };
        let code_error_chips = self.code_error(epoch);
        Measured {
            phase_error,
            code_error_chips,
            phase_cycles: self.spec.phase_offset_cycles - (epoch.carrier_cycles + phase_error),
            code_chips: epoch.code_chips + code_error_chips,
        }
    }

    fn code_error(&self, epoch: &Epoch) -> f64 {
        let p = self.taps.prompt;
        let power = self.cn0.signal_power(epoch.interval_s());
        let error = disc::code(
            epoch.taps[p - 1],
            epoch.taps[p],
            epoch.taps[p + 1],
            power,
            self.taps.slope,
        );
        // Beyond the taps the discriminator means nothing.
        error.clamp(-0.5, 0.5)
    }

    /// Closes an integration with the sideband's own loops.
    pub fn close_own(&mut self, epoch: &Epoch) {
        self.judge(epoch, None);
        let measured = self.measure(epoch);
        let interval = epoch.interval_s();
        let prompt = epoch.taps[self.taps.prompt];
        let block = match self.state {
            State::PullIn | State::Tracking => self.frequency.add(prompt, self.snr(), interval),
            _ => None,
        };
        let doppler = if self.state == State::PullIn && !self.phase_loop {
            self.acquire_frequency(block)
        } else {
            self.assist(block, interval);
            self.carrier.update(measured.phase_error)
        };
        let code_rate = self.code.update(measured.code_error_chips);
        self.finish(epoch, &measured, [doppler, code_rate], self.state);
    }

    /// First part of pull-in: waits for the frequency, then starts the phase loop at the
    /// measured frequency and phase, so that it need not swing in.
    fn acquire_frequency(&mut self, block: Option<BlockError>) -> f64 {
        if let Some(error) = block {
            self.carrier.rate += error.frequency_hz;
            self.correlator.shift_carrier(error.phase_cycles);
            self.phase_loop = true;
        }
        self.carrier.rate
    }

    /// Frequency-locked loop beside the phase loop, until symbols are synchronised.
    fn assist(&mut self, block: Option<BlockError>, interval_s: f64) {
        if let Some(error) = block {
            let gain = 4.0 * self.config.fll_bandwidth_hz * FLL_PROMPTS * interval_s;
            self.carrier.rate += gain.min(0.5) * error.frequency_hz;
        }
    }

    /// Signal-to-noise ratio of a prompt.
    fn snr(&self) -> f64 {
        10f64.powf(0.1 * self.cn0.dbhz()) * self.length as f64 * SLICE_S
    }

    /// Closes an integration as the sideband `i` of a combo, whose loops chose the Doppler and,
    /// in chips per second, the correction of the code. `other_lock` is the other sideband's
    /// phase-lock indicator: the joint loops hold both or none, and the mean of both is less noisy
    /// than either. (Sidebands that do not agree are parted by the combo.)
    pub fn close_joint(
        &mut self,
        epoch: &Epoch,
        steering: &Steering,
        i: usize,
        code_rate: f64,
        other_lock: f64,
    ) {
        self.judge(epoch, Some(other_lock));
        let measured = self.measure(epoch);
        // The own loop stands by, ready to take over without a jump.
        self.carrier.rate = steering.smooth_doppler_hz[i];
        self.carrier.acceleration = steering.rate_hz_s[i];
        let recorded = if self.state == State::Lost {
            State::Lost
        } else {
            State::Combo
        };
        let rates = [steering.doppler_hz[i], code_rate];
        self.finish(epoch, &measured, rates, recorded);
    }

    /// Records, and steers by a Doppler and a correction of the code in chips per second.
    fn finish(&mut self, epoch: &Epoch, measured: &Measured, rates: [f64; 2], recorded: State) {
        self.record(epoch, measured, recorded);
        self.in_state_s += epoch.interval_s();
        self.pull_in_s += epoch.interval_s();
        self.steer(rates[0], rates[1]);
        if self.state == State::Lost && self.count.wrong() {
            self.count_anew(epoch.end());
        } else if self.state != State::Lost {
            self.guard_side_peak(epoch);
            self.promote(epoch);
        }
    }

    /// Updates C/N0 and lock indicators, and declares loss; with the phase-lock indicator of the
    /// other sideband of a combo.
    fn judge(&mut self, epoch: &Epoch, other_lock: Option<f64>) {
        let prompt = epoch.taps[self.taps.prompt];
        let interval = epoch.interval_s();
        self.cn0.add_prompt(prompt, interval);
        if self.state != State::PullIn || self.phase_loop {
            let noise_power = self.cn0.noise_power(interval);
            let least_snr = 10f64.powf(0.1 * self.config.cn0_min_dbhz) * interval;
            self.lock.add(prompt, noise_power, least_snr, interval);
        }
        let lost = match self.state {
            State::Synced if self.count.wrong() => true,
            State::PullIn => self.pull_in_s > PULL_IN_S,
            State::Lost => false,
            _ => {
                let own = self.lock.phase();
                let phase_lock = other_lock.map_or(own, |other| 0.5 * (own + other));
                self.in_state_s > GRACE_S
                    && (phase_lock < UNLOCKED
                        || self.lock.presence() < ABSENT
                        || self.never_synchronises())
            }
        };
        if lost {
            self.enter(State::Lost);
        }
    }

    /// A secondary code that is not found in time: the loop is not on the signal, but perhaps
    /// half-way between two. (Plain symbols may stay without a change for long.)
    fn never_synchronises(&self) -> bool {
        self.state == State::Tracking && self.in_state_s > SYNC_S && self.has_overlay()
    }

    /// Moves on to the next state when its condition is met.
    fn promote(&mut self, epoch: &Epoch) {
        match self.state {
            State::PullIn
                if self.lock.elapsed_s() >= JUDGED_S
                    && self.lock.phase() > LOCKED
                    && self.cn0.dbhz() > self.config.cn0_min_dbhz =>
            {
                self.enter(State::Tracking);
            }
            State::PullIn if self.lock.elapsed_s() > PLL_TRY_S => self.enter(State::PullIn),
            State::Tracking => self.synchronise(epoch),
            _ => {}
        }
    }

    fn synchronise(&mut self, epoch: &Epoch) {
        let prompt = epoch.taps[self.taps.prompt];
        let period = self.period();
        let found = match &mut self.sync {
            Sync::Symbol(s) => s.add(prompt).map(|index| (index, false)),
            Sync::Secondary(s) => s.add(prompt).inspect(|_| self.signed = true),
            // A symbol per code period: nothing to find, but let the loops settle.
            Sync::Known => (self.in_state_s > GRACE_S).then_some((0, false)),
        };
        if let Some((index, reversed)) = found {
            self.sync = Sync::Known;
            self.position = index * period;
            if reversed {
                self.correlator.shift_carrier(0.5);
            }
            self.count.begin(epoch.end());
            self.enter(State::Synced);
        }
    }

    /// The signal is there, only out of step: looks for its symbols and secondary code again.
    fn count_anew(&mut self, sample: u64) {
        self.breaks.push(Break {
            from_s: self.count.right_until() as f64 / self.sample_rate_hz,
            until_s: sample as f64 / self.sample_rate_hz,
        });
        self.count.begin(sample);
        self.unsynchronise();
        self.enter(State::Tracking);
    }

    /// A BOC correlation has side peaks half a chip away; on one of them, the very early or very
    /// late tap stands on the main peak and is the larger.
    fn guard_side_peak(&mut self, epoch: &Epoch) {
        if self.modulation == Modulation::Bpsk {
            return;
        }
        let p = self.taps.prompt;
        let interval = epoch.interval_s();
        for (mean, tap) in self.side_peaks.iter_mut().zip([p - 2, p, p + 2]) {
            mean.add(epoch.taps[tap].norm_sqr() / interval, interval);
        }
        let [before, here, after] = self.side_peaks.each_ref().map(|m| m.value());
        if self.side_peaks[0].elapsed_s() > 0.2 && before.max(after) > 1.5 * here {
            let towards = if before > after { p - 2 } else { p + 2 };
            self.correlator
                .shift_code(self.taps.offsets[towards] as f64);
            self.side_peaks = Default::default();
            self.enter(self.state);
        }
    }

    fn record(&mut self, epoch: &Epoch, measured: &Measured, state: State) {
        let doppler_hz = self.doppler_hz();
        let state = match state {
            State::Synced if self.captured => State::Captured,
            state => state,
        };
        let rows = &mut self.rows;
        rows.time_s.push(epoch.middle() / self.sample_rate_hz);
        rows.integration_s.push(epoch.interval_s());
        rows.state.push(state as u8);
        rows.carrier_phase_cycles.push(measured.phase_cycles);
        rows.doppler_hz.push(doppler_hz);
        rows.code_phase_chips.push(measured.code_chips);
        rows.phase_error_cycles.push(measured.phase_error);
        rows.code_error_chips.push(measured.code_error_chips);
        rows.cn0_dbhz.push(self.cn0.dbhz());
        rows.phase_lock.push(self.lock.phase());
        rows.noise_power
            .push(self.cn0.noise_power(1.0 / self.sample_rate_hz));
        let rounded = |t: &C64| Complex::new(t.re as f32, t.im as f32);
        rows.data_prompt.push(rounded(&epoch.companion));
        rows.taps.extend(epoch.taps.iter().map(rounded));
    }
}
