//! BCH(15,11,1) of the D1 and D2 messages (BDS-SIS-ICD-B1I-3.0 section 5.1.3), hard and soft.
//!
//! The code is perfect: whatever is received is at most one bit from a code word, so that hard
//! decisions never tell that they are wrong. Soft decisions take the code word of largest
//! correlation among those up to three errors away, and tell the probability that it is wrong.

use std::sync::OnceLock;

use super::{doubt, hard};

/// Information bits of a code word.
pub const INFORMATION: usize = 11;
/// Bits of a code word.
pub const LENGTH: usize = 15;

/// g(x) = x^4 + x + 1.
const GENERATOR: u16 = 0b1_0011;
const SYNDROMES: usize = 1 << (LENGTH - INFORMATION);
const MOST_ERRORS: usize = 3;

/// Remainder of a code word, as a polynomial, by the generator; first bit highest power.
fn remainder(bits: impl Iterator<Item = u8>) -> u16 {
    bits.fold(0, |r, bit| {
        let shifted = r << 1 | u16::from(bit & 1);
        if shifted & 0b1_0000 != 0 {
            shifted ^ GENERATOR
        } else {
            shifted
        }
    })
}

/// Whether it is a code word.
pub fn fits(word: &[u8; LENGTH]) -> bool {
    remainder(word.iter().copied()) == 0
}

/// Code word of 11 information bits: they come first, then 4 bits of parity.
pub fn encode(information: &[u8; INFORMATION]) -> [u8; LENGTH] {
    let parity = remainder(information.iter().copied().chain([0; 4]));
    let mut word = [0; LENGTH];
    word[..INFORMATION].copy_from_slice(information);
    for (k, bit) in word[INFORMATION..].iter_mut().enumerate() {
        *bit = (parity >> (3 - k) & 1) as u8;
    }
    word
}

/// Repair a single error in place; the bits changed, 0 or 1. Two errors become three.
pub fn correct(word: &mut [u8; LENGTH]) -> usize {
    let syndrome = remainder(word.iter().copied());
    // Patterns of an error or none come first, one of them for each syndrome.
    let changed = patterns()[usize::from(syndrome)][0].into_iter();
    let changed = changed.filter(|&k| k < LENGTH);
    changed.map(|k| word[k] ^= 1).count()
}

/// A code word by soft decisions.
pub struct Likely {
    /// Information, then parity.
    pub word: [u8; LENGTH],
    /// Bits that differ from the hard decisions.
    pub corrected: usize,
    /// Probability that it is wrong.
    pub doubt: f64,
}

/// Most likely code word of symbols of amplitude 1, positive for 0, in noise of that standard
/// deviation.
pub fn most_likely(soft: &[f32; LENGTH], noise: f64) -> Likely {
    let mut word = soft.map(hard);
    let candidates = &patterns()[usize::from(remainder(word.iter().copied()))];
    let mut weights = [0.0f64; LENGTH + 1];
    for (weight, value) in weights.iter_mut().zip(soft) {
        *weight = f64::from(value.abs());
    }
    let costs = candidates
        .iter()
        .map(|p| p.iter().map(|&k| weights[k]).sum());
    let costs: Vec<f64> = costs.collect();
    let best = (1..costs.len()).fold(0, |b, k| if costs[k] < costs[b] { k } else { b });
    let changed = candidates[best].into_iter().filter(|&k| k < LENGTH);
    let corrected = changed.map(|k| word[k] ^= 1).count();
    let doubt = doubt::doubt(&costs, &mut weights[..LENGTH], MOST_ERRORS + 1, noise);
    Likely {
        word,
        corrected,
        doubt,
    }
}

/// Places of up to three errors, [`LENGTH`] for none, by the syndrome they leave; fewest first.
type Patterns = [Vec<[usize; MOST_ERRORS]>; SYNDROMES];

