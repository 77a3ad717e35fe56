//! What speaks for all satellites while none is used.

use super::{Action, Evidence, Rules};

/// Since when what has lasted, s.
#[derive(Debug, Clone, Copy, Default)]
pub struct Watch {
    /// All agree with one another.
    mutual: Option<f64>,
    /// They do so with the INS too, but perhaps for the clock.
    near: Option<f64>,
    /// So they do, and the clock clearly does not.
    clock_off: Option<f64>,
    /// They do so, clock and all, after a step back.
    stepped: Option<f64>,
    /// When the fix stepped against the INS last.
    jumped: Option<f64>,
    /// When they agreed after it last.
    landed: Option<f64>,
    /// Whether the clock agrees too.
    clock: bool,
}

impl Watch {
    /// Takes an epoch after the alarm at `alarmed`.
    pub fn push(&mut self, seen: &Evidence, r: &Rules, alarmed: f64) {
        let Some(said) = seen.agreement else {
            *self = Watch {
                jumped: self.jumped,
                landed: self.landed,
                ..Watch::default()
            };
            return;
        };
        let mutual = said.mutual < r.inside;
        lasts(&mut self.mutual, mutual, seen.time);
        let position = mutual && said.position < r.near;
        self.clock = mutual && said.inertial < r.near;
        lasts(&mut self.near, position || self.clock, seen.time);
        let off = position && said.inertial > said.position + r.outside;
        lasts(&mut self.clock_off, off, seen.time);
        if seen.jump > r.jump && seen.time - alarmed > r.after_alarm {
            self.jumped = Some(seen.time);
        }
        // A step comes once: an epoch out of place delays the return, and does not undo the step.
        let recent = |when: Option<f64>| when.is_some_and(|t| seen.time - t <= r.settles);
        let back = self.clock && (recent(self.jumped) || recent(self.landed));
        if back {
            self.landed = Some(seen.time);
        }
        lasts(&mut self.stepped, back, seen.time);
    }

    /// What all have deserved by now, if anything.
    pub fn pardon(&self, seen: &Evidence, r: &Rules, alarmed: f64) -> Option<Action> {
        let over = |since: Option<f64>, dwell: f64| since.is_some_and(|s| seen.time - s >= dwell);
        if over(self.stepped, r.dwell_after_step) {
            return Some(Action::Readmit);
        }
        let age = seen.time - alarmed;
        // The uncertainty of the INS grows over slow drags: agreement alone does not acquit.
        let doubtful = seen.acquits && !seen.confirmed && age >= r.doubt;
        let acquitted = doubtful && over(self.near, r.dwell);
        if acquitted && self.clock {
            return Some(Action::Readmit);
        }
        // Whether it is the INS that is off, as it was at the alarm: nothing has been added since.
        let lapsed = doubtful && age >= r.pardon && over(self.mutual, r.dwell);
        let clock_off = age <= r.pardon && over(self.clock_off, r.dwell_satellite);
        (acquitted || lapsed || clock_off).then_some(Action::ReadmitAnew)
    }
}

fn lasts(since: &mut Option<f64>, still: bool, now: f64) {
    *since = still.then(|| since.unwrap_or(now));
}
