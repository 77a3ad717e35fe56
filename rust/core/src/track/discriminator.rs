//! Discriminators: correlator outputs to errors in cycles, hertz and chips.

use std::f64::consts::TAU;

use crate::signal::Modulation;
use crate::C64;

/// Phase error in cycles, (-1/2, 1/2]: four-quadrant, for a signal of known sign.
pub fn phase(prompt: C64) -> f64 {
    prompt.arg() / TAU
}

/// Phase error in cycles, (-1/4, 1/4]: Costas, for a signal of unknown sign.
pub fn costas(prompt: C64) -> f64 {
    phase(if prompt.re < 0.0 { -prompt } else { prompt })
}

/// Received code phase minus replica in chips: early-minus-late dot prompt.
///
/// `power` is the (smoothed) prompt power and `slope` from [`early_late_slope`].
pub fn code(early: C64, prompt: C64, late: C64, power: f64, slope: f64) -> f64 {
    if power > 0.0 {
        ((early - late) * prompt.conj()).re / (power * slope)
    } else {
        0.0
    }
}

/// Autocorrelation of a chip sequence with the given shape, at a delay in chips, for random codes
/// and unlimited bandwidth. Piecewise linear between multiples of a sub-chip.
pub fn autocorrelation(modulation: Modulation, delay_chips: f64) -> f64 {
    modulation
        .layers()
        .iter()
        .map(|layer| {
            let n = layer.subchips as f64;
            let at_knot = |k: f64| {
                let sign = if k as i64 % 2 == 0 { 1.0 } else { -1.0 };
                sign * (1.0 - k / n).max(0.0)
            };
            let x = delay_chips.abs() * n;
            let k = x.floor();
            let r = at_knot(k) + (x - k) * (at_knot(k + 1.0) - at_knot(k));
            r * (layer.re * layer.re + layer.im * layer.im)
        })
        .sum()
}

/// Slope of (early - late) per chip of code error, prompt amplitude 1, taps at +-`half_chips`.
pub fn early_late_slope(modulation: Modulation, half_chips: f64) -> f64 {
    let small = 0.01;
    (autocorrelation(modulation, half_chips - small)
        - autocorrelation(modulation, half_chips + small))
        / small
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_of_the_ideal_autocorrelations() {
        assert!((early_late_slope(Modulation::Bpsk, 0.25) - 2.0).abs() < 1e-9);
        assert!((early_late_slope(Modulation::Boc11, 0.1) - 6.0).abs() < 1e-9);
        assert!((autocorrelation(Modulation::Boc11, 0.5) + 0.5).abs() < 1e-12);
        assert!((autocorrelation(Modulation::Qmboc, 0.0) - 1.0).abs() < 1e-12);
        // BOC(6,1) alone falls as 1 - 23 |tau|; the pilot mixes 29/33 and 4/33.
        let expected = 1.0 - (29.0 / 33.0 * 3.0 + 4.0 / 33.0 * 23.0) * 0.04;
        assert!((autocorrelation(Modulation::Qmboc, 0.04) - expected).abs() < 1e-12);
    }

    #[test]
    fn errors_have_the_right_sign() {
        let ahead = C64::from_polar(2.0, 0.3 * TAU);
        assert!((phase(ahead) - 0.3).abs() < 1e-12);
        assert!((costas(ahead) + 0.2).abs() < 1e-12);
        // Received ahead of the replica: the early tap is larger.
        let e = code(
            C64::new(0.9, 0.0),
            C64::new(1.0, 0.0),
            C64::new(0.7, 0.0),
            1.0,
            2.0,
        );
        assert!((e - 0.1).abs() < 1e-12);
    }
}
