//! What happens at an epoch: measurements are used or left out, tests are formed, the guard acts.

use nalgebra::Vector3;

use super::alarms::TESTS;
use super::copies::Copies;
use super::covariance::Transition;
use super::epoch::{usual_interval, Deviations, Epoch, Kind};
use super::fix::solve;
use super::guard::{Action, Alarm, Evidence, Guard, Rules, State};
use super::hearing::Hearing;
use super::monitors::Monitors;
use super::navigator::Navigator;
use super::output::{Event, Output, Usage};
use super::settings::{Mode, Settings};
use super::shadow::Shadow;
use super::statistics::Panel;
use super::step::Steps;
use super::windows::CLIP;

/// Copies are not renewed while a test is over this part of its threshold.
const SUSPICION: f64 = 0.75;

/// Everything around the navigator.
pub struct Supervisor {
    settings: Settings,
    guard: Guard,
    copies: Copies,
    monitors: Monitors,
    panel: Panel,
    shadow: Shadow,
    steps: Steps,
    jump: f64,
    hearing: Hearing,
    dev: Deviations,
    innovations: [Vec<f64>; 3],
    usage: Vec<Usage>,
    cn0: Vec<f64>,
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
        let interval = usual_interval(times);
        Supervisor {
            settings: settings.clone(),
            guard: Guard::new(rules, start, satellites),
            copies: Copies::new(&navigator.filter.navigation(), start),
            monitors: Monitors::new(interval, satellites),
            panel: Panel::new(settings.published, satellites),
            shadow: Shadow::new(&navigator.filter, interval, satellites),
            steps: Steps::new(interval, &settings.receiver),
            jump: 0.0,
            hearing: Hearing::new(interval, satellites),
            dev: Deviations::new(satellites),
            innovations: std::array::from_fn(|_| vec![f64::NAN; satellites]),
            usage: vec![Usage::Missing; satellites],
            cn0: vec![f64::NAN; satellites],
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
                || self.settings.testing.flags(epoch, k)
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

    /// Lets the shadow see the epoch.
    fn follow(&mut self, nav: &Navigator, epoch: &Epoch<'_>) {
        if !self.guard.blind() {
            self.shadow.end();
        }
        let testing = &self.settings.testing;
        self.shadow.follow(nav, epoch, &self.dev, testing);
    }

    /// Deviates of all tests.
    fn test(&mut self, nav: &Navigator, epoch: &Epoch<'_>) {
        for k in 0..self.cn0.len() {
            let heard = self.guard.uses(k) && !self.settings.testing.flags(epoch, k);
            self.cn0[k] = if heard { epoch.cn0[k] } else { f64::NAN };
        }
        self.monitors.push(&self.innovations, &self.cn0);
        let now = nav.filter.navigation();
        let slack = self.settings.testing.slack;
        self.monitors.compare(&self.copies, &now, slack);
    }

    fn judge(&mut self, nav: &mut Navigator, epoch: &Epoch<'_>, fix: [[f64; 3]; 2]) {
        let (worst, share) = self.monitors.worst(&self.settings.testing);
        let usable = !self.guard.blind();
        let alarm = (usable && share > 1.0).then_some(worst);
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
        let state = self.guard.state();
        if self.guard.blind() || state == State::Partial {
            let testing = &self.settings.testing;
            self.hearing.push(&self.dev, |k| testing.flags(epoch, k));
        }
        let (mut agreement, mut culprits, mut back) = (None, None, 0);
        if self.guard.blind() {
            let inertial = nav.filter.navigation();
            agreement = self.hearing.agreement(&self.dev, &inertial, &self.settings);
        } else if state == State::Partial {
            back = self.hearing.agreeing(&self.settings);
        }
        if let Some(said) = agreement.filter(|_| state == State::Deciding) {
            let most = self.settings.testing.most_excluded;
            culprits = self.hearing.culprits(&said, most);
        }
        Evidence {
            time: epoch.time,
            alarm,
            agreement,
            culprits,
            back,
            confirmed: self.shadow.confirmed(),
            acquits: self.shadow.acquits(),
            jump: self.jump,
        }
    }

    fn act(&mut self, nav: &mut Navigator, action: Action, time: f64) -> f64 {
        let mut back = 0.0;
        match action {
            Action::TakeBack(age) => {
                let chosen = self.copies.at_least(age, time).clone();
                back = time - chosen.born;
                nav.left_behind(&chosen.difference, &mut self.shadow.filter);
                self.shadow.begin();
                nav.take_back(&chosen.difference, &chosen.covariance);
                if let Some(tape) = &mut nav.filter.tape {
                    tape.take_back(chosen.born);
                }
                self.copies.taken_back(&chosen);
                self.hearing.clear();
            }
            Action::ReadmitAnew => {
                // Where the INS is off it is put right at once: it must not alarm again.
                if let Some((errors, covariance)) = self.shadow.finding() {
                    nav.take_back(&errors, &covariance);
                    if let Some(tape) = &mut nav.filter.tape {
                        tape.begin_anew();
                    }
                }
                nav.lose_clock();
                self.copies.renew_all(&nav.filter.navigation(), time);
                self.monitors.rebase();
            }
            Action::Readmit => self.monitors.rebase(),
            Action::Exclude(_) | Action::Coast | Action::None => (),
        }
        self.monitors.clear();
        back
    }

    fn log(&mut self, time: f64, alarm: Option<Alarm>, back: f64, fix: [[f64; 3]; 2]) {
        self.output.events.push(Event {
            time,
            state: self.guard.state(),
            test: alarm.map_or(-1, |a| a.test as i32),
            deviate: alarm.map_or(f64::NAN, |a| self.monitors.deviates[a.test]),
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
        self.output.deviates.extend(self.monitors.deviates);
        self.output.state.push(self.guard.state() as u8);
        if self.detailed {
            self.output
                .usage
                .extend(self.usage.iter().map(|u| *u as u8));
        }
    }

    /// Least-squares position and clock, velocity and drift of all satellites minus the INS, from
    /// GNSS alone, and the sums of their squared dilutions.
    fn fix(&self, epoch: &Epoch<'_>) -> ([[f64; 4]; 2], [f64; 2]) {
        let flagged = |k: usize| self.settings.testing.flags(epoch, k);
        let (place, wide) = solve(&self.dev.range, &self.dev.sight, flagged);
        let (speed, broad) = solve(&self.dev.rate, &self.dev.sight, flagged);
        ([place, speed], [wide, broad])
    }
}
