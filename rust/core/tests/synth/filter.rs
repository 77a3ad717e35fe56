//! The front-end filter.

use std::f64::consts::TAU;

use sdr_spoof_core::simd::Level;
use sdr_spoof_core::synth::Filter;

#[test]
fn response_is_that_of_a_band_pass() {
    for (centre, complex) in [(0.25, false), (0.0, true), (-0.13, true)] {
        let filter = Filter::new(centre, 0.3, 63, complex).unwrap();
        assert!((filter.gain(centre) - 1.0).abs() < 2e-3);
        for offset in [-0.12, -0.05, 0.03, 0.12] {
            assert!(
                (filter.gain(centre + offset) - 1.0).abs() < 3e-3,
                "{centre} {offset}"
            );
        }
        for edge in [-0.15, 0.15] {
            assert!((filter.gain(centre + edge) - 0.5).abs() < 0.02);
        }
        for outside in [-0.185, 0.185, 0.21] {
            assert!(
                filter.gain(centre + outside).abs() < 2e-3,
                "{centre} {outside}"
            );
        }
        // Noise gain: power of the response over the whole sampled band.
        let grid = if complex {
            (-500..500, 1000.0)
        } else {
            (0..500, 500.0)
        };
        let power: f64 = grid
            .0
            .map(|k| filter.gain(f64::from(k) / 1000.0).powi(2))
            .sum();
        assert!((filter.noise_gain() - (power / grid.1).sqrt()).abs() < 1e-3);
    }
}

/// A tone comes out with the gain and without delay, with the same bits at every level.
#[test]
fn filtering_is_what_the_response_says() {
    let frequency = -0.21;
    let filter = Filter::new(-0.13, 0.2, 63, true).unwrap();
    let reach = filter.reach();
    let wave = |n: usize| TAU * frequency * n as f64;
    let re: Vec<f32> = (0..200 + 2 * reach).map(|n| wave(n).cos() as f32).collect();
    let im: Vec<f32> = (0..200 + 2 * reach).map(|n| wave(n).sin() as f32).collect();
    let complex = |level| {
        let (mut a, mut b, mut scratch) = (vec![0.0; 200], vec![0.0; 200], vec![0.0; 200]);
        filter.apply_complex(level, [&re, &im], [&mut a, &mut b], &mut scratch);
        (a, b)
    };
    let (a, b) = complex(Level::Portable);
    for n in 0..200 {
        assert!((f64::from(a[n]) - filter.gain(frequency) * wave(n + reach).cos()).abs() < 1e-5);
        assert!((f64::from(b[n]) - filter.gain(frequency) * wave(n + reach).sin()).abs() < 1e-5);
    }
    // A quarter of the sample rate, where every other tap is zero, and another centre.
    for centre in [0.25, 0.22] {
        let real_filter = Filter::new(centre, 0.3, 31, false).unwrap();
        let real = |level| {
            let mut out = vec![0.0; 77];
            real_filter.apply_real(level, &re[..77 + 2 * 15], &mut out);
            out
        };
        for (n, value) in real(Level::Portable).into_iter().enumerate() {
            let expected = real_filter.gain(frequency) * wave(n + 15).cos();
            assert!((f64::from(value) - expected).abs() < 1e-5);
        }
        for level in Level::available() {
            assert_eq!(complex(level), (a.clone(), b.clone()), "{level:?}");
            assert_eq!(real(level), real(Level::Portable), "{level:?}");
        }
    }
}

#[test]
fn bands_outside_are_refused() {
    assert!(Filter::new(0.1, 0.3, 63, false).is_err());
    assert!(Filter::new(0.4, 0.3, 63, true).is_err());
    assert!(Filter::new(0.25, 0.3, 62, false).is_err());
    assert!(Filter::new(0.25, f64::NAN, 63, false).is_err());
}
