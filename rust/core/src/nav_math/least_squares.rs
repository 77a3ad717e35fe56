//! Iterated weighted least squares of position, clocks and inter-signal biases.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::measurement::{geometry, near_ground, Correction, Measurement, Settings};
use super::SPEED_OF_LIGHT_M_S;

const MOST_STEPS: usize = 20;
const MOST_PASSES: usize = 6;
/// Corrections are computed anew where the place moved farther, m.
const MOVED_M: f64 = 0.1;
const CONVERGED_M: f64 = 1e-6;

/// Why there is no position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Fewer satellites than unknowns need.
    TooFew,
    /// Satellites stand so that the position is not determined.
    Geometry,
    /// No place fits.
    Divergence,
}

/// What each column of the design stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknowns {
    /// Systems with a clock of their own, ascending.
    pub systems: Vec<usize>,
    /// (system, group) with a bias against the system's first group, ascending.
    pub biases: Vec<(usize, usize)>,
}

impl Unknowns {
    /// Those that measurements determine.
    pub fn of(measurements: &[&Measurement]) -> Self {
        let mut kinds: Vec<_> = measurements.iter().map(|m| (m.system, m.group)).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let mut systems: Vec<usize> = kinds.iter().map(|k| k.0).collect();
        systems.dedup();
        let biases = kinds
            .windows(2)
            .filter(|k| k[0].0 == k[1].0)
            .map(|k| k[1])
            .collect();
        Self { systems, biases }
    }

    /// How many there are, with the position.
    pub fn count(&self) -> usize {
        3 + self.systems.len() + self.biases.len()
    }

    /// Satellites that they need.
    pub fn satellites(&self) -> usize {
        3 + self.systems.len()
    }

    /// Columns of a measurement's clock and bias.
    pub fn columns(&self, m: &Measurement) -> (usize, Option<usize>) {
        let clock = self
            .systems
            .iter()
            .position(|s| *s == m.system)
            .expect("its system is known");
        let bias = self.biases.iter().position(|b| *b == (m.system, m.group));
        (3 + clock, bias.map(|b| 3 + self.systems.len() + b))
    }
}

/// A solution at one epoch.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Earth-fixed, m.
    pub position: Vector3<f64>,
    /// What the entries of `values` from the fourth on are.
    pub unknowns: Unknowns,
    /// Position, clocks and biases, m.
    pub values: DVector<f64>,
    /// Of `values`.
    pub covariance: DMatrix<f64>,
    /// Columns of the observations used, in order.
    pub columns: Vec<usize>,
    /// Their satellites.
    pub satellites: Vec<usize>,
    /// Measured minus modelled, m.
    pub residuals: DVector<f64>,
    /// 1 / variance.
    pub weights: DVector<f64>,
    /// Derivatives of the measurements by the unknowns.
    pub design: DMatrix<f64>,
}

impl Solution {
    /// Weighted sum of squared residuals: chi-square with `freedom` degrees under H0.
    pub fn square_sum(&self) -> f64 {
        self.residuals
            .iter()
            .zip(&self.weights)
            .map(|(r, w)| r * r * w)
            .sum()
    }

    /// Measurements beyond the unknowns.
    pub fn freedom(&self) -> usize {
        self.design.nrows() - self.design.ncols()
    }

    /// Whether a false measurement of any one satellite could show.
    pub fn checkable(&self) -> bool {
        distinct(&self.satellites) > self.unknowns.satellites() && self.freedom() > 0
    }

    /// Covariance of the position.
    pub fn position_covariance(&self) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }
}

/// Number of different satellites.
pub fn distinct(satellites: &[usize]) -> usize {
    let mut sorted = satellites.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    sorted.len()
}

/// Finds the place that fits the pseudoranges best, from `start` (the Earth's centre will do).
///
/// # Errors
/// [`Failure`] where satellites are too few, stand badly, or no place fits.
pub fn solve(
    measurements: &[Measurement],
    start: Vector3<f64>,
    gpst_s: f64,
    settings: &Settings,
) -> Result<Solution, Failure> {
    let mut place = start;
    for _ in 0..MOST_PASSES {
        let known = near_ground(place).then_some(place);
        let model = Model::at(measurements, known, gpst_s, settings)?;
        let solution = model.converge(place)?;
        let moved = (solution.position - place).norm();
        place = solution.position;
        // Far from the ground there is nothing to correct.
        if (known.is_some() && moved < MOVED_M) || (known.is_none() && !near_ground(place)) {
            return solution.sound(settings);
        }
    }
    Err(Failure::Divergence)
}

