//! What happens at an epoch: measurements are used or left out, tests are formed, the guard acts.

use nalgebra::Vector3;

use super::alarms::{limit, CLOCKS, POWER, SEPARATION, TESTS, WINDOWS};
use super::copies::{Copies, SPANS};
use super::covariance::Transition;
use super::decide::{Jury, Means};
use super::epoch::{Deviations, Epoch, Kind};
use super::fix::solve;
use super::guard::{Action, Alarm, Evidence, Guard, Rules, State};
use super::navigator::Navigator;
use super::output::{Event, Output, Usage};
use super::power::Power;
use super::settings::{Mode, Settings};
use super::shadow::Shadow;
use super::statistics::Panel;
use super::step::Steps;
use super::windows::Windows;

/// One innovation counts no more than this, so that one glitch is no attack.
const CLIP: f64 = 5.0;
/// Means that decide who is wrong, s.
const MEANS: f64 = 10.0;
/// Copies are not renewed while a test is over this part of its threshold.
const SUSPICION: f64 = 0.75;
/// An alarm is confirmed so far beyond its threshold.
const CERTAIN: f64 = 0.6;
/// A single satellite agrees below so many standard deviations.
const AGREES: f64 = 2.8;

/// Everything around the navigator.
pub struct Supervisor {
    settings: Settings,
    guard: Guard,
    copies: Copies,
    windows: [Windows; 3],
    panel: Panel,
    power: Power,
    shadow: Shadow,
    confirmed: bool,
    steps: Steps,
    jump: f64,
    means: Means,
    jury: Jury,
    dev: Deviations,
    innovations: [Vec<f64>; 3],
    usage: Vec<Usage>,
    deviates: [f64; TESTS],
    interval: f64,
    scratch: [Vec<f64>; 2],
    detailed: bool,
    /// What has come out so far.
    pub output: Output,
}

impl Supervisor {
    /// For epochs at these times.
    pub fn new(
        settings: &Settings,
        rules: Rules,
        navigator: &Navigator,
        start: f64,
        times: &[f64],
        satellites: usize,
        detailed: bool,
    ) -> Self {
        let interval = typical(times);
        let epochs = |s: &f64| ((s / interval).round() as usize).max(1);
        let windows = WINDOWS.map(|w| {
            let lengths: Vec<usize> = w.iter().map(epochs).collect();
            Windows::new(&lengths, satellites)
        });
        Supervisor {
            settings: settings.clone(),
            shadow: Shadow::new(&navigator.filter, &windows, satellites),
            confirmed: false,
            steps: Steps::new(interval, &settings.receiver),
            jump: 0.0,
            guard: Guard::new(rules, start, satellites),
            copies: Copies::new(&navigator.filter.navigation(), start),
            windows,
            panel: Panel::new(settings.published, satellites),
            power: Power::new(satellites),
            means: Means::new(epochs(&MEANS), satellites),
            jury: Jury::new(satellites),
            dev: Deviations::new(satellites),
            innovations: std::array::from_fn(|_| vec![f64::NAN; satellites]),
            usage: vec![Usage::Missing; satellites],
            deviates: [0.0; TESTS],
            interval,
            scratch: std::array::from_fn(|_| vec![f64::NAN; satellites]),
            detailed,
            output: Output::with_capacity(times.len(), satellites, TESTS, detailed),
        }
    }

    /// The filter has moved on in time.
    pub fn predict(&mut self, step: &Transition) {
        self.copies.predict(step);
        self.shadow.predict(step);
    }

    /// One epoch.
    pub fn epoch(&mut self, nav: &mut Navigator, epoch: &Epoch<'_>, before: Option<&Epoch<'_>>) {
        nav.deviate(epoch, &mut self.dev);
        nav.changes(epoch, before, &mut self.dev);
        let (whole, dilution) = self.fix(epoch);
        self.jump = self.steps.push(whole, dilution);
        let fix = whole.map(|[x, y, z, _]| [x, y, z]);
        self.panel.push(fix, &self.dev.range, &self.dev.rate);
        self.choose(epoch);
        self.measure(nav, epoch);
        let found = nav.correct();
        self.copies.corrected(&found);
        self.follow(nav, epoch);
        nav.close_epoch();
        self.test(nav, epoch);
        if self.settings.mode == Mode::Robust {
            self.judge(nav, epoch, fix);
        } else {
            let calm = nav.filter.navigation();
            self.copies.renew(&calm, epoch.time, false);
        }
        self.record(nav);
    }

