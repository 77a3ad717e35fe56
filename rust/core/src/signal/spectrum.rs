//! Power spectra of signals.

use std::f64::consts::{PI, TAU};

use super::Layer;
use crate::C64;

/// Power spectral density of random chips of unit power, in 1/Hz, beside the carrier.
pub(crate) fn spectrum(layers: &[Layer], chip_rate_hz: f64, frequency_hz: f64) -> f64 {
    let cycles = frequency_hz / chip_rate_hz;
    let of = |layer: &Layer| {
        let cells = layer.subchips as f64;
        let cell = cycles / cells;
        // Cells of alternating sign, one after the other, about the middle of the chip.
        let wave: C64 = (0..layer.subchips)
            .map(|i| {
                let middle = (i as f64 + 0.5) / cells - 0.5;
                C64::from_polar(if i % 2 == 0 { 1.0 } else { -1.0 }, -TAU * cycles * middle)
            })
            .sum();
        wave * C64::new(layer.re, layer.im) * (sinc(cell) / cells)
    };
    layers.iter().map(of).sum::<C64>().norm_sqr() / chip_rate_hz
}

/// sin(pi x) / (pi x)
fn sinc(x: f64) -> f64 {
    if x == 0.0 {
        1.0
    } else {
        (PI * x).sin() / (PI * x)
    }
}
