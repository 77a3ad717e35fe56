//! Plain loops over lanes; the compiler vectorises them for the level.

use super::{Runs, Sums, TURN, UNIT};
use crate::dsp::ring::LANES;

/// I and Q of eight taps.
type Lanes = [i32; 2 * LANES];

pub(super) fn correlate(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    correlate_inline(runs, taps, sums)
}

/// The same for every level that has no form of its own.
#[inline(always)]
pub(super) fn correlate_inline(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    let mut done = 0;
    for (&tap, sums) in taps.iter().zip(sums) {
        done = match runs.runs_per_turn {
            2 => one::<2>(runs, tap, sums),
            4 => one::<4>(runs, tap, sums),
            _ => one::<UNIT>(runs, tap, sums),
        };
    }
    done
}

/// One group of taps; `PART` runs of a unit are summed at a time.
#[inline(always)]
fn one<const PART: usize>(runs: &Runs<'_>, tap: i64, sums: &mut Sums) -> usize {
    let table = &*TURN;
    let per_turn = runs.runs_per_turn.max(UNIT);
    let origin = runs.base.wrapping_add_signed(tap);
    let cells = runs.cells.as_flattened();
    let load = |position: u64| -> &Lanes {
        let cell = runs.geometry.cell(origin.wrapping_add(position));
        cells[2 * cell..].first_chunk().unwrap_or(&[0; 2 * LANES])
    };
    let mut first = runs.position(0);
    let mut before = *load(first);
    let mut edge = 0;
    while edge + per_turn < runs.edges.len() {
        let last = runs.position(edge + per_turn);
        if last as i64 > runs.limit {
            break;
        }
        let mut total: Lanes = [0; 2 * LANES];
        for unit in (edge..edge + per_turn).step_by(UNIT) {
            for part in (unit..unit + UNIT).step_by(PART) {
                // Twice the edges between, in turn plus and minus, less the outer ones.
                let mut inner: Lanes = [0; 2 * LANES];
                for i in 1..PART {
                    let edge = load(runs.position(part + i));
                    if i % 2 == 1 {
                        accumulate(&mut inner, edge, i32::wrapping_add);
                    } else {
                        accumulate(&mut inner, edge, i32::wrapping_sub);
                    }
                }
                let end = runs.position(part + PART);
                let after = load(end);
                for lane in 0..2 * LANES {
                    let outer = before[lane].wrapping_add(after[lane]);
                    let sum = inner[lane].wrapping_mul(2).wrapping_sub(outer);
                    total[lane] = total[lane].wrapping_add(sum);
                }
                before = *after;
                if PART < UNIT {
                    turn(sums, &total, runs.turn(table, first, end));
                    total = [0; 2 * LANES];
                    first = end;
                }
            }
        }
        if PART == UNIT {
            turn(sums, &total, runs.turn(table, first, last));
        }
        first = last;
        edge += per_turn;
    }
    edge
}

#[inline(always)]
fn accumulate(sum: &mut Lanes, edge: &Lanes, add: impl Fn(i32, i32) -> i32) {
    for (s, &e) in sum.iter_mut().zip(edge) {
        *s = add(*s, e);
    }
}

/// Adds (I + jQ)(c - js).
#[inline(always)]
fn turn(sums: &mut Sums, total: &Lanes, phasor: [i32; 2]) {
    let [c, s] = phasor.map(i64::from);
    for lane in 0..LANES {
        let (i, q) = (i64::from(total[2 * lane]), i64::from(total[2 * lane + 1]));
        sums[0][lane] += i * c + q * s;
        sums[1][lane] += q * c - i * s;
    }
}
