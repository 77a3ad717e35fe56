//! Correlation of a code with itself, whole chips apart, over each slice of its period.

/// Lags that are known, to either side; beyond them there is taken to be none.
pub(super) const LAGS: i64 = 24;
const WIDTH: usize = 2 * LAGS as usize + 1;

/// One row per slice.
#[derive(Debug, Clone)]
pub(super) struct CodeLags {
    slices: Vec<[f64; WIDTH]>,
    mean: [f64; WIDTH],
}

impl CodeLags {
    /// Of a code cut into slices of so many chips.
    pub fn new(code: &[i8], chips_per_slice: usize) -> Self {
        let (n, reach) = (code.len(), LAGS as usize);
        // From LAGS chips before the period to as many after it.
        let around: Vec<i8> = [&code[n - reach..], code, &code[..reach]].concat();
        let row = |first: usize| {
            let here = &code[first..first + chips_per_slice];
            std::array::from_fn(|lag| {
                let there = &around[first + lag..];
                let products = here.iter().zip(there).map(|(a, b)| i32::from(a * b));
                f64::from(products.sum::<i32>()) / chips_per_slice as f64
            })
        };
        let slices: Vec<[f64; WIDTH]> = (0..n).step_by(chips_per_slice).map(row).collect();
        let mean = |lag| slices.iter().map(|s| s[lag]).sum::<f64>() / slices.len() as f64;
        CodeLags {
            mean: std::array::from_fn(mean),
            slices,
        }
    }

    /// In a slice: mean of chip i times chip i + `lag`.
    #[inline]
    pub fn slice(&self, slice: usize, lag: i64) -> f64 {
        value(&self.slices[slice], lag)
    }

    /// Over the whole period.
    pub fn whole(&self, lag: i64) -> f64 {
        value(&self.mean, lag)
    }
}

#[inline]
fn value(row: &[f64; WIDTH], lag: i64) -> f64 {
    row.get((lag + LAGS) as usize).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::find;

    #[test]
    fn a_gold_code_has_three_values() {
        let code = find("L1CA").unwrap().code(3).unwrap();
        let lags = CodeLags::new(&code, 1023);
        assert_eq!(lags.slice(0, 0), 1.0);
        for lag in 1..=LAGS {
            let sum = (lags.slice(0, lag) * 1023.0).round() as i64;
            assert!([-65, -1, 63].contains(&sum), "{lag}: {sum}");
            assert_eq!(lags.slice(0, lag), lags.slice(0, -lag));
        }
        assert_eq!(lags.slice(0, LAGS + 1), 0.0);
    }

    #[test]
    fn slices_of_a_long_code_average_to_the_whole() {
        let code = find("B1CP").unwrap().code(20).unwrap();
        let lags = CodeLags::new(&code, 1023);
        for lag in [-7, -1, 0, 3] {
            let mean = (0..10).map(|s| lags.slice(s, lag)).sum::<f64>() / 10.0;
            assert!((lags.whole(lag) - mean).abs() < 1e-12);
        }
    }
}
