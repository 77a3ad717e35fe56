use super::*;

const N: usize = 400_000;
const DT: f64 = 0.01;

fn still() -> Increment {
    Increment {
        rotation: Vector3::new(1e-6, -2e-6, 3e-6),
        velocity: Vector3::new(0.01, 0.02, -0.098),
        interval: DT,
    }
}

fn noisy() -> ImuErrors {
    let sensor = SensorErrors {
        wander: 2e-3,
        wander_time: 3.0,
        density: 1e-3,
        ..Default::default()
    };
    ImuErrors {
        gyro: sensor,
        accelerometer: sensor,
        seed: 5,
    }
}

fn read(stream: &mut ErrorStream, count: usize) -> Vec<Increment> {
    (0..count)
        .map(|_| {
            let mut increment = still();
            stream.apply(&mut increment);
            increment
        })
        .collect()
}

/// Allan variance of rates from sums of `m` increments each, and its relative standard error.
fn allan(sums: &[f64], m: usize) -> (f64, f64) {
    let tau = m as f64 * DT;
    let rates: Vec<f64> = sums
        .chunks_exact(m)
        .map(|c| c.iter().sum::<f64>() / tau)
        .collect();
    let square = rates.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>();
    let count = (rates.len() - 1) as f64;
    (square / (2.0 * count), (3.0 / count).sqrt())
}

#[test]
fn nothing_added_leaves_the_truth() {
    let mut stream = ErrorStream::new(&ImuErrors::default(), 3);
    assert!(read(&mut stream, 10).iter().all(|i| *i == still()));
}

#[test]
fn bias_scale_misalignment() {
    let mut errors = ImuErrors::default();
    errors.gyro.bias = Vector3::new(1e-4, 0.0, -1e-4);
    errors.gyro.distortion[(0, 0)] = 0.5;
    errors.gyro.distortion[(1, 2)] = 0.1;
    let got = read(&mut ErrorStream::new(&errors, 0), 1)[0];
    let expected = Vector3::new(2.5e-6, -1.7e-6, 2e-6);
    assert!((got.rotation - expected).norm() < 1e-18);
    assert_eq!(got.velocity, still().velocity);
}

/// Angle random walk: Allan variance density^2 / tau. Gauss-Markov: IEEE Std 952-1997, eq. C.19
/// in closed form for independent clusters.
#[test]
fn allan_variance_is_that_of_the_model() {
    let e = noisy();
    let rows = read(&mut ErrorStream::new(&e, 0), N);
    let (sigma, time) = (e.gyro.wander, e.gyro.wander_time);
    for axis in 0..3 {
        let sums: Vec<f64> = rows.iter().map(|i| i.rotation[axis]).collect();
        for m in [1, 10, 100, 1000] {
            let tau = m as f64 * DT;
            let x: f64 = tau / time;
            let markov =
                sigma * sigma / (x * x) * (2.0 * x - 3.0 + 4.0 * (-x).exp() - (-2.0 * x).exp());
            let expected = e.gyro.density.powi(2) / tau + markov;
            let (seen, relative) = allan(&sums, m);
            assert!((seen / expected - 1.0).abs() < 4.0 * relative, "{axis} {m}");
        }
    }
}

#[test]
fn wander_is_stationary_from_the_first_increment() {
    let e = noisy();
    let runs = 4000_u64;
    let first = |run| {
        let mut stream = ErrorStream::new(&e, run);
        stream.skip(1, DT);
        stream.biases()[1].norm_squared()
    };
    let mean = (0..runs).map(first).sum::<f64>() / (3 * runs) as f64;
    let relative = mean / e.accelerometer.wander.powi(2) - 1.0;
    assert!(relative.abs() < 4.0 * (2.0 / (3 * runs) as f64).sqrt());
}

#[test]
fn axes_sensors_and_runs_are_independent() {
    let e = noisy();
    let a = read(&mut ErrorStream::new(&e, 0), N / 10);
    let b = read(&mut ErrorStream::new(&e, 1), N / 10);
    let white = |rows: &[Increment], axis: usize| -> Vec<f64> {
        let values = rows.windows(2).map(|w| {
            let change = w[1].rotation - w[0].rotation;
            let other = w[1].velocity - w[0].velocity;
            if axis < 3 {
                change[axis]
            } else {
                other[axis - 3]
            }
        });
        values.collect()
    };
    let correlation = |x: &[f64], y: &[f64]| {
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
        dot(x, y) / (dot(x, x) * dot(y, y)).sqrt()
    };
    // Differences of white noise are correlated, which widens the law by sqrt(1.5).
    let limit = 4.0 * (1.5 / (N / 10) as f64).sqrt();
    for k in 0..6 {
        assert!(
            correlation(&white(&a, k), &white(&b, k)).abs() < limit,
            "{k}"
        );
        for l in 0..k {
            assert!(correlation(&white(&a, k), &white(&a, l)).abs() < limit);
        }
    }
}

#[test]
fn any_cut_gives_the_same_bits() {
    let e = noisy();
    let whole = read(&mut ErrorStream::new(&e, 7), 1000);
    for cut in [0, 1, 63, 64, 65, 500] {
        let mut stream = ErrorStream::new(&e, 7);
        stream.skip(cut, DT);
        assert_eq!(read(&mut stream, 1000 - cut), whole[cut..]);
    }
}

#[test]
fn range_clips_and_resolution_keeps_the_remainder() {
    let mut errors = ImuErrors::default();
    errors.accelerometer.limit = 5.0;
    errors.accelerometer.quantum = 0.003;
    let rows = read(&mut ErrorStream::new(&errors, 0), 1000);
    let sum: Vector3<f64> = rows.iter().map(|i| i.velocity).sum();
    let expected = Vector3::new(10.0, 20.0, -50.0);
    assert!((sum - expected).abs().max() <= 0.0015 + 1e-9);
    for row in rows {
        for v in row.velocity.iter() {
            assert!((v / 0.003 - (v / 0.003).round()).abs() < 1e-9);
        }
    }
}
