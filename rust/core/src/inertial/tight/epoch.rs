//! One epoch: what is measured, and what it deviates from the navigator.

use nalgebra::Vector3;

use super::measure::Sight;

/// What one epoch brings, a column a satellite; NaN where there is none.
#[derive(Debug, Clone, Copy)]
pub struct Epoch<'a> {
    /// System time, s.
    pub time: f64,
    /// Earth-fixed places of the satellites, m.
    pub place: &'a [[f64; 3]],
    /// m/s.
    pub velocity: &'a [[f64; 3]],
    /// m.
    pub range: &'a [f64],
    /// m/s.
    pub rate: &'a [f64],
    /// Since the epoch before, m.
    pub change: &'a [f64],
    /// dB-Hz.
    pub cn0: &'a [f64],
    /// Whether the receiver calls it spoofed.
    pub spoofed: &'a [bool],
    /// Number of its system.
    pub system: &'a [usize],
}

/// Predicted minus measured of all satellites before any of them was used.
#[derive(Debug, Clone)]
pub struct Deviations {
    /// As seen from the antenna.
    pub sight: Vec<Sight>,
    /// m.
    pub range: Vec<f64>,
    /// m/s.
    pub rate: Vec<f64>,
    /// m.
    pub change: Vec<f64>,
    /// Factor of the variances.
    pub scale: Vec<f64>,
    /// Unit vectors of the epoch before, local axes.
    pub before: Vec<Vector3<f64>>,
}

impl Deviations {
    /// For so many satellites.
    pub fn new(satellites: usize) -> Self {
        let sight = Sight {
            range: f64::NAN,
            rate: f64::NAN,
            towards: Vector3::zeros(),
            turning: Vector3::zeros(),
        };
        Deviations {
            sight: vec![sight; satellites],
            range: vec![f64::NAN; satellites],
            rate: vec![f64::NAN; satellites],
            change: vec![f64::NAN; satellites],
            scale: vec![1.0; satellites],
            before: vec![Vector3::zeros(); satellites],
        }
    }
}

/// Which kind of measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Range rate.
    Rate,
    /// Change by carrier phase.
    Change,
    /// Pseudorange.
    Range,
}

/// Median interval between epochs, s.
pub fn usual_interval(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times
        .windows(2)
        .map(|w| w[1] - w[0])
        .filter(|s| *s > 0.0)
        .collect();
    steps.sort_unstable_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0)
}
