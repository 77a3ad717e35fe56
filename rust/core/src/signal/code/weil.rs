//! Weil codes: a Legendre sequence xor its own shift, truncated (BDS-SIS-ICD-B1C-1.0 section 5.2).

use super::chip;

/// Legendre sequence of prime length n: L(0) = 0, L(k) = 1 where k is a square mod n.
pub fn legendre(n: usize) -> Vec<u8> {
    let mut l = vec![0u8; n];
    for k in 1..n {
        l[k * k % n] = 1;
    }
    l[0] = 0;
    l
}

/// Truncated Weil code: `W(k; w) = L(k) xor L((k + w) mod n)`, `length` chips from the 1-based
/// truncation point `p`.
pub fn weil(n: usize, w: usize, p: usize, length: usize) -> Vec<i8> {
    let l = legendre(n);
    (0..length)
        .map(|i| {
            let k = (i + p - 1) % n;
            chip(l[k] ^ l[(k + w) % n])
        })
        .collect()
}