    /// Which satellites may move the states.
    fn choose(&mut self, epoch: &Epoch<'_>) {
        let coasts = self
            .settings
            .outages
            .iter()
            .any(|o| (o.0..o.1).contains(&epoch.time));
        let printed = self.settings.mode == Mode::Printed;
        let none_named = !(0..self.usage.len()).any(|k| self.panel.satellite_over(k));
        // Position or velocity over 1 and no satellite named: the publication has no rule.
        let all_out = printed && none_named && self.panel.solution_over();
        for (k, usage) in self.usage.iter_mut().enumerate() {
            let there = epoch.range[k].is_finite() || epoch.rate[k].is_finite();
            let out = coasts
                || self.settings.testing.heed_receiver && epoch.spoofed[k]
                || all_out
                || !self.guard.uses(k)
                || printed && self.panel.satellite_over(k);
            *usage = match (there, out) {
                (false, _) => Usage::Missing,
                (_, true) => Usage::Excluded,
                _ => Usage::Used,
            };
        }
    }

    fn measure(&mut self, nav: &mut Navigator, epoch: &Epoch<'_>) {
        for (which, kind) in [Kind::Rate, Kind::Change, Kind::Range]
            .into_iter()
            .enumerate()
        {
            for k in 0..self.usage.len() {
                let used = matches!(self.usage[k], Usage::Used | Usage::Weakened);
                let found = match self.usage[k] {
                    Usage::Missing => None,
                    _ => nav.measure(kind, k, epoch.system[k], &self.dev, used),
                };
                self.innovations[which][k] = f64::NAN;
                let pair = found.map_or([f64::NAN; 2], |f| [f.value, f.sigma]);
                if self.detailed && kind == Kind::Rate {
                    self.output.rate.push(pair);
                } else if self.detailed && kind == Kind::Range {
                    self.output.range.push(pair);
                }
                let Some(found) = found.filter(|_| used) else {
                    continue;
                };
                self.innovations[which][k] = found.normalised().clamp(-CLIP, CLIP);
                if found.weakened {
                    self.usage[k] = Usage::Weakened;
                }
            }
        }
    }

    /// Lets the shadow see the epoch, and notes whether it confirms the alarm.
    fn follow(&mut self, nav: &Navigator, epoch: &Epoch<'_>) {
        if !self.shadow.active {
            return;
        }
        let testing = &self.settings.testing;
        let flagged = |k: usize| testing.heed_receiver && epoch.spoofed[k];
        let robust = testing.robust;
        let largest = self
            .shadow
            .epoch(nav, epoch, &self.dev, flagged, robust, CLIP);
        let t = &testing.thresholds;
        let parted = self.shadow.separation(&nav.filter.navigation());
        self.confirmed |=
            parted > t[3] + CERTAIN || largest.iter().zip(t).any(|(z, limit)| *z > limit + CERTAIN);
        self.shadow.active = !self.confirmed && self.guard.blind();
    }

    /// Deviates of all tests.
    fn test(&mut self, nav: &Navigator, epoch: &Epoch<'_>) {
        let mut at = 0;
        for (windows, innovations) in self.windows.iter_mut().zip(&self.innovations) {
            windows.push(innovations);
            for deviate in windows.deviates() {
                self.deviates[at] = deviate;
                at += 1;
            }
        }
        let now = nav.filter.navigation();
        for span in 0..SPANS.len() {
            let [place, clock] = self
                .copies
                .older(span)
                .separation(&now, self.settings.testing.slack);
            self.deviates[SEPARATION + span] = place;
            self.deviates[CLOCKS + span] = clock;
        }
        for k in 0..self.usage.len() {
            let heard = self.guard.uses(k) && !self.flagged(epoch, k);
            self.scratch[0][k] = if heard { epoch.cn0[k] } else { f64::NAN };
        }
        self.deviates[POWER] = self.power.push(&self.scratch[0], self.interval);
    }

    fn limit_of(&self, test: usize) -> (f64, f64) {
        limit(test, &self.settings.testing)
    }

