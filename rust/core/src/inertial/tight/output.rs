//! What comes out of a run, a row an epoch.

use super::guard::State;
use super::smooth::Smoothed;
use super::statistics::{Forms, Panel};
use super::subsets::Apart;
use super::{ATTITUDE, CLOCK, POSITION, VELOCITY};

/// What a satellite's measurements were used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Usage {
    /// There were none.
    Missing = 0,
    /// They moved the solution.
    Used = 1,
    /// So they did, weighted down.
    Weakened = 2,
    /// Left out.
    Excluded = 3,
}

/// Something that the guard did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// s.
    pub time: f64,
    /// State that it led to.
    pub state: State,
    /// Test that alarmed, -1 where none did.
    pub test: i32,
    /// Its deviate.
    pub deviate: f64,
    /// Satellites left out, a bit each; all bits: all.
    pub excluded: u64,
    /// How far the navigator went back in time, s; 0: it did not.
    pub back: f64,
    /// Distance of the fix from the INS, m; NaN without a fix.
    pub apart: f64,
}

/// Columns of all epochs; `satellites` values a row where there is one for each.
#[derive(Debug, Clone, Default)]
pub struct Output {
    /// Whether there was an IMU to navigate with.
    pub valid: Vec<bool>,
    /// Latitude, longitude in rad, height in m.
    pub place: Vec<[f64; 3]>,
    /// North, east, down, m/s.
    pub velocity: Vec<[f64; 3]>,
    /// Yaw, pitch, roll, rad.
    pub attitude: Vec<[f64; 3]>,
    /// Of position (m^2), velocity and attitude: 3 x 3 each, north, east, down.
    pub covariance: Vec<[f64; 27]>,
    /// Clock in m and drift in m/s.
    pub clock: Vec<[f64; 2]>,
    /// Of gyros and accelerometers.
    pub bias: Vec<[f64; 6]>,
    /// Predicted minus measured, and its standard deviation, of pseudoranges.
    pub range: Vec<[f64; 2]>,
    /// Of rates.
    pub rate: Vec<[f64; 2]>,
    /// What each satellite was used for.
    pub usage: Vec<u8>,
    /// Statistics of position and velocity, undivided.
    pub solution: Vec<[Forms; 2]>,
    /// Of pseudorange and rate of each satellite.
    pub channel: Vec<[Forms; 2]>,
    /// Verdict of the publication, and share of the statistics over 1.
    pub threat: Vec<(u8, f64)>,
    /// Deviate of every test.
    pub deviates: Vec<f64>,
    /// Tests a row.
    pub tests: usize,
    /// State of the guard.
    pub state: Vec<u8>,
    /// What it did.
    pub events: Vec<Event>,
    /// From all that was measured before and after each epoch, if it was asked for.
    pub smoothed: Option<Smoothed>,
    /// Filters without each satellite against the whole one; none unless they were asked for.
    pub apart: Vec<Apart>,
}

impl Output {
    /// Room for so many epochs and satellites; columns of satellites only if `detailed`.
    pub fn with_capacity(epochs: usize, satellites: usize, tests: usize, detailed: bool) -> Self {
        let cells = if detailed { epochs * satellites } else { 0 };
        Output {
            valid: Vec::with_capacity(epochs),
            place: Vec::with_capacity(epochs),
            velocity: Vec::with_capacity(epochs),
            attitude: Vec::with_capacity(epochs),
            covariance: Vec::with_capacity(epochs),
            clock: Vec::with_capacity(epochs),
            bias: Vec::with_capacity(epochs),
            range: Vec::with_capacity(cells),
            rate: Vec::with_capacity(cells),
            usage: Vec::with_capacity(cells),
            solution: Vec::with_capacity(epochs),
            channel: Vec::with_capacity(cells),
            threat: Vec::with_capacity(epochs),
            deviates: Vec::with_capacity(epochs * tests),
            tests,
            state: Vec::with_capacity(epochs),
            events: Vec::new(),
            smoothed: None,
            apart: Vec::new(),
        }
    }

    /// An epoch without IMU.
    pub fn push_nothing(&mut self, satellites: usize, detailed: bool) {
        let nan = f64::NAN;
        self.valid.push(false);
        self.place.push([nan; 3]);
        self.velocity.push([nan; 3]);
        self.attitude.push([nan; 3]);
        self.covariance.push([nan; 27]);
        self.clock.push([nan; 2]);
        self.bias.push([nan; 6]);
        self.solution.push([[nan; 3]; 2]);
        self.threat.push((0, nan));
        self.deviates.extend((0..self.tests).map(|_| nan));
        self.state.push(State::Starting as u8);
        if detailed {
            self.usage
                .extend((0..satellites).map(|_| Usage::Missing as u8));
            self.range.extend((0..satellites).map(|_| [nan; 2]));
            self.rate.extend((0..satellites).map(|_| [nan; 2]));
            self.channel.extend((0..satellites).map(|_| [[nan; 3]; 2]));
        }
    }

    /// Where the navigator is.
    pub fn push_navigator(&mut self, navigator: &super::navigator::Navigator) {
        let state = navigator.state();
        let (roll, pitch, yaw) = state.attitude.euler_angles();
        let [gyro, force] = navigator.biases();
        self.valid.push(true);
        self.place.push([
            state.place.latitude,
            state.place.longitude,
            state.place.height,
        ]);
        self.velocity.push(state.velocity.into());
        self.attitude.push([yaw, pitch, roll]);
        self.clock.push(navigator.clock());
        self.bias
            .push([gyro.x, gyro.y, gyro.z, force.x, force.y, force.z]);
        let (p, n) = (&navigator.filter.p, navigator.filter.layout.count);
        debug_assert!(CLOCK < n);
        let mut flat = [0.0; 27];
        for (block, first) in [POSITION, VELOCITY, ATTITUDE].into_iter().enumerate() {
            for row in 0..3 {
                for column in 0..3 {
                    flat[9 * block + 3 * row + column] = p[(first + row) * n + first + column];
                }
            }
        }
        self.covariance.push(flat);
    }

    /// The published statistics.
    pub fn push_panel(&mut self, panel: &Panel, detailed: bool) {
        let (threat, share) = panel.verdict();
        self.threat.push((threat as u8, share));
        self.solution.push(panel.solution);
        if detailed {
            let pairs = panel.range.iter().zip(&panel.rate);
            self.channel
                .extend(pairs.map(|(range, rate)| [*range, *rate]));
        }
    }
}
