//! BCH(15,11,1) of the D1 and D2 messages (BDS-SIS-ICD-B1I-3.0 section 5.1.3).
//!
//! A word of 30 bits holds two code words, sent bit by bit in turn. The first word of a subframe
//! holds one code word, in its last 15 bits, behind 15 bits without protection.

/// Information bits of a code word.
pub const INFORMATION: usize = 11;
/// Bits of a code word.
pub const LENGTH: usize = 15;
/// Bits of a word of two.
pub const WORD: usize = 2 * LENGTH;

/// g(x) = x^4 + x + 1.
const GENERATOR: u16 = 0b1_0011;

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

/// Repair a single error in place; the bits changed, 0 or 1. Two errors become three: every
/// pattern is within one bit of some code word.
pub fn correct(word: &mut [u8; LENGTH]) -> usize {
    let syndrome = remainder(word.iter().copied());
    if syndrome == 0 {
        return 0;
    }
    // A single error of position k leaves the remainder of x^(14 - k), each one different.
    let mut power = 1u16;
    for k in (0..LENGTH).rev() {
        if power == syndrome {
            word[k] ^= 1;
            break;
        }
        power <<= 1;
        if power & 0b1_0000 != 0 {
            power ^= GENERATOR;
        }
    }
    1
}

/// A word as sent, from 22 information bits.
pub fn encode_word(information: &[u8; 2 * INFORMATION]) -> [u8; WORD] {
    let half = |k: usize| {
        let mut bits = [0; INFORMATION];
        bits.copy_from_slice(&information[k * INFORMATION..][..INFORMATION]);
        encode(&bits)
    };
    let halves = [half(0), half(1)];
    std::array::from_fn(|k| halves[k % 2][k / 2])
}

/// Corrected bits of a received word, 22 of information then 8 of parity (first code word's
/// first), and how many were changed.
pub fn decode_word(word: &[u8; WORD]) -> ([u8; WORD], usize) {
    let mut bits = [0; WORD];
    let mut corrected = 0;
    for half in 0..2 {
        let mut code: [u8; LENGTH] = std::array::from_fn(|k| word[2 * k + half]);
        corrected += correct(&mut code);
        bits[half * INFORMATION..][..INFORMATION].copy_from_slice(&code[..INFORMATION]);
        bits[2 * INFORMATION + 4 * half..][..4].copy_from_slice(&code[INFORMATION..]);
    }
    (bits, corrected)
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let word = encode(&std::array::from_fn(|k| (n >> (10 - k) & 1) as u8));
            let number = word.iter().fold(0u16, |v, &b| v << 1 | u16::from(b));
            assert!(H.iter().all(|row| (row & number).count_ones() % 2 == 0));
        }
    }

    #[test]
    fn single_errors_are_repaired_wherever_they_are() {
        let information: [u8; 22] = std::array::from_fn(|k| u8::from(k * k % 7 < 3));
        let sent = encode_word(&information);
        for k in 0..WORD {
            let mut word = sent;
            word[k] ^= 1;
            let (bits, corrected) = decode_word(&word);
            assert_eq!((&bits[..22], corrected), (&information[..], 1));
        }
        let (bits, corrected) = decode_word(&sent);
        assert_eq!((&bits[..22], corrected), (&information[..], 0));
    }

    #[test]
    fn two_errors_in_different_code_words_are_repaired() {
        let information = [1; 22];
        let mut word = encode_word(&information);
        word[4] ^= 1;
        word[9] ^= 1;
        let (bits, corrected) = decode_word(&word);
        assert_eq!((&bits[..22], corrected), (&information[..], 2));
    }
}
