//! BCH(21,6) and BCH(51,8) of subframe 1 of B-CNAV1 (BDS-SIS-ICD-B1C-1.0 section 6.2.2.1).
//!
//! Code words are the output of a shift register that starts with the information bits, so they
//! begin with them. With 64 and 256 code words the decoder compares them all: the correlations
//! with every word of a linear code are one Walsh-Hadamard transform.

/// Symbols of the PRN's code word.
pub const PRN_LENGTH: usize = 21;
/// Symbols of the code word of the seconds of the hour.
pub const SOH_LENGTH: usize = 51;
/// Frames in an hour: the seconds of the hour count from 0 to 199 in steps of 18 s.
pub const FRAMES_PER_HOUR: usize = 200;
/// Largest PRN that 6 bits hold.
pub const LARGEST_PRN: usize = 63;

/// A code: 2^bits words of some length.
pub struct Code {
    bits: usize,
    length: usize,
    /// Bit k set: the next symbol depends on the one k after the oldest in the register.
    taps: u32,
}

/// g(x) = x^6 + x^4 + x^2 + x + 1, of the PRN.
pub const PRN: Code = Code {
    bits: 6,
    length: PRN_LENGTH,
    taps: 0b01_0111,
};

/// g(x) = x^8 + x^7 + x^4 + x^3 + x^2 + x + 1, of the seconds of the hour.
pub const SOH: Code = Code {
    bits: 8,
    length: SOH_LENGTH,
    taps: 0b1001_1111,
};

/// The most likely word.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// What it says.
    pub value: usize,
    /// Its correlation with the soft values.
    pub correlation: f32,
    /// How far the second best is behind.
    pub margin: f32,
    /// Symbols whose sign disagrees.
    pub errors: usize,
}

impl Code {
    /// Code word of a number, as bits.
    ///
    /// # Panics
    /// If it has more bits than the code carries.
    pub fn word(&self, value: usize) -> Vec<u8> {
        assert!(value >> self.bits == 0, "{value} needs more bits");
        let mut word: Vec<u8> = (0..self.bits)
            .rev()
            .map(|k| (value >> k & 1) as u8)
            .collect();
        for k in self.bits..self.length {
            let register = &word[k - self.bits..k];
            let next = (0..self.bits).fold(0, |sum, t| sum ^ register[t] & (self.taps >> t) as u8);
            word.push(next & 1);
        }
        word
    }

    /// Correlation of soft values with every code word, by its number.
    pub fn correlations(&self, values: &[f32]) -> Vec<f32> {
        let mut sums = vec![0.0; 1 << self.bits];
        for (&value, combination) in values.iter().zip(self.combinations()) {
            sums[combination] += value;
        }
        let mut half = 1;
        while half < sums.len() {
            for pair in sums.chunks_exact_mut(2 * half) {
                let (low, high) = pair.split_at_mut(half);
                for (a, b) in low.iter_mut().zip(high) {
                    (*a, *b) = (*a + *b, *a - *b);
                }
            }
            half *= 2;
        }
        sums
    }

    /// Of which information bits each symbol is the sum.
    fn combinations(&self) -> impl Iterator<Item = usize> {
        let words: Vec<Vec<u8>> = (0..self.bits).map(|k| self.word(1 << k)).collect();
        (0..self.length).map(move |symbol| {
            let bit = |k: usize| usize::from(words[k][symbol]) << k;
            (0..words.len()).map(bit).sum()
        })
    }

    /// The word that soft values agree with best, of the numbers in a range.
    pub fn decode(&self, values: &[f32], numbers: std::ops::Range<usize>) -> Choice {
        let correlations = self.correlations(values);
        let (mut best, mut second) = (numbers.start, f32::NEG_INFINITY);
        for n in numbers.skip(1) {
            if correlations[n] > correlations[best] {
                (best, second) = (n, correlations[best]);
            } else {
                second = second.max(correlations[n]);
            }
        }
        let word = self.word(best);
        let wrong = |(&v, &b): (&f32, &u8)| super::hard(v) != b;
        Choice {
            value: best,
            correlation: correlations[best],
            margin: correlations[best] - second,
            errors: values.iter().zip(&word).filter(|&x| wrong(x)).count(),
        }
    }
}

/// The PRN that 21 soft values spell.
pub fn decode_prn(values: &[f32]) -> Choice {
    PRN.decode(values, 1..LARGEST_PRN + 1)
}

/// The frame's number within the hour that 51 soft values spell.
pub fn decode_soh(values: &[f32]) -> Choice {
    SOH.decode(values, 0..FRAMES_PER_HOUR)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(word: &[u8]) -> u64 {
        word.iter().fold(0, |n, &b| n << 1 | u64::from(b))
    }

    fn soft(word: &[u8]) -> Vec<f32> {
        word.iter().map(|&b| 1.0 - 2.0 * f32::from(b)).collect()
    }

    #[test]
    fn words_are_those_of_a_published_table() {
        // From the tables of a public simulator (SignalSim, BCNav1Bit.cpp).
        for (prn, word) in [
            (1, 0x00_A4CB),
            (2, 0x01_4996),
            (19, 0x09_960A),
            (63, 0x1F_9C46),
        ] {
            assert_eq!(number(&PRN.word(prn)), word, "PRN {prn}");
        }
        for (soh, word) in [
            (1, 0x0F3A_905B_4BE3),
            (2, 0x114F_B0ED_DC25),
            (100, 0x3_2378_33D0_D136),
            (199, 0x6_3F24_E57B_FD74),
        ] {
            assert_eq!(number(&SOH.word(soh)), word, "SOH {soh}");
        }
    }

    #[test]
    fn every_word_is_decoded_through_errors() {
        // Minimum distances are 8 and 24: 3 and 11 errors are always repaired.
        for (code, numbers, errors) in [(PRN, 1..64, 3), (SOH, 0..200, 11)] {
            for n in numbers.clone() {
                let mut values = soft(&code.word(n));
                for k in 0..errors {
                    values[(7 * n + 5 * k) % code.length] *= -1.0;
                }
                let choice = code.decode(&values, numbers.clone());
                assert_eq!((choice.value, choice.errors), (n, errors));
                assert!(choice.margin > 0.0);
            }
        }
    }

    #[test]
    fn correlations_are_sums_of_products() {
        let values: Vec<f32> = (0..51)
            .map(|k| ((k * 37 % 19) as f32 - 9.0) / 4.0)
            .collect();
        let all = SOH.correlations(&values);
        for n in [0, 1, 77, 255] {
            let sum: f32 = soft(&SOH.word(n))
                .iter()
                .zip(&values)
                .map(|(a, b)| a * b)
                .sum();
            assert!((sum - all[n]).abs() < 1e-4);
        }
    }
}
