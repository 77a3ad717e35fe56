//! A low-pass filter by its window: Kaiser, "Nonrecursive digital filter design using the I0-sinh
//! window function", 1974.

/// Kaiser shape: 60 dB stop band.
const KAISER_BETA: f64 = 5.65;

/// Kaiser-windowed sinc, from 0 to `half` input samples, at each phase.
pub(crate) fn low_pass(cutoff: f64, half: usize, phases: usize) -> Vec<f64> {
    let end = bessel_i0(KAISER_BETA);
    (0..=half * phases)
        .map(|i| {
            let u = i as f64 / phases as f64;
            let edge = (1.0 - (u / half as f64).powi(2)).max(0.0).sqrt();
            cutoff * sinc(cutoff * u) * bessel_i0(KAISER_BETA * edge) / end
        })
        .collect()
}

/// sin(pi x) / (pi x).
pub(crate) fn sinc(x: f64) -> f64 {
    let y = std::f64::consts::PI * x;
    if y.abs() < 1e-9 {
        1.0
    } else {
        y.sin() / y
    }
}

/// Modified Bessel function of the first kind, order 0, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let mut term = 1.0;
    let mut sum = 1.0;
    let mut k = 1.0;
    while term > 1e-17 * sum {
        term *= (x / (2.0 * k)).powi(2);
        sum += term;
        k += 1.0;
    }
    sum
}
