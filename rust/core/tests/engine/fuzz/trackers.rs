//! Settings and samples of a tracker.

use sdr_spoof_core::simd::Level;
use sdr_spoof_core::track::config::TrackConfig;
use sdr_spoof_core::track::engine::{Input as Recording, Target, Tracker};
use sdr_spoof_core::track::epoch::Seed;
use sdr_spoof_core::Result;

use super::input::Input;
use crate::format::FORMATS;
use crate::tracker::{tracked, Rows};

const SIGNALS: [&str; 5] = ["L1CA", "B1I", "B1CP", "B1CD", "E1B"];

struct Case {
    recording: Recording,
    config: TrackConfig,
    targets: Vec<Target>,
    /// To restart what is lost, half-way.
    again: Seed,
    samples: Vec<u8>,
}

impl Input<'_> {
    fn seed(&mut self) -> Seed {
        Seed {
            sample: self.below(1 << 16) as u64,
            doppler_hz: self.number(-2e4..2e4),
            code_delay_s: self.number(0.0..0.01),
        }
    }

    fn case(&mut self) -> Case {
        let format = FORMATS[self.below(FORMATS.len())];
        let bits = format.parsed().bits_per_sample();
        let targets = 1 + self.below(3);
        Case {
            recording: Recording {
                format: format.parsed(),
                conjugate: format.conjugate,
                float_scale: self.number(0.1..200.0) as f32,
                sample_rate_hz: self.number(1.5e6..6e6),
                lo_hz: self.number(1559e6..1577e6),
                start: (self.below(1 << 16) * [1, 1 << 24][self.below(2)]) as u64,
            },
            config: TrackConfig {
                pll_bandwidth_hz: self.number(1.0..12.0),
                dll_bandwidth_hz: self.number(0.1..12.0),
                integration_ms: [1, 2, 4, 5, 10, 20][self.below(6)],
                cn0_min_dbhz: self.number(0.0..40.0),
                qmboc: self.chance(128),
                combo: self.chance(128),
                data_component: self.chance(128),
                ..TrackConfig::default()
            },
            targets: (0..targets)
                .map(|_| Target {
                    signal: SIGNALS[self.below(SIGNALS.len() - usize::from(!self.wild()))].into(),
                    prn: 19 + self.below(8) as u16,
                    seed: self.seed(),
                })
                .collect(),
            again: self.seed(),
            samples: self.samples(60_000 * bits / 8 * 4),
        }
    }
}

impl Case {
    fn rows(&self, threads: usize, level: Level, cut: usize) -> Result<Rows> {
        let Case {
            recording,
            config,
            targets,
            ..
        } = self;
        let mut tracker = Tracker::with_level(recording.clone(), config, targets, threads, level)?;
        let (first, second) = self.samples.split_at(self.samples.len() / 2);
        tracked(&mut tracker, first, cut);
        for (signal, prn, _) in tracker.lost() {
            let seed = self.again;
            // What the seed is worth is for the tracker to say.
            let _ = tracker.restart(&Target { signal, prn, seed });
        }
        Ok(tracked(&mut tracker, second, cut))
    }
}

/// No panic, and the same rows for any threads, cut and level.
pub fn tracker(bytes: &[u8]) {
    let mut input = Input::new(bytes);
    let case = input.case();
    let (threads, cut) = (1 + input.below(4), 32 * (1 + input.below(500)));
    let whole = case.rows(1, Level::Portable, usize::MAX);
    assert!(
        whole == case.rows(threads, Level::best(), cut),
        "other rows: {:?}",
        case.targets
    );
}
