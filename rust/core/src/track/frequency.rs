//! Frequency and phase error of a block of prompts of unknown signs.
//!
//! Squaring removes the signs; the largest line of the squares' spectrum is at twice the error.
//! Close to the maximum-likelihood estimate, it works at C/N0 where a discriminator from prompt to
//! prompt gives noise.

use std::f64::consts::TAU;

use crate::C64;

/// The block is long enough once its squares have this signal-to-noise ratio in all...
const BLOCK_SNR: f64 = 30.0;
/// ...but within these limits.
const BLOCK: (usize, usize) = (20, 400);

/// What a block shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockError {
    /// Received minus oscillator frequency, within +-1/(4 interval).
    pub frequency_hz: f64,
    /// Received minus oscillator phase at the end of the block, cycles, modulo a half.
    pub phase_cycles: f64,
}

/// Gathers prompts until a frequency can be read from them.
#[derive(Debug, Clone, Default)]
pub struct FrequencyBlock {
    squares: Vec<C64>,
}

impl FrequencyBlock {
    /// Adds a prompt; gives the block's errors, and starts afresh, once it is long enough for a
    /// signal of `snr` (C/N0 times the interval).
    pub fn add(&mut self, prompt: C64, snr: f64, interval_s: f64) -> Option<BlockError> {
        // Squared angle, plain amplitude: squared amplitudes would give noise peaks more weight.
        self.squares
            .push(prompt * prompt / prompt.norm().max(f64::MIN_POSITIVE));
        let square_snr = 1.0 / (4.0 / snr + 2.0 / (snr * snr));
        let wanted = ((BLOCK_SNR / square_snr) as usize).clamp(BLOCK.0, BLOCK.1);
        (self.squares.len() >= wanted).then(|| {
            let error = self.error(interval_s);
            self.squares.clear();
            error
        })
    }

    /// Line of the squares at `frequency` cycles per prompt, phase at the last prompt.
    fn line(&self, frequency: f64) -> C64 {
        let turn = C64::from_polar(1.0, TAU * frequency);
        self.squares
            .iter()
            .fold(C64::default(), |sum, s| sum * turn + s)
    }

    fn error(&self, interval_s: f64) -> BlockError {
        let cells = 4 * self.squares.len() as i32;
        let at = |k: i32| f64::from(k) / f64::from(cells) - 0.5;
        let power = |f: f64| self.line(f).norm_sqr();
        let best = (0..cells)
            .map(|k| (k, power(at(k))))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |(k, _)| k);
        let [before, peak, after] = [-1, 0, 1].map(|d| power(at(best + d)));
        let bend = before - 2.0 * peak + after;
        let fraction = if bend < 0.0 {
            0.5 * (before - after) / bend
        } else {
            0.0
        };
        let turns = at(best) + fraction / f64::from(cells);
        let frequency_hz = 0.5 * turns / interval_s;
        BlockError {
            frequency_hz,
            // From the last prompt's middle to its end.
            phase_cycles: 0.5 * self.line(turns).arg() / TAU + 0.5 * frequency_hz * interval_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequency_and_phase_under_data() {
        for error_hz in [-230.0, -3.3, 0.0, 41.7, 244.0] {
            let mut block = FrequencyBlock::default();
            let found = (0..)
                .find_map(|k| {
                    let sign = if k % 7 < 3 { -1.0 } else { 1.0 };
                    let phase = 0.13 + error_hz * 1e-3 * (f64::from(k) + 0.5);
                    block
                        .add(C64::from_polar(sign, TAU * phase), 100.0, 1e-3)
                        .map(|e| (k, e))
                })
                .unwrap();
            let end = 0.13 + error_hz * 1e-3 * f64::from(found.0 + 1);
            let miss = 2.0 * (found.1.phase_cycles - end);
            assert!(
                (found.1.frequency_hz - error_hz).abs() < 0.5,
                "{error_hz}: {:?}",
                found.1
            );
            assert!(
                (miss - miss.round()).abs() < 0.02,
                "{error_hz}: {:?}",
                found.1
            );
        }
    }
}
