//! The adjoint against all measurements at once, and against the smoother with gains.

use nalgebra::{DMatrix, DVector};

use linear::{begin, Event, Linear, EPOCHS};

use crate::inertial::tight::run::tests::settings;
use crate::inertial::tight::settings::{Mode, Settings};
use crate::inertial::tight::NAV;

mod linear;

fn believed(change: f64, bias: f64) -> Settings {
    let mut made = settings(Mode::Off);
    made.receiver.change = change;
    made.receiver.wander_time = 2.0;
    let s = &mut made.start;
    (s.position, s.velocity, s.level, s.heading) = (2.0, 1.0, 1.0, 1.0);
    (s.gyro_bias, s.accelerometer_bias, s.clock, s.drift) = (bias, bias, 3.0, 1.0);
    made
}

#[test]
fn it_is_what_all_measurements_at_once_say() {
    // Singular where biases are no states and places are remembered.
    for (change, bias) in [(0.0, 1.0), (0.1, 0.0)] {
        let mut linear = Linear::new(&believed(change, bias));
        linear.run(bias == 0.0);
        let whole = linear.batch();
        let mut moved: f64 = 0.0;
        linear.adjoint(|epoch, errors, covariance| {
            let (wanted, left) = &whole[epoch];
            for k in 0..NAV {
                assert!((errors[k] - wanted[k]).abs() < 1e-9, "{change} {epoch} {k}");
                moved = moved.max(errors[k].abs());
            }
            for (b, block) in covariance.iter().enumerate() {
                for (k, value) in block.iter().enumerate() {
                    let wanted = left[(3 * b + k / 3, 3 * b + k % 3)];
                    assert!((value - wanted).abs() < 1e-9, "{change} {epoch} {b} {k}");
                }
            }
        });
        assert!(moved > 0.5, "{moved}");
    }
}

/// H. E. Rauch, F. Tung, C. T. Striebel, "Maximum likelihood estimates of linear dynamic systems",
/// AIAA J. 3 (1965), 1445-1450, about each epoch's corrected state.
#[test]
fn it_is_the_smoother_with_gains_in_closed_loop() {
    let settings = believed(0.0, 1.0);
    let mut linear = Linear::new(&settings);
    linear.run(false);
    let n = linear.count();
    let mut filter = begin(&settings);
    let mut stages = Vec::new();
    for events in &linear.events {
        let mut phi = DMatrix::identity(n, n);
        let (mut found, mut prior) = (DVector::zeros(n), Vec::new());
        for event in events {
            match event {
                Event::Moved(step) => {
                    filter.predict(step);
                    phi = linear.dense(step).0 * phi;
                    prior.clone_from(&filter.p);
                }
                Event::Used {
                    gain,
                    s,
                    innovation,
                    ..
                } => {
                    let gain = DVector::from_column_slice(gain);
                    found += &gain * (*innovation / *s);
                    let p =
                        DMatrix::from_row_slice(n, n, &filter.p) - &gain * gain.transpose() / *s;
                    filter.p.copy_from_slice(p.as_slice());
                }
                Event::Remembered => unreachable!(),
            }
        }
        let square = |p: &[f64]| DMatrix::from_row_slice(n, n, p);
        stages.push((phi, square(&prior), square(&filter.p), found));
    }
    let mut wanted = vec![(DVector::zeros(n), stages[EPOCHS - 1].2.clone())];
    for k in (0..EPOCHS - 1).rev() {
        let (phi, prior, _, found) = &stages[k + 1];
        let here = &stages[k].2;
        let gain = here * phi.transpose() * prior.clone().cholesky().unwrap().inverse();
        let (errors, covariance) = wanted.last().unwrap();
        // What was taken off the navigator then was an error of its prediction.
        let next = (
            &gain * (errors + found),
            here + &gain * (covariance - prior) * gain.transpose(),
        );
        wanted.push(next);
    }
    wanted.reverse();
    linear.adjoint(|epoch, errors, covariance| {
        let (by_gains, left) = &wanted[epoch];
        for k in 0..NAV {
            assert!((errors[k] - by_gains[k]).abs() < 1e-9, "{epoch} {k}");
        }
        assert!((covariance[1][4] - left[(4, 4)]).abs() < 1e-9);
    });
}
