use super::*;
use crate::inertial::closed_form::{self, Path};

fn navigate(
    path: &Path,
    rate: f64,
    seconds: f64,
    mut spoil: impl FnMut(&mut Increment),
) -> Strapdown {
    let mut ins = Strapdown::new(path.state(0.0));
    for k in 0..(seconds * rate).round() as u32 {
        let mut increment = path.increment(f64::from(k) / rate, 1.0 / rate);
        spoil(&mut increment);
        ins.advance(&increment);
    }
    ins
}

fn closes(path: &Path, rate: f64) {
    let ins = navigate(path, rate, 1750.0, |_| ());
    let error = error_of(ins.state(), &path.state(1750.0));
    assert!(error.velocity.norm() < 1e-4, "{error:?}");
    assert!(error.position.norm() < 0.05, "{error:?}");
    assert!(error.attitude.norm() < 1e-6, "{error:?}");
}

#[test]
fn vehicle_closes() {
    closes(&closed_form::vehicle(), 100.0);
}

#[test]
fn aircraft_closes() {
    closes(&closed_form::aircraft(), 100.0);
}

#[test]
fn ship_closes() {
    closes(&closed_form::ship(), 100.0);
}

#[test]
fn drone_closes() {
    closes(&closed_form::drone(), 400.0);
}

const DEG_PER_HOUR: f64 = std::f64::consts::PI / 180.0 / 3600.0;
const MICRO_G: f64 = 9.806_65e-6;

/// Velocity errors at the four times of the published numbers, at rest at 34 N, level, to the
/// north, with constant biases.
fn drift(rotation: Vector3<f64>, force: Vector3<f64>) -> [Vector3<f64>; 4] {
    let path = Path::at_rest(0.593, 1.885, 400.0);
    let mut increment = path.increment(0.0, 0.01);
    increment.rotation += rotation * 0.01;
    increment.velocity += force * 0.01;
    let mut ins = Strapdown::new(path.state(0.0));
    let mut now = 0;
    [20_000, 65_000, 150_000, 174_900].map(|then| {
        (now..then).for_each(|_| ins.advance(&increment));
        now = then;
        ins.state().velocity
    })
}

#[test]
fn schuler_numbers() {
    let gyro = drift(Vector3::new(0.0, 0.1 * DEG_PER_HOUR, 0.0), Vector3::zeros());
    for (got, want) in gyro.iter().zip([0.0945, 0.949, 3.95, 4.80]) {
        assert!((got.x.abs() / want - 1.0).abs() < 0.01, "{got} {want}");
    }
    let force = drift(Vector3::zeros(), Vector3::new(0.0, 10.0 * MICRO_G, 0.0));
    for (got, want) in force.iter().zip([0.0194, 0.0570, 0.0749, 0.0639]) {
        assert!((got.y / want - 1.0).abs() < 0.01, "{got} {want}");
    }
}

#[test]
fn errors_are_five_times_as_large_where_the_biases_are() {
    let bias = |times: f64| {
        let turn = times * 0.1 * DEG_PER_HOUR * Vector3::new(1.0, -1.0, 1.0);
        drift(turn, times * 10.0 * MICRO_G * Vector3::new(-1.0, 1.0, 1.0))
    };
    for (n2, n1) in bias(5.0).iter().zip(bias(1.0)) {
        for axis in 0..2 {
            assert!((n2[axis] / n1[axis] - 5.0).abs() < 0.05, "{n2} {n1}");
        }
    }
}

#[test]
fn at_rest_it_stays_at_rest() {
    let path = Path::at_rest(-0.7, 3.0, 0.0);
    let ins = navigate(&path, 50.0, 1750.0, |_| ());
    let error = error_of(ins.state(), &path.state(0.0));
    assert!(
        error.velocity.norm() < 1e-6 && error.position.norm() < 1e-3,
        "{error:?}"
    );
}

#[test]
fn corrections_undo_errors() {
    let truth = closed_form::aircraft().state(100.0);
    let error = StateError {
        position: Vector3::new(30.0, -20.0, 10.0),
        velocity: Vector3::new(0.3, 0.2, -0.1),
        attitude: Vector3::new(1e-3, -2e-3, 3e-3),
    };
    let opposite = StateError {
        position: -error.position,
        velocity: -error.velocity,
        attitude: -error.attitude,
    };
    let spoiled = corrected(&truth, &opposite);
    let found = error_of(&spoiled, &truth);
    assert!((found.position - error.position).norm() < 1e-3);
    assert!((found.velocity - error.velocity).norm() < 1e-12);
    assert!((found.attitude - error.attitude).norm() < 1e-12);
    let mut ins = Strapdown::new(spoiled);
    ins.correct(&error);
    let left = error_of(ins.state(), &truth);
    assert!(left.position.norm() < 1e-3 && left.attitude.norm() < 1e-12);
}

/// A gap in the middle, bridged by one long increment, costs little where nothing turns.
#[test]
fn intervals_may_differ() {
    let path = closed_form::ship();
    let mut ins = Strapdown::new(path.state(0.0));
    let mut t = 0.0;
    for k in 0..30_000_u32 {
        let interval = if k % 3 == 0 { 0.012 } else { 0.009 };
        ins.advance(&path.increment(t, interval));
        t += interval;
    }
    let error = error_of(ins.state(), &path.state(t));
    assert!(error.velocity.norm() < 1e-4, "{error:?}");
}
