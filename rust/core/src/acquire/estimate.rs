//! Peak to estimates: Doppler, code delay and C/N0 between the cells of the search.

use super::replica::PeakShape;
use crate::dsp::low_pass::sinc;

/// Delay cells on each side of the peak that the fit uses.
pub(super) const DELAY_REACH: usize = 2;
/// Delay cells of one row of the neighbourhood.
pub(super) const WIDTH: usize = 2 * DELAY_REACH + 1;

/// Power less the noise floor, in units of the floor: Doppler bins -1..=1, delay cells -2..=2.
pub(super) type Neighbourhood = [[f64; WIDTH]; 3];

/// Where in the neighbourhood the peak lies, and its signal-to-noise ratio.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    /// Samples after the middle cell.
    pub delay: f64,
    /// Doppler bins above the middle cell.
    pub doppler: f64,
    /// Signal power over noise power of one coherent integration, free of scalloping.
    pub snr: f64,
}

/// Reach of the fit, in cells, and steps of the lattice on each side.
const REACH: f64 = 0.75;
const STEPS: usize = 24;

/// Fits the shape of a signal's peak.
pub(super) struct Fitter {
    shape: PeakShape,
    /// Delay templates at the points of the lattice.
    lattice: Vec<[f64; WIDTH]>,
}

impl Fitter {
    pub fn new(shape: PeakShape) -> Self {
        // Lattice points are steps apart, cells whole cells: few different delays in all.
        let cell = (STEPS as f64 / REACH) as usize;
        let steps = DELAY_REACH * cell + STEPS;
        let correlation = |i: usize| shape.correlation(i as f64 / cell as f64);
        let table: Vec<f64> = (0..=steps).map(correlation).collect();
        let template = |i: usize| {
            let at = |l: usize| (l * cell + STEPS).abs_diff(DELAY_REACH * cell + i);
            std::array::from_fn(|l| table[at(l)].powi(2))
        };
        let lattice = (0..=2 * STEPS).map(template).collect();
        Fitter { shape, lattice }
    }

    /// Share of the signal's power inside the search band.
    pub fn power_in_band(&self) -> f64 {
        self.shape.power_in_band
    }

    /// Least-squares fit of `snr * |R(delay)|^2 * sinc^2(doppler / 2)`, first on the lattice, then
    /// between its points.
    pub fn fit(&self, cells: &Neighbourhood) -> Fit {
        let middle = cells.map(|row| row[DELAY_REACH]);
        let doppler = maximise(|i| score(&middle, &doppler_template(offset(i))));
        let weights = doppler_template(doppler);
        let profile: [f64; WIDTH] =
            std::array::from_fn(|l| (0..3).map(|b| weights[b] * cells[b][l]).sum());
        let delay = maximise(|i| score(&profile, &self.lattice[i]));
        let energy: f64 = weights.iter().map(|w| w * w).sum();
        let template = self.delay_template(delay);
        let snr = project(&profile, &template) / (energy * project(&template, &template));
        Fit {
            delay,
            doppler,
            snr,
        }
    }

    fn delay_template(&self, offset: f64) -> [f64; WIDTH] {
        std::array::from_fn(|l| {
            let delay = l as f64 - DELAY_REACH as f64 - offset;
            self.shape.correlation(delay).powi(2)
        })
    }
}

/// Of a lattice point, in cells.
fn offset(i: usize) -> f64 {
    (i as f64 - STEPS as f64) * REACH / STEPS as f64
}

fn doppler_template(offset: f64) -> [f64; 3] {
    [-1.0, 0.0, 1.0].map(|b| sinc((b - offset) / 2.0).powi(2))
}

fn project(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Energy that a template explains, with the sign of its amplitude.
fn score(data: &[f64], template: &[f64]) -> f64 {
    let p = project(data, template);
    p * p.abs() / project(template, template)
}

/// Offset of the largest value: on the lattice, then by a parabola.
fn maximise(f: impl Fn(usize) -> f64) -> f64 {
    let values: Vec<f64> = (0..=2 * STEPS).map(f).collect();
    let (mut best, mut top) = (0, f64::NEG_INFINITY);
    for (i, &v) in values.iter().enumerate() {
        if v > top {
            (best, top) = (i, v);
        }
    }
    if best == 0 || best + 1 == values.len() {
        return offset(best);
    }
    let (below, above) = (values[best - 1], values[best + 1]);
    let curvature = below - 2.0 * top + above;
    if curvature < 0.0 {
        offset(best) + 0.5 * (below - above) / curvature * (offset(1) - offset(0))
    } else {
        offset(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::SIGNALS;

    #[test]
    fn fit_is_exact_without_noise() {
        for spec in SIGNALS {
            let fitter = Fitter::new(PeakShape::new(spec));
            for (delay, doppler) in [(0.0, 0.0), (0.31, -0.42), (-0.47, 0.2)] {
                let (f, d) = (doppler_template(doppler), fitter.delay_template(delay));
                let cells = f.map(|w| d.map(|x| 12.0 * w * x));
                let got = fitter.fit(&cells);
                assert!((got.delay - delay).abs() < 0.01, "{} {got:?}", spec.id);
                assert!((got.doppler - doppler).abs() < 0.01, "{} {got:?}", spec.id);
                assert!((got.snr - 12.0).abs() < 0.1, "{} {got:?}", spec.id);
            }
        }
    }
}