    /// The test furthest over its threshold, as a share of it.
    fn worst(&self) -> (usize, f64) {
        let shares = (0..TESTS).map(|k| (k, self.deviates[k] / self.limit_of(k).0));
        shares.fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a })
    }

    fn judge(&mut self, nav: &mut Navigator, epoch: &Epoch<'_>, fix: [[f64; 3]; 2]) {
        let (test, share) = self.worst();
        let usable = !self.guard.blind();
        let alarm = (usable && share > 1.0).then(|| Alarm {
            test,
            age: self.limit_of(test).1,
        });
        let evidence = self.evidence(nav, epoch, alarm);
        let action = self.guard.step(&evidence);
        if action != Action::None {
            let back = self.act(nav, action, epoch.time);
            self.log(epoch.time, alarm, back, fix);
        } else if usable {
            let calm = nav.filter.navigation();
            self.copies.renew(&calm, epoch.time, share > SUSPICION);
        }
    }

    fn evidence(&mut self, nav: &Navigator, epoch: &Epoch<'_>, alarm: Option<Alarm>) -> Evidence {
        let (mut agreement, mut culprits, mut back) = (None, None, 0);
        if self.guard.blind() || self.guard.state() == State::Partial {
            for k in 0..self.usage.len() {
                let gone = self.flagged(epoch, k);
                self.scratch[0][k] = if gone { f64::NAN } else { self.dev.range[k] };
                self.scratch[1][k] = if gone { f64::NAN } else { self.dev.rate[k] };
            }
            self.means.push(&self.scratch[0], &self.scratch[1]);
        }
        if self.guard.blind() && self.means.filled() >= 3 {
            let covariance = nav.filter.navigation();
            let towards = |k: usize| self.dev.sight[k].towards;
            self.jury
                .summon(&self.means, towards, &covariance, &self.settings.receiver);
            let said = self.jury.agreement(0);
            if said.count >= 4 {
                agreement = Some(said);
            }
            if self.guard.state() == State::Deciding && said.mutual > 4.0 {
                culprits = self
                    .jury
                    .culprits(self.settings.testing.most_excluded, 2.33);
            }
        } else if self.guard.state() == State::Partial {
            back = self.agreeing();
        }
        Evidence {
            time: epoch.time,
            alarm,
            agreement,
            culprits,
            back,
            confirmed: self.confirmed,
            jump: self.jump,
        }
    }

    /// Excluded satellites whose means agree with the filter; its own errors are small then.
    fn agreeing(&self) -> u64 {
        let noise = &self.settings.receiver;
        let mut mask = 0;
        for (k, (mean, count)) in self.means.mean.iter().enumerate() {
            let n = f64::max(*count as f64, 1.0);
            // Half a metre and 2 cm/s for the filter itself.
            let range = noise.wander.hypot(noise.code / n.sqrt()).hypot(1.5);
            let rate = (noise.rate / n.sqrt()).hypot(0.02);
            let agrees = mean[0].abs() < AGREES * range && mean[1].abs() < AGREES * rate;
            if agrees && 2 * count > self.means.filled() && self.means.filled() >= 3 {
                mask |= 1 << k;
            }
        }
        mask
    }

    fn act(&mut self, nav: &mut Navigator, action: Action, time: f64) -> f64 {
        let mut back = 0.0;
        match action {
            Action::TakeBack(age) => {
                let chosen = self.copies.at_least(age, time).clone();
                back = time - chosen.born;
                nav.left_behind(&chosen.difference, &mut self.shadow.filter);
                std::mem::swap(&mut self.shadow.windows, &mut self.windows);
                (self.shadow.active, self.confirmed) = (true, self.certain());
                nav.take_back(&chosen.difference, &chosen.covariance);
                if let Some(tape) = &mut nav.filter.tape {
                    tape.take_back(chosen.born);
                }
                self.copies.taken_back(&chosen);
                self.means.clear();
            }
            Action::ReadmitWithClock => {
                nav.lose_clock();
                self.copies.renew_all(&nav.filter.navigation(), time);
                self.power.rebase();
            }
            Action::Readmit => self.power.rebase(),
            Action::Exclude(_) | Action::Coast | Action::None => (),
        }
        self.windows.iter_mut().for_each(Windows::clear);
        back
    }

    /// Whether the alarm needs no confirmation.
    fn certain(&self) -> bool {
        let windows = (0..SEPARATION).any(|k| self.deviates[k] > self.limit_of(k).0 + CERTAIN);
        windows || self.deviates[POWER] > self.limit_of(POWER).0
    }

    fn log(&mut self, time: f64, alarm: Option<Alarm>, back: f64, fix: [[f64; 3]; 2]) {
        self.output.events.push(Event {
            time,
            state: self.guard.state(),
            test: alarm.map_or(-1, |a| a.test as i32),
            deviate: alarm.map_or(f64::NAN, |a| self.deviates[a.test]),
            excluded: if self.guard.blind() {
                u64::MAX
            } else {
                self.guard.excluded()
            },
            back,
            apart: Vector3::from(fix[0]).norm(),
        });
    }

    fn record(&mut self, nav: &Navigator) {
        self.output.push_navigator(nav);
        self.output.push_panel(&self.panel, self.detailed);
        self.output.deviates.extend(self.deviates);
        self.output.state.push(self.guard.state() as u8);
        if self.detailed {
            self.output
                .usage
                .extend(self.usage.iter().map(|u| *u as u8));
        }
    }

    /// Whether the receiver calls a satellite spoofed, and that counts.
    fn flagged(&self, epoch: &Epoch<'_>, k: usize) -> bool {
        self.settings.testing.heed_receiver && epoch.spoofed[k]
    }

    /// Least-squares position and clock, velocity and drift of all satellites minus the INS, from
    /// GNSS alone, and the sums of their squared dilutions.
    fn fix(&self, epoch: &Epoch<'_>) -> ([[f64; 4]; 2], [f64; 2]) {
        let flagged = |k: usize| self.flagged(epoch, k);
        let (place, wide) = solve(&self.dev.range, &self.dev.sight, flagged);
        let (speed, broad) = solve(&self.dev.rate, &self.dev.sight, flagged);
        ([place, speed], [wide, broad])
    }
}

/// Median interval between epochs, s.
fn typical(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times
        .windows(2)
        .map(|w| w[1] - w[0])
        .filter(|s| *s > 0.0)
        .collect();
    steps.sort_unstable_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0)
}
