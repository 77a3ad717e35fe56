//! AVX2: two vectors hold I and Q of eight taps.

use std::arch::x86_64::*;

use super::{Runs, Sums, TURN, UNIT};
use crate::dsp::ring::{Sum, LANES};

/// I and Q of four taps, twice.
type Taps = [__m256i; 2];

/// # Safety
/// The processor must have AVX2, and the caller have checked the runs' shape.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn correlate(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    let mut done = 0;
    for (&tap, sums) in taps.iter().zip(sums) {
        // SAFETY: handed on.
        done = unsafe {
            match runs.runs_per_turn {
                2 => one::<2>(runs, tap, sums),
                4 => one::<4>(runs, tap, sums),
                _ => one::<UNIT>(runs, tap, sums),
            }
        };
    }
    done
}

/// One group of taps; `PART` runs of a unit are summed at a time.
///
/// # Safety
/// As [`correlate`].
#[target_feature(enable = "avx2")]
unsafe fn one<const PART: usize>(runs: &Runs<'_>, tap: i64, sums: &mut Sums) -> usize {
    let table = &*TURN;
    let per_turn = runs.runs_per_turn.max(UNIT);
    let origin = runs.base.wrapping_add_signed(tap);
    let cells = runs.cells.as_ptr();
    let mut first = runs.position(0);
    let mut edge = 0;
    // SAFETY: eight cells are read at a cell of the ring: its row is below `rows` and its plane
    // below 8, and the caller has checked that eight cells from there are inside.
    let at = |position: u64| unsafe {
        load(cells.add(runs.geometry.cell(origin.wrapping_add(position))))
    };
    let mut before = at(first);
    // SAFETY: arrays of the vectors' size are read.
    let mut result = unsafe { [halves(&sums[0]), halves(&sums[1])] };
    while edge + per_turn < runs.edges.len() {
        let last = runs.position(edge + per_turn);
        if last as i64 > runs.limit {
            break;
        }
        let mut total = [_mm256_setzero_si256(); 2];
        for unit in (edge..edge + per_turn).step_by(UNIT) {
            for part in (unit..unit + UNIT).step_by(PART) {
                let mut inner = at(runs.position(part + 1));
                for i in (2..PART).step_by(2) {
                    inner = sub(inner, at(runs.position(part + i)));
                    inner = add(inner, at(runs.position(part + i + 1)));
                }
                let end = runs.position(part + PART);
                let after = at(end);
                total = add(total, sub(add(inner, inner), add(before, after)));
                before = after;
                if PART < UNIT {
                    turn(&mut result, total, runs.turn(table, first, end));
                    total = [_mm256_setzero_si256(); 2];
                    first = end;
                }
            }
        }
        if PART == UNIT {
            turn(&mut result, total, runs.turn(table, first, last));
        }
        first = last;
        edge += per_turn;
    }
    for (sums, [low, high]) in sums.iter_mut().zip(result) {
        let to = sums.as_mut_ptr();
        // SAFETY: an array of the vectors' size is written.
        unsafe {
            _mm256_storeu_si256(to.cast(), low);
            _mm256_storeu_si256(to.add(LANES / 2).cast(), high);
        }
    }
    edge
}

/// # Safety
/// Eight cells must be there.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn load(cells: *const Sum) -> Taps {
    // SAFETY: by the caller.
    unsafe {
        [
            _mm256_loadu_si256(cells.cast()),
            _mm256_loadu_si256(cells.add(LANES / 2).cast()),
        ]
    }
}

/// # Safety
/// None, but that the processor has AVX2.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn halves(sums: &[i64; LANES]) -> Taps {
    // SAFETY: an array of the vectors' size is read.
    unsafe {
        [
            _mm256_loadu_si256(sums.as_ptr().cast()),
            _mm256_loadu_si256(sums.as_ptr().add(LANES / 2).cast()),
        ]
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn add([a, b]: Taps, [c, d]: Taps) -> Taps {
    [_mm256_add_epi32(a, c), _mm256_add_epi32(b, d)]
}

#[inline]
#[target_feature(enable = "avx2")]
fn sub([a, b]: Taps, [c, d]: Taps) -> Taps {
    [_mm256_sub_epi32(a, c), _mm256_sub_epi32(b, d)]
}

/// Adds (I + jQ)(c - js).
#[inline]
#[target_feature(enable = "avx2")]
fn turn(result: &mut [Taps; 2], total: Taps, [c, s]: [i32; 2]) {
    let (c, s) = (
        _mm256_set1_epi64x(i64::from(c)),
        _mm256_set1_epi64x(i64::from(s)),
    );
    let [re, im] = result;
    for ((re, im), sum) in re.iter_mut().zip(im).zip(total) {
        // The product takes the low halves as signed numbers.
        let q = _mm256_srli_epi64::<32>(sum);
        let real = _mm256_add_epi64(_mm256_mul_epi32(sum, c), _mm256_mul_epi32(q, s));
        let imaginary = _mm256_sub_epi64(_mm256_mul_epi32(q, c), _mm256_mul_epi32(sum, s));
        *re = _mm256_add_epi64(*re, real);
        *im = _mm256_add_epi64(*im, imaginary);
    }
}
