//! Peak to estimates: Doppler, code delay and C/N0 between the cells of the search.

use super::replica::PeakShape;
use crate::dsp::resample::sinc;

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

/// Least-squares fit of `snr * |R(delay)|^2 * sinc^2(doppler / 2)`, first on the lattice, then
/// between its points.
pub(super) fn fit(shape: &PeakShape, cells: &Neighbourhood) -> Fit {
    let doppler = maximise(0.75, |d| {
        let middle: Vec<f64> = cells.iter().map(|row| row[DELAY_REACH]).collect();
        score(&middle, &doppler_template(d))
    });
    let weights = doppler_template(doppler);
    let column = |l: usize| -> f64 { (0..3).map(|b| weights[b] * cells[b][l]).sum() };
    let profile: Vec<f64> = (0..WIDTH).map(column).collect();
    let delay = maximise(0.75, |d| score(&profile, &delay_template(shape, d)));
    let energy: f64 = weights.iter().map(|w| w * w).sum();
    let template = delay_template(shape, delay);
    let snr = project(&profile, &template) / (energy * project(&template, &template));
    Fit {
        delay,
        doppler,
        snr,
    }
}

fn doppler_template(offset: f64) -> [f64; 3] {
    [-1.0, 0.0, 1.0].map(|b| sinc((b - offset) / 2.0).powi(2))
}

fn delay_template(shape: &PeakShape, offset: f64) -> [f64; WIDTH] {
    std::array::from_fn(|l| {
        shape
            .correlation(l as f64 - DELAY_REACH as f64 - offset)
            .powi(2)
    })
}

fn project(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Energy that a template explains, with the sign of its amplitude.
fn score(data: &[f64], template: &[f64]) -> f64 {
    let p = project(data, template);
    p * p.abs() / project(template, template)
}

/// Argument in [-reach, reach] of the largest value: lattice, then parabola.
fn maximise(reach: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: i32 = 24;
    let step = reach / f64::from(STEPS);
    let values: Vec<f64> = (-STEPS..=STEPS).map(|i| f(f64::from(i) * step)).collect();
    let (mut best, mut top) = (0, f64::NEG_INFINITY);
    for (i, &v) in values.iter().enumerate() {
        if v > top {
            (best, top) = (i, v);
        }
    }
    let at = (best as f64 - f64::from(STEPS)) * step;
    if best == 0 || best + 1 == values.len() {
        return at;
    }
    let (below, above) = (values[best - 1], values[best + 1]);
    let curvature = below - 2.0 * top + above;
    if curvature < 0.0 {
        at + step * 0.5 * (below - above) / curvature
    } else {
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::SIGNALS;

    #[test]
    fn fit_is_exact_without_noise() {
        for spec in SIGNALS {
            let shape = PeakShape::new(spec);
            for (delay, doppler) in [(0.0, 0.0), (0.31, -0.42), (-0.47, 0.2)] {
                let (f, d) = (doppler_template(doppler), delay_template(&shape, delay));
                let cells = f.map(|w| d.map(|x| 12.0 * w * x));
                let got = fit(&shape, &cells);
                assert!((got.delay - delay).abs() < 0.01, "{} {got:?}", spec.id);
                assert!((got.doppler - doppler).abs() < 0.01, "{} {got:?}", spec.id);
                assert!((got.snr - 12.0).abs() < 0.1, "{} {got:?}", spec.id);
            }
        }
    }
}
