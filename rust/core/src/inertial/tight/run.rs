//! A whole recording: increments and epochs in, a row an epoch out.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::guard::Rules;
use super::navigator::Navigator;
use super::output::Output;
pub use super::recording::{ImuLog, Measured, Run, Sky};
use super::settings::Settings;
use super::smooth::smooth;
use super::subsets::Subsets;
use super::supervisor::Supervisor;
use super::tape::Tape;
use crate::inertial::errors::ErrorStream;
use crate::inertial::Increment;
use crate::{Error, Result};

/// Longest step of the filter, s.
const STEP: f64 = 1.0;
/// Times that differ by less are the same, s.
const SAME: f64 = 1e-6;
/// What an unmeasured second makes uncertain: attitude in rad, velocity in m/s.
const BLIND: [f64; 2] = [0.05, 1.0];

/// Navigates every run from `start_time` on; runs go side by side, each by itself.
#[allow(clippy::too_many_arguments)]
pub fn navigate(
    log: ImuLog<'_>,
    sky: Sky<'_>,
    runs: &[Run<'_>],
    start_time: f64,
    settings: &Settings,
    rules: Rules,
    detailed: bool,
    threads: usize,
) -> Result<Vec<Output>> {
    sky.check(runs)?;
    if log.rotation.len() != log.time.len() || log.velocity.len() != log.time.len() {
        return Err(Error::Invalid("increments differ in number".into()));
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Error::Invalid(e.to_string()))?;
    let one = |run: &Run<'_>| {
        let mut pilot = Pilot::new(log, run, start_time, settings, rules, &sky, detailed);
        pilot.fly(&sky, &run.measured);
        pilot.supervisor.output
    };
    Ok(pool.install(|| runs.par_iter().map(one).collect()))
}

/// One run on its way.
struct Pilot<'a> {
    log: ImuLog<'a>,
    errors: Option<ErrorStream>,
    settings: &'a Settings,
    navigator: Navigator,
    supervisor: Supervisor,
    now: f64,
    next: usize,
    /// The increment that is being used, with its errors.
    current: Option<Increment>,
    /// Rates of the last one, for gaps.
    last: Increment,
    detailed: bool,
}

impl<'a> Pilot<'a> {
    fn new(
        log: ImuLog<'a>,
        run: &Run<'_>,
        start: f64,
        settings: &'a Settings,
        rules: Rules,
        sky: &Sky<'_>,
        detailed: bool,
    ) -> Self {
        let systems = sky.system.iter().max().map_or(1, |m| m + 1);
        let mut navigator = Navigator::new(run.start, settings, sky.satellites(), systems);
        let mut supervisor = Supervisor::new(
            settings,
            rules,
            &navigator,
            start,
            sky.time,
            sky.satellites(),
            detailed,
        );
        // The supervisor's own filters are not recorded.
        navigator.filter.tape = settings.smooth.then(|| {
            let (epochs, filter) = (sky.time.len(), &navigator.filter);
            let count = run.measured.count();
            Box::new(Tape::new(settings, filter, start, epochs, count))
        });
        if settings.subsets {
            navigator.filter.subsets = Some(Box::new(Subsets::new(sky.satellites())));
            supervisor.output.apart = vec![[f64::NAN; 4]; sky.time.len() * sky.satellites()];
        }
        let mut errors = run.errors.map(|(e, number)| ErrorStream::new(&e, number));
        let next = log.time.partition_point(|&t| t <= start + SAME);
        if let Some(stream) = &mut errors {
            stream.skip(next, log.interval);
        }
        let still = Increment {
            rotation: Vector3::zeros(),
            velocity: -(run.start.attitude.inverse() * Vector3::new(0.0, 0.0, 9.81)) * log.interval,
            interval: log.interval,
        };
        Pilot {
            log,
            errors,
            settings,
            navigator,
            supervisor,
            now: start,
            next,
            current: None,
            last: still,
            detailed,
        }
    }

