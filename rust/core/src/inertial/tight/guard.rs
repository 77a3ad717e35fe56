//! Who is trusted: the state machine of exclusion, re-admission and return to a trusted copy.
//!
//! Pure logic: it sees what the tests say of an epoch and answers what is to be done. The diagram
//! is in `docs/design.md`.

use super::decide::Agreement;

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
    /// The tests have gone on growing since the alarm.
    pub confirmed: bool,
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

/// Time, s, and size constants of the rules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// No test before.
    pub settle: f64,
    /// Least time before a subset is named.
    pub least_decision: f64,
    /// A subset must be named so many times in a row.
    pub confirmations: usize,
    /// When the search for a subset ends.
    pub decision: f64,
    /// A return by a step counts from so long after the alarm.
    pub after_alarm: f64,
    /// How long all must agree after a step back.
    pub dwell_after_step: f64,
    /// How long all must agree for the alarm to have been false.
    pub dwell: f64,
    /// An alarm may turn out to be false so long.
    pub pardon: f64,
    /// It takes so long for an alarm to be confirmed.
    pub doubt: f64,
    /// How long an excluded satellite must agree.
    pub dwell_satellite: f64,
    /// Satellites agree with one another below this deviate.
    pub inside: f64,
    /// Agreement of everything: the INS alone may be further off than once in a hundred times.
    pub near: f64,
    /// The clock alone is off if agreement without it is better by this.
    pub outside: f64,
    /// A step of the fix against the INS is at least so many standard deviations.
    pub jump: f64,
    /// After a step back all agree within so long.
    pub settles: f64,
}

impl Default for Rules {
    fn default() -> Self {
        Rules {
            settle: 60.0,
            least_decision: 5.0,
            confirmations: 3,
            decision: 60.0,
            after_alarm: 10.0,
            dwell_after_step: 20.0,
            dwell: 40.0,
            pardon: 600.0,
            doubt: 150.0,
            dwell_satellite: 20.0,
            inside: 3.33,
            near: 3.5,
            outside: 4.0,
            jump: 7.0,
            settles: 20.0,
        }
    }
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
    /// Since when all agree, position only, and each excluded satellite.
    inside: Option<f64>,
    inside_position: Option<f64>,
    back: Vec<Option<f64>>,
    /// When the fix stepped against the INS last.
    jumped: f64,
    /// Since when all are near after a step back.
    stepped: Option<f64>,
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
            inside: None,
            inside_position: None,
            back: vec![None; satellites],
            jumped: f64::NEG_INFINITY,
            stepped: None,
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
        (self.inside, self.inside_position) = (None, None);
        (self.jumped, self.stepped) = (f64::NEG_INFINITY, None);
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
        self.watch(seen);
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
        self.watch(seen);
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

    /// Notes since when all satellites agree with the INS, and whether they came back by a step.
    fn watch(&mut self, seen: &Evidence) {
        let Some(said) = seen.agreement else {
            (self.inside, self.inside_position, self.stepped) = (None, None, None);
            return;
        };
        let r = self.rules;
        let mutual = said.mutual < r.inside;
        let inside = mutual && said.inertial < r.near;
        self.inside = inside.then(|| self.inside.unwrap_or(seen.time));
        let clock_alone =
            mutual && said.position < r.near && said.inertial > said.position + r.outside;
        self.inside_position = clock_alone.then(|| self.inside_position.unwrap_or(seen.time));
        if seen.jump > r.jump && seen.time - self.alarmed > r.after_alarm {
            self.jumped = seen.time;
        }
        let recent = seen.time - self.jumped <= r.settles;
        self.stepped = match self.stepped {
            _ if !inside => None,
            None if recent => Some(seen.time),
            since => since,
        };
    }

    fn pardoned(&mut self, seen: &Evidence) -> Option<Action> {
        let (r, time) = (self.rules, seen.time);
        let lasts = |since: Option<f64>| since.map_or(-1.0, |s| time - s);
        let early = time - self.alarmed <= r.pardon;
        // The uncertainty of the INS grows over slow drags: agreement alone does not acquit.
        let doubtful = !seen.confirmed && time - self.alarmed >= r.doubt;
        let (all, clock) = (lasts(self.inside), lasts(self.inside_position));
        if lasts(self.stepped) >= r.dwell_after_step || early && doubtful && all >= r.dwell {
            return Some(self.readmit(Action::Readmit));
        }
        if early && clock >= r.dwell_satellite {
            return Some(self.readmit(Action::ReadmitWithClock));
        }
        None
    }

    fn readmit(&mut self, action: Action) -> Action {
        self.state = State::Trusted;
        self.excluded = 0;
        action
    }
}

#[cfg(test)]
mod tests;
