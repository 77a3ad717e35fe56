//! Spectral separation: the noise that one signal makes in the correlator of another.

use super::front_end::FrontEnd;
use super::pulse::Pulse;
use crate::signal::spectrum::spectrum;
use crate::signal::{Layer, SignalSpec};

/// Step of the integral over frequency. It is exact up to where it ends, as the correlation of two
/// chips and a filter's response is shorter than the 10 us that the step stands for.
const STEP_HZ: f64 = 100e3;
/// The integral ends so many of the faster subcarrier's sub-chip rates beyond either carrier, where
/// the product of two spectra has fallen with the fourth power.
const LOBES: f64 = 4.0;

/// Noise power over that of the receiver that a signal of another code and 1 Hz of C/N0 makes, in
/// seconds: the integral of the product of both spectra behind the front end, each of unit power
/// and at its own carrier (the spectral separation coefficient of Betz, "Effect of partial-band
/// interference on receiver estimation of C/N0", 2001).
pub(super) fn separation_s(
    front: &FrontEnd,
    spec: &SignalSpec,
    replica: &[Layer],
    received: &SignalSpec,
) -> f64 {
    let layers = received.modulation.layers();
    if received.carrier_hz == spec.carrier_hz && received.chip_rate_hz == spec.chip_rate_hz {
        // By Parseval's theorem: a chip's correlation squared, over all delays.
        return front.signal(Pulse::new(replica, layers)).power() / spec.chip_rate_hz;
    }
    let apart_hz = received.carrier_hz - spec.carrier_hz;
    let lobe_hz = |layers: &[Layer], rate_hz: f64| {
        layers.iter().map(|l| l.subchips).max().unwrap_or(1) as f64 * rate_hz
    };
    let reach_hz =
        LOBES * lobe_hz(replica, spec.chip_rate_hz).max(lobe_hz(layers, received.chip_rate_hz));
    let first_hz = apart_hz.min(0.0) - reach_hz;
    let count = ((apart_hz.abs() + 2.0 * reach_hz) / STEP_HZ).ceil() as usize;
    let gains = front.gains(spec.chip_rate_hz, first_hz, STEP_HZ, count);
    let at = |(i, gain): (usize, f64)| {
        let frequency_hz = first_hz + i as f64 * STEP_HZ;
        let theirs = spectrum(layers, received.chip_rate_hz, frequency_hz - apart_hz);
        gain * theirs * spectrum(replica, spec.chip_rate_hz, frequency_hz)
    };
    gains.into_iter().enumerate().map(at).sum::<f64>() * STEP_HZ
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::SIGNALS;

    /// Integral of the product of two spectra on one carrier.
    fn integral_s(a: &SignalSpec, b: &SignalSpec) -> f64 {
        let at = |i: i64| {
            let f = i as f64 * STEP_HZ;
            let of = |s: &SignalSpec| spectrum(s.modulation.layers(), s.chip_rate_hz, f);
            of(a) * of(b)
        };
        (-2000..=2000).map(at).sum::<f64>() * STEP_HZ
    }

    #[test]
    fn spectra_and_pulses_agree_on_one_carrier() {
        let front = FrontEnd::unlimited();
        for a in SIGNALS {
            for b in SIGNALS.iter().filter(|b| b.chip_rate_hz == a.chip_rate_hz) {
                let pulse = Pulse::new(a.modulation.layers(), b.modulation.layers());
                let expected = front.signal(pulse).power() / a.chip_rate_hz;
                let found = integral_s(a, b);
                assert!((found / expected - 1.0).abs() < 2e-3, "{} {}", a.id, b.id);
            }
        }
    }

    #[test]
    fn spectra_have_unit_power() {
        for s in SIGNALS {
            let at = |i: i64| {
                spectrum(s.modulation.layers(), s.chip_rate_hz, i as f64 * STEP_HZ) * STEP_HZ
            };
            let power: f64 = (-20_000..=20_000).map(at).sum();
            assert!((power - 1.0).abs() < 0.01, "{}: {power}", s.id);
        }
    }

    #[test]
    fn signals_far_apart_hardly_disturb_each_other() {
        let front = FrontEnd::unlimited();
        for a in SIGNALS {
            for b in SIGNALS {
                let mutual = separation_s(&front, a, a.modulation.layers(), b);
                let back = separation_s(&front, b, b.modulation.layers(), a);
                assert!((mutual / back - 1.0).abs() < 1e-9, "{} {}", a.id, b.id);
                let own = separation_s(&front, a, a.modulation.layers(), a);
                if (a.carrier_hz - b.carrier_hz).abs() > 10e6 {
                    assert!(mutual < 0.02 * own, "{} {}: {}", a.id, b.id, mutual / own);
                }
            }
        }
    }
}
