//! How long and how well satellites must agree.

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
    /// An alarm lapses after so long if nothing was added to it.
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
    /// After a step back, and after an interruption of the agreement, all agree within so long.
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
            pardon: 300.0,
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