    fn fly(&mut self, sky: &Sky<'_>, measured: &Measured<'_>) {
        let mut before: Option<usize> = None;
        let begin = self.now;
        for e in 0..sky.time.len() {
            let time = sky.time[e];
            let usable = time.is_finite() && time >= begin - SAME;
            if !usable || !self.advance_to(time) {
                self.supervisor
                    .output
                    .push_nothing(sky.satellites(), self.detailed);
                continue;
            }
            self.propagate();
            let past = before.map(|b| sky.epoch(b, measured));
            let epoch = sky.epoch(e, measured);
            self.supervisor
                .epoch(&mut self.navigator, &epoch, past.as_ref());
            let state = *self.navigator.state();
            let filter = &mut self.navigator.filter;
            if let Some(tape) = &mut filter.tape {
                tape.close(e, time, state, &filter.p);
            }
            if let Some(subsets) = &filter.subsets {
                let row = &mut self.supervisor.output.apart[e * sky.satellites()..];
                row.iter_mut()
                    .zip(subsets.apart())
                    .for_each(|(a, b)| *a = b);
            }
            before = Some(e);
        }
        if let Some(tape) = &self.navigator.filter.tape {
            self.supervisor.output.smoothed = Some(smooth(tape, sky.time.len()));
        }
    }

    /// Moves the navigator to a time; false where the log has ended before.
    fn advance_to(&mut self, time: f64) -> bool {
        while self.now < time - SAME {
            if self.current.is_none() && !self.load() {
                return false;
            }
            let end = self.log.time[self.next];
            let begin = end - self.log.interval;
            let gap = begin - self.now;
            if gap > 0.5 * self.log.interval {
                self.bridge(gap.min(time - self.now).min(STEP));
            } else {
                self.use_part(end, time);
            }
            if self.navigator.elapsed() >= STEP - SAME {
                self.propagate();
            }
        }
        true
    }

    /// The next increment that can be read.
    fn load(&mut self) -> bool {
        while self.next < self.log.time.len() {
            let k = self.next;
            let mut raw = Increment {
                rotation: self.log.rotation[k].into(),
                velocity: self.log.velocity[k].into(),
                interval: self.log.interval,
            };
            if let Some(stream) = &mut self.errors {
                stream.apply(&mut raw);
            }
            let sum = raw.rotation.sum() + raw.velocity.sum();
            if sum.is_finite() && self.log.time[k] > self.now {
                self.current = Some(raw);
                return true;
            }
            self.next += 1;
        }
        false
    }

    /// As much of the current increment as fits before `time`.
    #[inline]
    fn use_part(&mut self, end: f64, time: f64) {
        let Some(raw) = self.current else { return };
        let whole = end <= time + SAME;
        let until = if whole { end } else { time };
        let length = until - self.now;
        let share = length / self.log.interval;
        let part = if whole && (share - 1.0).abs() < 0.01 {
            Increment {
                interval: length,
                ..raw
            }
        } else {
            Increment {
                rotation: raw.rotation * share,
                velocity: raw.velocity * share,
                interval: length,
            }
        };
        self.navigator.advance(&part);
        self.now = until;
        if whole {
            self.last = raw;
            self.current = None;
            self.next += 1;
        }
    }

    /// A gap: the last rates go on, with what nobody measured as uncertainty.
    fn bridge(&mut self, length: f64) {
        let share = length / self.log.interval;
        let held = Increment {
            rotation: self.last.rotation * share,
            velocity: self.last.velocity * share,
            interval: length,
        };
        let worse = if length > self.settings.bridge {
            4.0
        } else {
            1.0
        };
        let [turn, speed] = BLIND.map(|b| b * length * worse);
        self.navigator.bridge(&held, turn, speed);
        self.now += length;
    }

    fn propagate(&mut self) {
        if self.navigator.elapsed() > 0.0 {
            let step = self.navigator.predict();
            self.supervisor.predict(&step);
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
