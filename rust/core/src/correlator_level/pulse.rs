//! Correlation of a received chip with a replica's chip, over delay.

use crate::signal::Layer;
use crate::C64;

/// Every modulation's sub-chips divide this: between multiples of it correlations are linear.
const SUBCHIPS: usize = 12;
/// Points per chip of a correlation through a filter, which has no corners of its own.
const FILTERED: usize = 96;

/// A piecewise-linear function of delay in chips, zero beyond its reach.
#[derive(Debug, Clone)]
pub(super) struct Pulse {
    cells: usize,
    /// Chips to either side.
    reach: usize,
    table: Vec<C64>,
}

impl Pulse {
    /// Unlimited bandwidth: the mean of conj(replica at u) times (received at u + delay).
    pub fn new(replica: &[Layer], received: &[Layer]) -> Self {
        let value = |layers: &[Layer], cell: i64| -> C64 {
            if !(0..SUBCHIPS as i64).contains(&cell) {
                return C64::default();
            }
            let of = |l: &Layer| match cell as usize / (SUBCHIPS / l.subchips) % 2 {
                0 => C64::new(l.re, l.im),
                _ => -C64::new(l.re, l.im),
            };
            layers.iter().map(of).sum()
        };
        let at = |shift: i64| {
            let cells = 0..SUBCHIPS as i64;
            let sum: C64 = cells
                .map(|cell| value(replica, cell).conj() * value(received, cell + shift))
                .sum();
            sum / SUBCHIPS as f64
        };
        Pulse {
            cells: SUBCHIPS,
            reach: 1,
            table: (-(SUBCHIPS as i64)..=SUBCHIPS as i64).map(at).collect(),
        }
    }

    /// What a filter makes of it: the sum over `response` of weight times the pulse at the delay
    /// less that many chips.
    pub fn through(&self, response: &[(f64, C64)]) -> Self {
        let longest = response.iter().map(|r| r.0.abs()).fold(0.0, f64::max);
        let reach = self.reach + longest.ceil() as usize;
        let at = |i: usize| {
            let delay = i as f64 / FILTERED as f64 - reach as f64;
            response.iter().map(|(d, h)| h * self.at(delay - d)).sum()
        };
        Pulse {
            cells: FILTERED,
            reach,
            table: (0..=2 * reach * FILTERED).map(at).collect(),
        }
    }

    /// Integral of its squared magnitude over all delays, in chips.
    pub fn power(&self) -> f64 {
        let pairs = self.table.windows(2);
        // Simpson's rule is exact for the square of a line.
        let area = |w: &[C64]| {
            let middle = 0.5 * (w[0] + w[1]);
            (w[0].norm_sqr() + 4.0 * middle.norm_sqr() + w[1].norm_sqr()) / 6.0
        };
        pairs.map(area).sum::<f64>() / self.cells as f64
    }

    /// Value at a delay in chips.
    fn at(&self, delay: f64) -> C64 {
        let place = (delay + self.reach as f64) * self.cells as f64;
        if !(0.0..(self.table.len() - 1) as f64).contains(&place) {
            return C64::default();
        }
        let (cell, share) = split(place);
        self.between(cell as usize, share)
    }

    #[inline]
    fn between(&self, cell: usize, share: f64) -> C64 {
        let [here, next] = [self.table[cell], self.table[cell + 1]];
        here + (next - here) * share
    }

    /// Correlation of trains of chips, received ahead of the replica by `delay` chips;
    /// `lags(k)` is that of the code with itself k chips on.
    #[inline]
    pub fn train(&self, delay: f64, lags: impl Fn(i64) -> f64) -> C64 {
        let (whole, rest) = split(delay);
        let (cell, share) = split(rest * self.cells as f64);
        let cell = (cell as usize).min(self.cells - 1);
        let first = whole - (self.reach as i64 - 1);
        (0..2 * self.reach)
            .map(|j| {
                let at = (2 * self.reach - 1 - j) * self.cells + cell;
                self.between(at, share) * lags(first + j as i64)
            })
            .sum()
    }
}

/// The whole number below, and the rest; without a call, as `floor` is one on some processors.
#[inline(always)]
pub(super) fn split(x: f64) -> (i64, f64) {
    let towards_zero = x as i64;
    let whole = towards_zero - i64::from(x < towards_zero as f64);
    (whole, x - whole as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Modulation::{Boc11, Bpsk, Qmboc};
    use crate::track::discriminator::autocorrelation;

    /// A code without side lobes.
    fn single(k: i64) -> f64 {
        f64::from(u8::from(k == 0))
    }

    #[test]
    fn a_random_code_has_the_ideal_autocorrelation() {
        for modulation in [Bpsk, Boc11, Qmboc] {
            let pulse = Pulse::new(modulation.layers(), modulation.layers());
            for i in -130..130 {
                let delay = f64::from(i) * 0.0123;
                let expected = C64::from(autocorrelation(modulation, delay));
                assert!((pulse.train(delay, single) - expected).norm() < 1e-12);
                assert!((pulse.at(delay) - expected).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn boc11_hears_its_share_of_qmboc() {
        let pulse = Pulse::new(Boc11.layers(), Qmboc.layers());
        let share = Qmboc.layers()[0].re;
        assert!((pulse.at(0.0) - C64::from(share)).norm() < 1e-12);
        // The other layer is in quadrature.
        let expected = share * autocorrelation(Boc11, 0.3);
        assert!((pulse.at(0.3).re - expected).abs() < 1e-12);
    }

    #[test]
    fn power_of_a_triangle() {
        let pulse = Pulse::new(Bpsk.layers(), Bpsk.layers());
        assert!((pulse.power() - 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn an_echo_is_a_filter() {
        let pulse = Pulse::new(Bpsk.layers(), Bpsk.layers());
        let echo = [(0.0, C64::from(1.0)), (0.5, C64::new(0.0, -0.4))];
        let through = pulse.through(&echo);
        for delay in [-1.2, -0.3, 0.0, 0.25, 0.5, 1.3] {
            let plain = |d| autocorrelation(Bpsk, d);
            let expected = C64::new(plain(delay), -0.4 * plain(delay - 0.5));
            assert!((through.train(delay, single) - expected).norm() < 2e-2);
        }
    }
}
