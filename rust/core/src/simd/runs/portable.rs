//! Plain loops over lanes; the compiler vectorises them for the level.

use super::{Runs, Sums, TURN, UNIT};
use crate::dsp::ring::{Sum, LANES};

pub(super) fn correlate(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    correlate_inline(runs, taps, sums)
}

/// The same for every level that has no form of its own.
#[inline(always)]
pub(super) fn correlate_inline(runs: &Runs<'_>, taps: &[i64], sums: &mut [Sums]) -> usize {
    let per_turn = runs.runs_per_turn.max(UNIT);
    let turns = (runs.edges.len() - 1) / per_turn;
    let done = (0..turns)
        .take_while(|t| runs.position((t + 1) * per_turn) as i64 <= runs.limit)
        .count()
        * per_turn;
    for (&tap, sums) in taps.iter().zip(sums) {
        one(runs, tap, done, sums);
    }
    done
}

/// One group of taps over the runs up to edge `done`.
#[inline(always)]
fn one(runs: &Runs<'_>, tap: i64, done: usize, sums: &mut Sums) {
    let table = &*TURN;
    let origin = runs.base.wrapping_add_signed(tap);
    let load = |position: u64| -> &[Sum; LANES] {
        let cell = runs.geometry.cell(origin.wrapping_add(position));
        runs.cells[cell..].first_chunk().unwrap_or(&[[0; 2]; LANES])
    };
    let mut position = runs.position(0);
    let mut before = load(position);
    let mut first = position;
    let mut total = [[0i32; 2]; LANES];
    for pair in 0..done / 2 {
        // Two runs, plus and minus: twice the edge between, less the outer ones.
        let middle = load(runs.position(2 * pair + 1));
        position = runs.position(2 * pair + 2);
        let after = load(position);
        for lane in 0..LANES {
            for k in 0..2 {
                let m = middle[lane][k];
                let outer = before[lane][k].wrapping_add(after[lane][k]);
                total[lane][k] = total[lane][k]
                    .wrapping_add(m.wrapping_add(m))
                    .wrapping_sub(outer);
            }
        }
        before = after;
        if (2 * pair + 2) % runs.runs_per_turn == 0 {
            let [c, s] = runs.turn(table, first, position).map(i64::from);
            for lane in 0..LANES {
                let [i, q] = total[lane].map(i64::from);
                sums[0][lane] += i * c + q * s;
                sums[1][lane] += q * c - i * s;
            }
            total = [[0; 2]; LANES];
            first = position;
        }
    }
}
