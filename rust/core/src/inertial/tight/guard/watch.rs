//! What speaks for all satellites while none is used.

use super::{Action, Evidence, Rules};

/// Since when what has lasted, s.
#[derive(Debug, Clone, Copy, Default)]
pub struct Watch {
    /// All agree with one another and with the INS, but perhaps for the clock.
    near: Option<f64>,
    /// So they do, and the clock clearly does not.
    clock_off: Option<f64>,
    /// They do so, clock and all, after a step back.
    stepped: Option<f64>,
    /// When the fix stepped against the INS last.
    jumped: Option<f64>,
    /// Whether the clock agrees too.
    clock: bool,
}

impl Watch {
    /// Takes an epoch after the alarm at `alarmed`.
    pub fn push(&mut self, seen: &Evidence, r: &Rules, alarmed: f64) {
        let Some(said) = seen.agreement else {
            (self.near, self.clock_off, self.stepped) = (None, None, None);
            return;
        };
        let mutual = said.mutual < r.inside;
        let position = mutual && said.position < r.near;
        self.clock = mutual && said.inertial < r.near;
        lasts(&mut self.near, position || self.clock, seen.time);
        let off = position && said.inertial > said.position + r.outside;
        lasts(&mut self.clock_off, off, seen.time);
        if seen.jump > r.jump && seen.time - alarmed > r.after_alarm {
            self.jumped = Some(seen.time);
        }
        let recent = self.jumped.is_some_and(|j| seen.time - j <= r.settles);
        let back = self.clock && (recent || self.stepped.is_some());
        lasts(&mut self.stepped, back, seen.time);
    }

    /// What all have deserved by now, if anything.
    pub fn pardon(&self, seen: &Evidence, r: &Rules, alarmed: f64) -> Option<Action> {
        let over = |since: Option<f64>, dwell: f64| since.is_some_and(|s| seen.time - s >= dwell);
        if over(self.stepped, r.dwell_after_step) {
            return Some(Action::Readmit);
        }
        let age = seen.time - alarmed;
        if age > r.pardon {
            return None;
        }
        // The uncertainty of the INS grows over slow drags: agreement alone does not acquit.
        let doubtful = seen.acquits && !seen.confirmed && age >= r.doubt;
        let acquitted = doubtful && over(self.near, r.dwell);
        if acquitted && self.clock {
            return Some(Action::Readmit);
        }
        let clock_off = acquitted || over(self.clock_off, r.dwell_satellite);
        clock_off.then_some(Action::ReadmitWithClock)
    }
}

fn lasts(since: &mut Option<f64>, still: bool, now: f64) {
    *since = still.then(|| since.unwrap_or(now));
}
