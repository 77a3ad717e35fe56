//! Do the pseudoranges agree? Chi-square test of the residuals, exclusion of the worst satellite.
//!
//! Source: Parkinson and Axelrad, "Autonomous GPS integrity monitoring using the pseudorange
//! residual", Navigation 35 (1988) 255; exclusion by the largest fall of the square sum, which for
//! one signal per satellite is the largest normalised residual (Baarda 1968).

use nalgebra::{DMatrix, DVector, Vector3};

use super::least_squares::{inverse_normal, solve, Failure, Solution};
use super::measurement::{Measurement, Settings};

/// What the test says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The residuals are as noise makes them.
    Passed,
    /// They are not, and no satellite that could be left out explains it.
    Failed,
    /// There is no satellite more than needed.
    Unchecked,
}

/// A solution with what RAIM says of it.
#[derive(Debug, Clone)]
pub struct Checked {
    /// Without the satellites left out.
    pub solution: Solution,
    /// Of the satellites that are left.
    pub verdict: Verdict,
    /// Satellites left out.
    pub excluded: Vec<usize>,
}

/// Solves and checks; leaves out the worst satellite as long as the test fails and the rest can
/// still be checked (6 satellites at first, 7 with two systems).
///
/// # Errors
/// As [`solve`].
pub fn solve_checked(
    measurements: &[Measurement],
    start: Vector3<f64>,
    gpst_s: f64,
    settings: &Settings,
) -> Result<Checked, Failure> {
    let mut solution = solve(measurements, start, gpst_s, settings)?;
    let (mut kept, mut excluded) = (measurements.to_vec(), Vec::new());
    let mut verdict = test(&solution, settings);
    while verdict == Verdict::Failed && excluded.len() < settings.exclusions {
        let Some(worst) = worst_satellite(&solution) else {
            break;
        };
        kept.retain(|m| m.satellite != worst);
        let Ok(without) = solve(&kept, solution.position, gpst_s, settings) else {
            break;
        };
        if !without.checkable() {
            break;
        }
        excluded.push(worst);
        solution = without;
        verdict = test(&solution, settings);
    }
    // What did not help is not left out: the full set says more clearly that something is wrong.
    if verdict == Verdict::Failed && !excluded.is_empty() {
        excluded.clear();
        solution = solve(measurements, start, gpst_s, settings)?;
    }
    Ok(Checked {
        solution,
        verdict,
        excluded,
    })
}

fn test(solution: &Solution, settings: &Settings) -> Verdict {
    if !solution.checkable() {
        return Verdict::Unchecked;
    }
    let most = settings.threshold(solution.freedom());
    if solution.square_sum() <= most {
        Verdict::Passed
    } else {
        Verdict::Failed
    }
}

/// The satellite without which the square sum is least; `None` where two satellites or fewer than
/// two spare ones leave the choice open.
fn worst_satellite(solution: &Solution) -> Option<usize> {
    let mut satellites = solution.satellites.clone();
    satellites.sort_unstable();
    satellites.dedup();
    if satellites.len() < solution.unknowns.satellites() + 2 {
        return None;
    }
    let sums = satellites
        .iter()
        .filter_map(|s| Some((square_sum_without(solution, *s)?, *s)));
    sums.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, s)| s)
}

/// Square sum of the linearised problem without a satellite; `None` where the rest does not
/// determine the unknowns.
fn square_sum_without(solution: &Solution, satellite: usize) -> Option<f64> {
    let rows: Vec<usize> = (0..solution.satellites.len())
        .filter(|r| solution.satellites[*r] != satellite)
        .collect();
    let design: DMatrix<f64> = solution.design.select_rows(&rows);
    let residuals: DVector<f64> = solution.residuals.select_rows(&rows);
    let weights: DVector<f64> = solution.weights.select_rows(&rows);
    // A system of one satellite loses its clock with it: that column is then empty.
    let columns: Vec<usize> = (0..design.ncols())
        .filter(|c| design.column(*c).amax() > 0.0)
        .collect();
    let design = design.select_columns(&columns);
    let covariance = inverse_normal(&design, &weights)?;
    let step = covariance * design.tr_mul(&weights.component_mul(&residuals));
    let left = residuals - design * step;
    Some(left.iter().zip(&weights).map(|(r, w)| r * r * w).sum())
}
