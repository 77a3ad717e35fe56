//! The adjoint against all measurements at once, and against the smoother with gains.

use nalgebra::{DMatrix, DVector, Vector3};

use linear::{begin, Event, Linear, EPOCHS};

use super::{smooth, Tape};
use crate::inertial::closed_form;
use crate::inertial::tight::covariance::Row;
use crate::inertial::tight::filter::ErrorFilter;
use crate::inertial::tight::motion::Motion;
use crate::inertial::tight::run::tests::{noise, settings};
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

/// A record of so many epochs on a ship; at `jump` the navigator goes over to another estimate.
fn recorded(epochs: usize, jump: Option<usize>) -> Tape {
    let believed = believed(0.0, 1.0);
    let mut filter = ErrorFilter::new(&believed, 2, 1);
    filter.tape = Some(Box::new(Tape::new(
        &believed,
        &filter,
        0.0,
        epochs,
        4 * epochs,
    )));
    for epoch in 0..epochs {
        let time = 1.0 + epoch as f64;
        let state = closed_form::ship().state(time);
        let mut motion = Motion::new();
        motion.add(&state, &Vector3::new(0.0, 0.0, -9.8), 1.0);
        filter.predict(&motion.transition(&state, &believed));
        filter.tape.as_mut().unwrap().moved(motion, &state);
        for k in 0..4 {
            let mut row = Row::default();
            row.push((epoch + k) % 6, 1.0);
            row.push(NAV + k % 2, 1.0);
            filter.update(&row, noise(4 * epoch + k), 0.25, 0.0);
        }
        filter.taken_off();
        if jump == Some(epoch) {
            filter.replace(&filter.navigation());
            filter.tape.as_mut().unwrap().begin_anew();
        }
        let tape = filter.tape.as_mut().unwrap();
        tape.close(epoch, time, state, &filter.p);
    }
    *filter.tape.unwrap()
}

#[test]
fn before_a_jump_nothing_later_is_heard() {
    const JUMP: usize = 4;
    let broken = smooth(&recorded(9, Some(JUMP)), 9);
    let whole = smooth(&recorded(9, None), 9);
    // The epoch of the jump is another estimate; what was measured at it belongs to those before.
    let before = smooth(&recorded(JUMP + 1, None), JUMP + 1);
    for epoch in 0..JUMP {
        assert_eq!(broken.place[epoch], before.place[epoch]);
        assert_eq!(broken.covariance[epoch], before.covariance[epoch]);
        assert_ne!(broken.place[epoch], whole.place[epoch]);
    }
    assert_ne!(broken.place[JUMP], before.place[JUMP]);
}
