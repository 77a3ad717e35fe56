//! Statistics over windows of the last samples.

/// Largest log-likelihood ratio of a mean over several windows: (sum of n samples)^2 / (2 n).
///
/// Willsky and Jones (1976); windows that reach back before the first sample are left out.
pub fn glr(windows: &[usize], samples: &[f64], path: &mut [f64]) {
    let mut sums = Vec::with_capacity(samples.len() + 1);
    sums.push(0.0);
    let mut total = 0.0;
    for z in samples {
        total += z;
        sums.push(total);
    }
    path.fill(0.0);
    for window in windows.iter().filter(|n| **n > 0 && **n <= samples.len()) {
        let scale = 0.5 / *window as f64;
        let ends = sums[*window..].iter().zip(&sums);
        for (out, (end, start)) in path[window - 1..].iter_mut().zip(ends) {
            let sum = end - start;
            *out = out.max(scale * sum * sum);
        }
    }
}

/// Sum of the squares of the last `window` samples; zero until there are so many.
pub fn squares(window: usize, samples: &[f64], path: &mut [f64]) {
    let mut sum = 0.0_f64;
    for (k, z) in samples.iter().enumerate() {
        sum += z * z;
        if k >= window {
            sum -= samples[k - window] * samples[k - window];
        }
        path[k] = if k + 1 >= window { sum.max(0.0) } else { 0.0 };
    }
}

/// Size of the mean of the last `window` samples over its standard error; zero until there are so
/// many. With `known`, the samples are in standard deviations; else it is Student's t.
pub fn student(window: usize, known: bool, samples: &[f64], path: &mut [f64]) {
    let count = window as f64;
    let origin = samples.first().copied().unwrap_or(0.0);
    let (mut sum, mut square) = (0.0_f64, 0.0_f64);
    for (k, z) in samples.iter().enumerate() {
        let new = z - origin;
        sum += new;
        square += new * new;
        if k >= window {
            let old = samples[k - window] - origin;
            sum -= old;
            square -= old * old;
        }
        let mean = sum / count + origin;
        let variance = match known {
            true => 1.0,
            false => (square - sum * sum / count) / (count - 1.0),
        };
        let usable = k + 1 >= window && variance > f64::EPSILON * square;
        path[k] = match usable {
            true => mean.abs() * (count / variance).sqrt(),
            false => 0.0,
        };
    }
}

/// A mean over a window against a line through the samples before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalMean {
    /// Samples that are averaged.
    pub window: usize,
    /// Samples before the window.
    pub baseline: usize,
    /// Whether the line may have a slope.
    pub slope: bool,
    /// Whether the samples are in standard deviations; else the scatter about the line is taken.
    pub known: bool,
}

