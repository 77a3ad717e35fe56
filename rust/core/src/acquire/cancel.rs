//! Takes known signals out of the samples, so that their cross-correlation with other codes does
//! not pass for satellites (successive interference cancellation by projection).

use num_complex::{Complex32, Complex64};
use rayon::prelude::*;

use super::library::{inverse, phasors};

/// A signal to take out, as the search estimated it.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// Satellite.
    pub prn: u16,
    /// Doppler.
    pub doppler_hz: f64,
    /// From the first sample to the first following start of a code period.
    pub code_delay_s: f64,
}

/// A signal in samples: where its code periods lie and how its carrier turns.
pub(super) struct Track {
    /// Start of a code period, in samples.
    pub start: f64,
    /// Samples from one to the next.
    pub step: f64,
    pub cycles_per_sample: f64,
}

/// Removes from each received code period its projection on the replica: the complex amplitude
/// is free from period to period, so data and secondary code need not be known.
///
/// `spectrum` holds the Fourier coefficients of one period of replica.
pub(super) fn cancel(spectrum: &[Complex32], track: &Track, samples: &mut [Complex32]) {
    let carrier = phasors(0.0, track.cycles_per_sample, spectrum.len());
    periods(track, spectrum.len(), samples)
        .into_par_iter()
        .for_each(|period| {
            let mut replica = delayed(spectrum, period.delay);
            for (r, c) in replica.iter_mut().zip(&carrier) {
                *r *= c;
            }
            project_out(period.samples, &replica[period.skipped..]);
        });
}

/// The samples of one received code period.
struct Period<'a> {
    /// Of the code after the first sample of the whole period, below 1.
    delay: f64,
    /// Samples of the period that lie before the first of all.
    skipped: usize,
    samples: &'a mut [Complex32],
}

/// Cuts samples into code periods, none of them longer than `length`.
fn periods<'a>(track: &Track, length: usize, samples: &'a mut [Complex32]) -> Vec<Period<'a>> {
    let total = samples.len() as i64;
    let (mut rest, mut at) = (samples, 0);
    let first = (-track.start / track.step).floor() as i64;
    let last = ((total as f64 - track.start) / track.step).ceil() as i64;
    let mut periods = Vec::new();
    for k in first..last {
        let start = track.start + k as f64 * track.step;
        let floor = start.floor() as i64;
        let from = floor.clamp(at, total);
        let next = (start + track.step).floor() as i64;
        let to = next.min(floor + length as i64).clamp(from, total);
        let (_, tail) = rest.split_at_mut((from - at) as usize);
        let (samples, tail) = tail.split_at_mut((to - from) as usize);
        (rest, at) = (tail, to);
        if from < to {
            periods.push(Period {
                delay: start - start.floor(),
                skipped: (from - floor) as usize,
                samples,
            });
        }
    }
    periods
}

/// One period of replica, `delay` samples late.
fn delayed(spectrum: &[Complex32], delay: f64) -> Vec<Complex32> {
    let size = spectrum.len();
    let half = size / 2;
    // Harmonics from -size/2 on; those below 0 stand in the upper half.
    let turns = phasors(0.5 * delay, -delay / size as f64, size);
    let mut period: Vec<Complex32> = spectrum[..half]
        .iter()
        .zip(&turns[size - half..])
        .chain(spectrum[half..].iter().zip(&turns[..size - half]))
        .map(|(v, t)| v * t)
        .collect();
    inverse(size).process(&mut period);
    period
}

/// Subtracts the projection of the samples on as much of the replica.
fn project_out(samples: &mut [Complex32], replica: &[Complex32]) {
    let (mut energy, mut product) = (0f64, Complex64::default());
    for (x, r) in samples.chunks(256).zip(replica.chunks(256)) {
        let sums = x
            .iter()
            .zip(r)
            .fold((0f32, Complex32::default()), |(e, p), (x, r)| {
                (e + r.norm_sqr(), p + x * r.conj())
            });
        energy += f64::from(sums.0);
        product += Complex64::new(sums.1.re.into(), sums.1.im.into());
    }
    if energy > 0.0 {
        let amplitude = product / energy;
        let amplitude = Complex32::new(amplitude.re as f32, amplitude.im as f32);
        for (x, r) in samples.iter_mut().zip(replica) {
            *x -= amplitude * r;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periods_cover_all_samples_once() {
        for (start, step) in [(0.3, 100.4), (99.9, 99.7), (0.0, 100.0), (-250.2, 100.01)] {
            let mut samples: Vec<Complex32> =
                (0..1_000).map(|i| Complex32::new(i as f32, 0.0)).collect();
            let track = Track {
                start,
                step,
                cycles_per_sample: 0.0,
            };
            let mut seen = 0;
            for period in periods(&track, 100, &mut samples) {
                assert!(period.skipped + period.samples.len() <= 100);
                assert!((0.0..1.0).contains(&period.delay));
                // The position in the period is that of the track.
                let at = (f64::from(period.samples[0].re) - start).rem_euclid(step);
                let from = period.skipped as f64 - period.delay;
                assert!((at - from).abs().min((at - from - step).abs()) < 1e-3);
                seen += period.samples.len();
            }
            // A sample now and then lies between periods longer than the replica.
            assert!(seen >= 996, "{start} {step} {seen}");
        }
    }
}
