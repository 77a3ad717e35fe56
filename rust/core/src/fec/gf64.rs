//! Arithmetic of GF(64), primitive polynomial 1 + x + x^6 (BDS-SIS-ICD-B1C-1.0 section 6.2.2).
//!
//! An element is the number that its bits spell, most significant first; adding is exclusive or.

/// Number of elements.
pub const SIZE: usize = 64;

const POLYNOMIAL: u8 = 0b100_0011;

/// Products of all pairs.
pub static PRODUCT: [[u8; SIZE]; SIZE] = products();

const fn product(mut a: u8, b: u8) -> u8 {
    let mut sum = 0;
    let mut k = 0;
    while k < 6 {
        if b >> k & 1 == 1 {
            sum ^= a;
        }
        a <<= 1;
        if a & 64 != 0 {
            a ^= POLYNOMIAL;
        }
        k += 1;
    }
    sum
}

const fn products() -> [[u8; SIZE]; SIZE] {
    let mut table = [[0; SIZE]; SIZE];
    let mut a = 0;
    while a < SIZE {
        let mut b = 0;
        while b < SIZE {
            table[a][b] = product(a as u8, b as u8);
            b += 1;
        }
        a += 1;
    }
    table
}

/// The element whose product with a non-zero one is 1.
pub fn inverse(a: u8) -> u8 {
    (1..SIZE as u8)
        .find(|&b| PRODUCT[usize::from(a)][usize::from(b)] == 1)
        .expect("zero has no inverse")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_those_of_the_icd() {
        // First and last powers of the vector table in the ICD's annex.
        let powers: Vec<u8> = std::iter::successors(Some(1u8), |&a| Some(PRODUCT[2][a as usize]))
            .take(64)
            .collect();
        assert_eq!(powers[..12], [1, 2, 4, 8, 16, 32, 3, 6, 12, 24, 48, 35]);
        assert_eq!(powers[55..], [46, 31, 62, 63, 61, 57, 49, 33, 1]);
    }

    #[test]
    fn every_element_has_its_inverse() {
        for a in 1..64u8 {
            assert_eq!(PRODUCT[a as usize][inverse(a) as usize], 1);
        }
    }
}
