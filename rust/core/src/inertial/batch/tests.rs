use super::*;
use crate::inertial::closed_form;
use nalgebra::Vector3;

const RATE: f64 = 100.0;

fn increments(seconds: f64) -> Vec<Increment> {
    let path = closed_form::vehicle();
    (0..(seconds * RATE) as u32)
        .map(|k| path.increment(f64::from(k) / RATE, 1.0 / RATE))
        .collect()
}

fn plan(increments: &[Increment]) -> Plan<'_> {
    Plan {
        increments,
        start: closed_form::vehicle().state(0.0),
        resets: &[],
        vertical: None,
        every: 100,
        mechanisation: Mechanisation::Local,
    }
}

fn noisy(seed: u64) -> ImuErrors {
    let mut errors = ImuErrors {
        seed,
        ..ImuErrors::default()
    };
    errors.gyro.density = 1e-5;
    errors.accelerometer.bias = Vector3::new(1e-3, 0.0, 0.0);
    errors
}

fn navigated(plan: &Plan<'_>, runs: &[Run<'_>]) -> Vec<f64> {
    let mut out = vec![0.0; COLUMNS * plan.rows() * runs.len()];
    navigate(plan, runs, &mut out);
    out
}

fn position(state: &NavState) -> Vector3<f64> {
    WGS84.ecef(state.place)
}

fn row(out: &[f64], k: usize) -> Vector3<f64> {
    Vector3::from_column_slice(&out[COLUMNS * k..COLUMNS * k + 3])
}

#[test]
fn rows_are_the_truth_where_nothing_is_wrong() {
    let increments = increments(20.0);
    let run = Run {
        errors: None,
        alignments: &[],
    };
    for mechanisation in [Mechanisation::Local, Mechanisation::EarthFixed] {
        let plan = Plan {
            mechanisation,
            ..plan(&increments)
        };
        let out = navigated(&plan, &[run]);
        for k in [0, 1, 20] {
            let truth = position(&closed_form::vehicle().state(k as f64));
            assert!((row(&out, k) - truth).norm() < 1e-4);
        }
    }
}

#[test]
fn a_run_does_not_depend_on_the_others() {
    let increments = increments(5.0);
    let plan = plan(&increments);
    let runs: Vec<_> = (0..5)
        .map(|k| Run {
            errors: Some((noisy(3), k)),
            alignments: &[],
        })
        .collect();
    let all = navigated(&plan, &runs);
    let third = navigated(&plan, &runs[2..3]);
    let size = COLUMNS * plan.rows();
    assert_eq!(all[2 * size..3 * size], third);
    assert_ne!(all[size..2 * size], third);
}

#[test]
fn a_reset_takes_the_truth_and_its_error() {
    let increments = increments(20.0);
    let resets = [Reset {
        after: 1000,
        state: closed_form::vehicle().state(10.0),
        gap: false,
    }];
    let plan = Plan {
        resets: &resets,
        ..plan(&increments)
    };
    let error = StateError {
        position: Vector3::new(3.0, 4.0, 0.0),
        ..StateError::default()
    };
    let run = Run {
        errors: Some((noisy(1), 0)),
        alignments: &[StateError::default(), error],
    };
    let out = navigated(&plan, &[run]);
    let off = |k: usize| (row(&out, k) - position(&closed_form::vehicle().state(k as f64))).norm();
    assert!(off(9) > 0.02, "{}", off(9));
    assert!((off(10) - 5.0).abs() < 1e-3, "{}", off(10));
}

#[test]
fn the_vertical_channel_can_be_held() {
    let increments = increments(100.0);
    let vertical: Vec<_> = (0..increments.len())
        .map(|k| {
            let state = closed_form::vehicle().state((k + 1) as f64 / RATE);
            Vertical {
                height: state.place.height,
                down: state.velocity.z,
            }
        })
        .collect();
    let mut errors = ImuErrors::default();
    errors.accelerometer.bias.z = 0.01;
    let run = Run {
        errors: Some((errors, 0)),
        alignments: &[],
    };
    let truth = closed_form::vehicle().state(100.0);
    let height_error = |plan: &Plan<'_>| {
        let out = navigated(plan, &[run]);
        WGS84.geodetic(row(&out, 100)).height - truth.place.height
    };
    let free = plan(&increments);
    assert!(height_error(&free).abs() > 40.0);
    for mechanisation in [Mechanisation::Local, Mechanisation::EarthFixed] {
        let held = Plan {
            vertical: Some(&vertical),
            mechanisation,
            ..free
        };
        assert!(height_error(&held).abs() < 1e-6);
    }
}

#[test]
fn after_a_gap_the_next_increment_begins_at_the_reset() {
    let mut increments = increments(20.0);
    increments.drain(500..1000);
    let resets = [Reset {
        after: 500,
        state: closed_form::vehicle().state(10.0),
        gap: true,
    }];
    let plan = Plan {
        resets: &resets,
        ..plan(&increments)
    };
    let run = Run {
        errors: None,
        alignments: &[],
    };
    let out = navigated(&plan, &[run]);
    for (k, seconds) in [(4, 4.0), (5, 5.0), (6, 11.0), (15, 20.0)] {
        let truth = position(&closed_form::vehicle().state(seconds));
        assert!((row(&out, k) - truth).norm() < 1e-4, "{k}");
    }
}
