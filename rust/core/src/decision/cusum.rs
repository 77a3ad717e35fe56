//! Page's cumulative sum, to both sides, for one or several shifts at a time.

/// The path of the largest of all sums, in log-likelihood.
///
/// S_k = max(0, S_(k-1) + d z_k - d^2 / 2) for every shift d and for -d (Page 1954).
pub fn path(shifts: &[f64], samples: &[f64], path: &mut [f64]) {
    path.fill(0.0);
    for shift in shifts {
        let (mut up, mut down, drift) = (0.0_f64, 0.0_f64, 0.5 * shift * shift);
        for (z, out) in samples.iter().zip(path.iter_mut()) {
            up = (up + shift * z - drift).max(0.0);
            down = (down - shift * z - drift).max(0.0);
            *out = out.max(up).max(down);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::{close, samples};

    #[test]
    fn is_the_largest_ratio_over_all_onsets() {
        let z = samples(120);
        let shifts = [0.7, 1.5];
        let wanted: Vec<f64> = (0..z.len())
            .map(|k| {
                let onsets = (0..=k).flat_map(|from| {
                    shifts
                        .iter()
                        .flat_map(|d| [*d, -*d])
                        .map(move |d| (from, d))
                });
                onsets
                    .map(|(from, d)| z[from..=k].iter().map(|v| d * v - 0.5 * d * d).sum::<f64>())
                    .fold(0.0, f64::max)
            })
            .collect();
        let mut path = vec![0.0; z.len()];
        super::path(&shifts, &z, &mut path);
        close(&path, &wanted);
    }
}
