//! Bytes as decisions.

use std::ops::Range;

const WILD: [f64; 12] = [
    0.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    9_007_199_254_740_992.0,
    -9_223_372_036_854_775_808.0,
    0.5,
    1e-12,
];

/// Input to be read as decisions; zeros once it is used up.
pub struct Input<'a> {
    bytes: &'a [u8],
    /// Numbers may be any.
    wild: bool,
}

impl<'a> Input<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut input = Input { bytes, wild: false };
        input.wild = input.chance(64);
        input
    }

    pub fn byte(&mut self) -> u8 {
        let (first, rest) = self.bytes.split_first().unwrap_or((&0, &[]));
        self.bytes = rest;
        *first
    }

    pub fn below(&mut self, limit: usize) -> usize {
        (usize::from(u16::from_le_bytes([self.byte(), self.byte()])) * limit) >> 16
    }

    /// Whether anything goes.
    pub fn wild(&self) -> bool {
        self.wild
    }

    pub fn chance(&mut self, of_256: u8) -> bool {
        self.byte() < of_256
    }

    /// A number in a range, or now and then any other.
    pub fn number(&mut self, range: Range<f64>) -> f64 {
        if self.wild && self.chance(8) {
            return WILD[self.below(WILD.len())];
        }
        let fine = self.below(1 << 16) as f64 + self.below(1 << 16) as f64 / 65536.0;
        range.start + (range.end - range.start) * fine / 65536.0
    }

    /// Samples: noise, all alike, or both by turns.
    pub fn samples(&mut self, count: usize) -> Vec<u8> {
        let (alike, noisy) = (self.byte(), self.byte());
        let mut random = Random(u64::from(self.byte()) + 1);
        (0..count)
            .map(|k| {
                let noise = random.byte();
                if k / 5000 % 2 == usize::from(noisy % 2) || noisy > 200 {
                    noise
                } else {
                    alike
                }
            })
            .collect()
    }
}

/// Pseudo-random bytes.
pub struct Random(pub u64);

impl Random {
    pub fn byte(&mut self) -> u8 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 56) as u8
    }
}
