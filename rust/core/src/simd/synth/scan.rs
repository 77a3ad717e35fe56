//! Running sums in place: shuffles that the compiler does not find by itself.

/// Replaces each word by `sum` plus all words up to it, wrapping.
pub(super) fn portable(mut sum: i64, words: &mut [i64]) {
    for word in words {
        sum = sum.wrapping_add(*word);
        *word = sum;
    }
}

/// [`portable`] from 0.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
pub(super) fn avx512(words: &mut [i64]) {
    use std::arch::x86_64::*;
    let zero = _mm512_setzero_si512();
    let last = _mm512_set1_epi64(7);
    let mut carry = zero;
    let (groups, rest) = words.as_chunks_mut::<8>();
    for group in groups {
        // SAFETY: a group is 64 bytes that may be read.
        let mut sums = unsafe { _mm512_loadu_epi64(group.as_ptr()) };
        sums = _mm512_add_epi64(sums, _mm512_alignr_epi64::<7>(sums, zero));
        sums = _mm512_add_epi64(sums, _mm512_alignr_epi64::<6>(sums, zero));
        sums = _mm512_add_epi64(sums, _mm512_alignr_epi64::<4>(sums, zero));
        let from_start = _mm512_add_epi64(sums, carry);
        // SAFETY: a group is 64 bytes that may be written.
        unsafe { _mm512_storeu_epi64(group.as_mut_ptr(), from_start) };
        carry = _mm512_add_epi64(carry, _mm512_permutexvar_epi64(last, sums));
    }
    portable(_mm_cvtsi128_si64(_mm512_castsi512_si128(carry)), rest);
}

#[cfg(test)]
mod tests {
    use super::super::Loops;
    use crate::simd::Level;

    #[test]
    fn every_level_sums_and_wraps() {
        for length in [0, 1, 7, 8, 9, 64, 1001] {
            let word = |k: usize| (k as i64 + 1).wrapping_mul(0x1234_5678_9abc_def1);
            let words: Vec<i64> = (0..length).map(word).collect();
            let mut sum = 0i64;
            let expected: Vec<i64> = words
                .iter()
                .map(|w| {
                    sum = sum.wrapping_add(*w);
                    sum
                })
                .collect();
            for level in Level::available() {
                let mut seen = words.clone();
                Loops::new(level).running_sum(&mut seen);
                assert_eq!(seen, expected, "{level:?}, {length} words");
            }
        }
    }
}
