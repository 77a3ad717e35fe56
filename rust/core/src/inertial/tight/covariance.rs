//! Covariance of the error states, propagated and updated in place.

use super::{CLOCK, DRIFT, NAV};

/// Rows of a transition that are not those of the identity.
const MOVING: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 8, CLOCK];

/// Square matrix over the navigation states.
pub type Square = [[f64; NAV]; NAV];

/// What happens to the navigation states from one time to another.
#[derive(Debug, Clone)]
pub struct Transition {
    /// Errors then from errors before; rows of biases and of the clock's drift are the identity's.
    pub phi: Square,
    /// Covariance that comes up on the way.
    pub noise: Square,
    /// s.
    pub interval: f64,
}

impl Transition {
    /// Errors at the end, from those at the beginning.
    pub fn carry(&self, errors: &mut [f64; NAV]) {
        let before = *errors;
        for row in MOVING {
            errors[row] = dot(&self.phi[row], &before);
        }
    }

    /// What weighs the errors at the end, as weights of those at the beginning: weights times phi.
    pub fn carry_back(&self, weights: &mut [f64; NAV]) {
        let after = *weights;
        for row in MOVING {
            weights[row] = 0.0;
        }
        for row in MOVING {
            add_scaled(weights, after[row], &self.phi[row]);
        }
    }

    /// Covariance at the end (n x n, row by row, navigation states first); `work` holds 10 rows.
    pub fn spread(&self, p: &mut [f64], n: usize, work: &mut [f64]) {
        for _ in 0..2 {
            self.multiply(p, n, work);
            transpose(p, n);
        }
        for (row, noise) in self.noise.iter().enumerate() {
            for (value, add) in p[row * n..row * n + NAV].iter_mut().zip(noise) {
                *value += add;
            }
        }
    }

    /// P = phi P.
    fn multiply(&self, p: &mut [f64], n: usize, work: &mut [f64]) {
        for (out, row) in work.chunks_exact_mut(n).zip(MOVING) {
            out.fill(0.0);
            for (k, &factor) in self.phi[row].iter().enumerate() {
                if factor != 0.0 {
                    add_scaled(out, factor, &p[k * n..(k + 1) * n]);
                }
            }
        }
        for (out, row) in work.chunks_exact(n).zip(MOVING) {
            p[row * n..(row + 1) * n].copy_from_slice(out);
        }
    }
}

/// Rows that [`Transition::spread`] needs as work space.
pub const WORK_ROWS: usize = MOVING.len();

/// Zeros.
pub fn zeros() -> Square {
    [[0.0; NAV]; NAV]
}

/// Identity, with the clock moved on by its drift.
pub fn at_rest(interval: f64) -> Square {
    let mut phi = zeros();
    for (k, row) in phi.iter_mut().enumerate() {
        row[k] = 1.0;
    }
    phi[CLOCK][DRIFT] = interval;
    phi
}

/// One row of a measurement matrix, with few entries.
#[derive(Debug, Clone, Copy, Default)]
pub struct Row {
    index: [usize; Row::MOST],
    value: [f64; Row::MOST],
    count: usize,
}

impl Row {
    const MOST: usize = 14;

    /// Adds an entry.
    pub fn push(&mut self, index: usize, value: f64) {
        self.index[self.count] = index;
        self.value[self.count] = value;
        self.count += 1;
    }

    /// Adds three entries from `first` on.
    pub fn push3(&mut self, first: usize, value: &nalgebra::Vector3<f64>) {
        for k in 0..3 {
            self.push(first + k, value[k]);
        }
    }

    /// Index and value of each.
    pub fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let pairs = self.index.iter().zip(&self.value);
        pairs.take(self.count).map(|(&i, &v)| (i, v))
    }

    /// Product with a vector of errors.
    pub fn times(&self, x: &[f64]) -> f64 {
        self.entries().map(|(i, v)| v * x[i]).sum()
    }

    /// `out` = P h; gives h P h.
    pub fn through(&self, p: &[f64], n: usize, out: &mut [f64]) -> f64 {
        out.fill(0.0);
        for (i, v) in self.entries() {
            add_scaled(out, v, &p[i * n..(i + 1) * n]);
        }
        self.times(out)
    }
}

/// P less g g' / s.
pub fn take_off(p: &mut [f64], n: usize, g: &[f64], s: f64) {
    for (row, &left) in p.chunks_exact_mut(n).zip(g) {
        add_scaled(row, -left / s, g);
    }
}

/// `out` + factor times `row`.
#[inline]
pub fn add_scaled(out: &mut [f64], factor: f64, row: &[f64]) {
    for (o, r) in out.iter_mut().zip(row) {
        *o += factor * r;
    }
}

#[inline]
fn dot(a: &[f64; NAV], b: &[f64; NAV]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Swaps rows and columns.
pub fn transpose(p: &mut [f64], n: usize) {
    for row in 0..n {
        for column in row + 1..n {
            p.swap(row * n + column, column * n + row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    fn mixed(n: usize) -> DMatrix<f64> {
        DMatrix::from_fn(n, n, |r, c| ((7 * r + 3 * c) % 11) as f64 / 11.0 - 0.4)
    }

    fn transition() -> Transition {
        let mut phi = at_rest(0.7);
        let mut noise = zeros();
        for row in 0..9 {
            for (column, value) in phi[row].iter_mut().take(15).enumerate() {
                *value += 0.1 * ((5 * row + column) % 7) as f64;
            }
            noise[row][row] = 0.3;
        }
        noise[CLOCK][DRIFT] = 0.1;
        noise[DRIFT][CLOCK] = 0.1;
        Transition {
            phi,
            noise,
            interval: 0.7,
        }
    }

    #[test]
    fn spread_is_the_sandwich() {
        for n in [NAV, NAV + 9] {
            let root = mixed(n);
            let p = &root * root.transpose();
            let step = transition();
            let full = DMatrix::from_fn(n, n, |r, c| match (r < NAV, c < NAV) {
                (true, true) => step.phi[r][c],
                _ => f64::from(r == c),
            });
            let noise = DMatrix::from_fn(n, n, |r, c| match r < NAV && c < NAV {
                true => step.noise[r][c],
                false => 0.0,
            });
            let wanted = &full * &p * full.transpose() + noise;
            let mut got = p.as_slice().to_vec();
            step.spread(&mut got, n, &mut vec![0.0; WORK_ROWS * n]);
            let got = DMatrix::from_row_slice(n, n, &got);
            assert!((got - wanted).amax() < 1e-12);
        }
    }

    #[test]
    fn scalar_update_is_that_of_kalman() {
        let n = NAV + 2;
        let root = mixed(n);
        let p = &root * root.transpose() + DMatrix::identity(n, n);
        let mut row = Row::default();
        row.push(0, 0.5);
        row.push(15, 1.0);
        row.push(n - 1, -2.0);
        let h = DMatrix::from_fn(1, n, |_, c| {
            row.entries().find(|e| e.0 == c).map_or(0.0, |e| e.1)
        });
        let mut flat = p.as_slice().to_vec();
        let mut g = vec![0.0; n];
        let s = row.through(&flat, n, &mut g) + 2.0;
        take_off(&mut flat, n, &g, s);
        let full = (&h * &p * h.transpose())[0] + 2.0;
        assert!((s - full).abs() < 1e-12);
        let wanted = &p - &p * h.transpose() * &h * &p / full;
        assert!((DMatrix::from_row_slice(n, n, &flat) - wanted).amax() < 1e-12);
    }
}