impl LocalMean {
    /// Size of the difference over its standard error; zero until window and baseline are full.
    pub fn path(&self, samples: &[f64], path: &mut [f64]) {
        path.fill(0.0);
        let whole = self.window + self.baseline;
        let origin = samples.first().copied().unwrap_or(0.0);
        let (n, m) = (self.window as f64, self.baseline as f64);
        // Of the baseline: sum, sum weighted by place, sum of squares; of the window: sum.
        let (mut base, mut moment, mut square, mut window) = (0.0_f64, 0.0, 0.0, 0.0);
        let scatter = (m * (m * m - 1.0)) / 12.0;
        let lever = 0.5 * (m + n);
        let turn = if self.slope {
            lever * lever / scatter
        } else {
            0.0
        };
        let error = 1.0 / n + 1.0 / m + turn;
        let freedom = m - if self.slope { 2.0 } else { 1.0 };
        for k in 0..samples.len() {
            window += samples[k] - origin;
            if k >= self.window {
                let new = samples[k - self.window] - origin;
                window -= new;
                if k >= whole {
                    let old = samples[k - whole] - origin;
                    base -= old;
                    square -= old * old;
                    // Every other sample is one place further back.
                    moment -= base;
                }
                let place = (k - self.window).min(self.baseline - 1) as f64;
                base += new;
                square += new * new;
                moment += place * new;
            }
            if k + 1 < whole {
                continue;
            }
            let mean = base / m;
            let along = moment - 0.5 * (m - 1.0) * base;
            let slope = if self.slope { along / scatter } else { 0.0 };
            let residual = square - base * mean - slope * along;
            let variance = if self.known { 1.0 } else { residual / freedom };
            if variance > f64::EPSILON * square {
                let difference = window / n - mean - slope * lever;
                path[k] = difference.abs() / (variance * error).sqrt();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::{close, samples};
    use super::*;

    fn whole(z: &[f64], rows: usize, of: impl Fn(&[f64]) -> f64) -> Vec<f64> {
        (1..=z.len())
            .map(|k| if k < rows { 0.0 } else { of(&z[k - rows..k]) })
            .collect()
    }

    fn moments(z: &[f64]) -> (f64, f64, f64) {
        let count = z.len() as f64;
        let mean = z.iter().sum::<f64>() / count;
        let rss = z.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        (count, mean, rss)
    }

    #[test]
    fn glr_is_its_definition() {
        let z = samples(100);
        let windows = [1, 3, 8, 200];
        let wanted: Vec<f64> = (1..=z.len())
            .map(|k| {
                let fits = windows.iter().filter(|n| **n <= k);
                fits.map(|n| z[k - n..k].iter().sum::<f64>().powi(2) / (2.0 * *n as f64))
                    .fold(0.0, f64::max)
            })
            .collect();
        let mut path = vec![0.0; z.len()];
        glr(&windows, &z, &mut path);
        close(&path, &wanted);
    }

    #[test]
    fn student_and_squares_are_their_definitions() {
        let z: Vec<f64> = samples(80).iter().map(|v| v + 1e3).collect();
        let mut path = vec![0.0; z.len()];
        student(7, false, &z, &mut path);
        let t = |w: &[f64]| {
            let (count, mean, rss) = moments(w);
            mean.abs() / (rss / (count - 1.0) / count).sqrt()
        };
        close(&path, &whole(&z, 7, t));
        student(7, true, &z, &mut path);
        close(&path, &whole(&z, 7, |w| moments(w).1.abs() * 7_f64.sqrt()));
        squares(5, &z, &mut path);
        close(&path, &whole(&z, 5, |w| w.iter().map(|v| v * v).sum()));
    }

    /// The line by its normal equations.
    fn local_mean(z: &[f64], of: LocalMean) -> f64 {
        let (before, window) = z.split_at(of.baseline);
        let (m, mean, mut rss) = moments(before);
        let at = |k: usize| k as f64 - 0.5 * (m - 1.0);
        let scatter: f64 = (0..before.len()).map(|k| at(k).powi(2)).sum();
        let mut slope = 0.0;
        if of.slope {
            let cross: f64 = before.iter().enumerate().map(|(k, v)| at(k) * v).sum();
            slope = cross / scatter;
            rss -= slope * cross;
        }
        let (n, local, _) = moments(window);
        let lever = 0.5 * (m + n);
        let turn = if of.slope {
            lever * lever / scatter
        } else {
            0.0
        };
        let freedom = m - if of.slope { 2.0 } else { 1.0 };
        let variance = if of.known { 1.0 } else { rss / freedom };
        (local - mean - slope * lever).abs() / (variance * (1.0 / n + 1.0 / m + turn)).sqrt()
    }

    #[test]
    fn local_mean_is_its_definition() {
        let z: Vec<f64> = samples(90).iter().map(|v| v - 50.0).collect();
        for (slope, known) in [(false, false), (false, true), (true, false), (true, true)] {
            let of = LocalMean {
                window: 4,
                baseline: 11,
                slope,
                known,
            };
            let mut path = vec![0.0; z.len()];
            of.path(&z, &mut path);
            close(&path, &whole(&z, 15, |w| local_mean(w, of)));
        }
    }
}