fn patterns() -> &'static Patterns {
    static PATTERNS: OnceLock<Patterns> = OnceLock::new();
    PATTERNS.get_or_init(|| {
        let mut found: Patterns = Default::default();
        for size in 0..=MOST_ERRORS {
            choose(size, 0, &mut Vec::new(), &mut found);
        }
        found
    })
}

fn choose(more: usize, from: usize, chosen: &mut Vec<usize>, found: &mut Patterns) {
    if more == 0 {
        let bits = (0..LENGTH).map(|k| u8::from(chosen.contains(&k)));
        let mut places = [LENGTH; MOST_ERRORS];
        places[..chosen.len()].copy_from_slice(chosen);
        found[usize::from(remainder(bits))].push(places);
        return;
    }
    for k in from..LENGTH {
        chosen.push(k);
        choose(more - 1, k + 1, chosen, found);
        chosen.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_noise::Normal;
    use super::*;

    fn word(n: u16) -> [u8; LENGTH] {
        encode(&std::array::from_fn(|k| (n >> (10 - k) & 1) as u8))
    }

    #[test]
    fn every_word_satisfies_the_check_matrix() {
        // Rows of H as public implementations of the ICD print them.
        const H: [u16; 4] = [
            0b111_1010_1100_1000,
            0b011_1101_0110_0100,
            0b001_1110_1011_0010,
            0b111_0101_1001_0001,
        ];
        for n in 0..1u16 << INFORMATION {
            let number = word(n).iter().fold(0u16, |v, &b| v << 1 | u16::from(b));
            assert!(H.iter().all(|row| (row & number).count_ones() % 2 == 0));
            assert!(fits(&word(n)));
        }
    }

    #[test]
    fn single_errors_are_repaired_wherever_they_are() {
        let sent = word(0b101_1001_0110);
        for k in 0..LENGTH {
            let mut found = sent;
            found[k] ^= 1;
            assert!(!fits(&found));
            assert_eq!((correct(&mut found), found), (1, sent));
        }
        let mut found = sent;
        assert_eq!((correct(&mut found), found), (0, sent));
    }

    #[test]
    fn soft_decisions_are_the_nearest_of_all_code_words() {
        let mut random = Normal::new(15);
        let words: Vec<[u8; LENGTH]> = (0..1 << INFORMATION).map(word).collect();
        let distance = |soft: &[f32; LENGTH], w: &[u8; LENGTH]| -> f32 {
            let signs = w.iter().map(|&b| 1.0 - 2.0 * f32::from(b));
            -soft.iter().zip(signs).map(|(v, s)| v * s).sum::<f32>()
        };
        for sent in words.iter().step_by(97) {
            let soft = sent.map(|b| 1.0 - 2.0 * f32::from(b) + 0.6 * random.next());
            let nearest = words
                .iter()
                .min_by(|a, b| distance(&soft, a).total_cmp(&distance(&soft, b)));
            let found = most_likely(&soft, 0.6);
            assert_eq!(&found.word, nearest.unwrap());
            let changed = found.word.iter().zip(&soft).filter(|(&b, &v)| b != hard(v));
            assert_eq!(found.corrected, changed.count());
        }
    }

    #[test]
    fn doubt_is_a_half_between_two_words() {
        let sent = word(0b110_0011_0101);
        let mut soft = sent.map(|b| 1.0 - 2.0 * f32::from(b));
        let sure = most_likely(&soft, 0.3);
        assert!(sure.word == sent && sure.doubt < 1e-7);
        // Three symbols between this word and the nearest other one.
        let other = (0..1 << INFORMATION).map(word).find(|w| {
            let differ = w.iter().zip(&sent).filter(|(a, b)| a != b).count();
            differ == 3
        });
        for (value, (a, b)) in soft.iter_mut().zip(sent.iter().zip(other.unwrap())) {
            if *a != b {
                *value = 0.0;
            }
        }
        assert!((most_likely(&soft, 0.3).doubt - 0.5).abs() < 1e-3);
    }
}
