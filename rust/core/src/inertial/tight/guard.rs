//! Who is trusted: the state machine of exclusion, re-admission and return to a trusted copy.
//!
//! Pure logic: it sees what the tests say of an epoch and answers what is to be done. The diagram
//! is in `docs/design.md`.

use self::watch::Watch;
use super::decide::Agreement;

mod rules;
mod watch;

pub use rules::Rules;

/// States of the guard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// The filter settles; nothing is tested.
    Starting = 0,
    /// All satellites are used.
    Trusted = 1,
    /// After an alarm: back at a trusted copy, no GNSS; which satellites are wrong?
    Deciding = 2,
    /// Some satellites are left out.
    Partial = 3,
    /// All are.
    Coasting = 4,
}

/// A test that alarmed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alarm {
    /// Its number.
    pub test: usize,
    /// How old a copy must be to be trusted, s.
    pub age: f64,
}

/// What an epoch says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// s.
    pub time: f64,
    /// Of the first test over its threshold.
    pub alarm: Option<Alarm>,
    /// Of all satellites, if there are enough means.
    pub agreement: Option<Agreement>,
    /// Without whom all others agree.
    pub culprits: Option<u64>,
    /// Excluded satellites that agree with the filter now.
    pub back: u64,
    /// Step of the fix against the INS in standard deviations.
    pub jump: f64,
    /// What came since the alarm is an alarm of its own.
    pub confirmed: bool,
    /// What came since the alarm is what comes without an attack.
    pub acquits: bool,
}

/// What is to be done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Nothing.
    None,
    /// Go back to a copy of at least this age and use no GNSS.
    TakeBack(f64),
    /// Use all but these.
    Exclude(u64),
    /// Use all satellites again.
    Readmit,
    /// The same; the clock is to be found anew.
    ReadmitWithClock,
    /// Go on without GNSS: nobody is exonerated.
    Coast,
}

/// The state machine.
#[derive(Debug, Clone)]
pub struct Guard {
    rules: Rules,
    start: f64,
    state: State,
    excluded: u64,
    alarmed: f64,
    named: (u64, usize),
    /// Since when each excluded satellite agrees.
    back: Vec<Option<f64>>,
    watch: Watch,
}

impl Guard {
    /// From a time on, for so many satellites.
    pub fn new(rules: Rules, start: f64, satellites: usize) -> Self {
        Guard {
            rules,
            start,
            state: State::Starting,
            excluded: 0,
            alarmed: f64::NAN,
            named: (0, 0),
            back: vec![None; satellites],
            watch: Watch::default(),
        }
    }

    /// Now.
    pub fn state(&self) -> State {
        self.state
    }

    /// Whether no GNSS is used.
    pub fn blind(&self) -> bool {
        matches!(self.state, State::Deciding | State::Coasting)
    }

    /// Whether a satellite is used.
    pub fn uses(&self, satellite: usize) -> bool {
        !self.blind() && self.excluded >> satellite & 1 == 0
    }

    /// Satellites that are left out by themselves.
    pub fn excluded(&self) -> u64 {
        self.excluded
    }

    /// Takes what an epoch says.
    pub fn step(&mut self, seen: &Evidence) -> Action {
        match self.state {
            State::Starting => self.starting(seen),
            State::Trusted => self.trusted(seen),
            State::Partial => self.partial(seen),
            State::Deciding => self.deciding(seen),
            State::Coasting => self.coasting(seen),
        }
    }

    fn starting(&mut self, seen: &Evidence) -> Action {
        if seen.time - self.start >= self.rules.settle {
            self.state = State::Trusted;
        }
        Action::None
    }

    fn trusted(&mut self, seen: &Evidence) -> Action {
        match seen.alarm {
            Some(alarm) => self.raise(alarm, seen.time),
            None => Action::None,
        }
    }

    fn raise(&mut self, alarm: Alarm, time: f64) -> Action {
        self.state = State::Deciding;
        self.excluded = 0;
        self.alarmed = time;
        self.named = (0, 0);
        self.watch = Watch::default();
        self.back.fill(None);
        Action::TakeBack(alarm.age)
    }

    fn partial(&mut self, seen: &Evidence) -> Action {
        if let Some(alarm) = seen.alarm {
            return self.raise(alarm, seen.time);
        }
        let mut still = self.excluded;
        for (k, since) in self.back.iter_mut().enumerate() {
            let agrees = self.excluded & seen.back & 1 << k != 0;
            *since = agrees.then(|| since.unwrap_or(seen.time));
            if since.is_some_and(|s| seen.time - s >= self.rules.dwell_satellite) {
                still &= !(1 << k);
            }
        }
        if still == self.excluded {
            return Action::None;
        }
        self.excluded = still;
        if still != 0 {
            return Action::Exclude(still);
        }
        self.readmit(Action::Readmit)
    }

    fn deciding(&mut self, seen: &Evidence) -> Action {
        self.watch.push(seen, &self.rules, self.alarmed);
        if let Some(action) = self.pardoned(seen) {
            return action;
        }
        if let Some(mask) = self.convicted(seen) {
            self.state = State::Partial;
            self.excluded = mask;
            return Action::Exclude(mask);
        }
        if seen.time - self.alarmed > self.rules.decision {
            self.state = State::Coasting;
            return Action::Coast;
        }
        Action::None
    }

    fn coasting(&mut self, seen: &Evidence) -> Action {
        self.watch.push(seen, &self.rules, self.alarmed);
        self.pardoned(seen).unwrap_or(Action::None)
    }

    /// The subset that is named often enough in a row.
    fn convicted(&mut self, seen: &Evidence) -> Option<u64> {
        self.named = match seen.culprits {
            Some(mask) if mask == self.named.0 => (mask, self.named.1 + 1),
            Some(mask) => (mask, 1),
            None => (0, 0),
        };
        let ripe = seen.time - self.alarmed >= self.rules.least_decision;
        (ripe && self.named.1 >= self.rules.confirmations).then_some(self.named.0)
    }

    fn pardoned(&mut self, seen: &Evidence) -> Option<Action> {
        let action = self.watch.pardon(seen, &self.rules, self.alarmed)?;
        Some(self.readmit(action))
    }

    fn readmit(&mut self, action: Action) -> Action {
        self.state = State::Trusted;
        self.excluded = 0;
        action
    }
}

#[cfg(test)]
mod tests;
