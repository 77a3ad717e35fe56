//! Sums of whitened innovations over several windows, and their chi-square as a normal deviate.

/// One innovation counts no more than this, so that one glitch is no attack.
pub const CLIP: f64 = 5.0;

/// Normal deviate of a chi-square (E. B. Wilson, M. M. Hilferty, Proc. Nat. Acad. Sci. 17 (1931)
/// 684): from 3 degrees of freedom on it is within 2 % up to 8.
pub fn deviate(square: f64, freedom: usize) -> f64 {
    if freedom == 0 {
        return 0.0;
    }
    let f = freedom as f64;
    let spread = 2.0 / (9.0 * f);
    ((square / f).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Sums of one kind of innovation of all satellites.
#[derive(Debug, Clone)]
pub struct Windows {
    lengths: Vec<usize>,
    satellites: usize,
    /// Ring of innovations, NaN where there was none: (depth, satellites).
    ring: Vec<f64>,
    depth: usize,
    count: usize,
    /// Sum and number in each window of each satellite.
    sums: Vec<(f64, usize)>,
}

impl Windows {
    /// Windows of so many epochs.
    pub fn new(lengths: &[usize], satellites: usize) -> Self {
        let depth = lengths.iter().copied().max().unwrap_or(1);
        Windows {
            lengths: lengths.to_vec(),
            satellites,
            ring: vec![f64::NAN; depth * satellites],
            depth,
            count: 0,
            sums: vec![(0.0, 0); lengths.len() * satellites],
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.ring.fill(f64::NAN);
        self.sums.fill((0.0, 0));
        self.count = 0;
    }

    /// Takes an epoch's innovations in standard deviations, NaN where there is none.
    pub fn push(&mut self, innovations: &[f64]) {
        for (w, &length) in self.lengths.iter().enumerate() {
            let old = (self.count + self.depth - length) % self.depth * self.satellites;
            let sums = self.sums[w * self.satellites..].iter_mut();
            for ((sum, leaves), enters) in sums.zip(&self.ring[old..]).zip(innovations) {
                if leaves.is_finite() {
                    *sum = (sum.0 - leaves, sum.1 - 1);
                }
                if enters.is_finite() {
                    *sum = (sum.0 + enters, sum.1 + 1);
                }
            }
        }
        let row = self.count % self.depth * self.satellites;
        self.ring[row..row + self.satellites].copy_from_slice(innovations);
        self.count += 1;
    }

    /// Normal deviate of the sum of squares of each window's sums; 0 where a window is not full.
    pub fn deviates(&self) -> impl Iterator<Item = f64> + '_ {
        self.lengths.iter().enumerate().map(|(w, &length)| {
            if self.count < length {
                return 0.0;
            }
            let (mut square, mut freedom) = (0.0, 0);
            for (sum, count) in &self.sums[w * self.satellites..(w + 1) * self.satellites] {
                if 2 * count > length {
                    square += sum * sum / *count as f64;
                    freedom += 1;
                }
            }
            deviate(square, freedom)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviates_of_quantiles() {
        // Chi-square quantiles of the probabilities of 3 and 5 standard deviations (one-sided).
        for (freedom, square, wanted) in [
            (4, 17.80, 3.0),
            (10, 28.78, 3.0),
            (20, 44.35, 3.0),
            (10, 49.83, 5.0),
            (6, 41.02, 5.0),
        ] {
            let got = deviate(square, freedom);
            assert!((got - wanted).abs() < 0.15, "{freedom} {square}: {got}");
        }
    }

    #[test]
    fn sums_follow_what_enters_and_leaves() {
        let mut windows = Windows::new(&[1, 3], 2);
        let rows = [
            [1.0, 2.0],
            [f64::NAN, -1.0],
            [3.0, 4.0],
            [1.0, f64::NAN],
            [2.0, 2.0],
        ];
        for (k, row) in rows.iter().enumerate() {
            windows.push(row);
            if k < 2 {
                continue;
            }
            let (mut square, mut freedom) = (0.0, 0);
            for satellite in 0..2 {
                let last: Vec<f64> = rows[k - 2..=k].iter().map(|r| r[satellite]).collect();
                let there: Vec<f64> = last.into_iter().filter(|v| v.is_finite()).collect();
                let sum: f64 = there.iter().sum();
                square += sum * sum / there.len() as f64;
                freedom += 1;
            }
            let got: Vec<f64> = windows.deviates().collect();
            assert!((got[1] - deviate(square, freedom)).abs() < 1e-9);
        }
        windows.clear();
        assert!(windows.deviates().all(|z| z == 0.0));
    }
}
