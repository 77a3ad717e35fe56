//! Subframes of D1 and D2 (BDS-SIS-ICD-B1I-3.0 section 5.1.3): 300 bits in ten words.
//!
//! Word 1 has 15 bits that are not coded and one code word of BCH(15,11); words 2 to 10 have two
//! each, sent bit by bit in turn. Bits are in the ICD's order, information of both code words first.

use super::bch15::{self, INFORMATION, LENGTH};
use super::hard;

/// Bits of a subframe.
pub const SUBFRAME: usize = 300;
/// Its code words.
pub const BLOCKS: usize = 19;
const WORD: usize = 2 * LENGTH;
/// Symbols are never taken to be surer than this.
const LEAST_NOISE: f64 = 1e-3;

/// Word of a subframe and half of it that a code word is.
fn word_and_half(block: usize) -> (usize, usize) {
    (block.div_ceil(2), (block + 1) % 2)
}

/// Where a code word's bits lie in the symbols as they are sent.
pub fn sent(block: usize) -> [usize; LENGTH] {
    let (word, half) = word_and_half(block);
    if word == 0 {
        return std::array::from_fn(|k| LENGTH + k);
    }
    std::array::from_fn(|k| WORD * word + half + 2 * k)
}

/// Where they lie in the subframe as the ICD numbers its bits.
pub fn places(block: usize) -> [usize; LENGTH] {
    let (word, half) = word_and_half(block);
    if word == 0 {
        return sent(block);
    }
    let start = WORD * word;
    std::array::from_fn(|k| match k.checked_sub(INFORMATION) {
        None => start + INFORMATION * half + k,
        Some(parity) => start + 2 * INFORMATION + 4 * half + parity,
    })
}

/// Fill in the parity of a subframe's bits; the bits in the order in which they are sent.
pub fn encode(bits: &mut [u8; SUBFRAME]) -> [u8; SUBFRAME] {
    let mut symbols = *bits;
    for block in 0..BLOCKS {
        let (from, to) = (places(block), sent(block));
        let word = bch15::encode(&std::array::from_fn(|k| bits[from[k]]));
        for (k, bit) in word.into_iter().enumerate() {
            bits[from[k]] = bit;
            symbols[to[k]] = bit;
        }
    }
    symbols
}

/// What a subframe said.
pub struct Decoded {
    /// In the ICD's order.
    pub bits: [u8; SUBFRAME],
    /// Bits of each code word that differ from the hard decisions.
    pub corrected: [usize; BLOCKS],
    /// Probability that a code word is wrong; 0 where hard decisions cannot tell.
    pub doubt: [f64; BLOCKS],
}

/// Most likely bits of symbols as sent, of amplitude 1 in noise of that standard deviation.
pub fn decode(soft: &[f32; SUBFRAME], noise: f64) -> Decoded {
    decoded(soft.map(hard), |at| {
        let found = bch15::most_likely(&at.map(|k| soft[k]), noise.max(LEAST_NOISE));
        (found.word, found.corrected, found.doubt)
    })
}

/// Bits as sent with one error repaired in each code word.
pub fn correct(symbols: &[u8; SUBFRAME]) -> Decoded {
    decoded(*symbols, |at| {
        let mut word = at.map(|k| symbols[k]);
        let corrected = bch15::correct(&mut word);
        (word, corrected, 0.0)
    })
}

fn decoded(
    mut bits: [u8; SUBFRAME],
    word_at: impl Fn([usize; LENGTH]) -> ([u8; LENGTH], usize, f64),
) -> Decoded {
    let (mut corrected, mut doubt) = ([0; BLOCKS], [0.0; BLOCKS]);
    for block in 0..BLOCKS {
        let word;
        (word, corrected[block], doubt[block]) = word_at(sent(block));
        for (k, bit) in places(block).into_iter().zip(word) {
            bits[k] = bit;
        }
    }
    Decoded {
        bits,
        corrected,
        doubt,
    }
}

/// Which blocks of bits as sent are no code words.
pub fn wrong_blocks(symbols: &[u8; SUBFRAME]) -> [bool; BLOCKS] {
    std::array::from_fn(|block| !bch15::fits(&sent(block).map(|k| symbols[k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits() -> [u8; SUBFRAME] {
        std::array::from_fn(|k| u8::from(k * k % 7 < 3))
    }

    #[test]
    fn every_bit_has_one_place() {
        for layout in [sent, places] {
            let mut used: Vec<usize> = (0..BLOCKS).flat_map(layout).collect();
            used.sort_unstable();
            assert!(used.into_iter().eq(LENGTH..SUBFRAME));
        }
    }

    #[test]
    fn any_single_error_is_repaired() {
        let mut sent_bits = bits();
        let symbols = encode(&mut sent_bits);
        assert!(!wrong_blocks(&symbols).contains(&true));
        for k in LENGTH..SUBFRAME {
            let mut received = symbols;
            received[k] ^= 1;
            assert_eq!(wrong_blocks(&received).iter().filter(|&&w| w).count(), 1);
            let found = correct(&received);
            assert_eq!(
                (found.bits, found.corrected.iter().sum()),
                (sent_bits, 1usize)
            );
            let soft = received.map(|b| 1.0 - 2.0 * f32::from(b));
            assert_eq!(decode(&soft, 0.3).bits, sent_bits);
        }
    }

    #[test]
    fn soft_decisions_repair_two_weak_errors_of_a_block() {
        let mut sent_bits = bits();
        let symbols = encode(&mut sent_bits);
        let mut soft = symbols.map(|b| 1.0 - 2.0 * f32::from(b));
        let at = sent(7);
        for k in [at[2], at[9]] {
            soft[k] *= -0.2;
        }
        let found = decode(&soft, 0.4);
        assert_eq!((found.bits, found.corrected[7]), (sent_bits, 2));
        assert_ne!(correct(&soft.map(hard)).bits, sent_bits);
    }
}
