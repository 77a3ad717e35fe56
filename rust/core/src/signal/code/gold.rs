//! Gold codes from two Fibonacci shift registers.

use super::chip;

/// A Fibonacci linear feedback shift register; stage 1 is the input end.
#[derive(Debug, Clone)]
pub struct Lfsr {
    /// `stages[0]` is stage 1.
    stages: Vec<u8>,
    /// 1-based stages whose sum is fed back.
    feedback: &'static [usize],
}

impl Lfsr {
    /// A register with its initial stages (stage 1 first) and 1-based feedback stages.
    pub fn new(initial: &[u8], feedback: &'static [usize]) -> Self {
        Lfsr {
            stages: initial.to_vec(),
            feedback,
        }
    }

    /// Sum of 1-based stages.
    pub fn tap(&self, stages: &[usize]) -> u8 {
        stages.iter().fold(0, |sum, &s| sum ^ self.stages[s - 1])
    }

    /// Shifts by one.
    pub fn clock(&mut self) {
        let input = self.tap(self.feedback);
        self.stages.rotate_right(1);
        self.stages[0] = input;
    }
}

/// `length` chips of `g1 stage last` xor `g2 taps`.
pub fn gold(mut g1: Lfsr, mut g2: Lfsr, g2_taps: &[usize], length: usize) -> Vec<i8> {
    let last = g1.stages.len();
    (0..length)
        .map(|_| {
            let bit = g1.tap(&[last]) ^ g2.tap(g2_taps);
            g1.clock();
            g2.clock();
            chip(bit)
        })
        .collect()
}
