//! Two coherent signals of one satellite tracked as the sidebands of one signal.
//!
//! Lower sideband l, upper u; main carrier f_m = (f_u + f_l) / 2, subcarrier f_s = (f_u - f_l) / 2;
//! phases phi_u = theta + psi, phi_l = theta - psi. With amplitudes removed and the lower symbol
//! wiped by decision,
//!
//! ```text
//! R_u + R_l        = 2 cos(dpsi)   exp(j dtheta)     main-carrier error
//! R_u + conj(R_l)  = 2 cos(dtheta) exp(j dpsi)       subcarrier error
//! ```
//!
//! (Zhou et al. 2019, equation 6, print the difference of the two, which does not decouple.) The
//! main loop carries the dynamics and aids the subcarrier loop by f_s / f_m. Two signals on one
//! carrier have no subcarrier: f_s is 0, their phases keep the distance that they had when they
//! were joined, and only the main loop runs.

use super::discriminator;
use super::loop_filter::LoopFilter;
use super::quality::RunningMean;
use crate::C64;

/// Memory of the subcarrier-lock indicator, s.
pub const ALIGNMENT_S: f64 = 0.2;

/// Power of a prompt, amplitude removed, that counts as none.
const FADED: f64 = 0.02;

/// The joint loops.
#[derive(Debug, Clone)]
pub struct JointLoops {
    /// Doppler of the main carrier.
    main: LoopFilter,
    /// Doppler of the subcarrier beyond what the main carrier explains; none on one carrier.
    sub: Option<LoopFilter>,
    /// f_s / f_m.
    ratio: f64,
    alignment: RunningMean,
    /// Of the prompts (lower, upper), noise removed.
    powers: [RunningMean; 2],
}

/// What the joint loops ask of the two sidebands.
#[derive(Debug, Clone, Copy)]
pub struct Steering {
    /// Doppler of lower and upper sideband.
    pub doppler_hz: [f64; 2],
    /// The same without the loops' proportional parts: what a sideband goes on with by itself.
    pub smooth_doppler_hz: [f64; 2],
    /// Its change per second.
    pub rate_hz_s: [f64; 2],
}

impl JointLoops {
    /// Loops that continue what the two sidebands (lower, upper) did on their own.
    pub fn new(
        carriers_hz: [f64; 2],
        bandwidths_hz: [f64; 2],
        interval_s: f64,
        doppler_hz: [f64; 2],
        rate_hz_s: [f64; 2],
    ) -> Self {
        let ratio = (carriers_hz[1] - carriers_hz[0]) / (carriers_hz[1] + carriers_hz[0]);
        let mean = |v: [f64; 2]| 0.5 * (v[0] + v[1]);
        let half = 0.5 * (doppler_hz[1] - doppler_hz[0]);
        JointLoops {
            main: LoopFilter::new(3, bandwidths_hz[0], interval_s)
                .starting(mean(doppler_hz), mean(rate_hz_s)),
            sub: (ratio != 0.0).then(|| {
                LoopFilter::new(2, bandwidths_hz[1], interval_s)
                    .starting(half - ratio * mean(doppler_hz), 0.0)
            }),
            ratio,
            alignment: RunningMean::new(ALIGNMENT_S),
            powers: [0, 1].map(|_| RunningMean::new(ALIGNMENT_S)),
        }
    }

    /// Takes the prompts (lower, upper) of one epoch, amplitude and symbols removed, and the mean
    /// noise power in them.
    pub fn update(&mut self, prompts: [C64; 2], noise: [f64; 2], interval_s: f64) -> Steering {
        let [lower, upper] = prompts;
        self.alignment.add((upper * lower.conj()).re, interval_s);
        for (i, power) in self.powers.iter_mut().enumerate() {
            power.add(prompts[i].norm_sqr() - noise[i], interval_s);
        }
        let main = self.main.update(discriminator::phase(upper + lower));
        let sub_error = discriminator::phase(upper + lower.conj());
        let sub = self.sub.as_mut().map_or(0.0, |s| s.update(sub_error));
        let smooth_sub = self.sub.as_ref().map_or(0.0, |s| s.rate);
        let sidebands = |main: f64, sub: f64| {
            let split = self.ratio * main + sub;
            [main - split, main + split]
        };
        Steering {
            doppler_hz: sidebands(main, sub),
            smooth_doppler_hz: sidebands(self.main.rate, smooth_sub),
            rate_hz_s: sidebands(self.main.acceleration, 0.0),
        }
    }

