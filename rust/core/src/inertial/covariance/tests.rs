use super::*;
use crate::inertial::closed_form;
use crate::inertial::draws::Draws;
use crate::inertial::errors::{ErrorStream, ImuErrors, SensorErrors};
use crate::inertial::strapdown::{corrected, error_of, StateError};

const RUNS: u64 = 200;
const SECONDS: usize = 60;

fn uncertainty() -> Uncertainty {
    Uncertainty {
        gyro: SensorNoise {
            bias: 2e-5,
            wander: 3e-5,
            wander_time: 20.0,
            density: 1e-4,
        },
        accelerometer: SensorNoise {
            bias: 3e-3,
            wander: 5e-3,
            wander_time: 30.0,
            density: 2e-3,
        },
        alignment: [
            Vector3::repeat(1.0),
            Vector3::repeat(0.05),
            Vector3::new(1e-3, 1e-3, 3e-3),
        ],
    }
}

fn sensor(noise: SensorNoise, normal: Vector3<f64>) -> SensorErrors {
    SensorErrors {
        bias: noise.bias * normal,
        wander: noise.wander,
        wander_time: noise.wander_time,
        density: noise.density,
        ..SensorErrors::default()
    }
}

/// Errors of one run at the end: position, velocity, attitude.
fn drawn(increments: &[Increment], run: u64, truth: [NavState; 2]) -> [f64; 9] {
    let u = uncertainty();
    let mut draws = Draws::new(99, run);
    let [gyro, accelerometer] = draws.six();
    let [position, velocity] = draws.six();
    let [attitude, _] = draws.six();
    let errors = ImuErrors {
        gyro: sensor(u.gyro, gyro),
        accelerometer: sensor(u.accelerometer, accelerometer),
        seed: 5,
    };
    let error = StateError {
        position: u.alignment[0].component_mul(&position),
        velocity: u.alignment[1].component_mul(&velocity),
        attitude: u.alignment[2].component_mul(&attitude),
    };
    let mut ins = Strapdown::new(corrected(&truth[0], &error));
    let mut stream = ErrorStream::new(&errors, run);
    for ideal in increments {
        let mut increment = *ideal;
        stream.apply(&mut increment);
        ins.advance(&increment);
    }
    let found = error_of(ins.state(), &truth[1]);
    let mut values = [0.0; 9];
    for (three, value) in
        values
            .chunks_exact_mut(3)
            .zip([found.position, found.velocity, found.attitude])
    {
        three.copy_from_slice(value.as_slice());
    }
    values
}

#[test]
fn it_is_what_runs_scatter_by() {
    let path = closed_form::vehicle();
    let increments: Vec<_> = (0..SECONDS * 50)
        .map(|k| path.increment(k as f64 * 0.02, 0.02))
        .collect();
    let mut covariance = Covariance::zeros();
    propagate(&increments, path.state(0.0), &uncertainty(), 50, |c| {
        covariance = *c;
    });
    let want = sigmas(&covariance);
    let truth = [path.state(0.0), path.state(SECONDS as f64)];
    let mut squares = [0.0; 9];
    for run in 0..RUNS {
        for (sum, value) in squares.iter_mut().zip(drawn(&increments, run, truth)) {
            *sum += value * value / RUNS as f64;
        }
    }
    let allowed = 4.0 * (2.0 / RUNS as f64).sqrt();
    for (square, sigma) in squares.iter().zip(want) {
        let ratio = square / (sigma * sigma);
        assert!((ratio - 1.0).abs() < allowed, "{ratio} {square} {sigma}");
    }
}

#[test]
fn rows_are_the_start_and_whole_steps() {
    let path = closed_form::vehicle();
    let increments: Vec<_> = (0..125)
        .map(|k| path.increment(f64::from(k) * 0.02, 0.02))
        .collect();
    let mut rows = Vec::new();
    propagate(&increments, path.state(0.0), &uncertainty(), 50, |c| {
        rows.push(sigmas(c));
    });
    assert_eq!(rows.len(), 3);
    assert_eq!(rows[0][0], 1.0);
    assert!(rows[2][3] > rows[1][3]);
}
