//! AVX-512: one vector holds I and Q of eight taps; eight edges are found at a time.

use std::arch::x86_64::*;

use super::{Runs, Sums, FRACTION, TURN, UNIT};
use crate::dsp::ring::{Sum, LANES};

/// # Safety
/// The processor must have the level, and the caller have checked the runs' shape.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
pub(super) unsafe fn correlate(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    // SAFETY: handed on.
    unsafe {
        match runs.runs_per_turn {
            2 => passes::<2>(runs, taps, sums),
            4 => passes::<4>(runs, taps, sums),
            _ => passes::<UNIT>(runs, taps, sums),
        }
    }
}

/// Up to three groups of taps share the edges' positions and turns; more need more passes.
///
/// # Safety
/// As [`correlate`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
unsafe fn passes<const PART: usize>(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    let (mut at, mut done) = (0, 0);
    macro_rules! pass {
        ($n:literal) => {
            if let (Some(t), Some(s)) = (taps[at..].first_chunk(), sums[at..].first_chunk_mut()) {
                // SAFETY: handed on.
                done = unsafe { pass::<$n, PART>(runs, t, s) };
                at += $n;
            }
        };
    }
    while at < taps.len() {
        match taps.len() - at {
            1 => pass!(1),
            2 => pass!(2),
            _ => pass!(3),
        }
    }
    done
}

/// # Safety
/// As [`correlate`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
unsafe fn pass<const N: usize, const PART: usize>(
    runs: &Runs<'_>,
    taps: &[i64; N],
    sums: &mut [Sums; N],
) -> usize {
    let table = &*TURN;
    let geometry = runs.geometry;
    let per_turn = runs.runs_per_turn.max(UNIT);
    let step = _mm512_set1_epi64(runs.step as i64);
    let fraction = _mm512_set1_epi64(runs.rounding() as i64);
    let rows = _mm512_set1_epi64(geometry.rows as i64 - 1);
    let strides: [u64; LANES] = std::array::from_fn(|plane| (plane * geometry.stride) as u64);
    let cells = runs.cells.as_ptr();
    let mut first = runs.position(0);
    let mut edge = 0;
    // SAFETY: vectors are read from and written to arrays of their size, or eight cells at a
    // cell of the ring: its row is below `rows` and its plane below 8, and the caller has checked
    // that eight cells from there are inside.
    unsafe {
        let planes = _mm512_loadu_si512(strides.as_ptr().cast());
        let zero = _mm512_setzero_si512();
        let mut origins = [zero; N];
        let mut before = [zero; N];
        let mut result = [[zero; 2]; N];
        for n in 0..N {
            let origin = runs.base.wrapping_add_signed(taps[n]);
            origins[n] = _mm512_set1_epi64(origin as i64);
            before[n] = load(cells, geometry.cell(origin.wrapping_add(first)) as u64);
            for k in 0..2 {
                result[n][k] = _mm512_loadu_si512(sums[n][k].as_ptr().cast());
            }
        }
        while edge + per_turn < runs.edges.len() {
            let last = runs.position(edge + per_turn);
            if last as i64 > runs.limit {
                break;
            }
            let mut total = [zero; N];
            for _ in 0..per_turn / UNIT {
                let edges = runs.edges[edge + 1..edge + 1 + UNIT].as_ptr();
                let chips = _mm512_cvtepu16_epi64(_mm_loadu_si128(edges.cast()));
                let exact = _mm512_add_epi64(_mm512_mullo_epi64(chips, step), fraction);
                let position = _mm512_srli_epi64::<FRACTION>(exact);
                let mut at = [0u64; UNIT];
                if PART < UNIT {
                    _mm512_storeu_si512(at.as_mut_ptr().cast(), position);
                }
                for n in 0..N {
                    let k = _mm512_add_epi64(position, origins[n]);
                    let row = _mm512_and_si512(_mm512_srli_epi64::<3>(k), rows);
                    let cell = _mm512_add_epi64(_mm512_permutexvar_epi64(k, planes), row);
                    let mut c = [0u64; UNIT];
                    _mm512_storeu_si512(c.as_mut_ptr().cast(), cell);
                    let mut begin = first;
                    for part in (0..UNIT).step_by(PART) {
                        // Twice the edges between, in turn plus and minus, less the outer ones.
                        let mut inner = load(cells, c[part]);
                        for i in (part + 1..part + PART - 1).step_by(2) {
                            inner = _mm512_sub_epi32(inner, load(cells, c[i]));
                            inner = _mm512_add_epi32(inner, load(cells, c[i + 1]));
                        }
                        let after = load(cells, c[part + PART - 1]);
                        let outer = _mm512_add_epi32(before[n], after);
                        let sum = _mm512_sub_epi32(_mm512_add_epi32(inner, inner), outer);
                        before[n] = after;
                        if PART == UNIT {
                            total[n] = _mm512_add_epi32(total[n], sum);
                        } else {
                            let end = at[part + PART - 1];
                            turn(&mut result[n], sum, runs.turn(table, begin, end));
                            begin = end;
                        }
                    }
                }
                if PART < UNIT {
                    first = at[UNIT - 1];
                }
                edge += UNIT;
            }
            if PART == UNIT {
                let phasor = runs.turn(table, first, last);
                for n in 0..N {
                    turn(&mut result[n], total[n], phasor);
                }
            }
            first = last;
        }
        for n in 0..N {
            for k in 0..2 {
                _mm512_storeu_si512(sums[n][k].as_mut_ptr().cast(), result[n][k]);
            }
        }
    }
    edge
}

/// # Safety
/// Eight cells from `cell` must be inside.
#[inline]
#[target_feature(enable = "avx512f")]
unsafe fn load(cells: *const Sum, cell: u64) -> __m512i {
    // SAFETY: by the caller.
    unsafe { _mm512_loadu_si512(cells.add(cell as usize).cast()) }
}

/// Adds (I + jQ)(c - js).
#[inline]
#[target_feature(enable = "avx512f")]
fn turn([re, im]: &mut [__m512i; 2], sum: __m512i, [c, s]: [i32; 2]) {
    let q = _mm512_srli_epi64::<32>(sum);
    let (c, s) = (
        _mm512_set1_epi64(i64::from(c)),
        _mm512_set1_epi64(i64::from(s)),
    );
    // The product takes the low halves as signed numbers.
    let real = _mm512_add_epi64(_mm512_mul_epi32(sum, c), _mm512_mul_epi32(q, s));
    let imaginary = _mm512_sub_epi64(_mm512_mul_epi32(q, c), _mm512_mul_epi32(sum, s));
    *re = _mm512_add_epi64(*re, real);
    *im = _mm512_add_epi64(*im, imaginary);
}