/// The measurements above the mask with their corrections.
struct Model<'a> {
    used: Vec<(&'a Measurement, Correction)>,
    unknowns: Unknowns,
}

impl<'a> Model<'a> {
    fn at(
        measurements: &'a [Measurement],
        place: Option<Vector3<f64>>,
        gpst_s: f64,
        settings: &Settings,
    ) -> Result<Self, Failure> {
        let used: Vec<_> = measurements
            .iter()
            .map(|m| (m, settings.correction(m, place, gpst_s)))
            .filter(|(_, c)| c.elevation >= settings.elevation_mask)
            .collect();
        let chosen: Vec<_> = used.iter().map(|(m, _)| *m).collect();
        let unknowns = Unknowns::of(&chosen);
        let satellites: Vec<_> = chosen.iter().map(|m| m.satellite).collect();
        if distinct(&satellites) < unknowns.satellites().max(4) || used.len() < unknowns.count() {
            return Err(Failure::TooFew);
        }
        Ok(Self { used, unknowns })
    }

    /// Design and residuals at some values of the unknowns.
    fn linearised(&self, values: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let mut design = DMatrix::zeros(self.used.len(), self.unknowns.count());
        let mut residuals = DVector::zeros(self.used.len());
        let place = Vector3::new(values[0], values[1], values[2]);
        for (row, (m, correction)) in self.used.iter().enumerate() {
            let (range, unit, _) = geometry(&m.state, place);
            let (clock, bias) = self.unknowns.columns(m);
            design
                .fixed_view_mut::<1, 3>(row, 0)
                .copy_from(&unit.transpose());
            let mut modelled = range + correction.delay_m - SPEED_OF_LIGHT_M_S * m.state.clock_s;
            for column in std::iter::once(clock).chain(bias) {
                design[(row, column)] = 1.0;
                modelled += values[column];
            }
            residuals[row] = m.range_m - modelled;
        }
        (design, residuals)
    }

    fn converge(&self, start: Vector3<f64>) -> Result<Solution, Failure> {
        let mut values = DVector::zeros(self.unknowns.count());
        values.fixed_rows_mut::<3>(0).copy_from(&start);
        let weights = DVector::from_iterator(
            self.used.len(),
            self.used.iter().map(|(_, c)| 1.0 / c.variance),
        );
        for _ in 0..MOST_STEPS {
            let (design, residuals) = self.linearised(&values);
            let covariance = inverse_normal(&design, &weights).ok_or(Failure::Geometry)?;
            let step = &covariance * design.tr_mul(&weights.component_mul(&residuals));
            values += &step;
            if !values.iter().all(|v| v.is_finite()) {
                return Err(Failure::Divergence);
            }
            if step.fixed_rows::<3>(0).norm() < CONVERGED_M {
                return Ok(self.solution(values, covariance, weights));
            }
        }
        Err(Failure::Divergence)
    }

    fn solution(
        &self,
        values: DVector<f64>,
        covariance: DMatrix<f64>,
        weights: DVector<f64>,
    ) -> Solution {
        let (design, residuals) = self.linearised(&values);
        Solution {
            position: Vector3::new(values[0], values[1], values[2]),
            unknowns: self.unknowns.clone(),
            values,
            covariance,
            columns: self.used.iter().map(|(m, _)| m.column).collect(),
            satellites: self.used.iter().map(|(m, _)| m.satellite).collect(),
            residuals,
            weights,
            design,
        }
    }
}

impl Solution {
    fn sound(self, settings: &Settings) -> Result<Self, Failure> {
        let equal = DVector::from_element(self.design.nrows(), 1.0);
        let shape = inverse_normal(&self.design, &equal).ok_or(Failure::Geometry)?;
        let pdop = (0..3).map(|i| shape[(i, i)]).sum::<f64>().sqrt();
        // Written so that a NaN fails.
        if pdop <= settings.max_pdop {
            Ok(self)
        } else {
            Err(Failure::Geometry)
        }
    }
}

/// (H' W H)^-1, or `None` where it is singular.
pub fn inverse_normal(design: &DMatrix<f64>, weights: &DVector<f64>) -> Option<DMatrix<f64>> {
    let mut weighted = design.clone();
    for (mut row, weight) in weighted.row_iter_mut().zip(weights) {
        row *= *weight;
    }
    Some(design.tr_mul(&weighted).cholesky()?.inverse())
}