    /// Mean of cos(2 dpsi), weighted by amplitude: 1 where the sidebands agree, 0 where they turn
    /// or one of them is gone. The prompts' own power is what counts: estimates of amplitude come
    /// late in a fade.
    pub fn subcarrier_lock(&self) -> f64 {
        let [lower, upper] = self.powers.each_ref().map(|p| p.value().max(FADED));
        self.alignment.value() / (lower * upper).sqrt()
    }

    /// Seconds since the loops were joined.
    pub fn elapsed_s(&self) -> f64 {
        self.alignment.elapsed_s()
    }
}

/// Removes the symbols of the prompts (lower, upper, amplitudes removed) by decision, unless their
/// sign is known.
///
/// Where one sign is known (a pilot's), the other is decided against the phase half-way between
/// the main loop's and that of the pilot's prompt: right up to a phase error of half a cycle, where
/// a decision on the loop's phase alone fails at a quarter, and with half the pilot's noise.
pub fn wiped([lower, upper]: [C64; 2], signed: [bool; 2]) -> [C64; 2] {
    let one = C64::new(1.0, 0.0);
    match signed {
        [true, true] => [lower, upper],
        [false, true] => [decided(lower, one + upper), upper],
        [true, false] => [lower, decided(upper, one + lower)],
        [false, false] => [decided(lower, one), decided(upper, one)],
    }
}

/// The prompt with the sign that brings it nearer to the reference.
fn decided(prompt: C64, reference: C64) -> C64 {
    if (prompt * reference.conj()).re < 0.0 {
        -prompt
    } else {
        prompt
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const CARRIERS_HZ: [f64; 2] = [1561.098e6, 1575.42e6];
    const INTERVAL_S: f64 = 0.01;

    fn turned(cycles: f64) -> C64 {
        C64::from_polar(1.0, TAU * cycles)
    }

    /// Errors of the two replicas after `epochs`, from given ones, without noise.
    fn settled(carriers_hz: [f64; 2], mut errors: [f64; 2], epochs: usize) -> [f64; 2] {
        let (doppler_hz, still) = ([1000.0, 1010.0], [0.0, 0.0]);
        let mut loops = JointLoops::new(carriers_hz, [10.0, 5.0], INTERVAL_S, doppler_hz, still);
        for _ in 0..epochs {
            let steering = loops.update(errors.map(turned), [0.0; 2], INTERVAL_S);
            for i in 0..2 {
                errors[i] -= (steering.doppler_hz[i] - doppler_hz[i]) * INTERVAL_S;
            }
        }
        errors
    }

    #[test]
    fn both_loops_settle() {
        for error in settled(CARRIERS_HZ, [0.1, -0.05], 200) {
            assert!(error.abs() < 1e-4, "{error}");
        }
    }

    /// Only the mean of the two is steered; their distance stays.
    #[test]
    fn one_carrier_has_only_the_main_loop() {
        let mut loops = JointLoops::new(
            [CARRIERS_HZ[1]; 2],
            [10.0, 5.0],
            INTERVAL_S,
            [1000.0; 2],
            [0.0; 2],
        );
        let mut errors = [0.1, 0.06];
        for _ in 0..200 {
            let steering = loops.update(errors.map(turned), [0.0; 2], INTERVAL_S);
            assert_eq!(steering.doppler_hz[0], steering.doppler_hz[1]);
            errors = errors.map(|e| e - (steering.doppler_hz[0] - 1000.0) * INTERVAL_S);
        }
        assert!((errors[0] - 0.02).abs() < 1e-4, "{errors:?}");
        assert!((errors[1] + 0.02).abs() < 1e-4, "{errors:?}");
        assert!(loops.subcarrier_lock() > 0.9);
    }

    #[test]
    fn symbols_are_decided_with_the_pilot_up_to_half_a_cycle() {
        for error in [-0.49, -0.3, 0.0, 0.2, 0.45] {
            for symbol in [-1.0, 1.0] {
                let received = [symbol * turned(error), turned(error)];
                let [lower, upper] = wiped(received, [false, true]);
                assert!((lower - upper).norm() < 1e-12, "{error} {symbol}");
                let [upper, lower] = wiped([received[1], received[0]], [true, false]);
                assert!((lower - upper).norm() < 1e-12, "{error} {symbol}");
            }
        }
        let data = [-turned(0.1), -turned(-0.1)];
        assert_eq!(wiped(data, [true, true]), data);
        assert_eq!(wiped(data, [false, false]), data.map(|d| -d));
    }
}
