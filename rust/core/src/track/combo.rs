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
//! main loop carries the dynamics and aids the subcarrier loop by f_s / f_m.

use super::discriminator;
use super::loop_filter::LoopFilter;
use super::quality::RunningMean;
use crate::C64;

/// The joint loops.
#[derive(Debug, Clone)]
pub struct JointLoops {
    /// Doppler of the main carrier.
    main: LoopFilter,
    /// Doppler of the subcarrier beyond what the main carrier explains.
    sub: LoopFilter,
    /// f_s / f_m.
    ratio: f64,
    alignment: RunningMean,
}

/// What the joint loops ask of the two sidebands.
#[derive(Debug, Clone, Copy)]
pub struct Steering {
    /// Doppler of lower and upper sideband.
    pub doppler_hz: [f64; 2],
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
            sub: LoopFilter::new(2, bandwidths_hz[1], interval_s)
                .starting(half - ratio * mean(doppler_hz), 0.0),
            ratio,
            alignment: RunningMean::new(0.2),
        }
    }

    /// Takes the prompts (lower, upper) of one epoch, amplitude and symbols removed.
    pub fn update(&mut self, lower: C64, upper: C64, interval_s: f64) -> Steering {
        self.alignment.add((upper * lower.conj()).re, interval_s);
        let main = self.main.update(discriminator::phase(upper + lower));
        let sub = self.sub.update(discriminator::phase(upper + lower.conj()));
        let split = self.ratio * main + sub;
        let acceleration = self.main.acceleration;
        Steering {
            doppler_hz: [main - split, main + split],
            rate_hz_s: [
                acceleration * (1.0 - self.ratio),
                acceleration * (1.0 + self.ratio),
            ],
        }
    }

    /// Mean of cos(2 dpsi) (times amplitude): 1 where the sidebands agree, 0 where they turn.
    pub fn subcarrier_lock(&self) -> f64 {
        self.alignment.value()
    }

    /// Seconds since the loops were joined.
    pub fn elapsed_s(&self) -> f64 {
        self.alignment.elapsed_s()
    }
}
