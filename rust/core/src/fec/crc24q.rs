//! CRC-24Q, which ends subframes 2 and 3 of B-CNAV1 (BDS-SIS-ICD-B1C-1.0 section 6.1.2).

/// x^24 + x^23 + x^18 + x^17 + x^14 + x^11 + x^10 + x^7 + x^6 + x^5 + x^4 + x^3 + x + 1.
const GENERATOR: u32 = 0x86_4CFB;
const MASK: u32 = 0xFF_FFFF;

/// Length of the check in bits.
pub const LENGTH: usize = 24;

/// The 24 check bits as a number, first one most significant.
pub fn crc24q(bits: &[u8]) -> u32 {
    bits.iter().fold(0, |crc, &bit| {
        let feedback = (crc >> 23) ^ u32::from(bit & 1);
        ((crc << 1) & MASK) ^ (feedback * GENERATOR)
    })
}

/// Put the check behind the bits.
pub fn append(bits: &mut Vec<u8>) {
    let crc = crc24q(bits);
    bits.extend((0..LENGTH).rev().map(|k| (crc >> k & 1) as u8));
}

/// Whether bits end with their own check.
pub fn holds(bits: &[u8]) -> bool {
    bits.len() > LENGTH && crc24q(bits) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits_of(bytes: &[u8]) -> Vec<u8> {
        bytes
            .iter()
            .flat_map(|b| (0..8).rev().map(move |k| b >> k & 1))
            .collect()
    }

    #[test]
    fn check_value_of_the_catalogue() {
        // CRC-24/LTE-A, the same generator and start: check value of "123456789" (3GPP TS 36.212).
        assert_eq!(crc24q(&bits_of(b"123456789")), 0xCD_E703);
    }

    #[test]
    fn appended_check_holds_and_every_single_error_breaks_it() {
        let mut bits = bits_of(b"B-CNAV1 subframe");
        append(&mut bits);
        assert!(holds(&bits));
        for k in 0..bits.len() {
            bits[k] ^= 1;
            assert!(!holds(&bits));
            bits[k] ^= 1;
        }
    }
}
