//! What later measurements say of earlier errors, carried backwards.
//!
//! Fixed-interval smoothing without the inverse of any covariance: G. J. Bierman, "Fixed interval
//! smoothing with discrete measurements", Int. J. Control 18 (1973), 65-75 (modified
//! Bryson-Frazier); the same estimate as that of H. E. Rauch, F. Tung, C. T. Striebel (1965), also
//! where a covariance is singular: biases that are no states, places that are remembered. With the
//! covariance P of an estimate the smoothed one is P l less, and its covariance P - P L P.

use super::covariance::{add_scaled, transpose, Transition};
use super::tape::Used;
use super::{CLOCK, NAV, POSITION};

/// The vector l and the matrix L of n states.
#[derive(Debug, Clone)]
pub struct Adjoint {
    n: usize,
    vector: Vec<f64>,
    matrix: Vec<f64>,
    work: Vec<f64>,
}

impl Adjoint {
    /// Nothing has come later.
    pub fn new(n: usize) -> Self {
        Adjoint {
            n,
            vector: vec![0.0; n],
            matrix: vec![0.0; n * n],
            work: vec![0.0; NAV * n],
        }
    }

    /// Before a measurement was used.
    pub fn used(&mut self, one: &Used<'_>) {
        let n = self.n;
        let product = &mut self.work[..n];
        for (value, row) in product.iter_mut().zip(self.matrix.chunks_exact(n)) {
            *value = dot(row, one.gain) / one.s;
        }
        let weight = (dot(product, one.gain) + 1.0) / one.s;
        let moves = (dot(&self.vector, one.gain) + one.innovation) / one.s;
        let entries = || one.columns.iter().map(|c| usize::from(*c)).zip(one.values);
        for (i, h) in entries() {
            self.vector[i] -= h * moves;
            add_scaled(&mut self.matrix[i * n..(i + 1) * n], -h, product);
            for (row, value) in self.matrix.chunks_exact_mut(n).zip(product.iter()) {
                row[i] -= h * value;
            }
        }
        for (i, h) in entries() {
            for (j, g) in entries() {
                self.matrix[i * n + j] += weight * h * g;
            }
        }
    }

    /// Before a step in which the states in `fading` kept a share of themselves.
    pub fn moved(&mut self, step: &Transition, fading: std::ops::Range<usize>, keeps: f64) {
        let back = |row: &mut [f64]| {
            let (navigation, _) = row.split_at_mut(NAV);
            step.carry_back(navigation.try_into().expect("navigation states"));
            row[fading.clone()].iter_mut().for_each(|x| *x *= keeps);
        };
        back(&mut self.vector);
        for _ in 0..2 {
            self.matrix.chunks_exact_mut(self.n).for_each(back);
            transpose(&mut self.matrix, self.n);
        }
        self.symmetrise();
    }

    /// What rounding makes skew is not damped by measurements and would grow from step to step.
    fn symmetrise(&mut self) {
        let n = self.n;
        for r in 0..n {
            for c in r + 1..n {
                let mean = 0.5 * (self.matrix[r * n + c] + self.matrix[c * n + r]);
                self.matrix[r * n + c] = mean;
                self.matrix[c * n + r] = mean;
            }
        }
    }

    /// Before position and clock were remembered as the states from `past` on.
    pub fn remembered(&mut self, past: usize) {
        let n = self.n;
        let back = |row: &mut [f64]| {
            for (k, source) in [POSITION, POSITION + 1, POSITION + 2, CLOCK]
                .into_iter()
                .enumerate()
            {
                row[source] += std::mem::take(&mut row[past + k]);
            }
        };
        back(&mut self.vector);
        for _ in 0..2 {
            self.matrix.chunks_exact_mut(n).for_each(back);
            transpose(&mut self.matrix, n);
        }
    }

    /// Before the states behind those of navigation began anew.
    pub fn began_anew(&mut self) {
        let n = self.n;
        self.vector[NAV..].fill(0.0);
        for (k, row) in self.matrix.chunks_exact_mut(n).enumerate() {
            row[if k < NAV { NAV } else { 0 }..].fill(0.0);
        }
    }

    /// Errors of the navigation states, whose covariance with all states is `rows`, NAV x n.
    pub fn errors(&self, rows: &[f64]) -> [f64; NAV] {
        std::array::from_fn(|k| -dot(&rows[k * self.n..(k + 1) * self.n], &self.vector))
    }

    /// What is left of the covariance of three states from each of `firsts` on, 3 x 3 each.
    pub fn covariance<const B: usize>(
        &mut self,
        rows: &[f64],
        firsts: [usize; B],
    ) -> [[f64; 9]; B] {
        let Adjoint {
            n, matrix, work, ..
        } = self;
        let n = *n;
        firsts.map(|first| {
            let rows = &rows[first * n..(first + 3) * n];
            for (out, row) in work.chunks_exact_mut(n).zip(rows.chunks_exact(n)) {
                out.fill(0.0);
                for (factor, of) in row.iter().zip(matrix.chunks_exact(n)) {
                    add_scaled(out, *factor, of);
                }
            }
            let left = |r: usize, c: usize| {
                rows[r * n + first + c] - dot(&work[r * n..(r + 1) * n], &rows[c * n..(c + 1) * n])
            };
            std::array::from_fn(|k| 0.5 * (left(k / 3, k % 3) + left(k % 3, k / 3)))
        })
    }
}

#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
