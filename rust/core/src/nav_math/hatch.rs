//! Smoothing of code by carrier (Hatch, "The synergism of GPS code and carrier measurements",
//! 3rd Int. Geodetic Symposium on Satellite Doppler Positioning (1982)).

/// Replaces the pseudoranges of one signal by smoothed ones: the change comes from the carrier,
/// the level from a mean of the code that forgets after `epochs`.
///
/// `carrier_m` grows with range. The mean begins anew where `broken` is set or either is NaN.
pub fn smooth(range_m: &mut [f64], carrier_m: &[f64], broken: &[bool], epochs: usize) {
    let (mut count, mut mean, mut before) = (0_usize, 0.0, 0.0);
    for ((range, carrier), cut) in range_m.iter_mut().zip(carrier_m).zip(broken) {
        if !range.is_finite() || !carrier.is_finite() {
            count = 0;
            continue;
        }
        if *cut {
            count = 0;
        }
        count = (count + 1).min(epochs.max(1));
        let predicted = mean + (carrier - before);
        mean = if count == 1 {
            *range
        } else {
            predicted + (*range - predicted) / count as f64
        };
        before = *carrier;
        *range = mean;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_passes_and_noise_is_averaged() {
        let carrier: Vec<f64> = (0..200).map(|k| f64::from(k * k) * 0.1).collect();
        let noise = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut range: Vec<f64> = (0..200).map(|k| carrier[k] + 7.0 + noise(k)).collect();
        smooth(&mut range, &carrier, &[false; 200], 50);
        assert!((range[199] - carrier[199] - 7.0).abs() < 0.02);
    }

    #[test]
    fn a_slip_and_a_gap_begin_anew() {
        let carrier = [0.0, 0.0, 500.0, 500.0, f64::NAN, 900.0];
        let mut range = [1.0, 3.0, 1.0, 3.0, 8.0, 2.0];
        smooth(
            &mut range,
            &carrier,
            &[false, false, true, false, false, false],
            10,
        );
        assert_eq!(range, [1.0, 2.0, 1.0, 2.0, 8.0, 2.0]);
    }
}
