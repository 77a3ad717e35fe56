//! Sequential decision statistics: from samples in standard deviations to the path of a statistic.
//!
//! A kernel sees the available samples of one row, in order, and writes one value for each; rows
//! (satellites, runs) are independent. What is not a finite number is a sample that is missing: it
//! is skipped, and its place in the path is NaN.

pub mod cusum;
pub mod likelihood;
pub mod sprt;
pub mod windows;

use rayon::prelude::*;

/// The path of a statistic over every row of `columns` samples.
pub fn paths(
    samples: &[f64],
    columns: usize,
    kernel: impl Fn(&[f64], &mut [f64]) + Sync,
) -> Vec<f64> {
    let mut out = vec![f64::NAN; samples.len()];
    if columns > 0 {
        out.par_chunks_mut(columns)
            .zip(samples.par_chunks(columns))
            .for_each(|(path, row)| one(row, path, &kernel));
    }
    out
}

fn one(row: &[f64], path: &mut [f64], kernel: &impl Fn(&[f64], &mut [f64])) {
    if row.iter().all(|z| z.is_finite()) {
        return kernel(row, path);
    }
    let there: Vec<usize> = (0..row.len()).filter(|k| row[*k].is_finite()).collect();
    let packed: Vec<f64> = there.iter().map(|k| row[*k]).collect();
    let mut found = vec![f64::NAN; packed.len()];
    kernel(&packed, &mut found);
    for (k, value) in there.into_iter().zip(found) {
        path[k] = value;
    }
}

#[cfg(test)]
pub(crate) mod reference {
    /// Samples that look random, the same each time.
    pub fn samples(count: usize) -> Vec<f64> {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        (0..count)
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 11) as f64 / (1_u64 << 53) as f64 * 4.0 - 2.0
            })
            .collect()
    }

    pub fn close(left: &[f64], right: &[f64]) {
        assert_eq!(left.len(), right.len());
        for (k, (a, b)) in left.iter().zip(right).enumerate() {
            assert!(
                (a - b).abs() <= 1e-9 * (1.0 + b.abs()),
                "row {k}: {a} against {b}"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(row: &[f64], path: &mut [f64]) {
        let mut total = 0.0;
        for (z, out) in row.iter().zip(path) {
            total += z;
            *out = total;
        }
    }

    #[test]
    fn a_missing_sample_is_skipped() {
        let row = [
            1.0,
            f64::NAN,
            2.0,
            f64::INFINITY,
            3.0,
            10.0,
            10.0,
            10.0,
            10.0,
            10.0,
        ];
        let path = paths(&row, 5, sum);
        assert!(path[1].is_nan() && path[3].is_nan());
        assert_eq!(
            [path[0], path[2], path[4], path[5], path[9]],
            [1.0, 3.0, 6.0, 10.0, 50.0]
        );
    }

    #[test]
    fn nothing_gives_nothing() {
        assert!(paths(&[], 0, sum).is_empty());
    }
}
