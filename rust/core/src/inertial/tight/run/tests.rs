//! Whole runs on a ship in closed form: time alignment, gaps, missing satellites, exclusion.

use nalgebra::Vector3;

use super::*;
use crate::inertial::closed_form;
use crate::inertial::strapdown::error_of;
use crate::inertial::tight::guard::State;
use crate::inertial::tight::motion::local_axes;
use crate::inertial::tight::output::Usage;
use crate::inertial::tight::settings::{
    Form, ImuNoise, Mode, Published, ReceiverNoise, StartSigma, Testing,
};
use crate::nav_math::geodesy::WGS84;

const SATELLITES: usize = 8;
const RATE: f64 = 100.0;

pub fn settings(mode: Mode) -> Settings {
    Settings {
        imu: ImuNoise {
            gyro: 3e-6,
            accelerometer: 1e-4,
            gyro_walk: 0.0,
            accelerometer_walk: 0.0,
        },
        receiver: ReceiverNoise {
            code: 0.5,
            wander: 0.5,
            wander_time: 100.0,
            rate: 0.02,
            change: 0.0,
            reference_cn0: 0.0,
            clock: 0.01,
            drift: 4e-4,
        },
        start: StartSigma {
            position: 3.0,
            velocity: 0.1,
            level: 1e-3,
            heading: 3e-3,
            gyro_bias: 5e-7,
            accelerometer_bias: 5e-4,
            clock: 30.0,
            drift: 10.0,
        },
        published: Published {
            length: 10,
            form: Form::MeanSquare,
            divisors: [1e3; 4],
        },
        mode,
        testing: Testing {
            thresholds: [6.0; 5],
            power_rise: 5.0,
            robust: 4.0,
            slack: 0.05,
            most_excluded: 3,
            heed_receiver: true,
        },
        lever_arm: Vector3::new(2.0, -1.0, -5.0),
        outages: Vec::new(),
        bridge: 0.5,
        smooth: false,
        subsets: false,
    }
}

/// A ship's log and what its antenna measures, both without receiver or sensor errors but for
/// white noise.
struct Scene {
    log: (Vec<f64>, Vec<[f64; 3]>, Vec<[f64; 3]>),
    time: Vec<f64>,
    place: Vec<[f64; 3]>,
    still: Vec<[f64; 3]>,
    range: Vec<f64>,
    rate: Vec<f64>,
    cn0: Vec<f64>,
    spoofed: Vec<bool>,
}

/// Nearly normal, the same for the same number (S. Vigna's splitmix64, four uniform values).
pub fn noise(number: usize) -> f64 {
    let uniform = |part: u64| {
        let mut z = (4 * number as u64 + part + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    (0..4).map(uniform).sum::<f64>() * f64::sqrt(3.0)
}

fn antenna(t: f64) -> Vector3<f64> {
    let state = closed_form::ship().state(t);
    let lever = state.attitude * settings(Mode::Off).lever_arm;
    WGS84.ecef(state.place) + local_axes(&state) * lever
}

fn scene(seconds: f64, offset: f64) -> Scene {
    let path = closed_form::ship();
    let steps = (seconds * RATE).round() as usize;
    let mut log = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..steps {
        let increment = path.increment(k as f64 / RATE, 1.0 / RATE);
        log.0.push((k + 1) as f64 / RATE);
        log.1.push(increment.rotation.into());
        log.2.push(increment.velocity.into());
    }
    let time: Vec<f64> = (0..seconds as usize - 1)
        .map(|k| k as f64 + offset)
        .collect();
    let axes = local_axes(&path.state(0.0));
    let (mut place, mut range, mut rate) = (Vec::new(), Vec::new(), Vec::new());
    for (e, &t) in time.iter().enumerate() {
        let (now, before, after) = (antenna(t), antenna(t - 0.01), antenna(t + 0.01));
        for k in 0..SATELLITES {
            let (azimuth, height) = (0.8 * k as f64, 0.25 + 0.08 * k as f64);
            let level = f64::sqrt(1.0 - height * height);
            let towards = Vector3::new(level * azimuth.cos(), level * azimuth.sin(), -height);
            let satellite = antenna(0.0) + axes * towards * 2.2e7;
            place.push(satellite.into());
            range.push(
                (satellite - now).norm() + 100.0 + 0.3 * t + 0.5 * noise(2 * (e * SATELLITES + k)),
            );
            let change = (satellite - after).norm() - (satellite - before).norm();
            rate.push(change / 0.02 + 0.3 + 0.02 * noise(2 * (e * SATELLITES + k) + 1));
        }
    }
    let cells = place.len();
    Scene {
        log,
        time,
        place,
        still: vec![[0.0; 3]; cells],
        range,
        rate,
        cn0: vec![45.0; cells],
        spoofed: vec![false; cells],
    }
}

fn fly(scene: &Scene, settings: &Settings, threads: usize) -> Vec<Output> {
    let rules = Rules {
        settle: 20.0,
        ..Rules::default()
    };
    let log = ImuLog {
        time: &scene.log.0,
        interval: 1.0 / RATE,
        rotation: &scene.log.1,
        velocity: &scene.log.2,
    };
    let sky = Sky {
        time: &scene.time,
        system: &[0; SATELLITES],
        place: &scene.place,
        velocity: &scene.still,
        cn0: &scene.cn0,
        spoofed: &scene.spoofed,
    };
    let change = vec![f64::NAN; scene.range.len()];
    let run = Run {
        start: closed_form::ship().state(0.0),
        errors: None,
        measured: Measured {
            range: &scene.range,
            rate: &scene.rate,
            change: &change,
        },
    };
    navigate(log, sky, &[run, run], 0.0, settings, rules, true, threads).unwrap()
}

/// Errors of position and velocity at the last epoch.
fn errors(scene: &Scene, output: &Output) -> (f64, f64) {
    let truth = closed_form::ship().state(*scene.time.last().unwrap());
    let [latitude, longitude, height] = *output.place.last().unwrap();
    let mut state = truth;
    state.place = crate::nav_math::geodesy::Geodetic {
        latitude,
        longitude,
        height,
    };
    state.velocity = Vector3::from(*output.velocity.last().unwrap());
    let error = error_of(&state, &truth);
    (error.position.norm(), error.velocity.norm())
}

#[test]
fn it_follows_the_ship_wherever_epochs_fall_between_increments() {
    for offset in [0.0, 0.0037] {
        let scene = scene(80.0, offset);
        let made = fly(&scene, &settings(Mode::Robust), 2);
        let (position, velocity) = errors(&scene, &made[0]);
        assert!(
            position < 0.6 && velocity < 0.02,
            "{offset} {position} {velocity}"
        );
        assert!(made[0].events.is_empty(), "{:?}", made[0].events);
    }
}

#[test]
fn runs_do_not_depend_on_threads() {
    let scene = scene(30.0, 0.0);
    let (one, two) = (
        fly(&scene, &settings(Mode::Robust), 1),
        fly(&scene, &settings(Mode::Robust), 2),
    );
    assert_eq!(one[0].place, two[1].place);
    assert_eq!(one[0].deviates, two[1].deviates);
}

#[test]
fn gaps_and_nan_of_the_imu_are_bridged_and_believed_less() {
    let mut broken = scene(80.0, 0.0);
    for k in 5010..5030 {
        broken.log.1[k] = [f64::NAN; 3];
    }
    for column in [&mut broken.log.1, &mut broken.log.2] {
        column.drain(6000..6015);
    }
    broken.log.0.drain(6000..6015);
    let whole = scene(80.0, 0.0);
    let of = |scene: &Scene| fly(scene, &settings(Mode::Off), 1).remove(0);
    let (made, clean) = (of(&broken), of(&whole));
    let (position, velocity) = errors(&broken, &made);
    assert!(position < 1.5 && velocity < 0.2, "{position} {velocity}");
    assert!(made.covariance[51][9] > 3.0 * clean.covariance[51][9]);
    assert!(made.valid.iter().all(|v| *v));
}

#[test]
fn it_goes_on_with_few_satellites_and_with_none() {
    let mut scene = scene(80.0, 0.0);
    for (cell, (range, rate)) in scene.range.iter_mut().zip(&mut scene.rate).enumerate() {
        let (epoch, satellite) = (cell / SATELLITES, cell % SATELLITES);
        if epoch > 40 && satellite > 1 || epoch > 60 {
            (*range, *rate) = (f64::NAN, f64::NAN);
        }
    }
    let made = fly(&scene, &settings(Mode::Robust), 1).remove(0);
    let (position, velocity) = errors(&scene, &made);
    assert!(position < 6.0 && velocity < 0.3, "{position} {velocity}");
    assert!(made.events.is_empty());
    assert_eq!(made.usage[70 * SATELLITES], Usage::Missing as u8);
}

#[test]
fn epochs_after_the_log_are_not_valid() {
    let mut scene = scene(40.0, 0.0);
    scene.log.0.truncate(2050);
    scene.log.1.truncate(2050);
    scene.log.2.truncate(2050);
    let made = fly(&scene, &settings(Mode::Robust), 1).remove(0);
    assert!(made.valid[20] && !made.valid[21]);
    assert!(made.place[30][0].is_nan());
    assert_eq!(made.usage.len(), scene.range.len());
}

#[test]
fn three_that_are_pulled_are_left_out_and_come_back() {
    let mut scene = scene(160.0, 0.0);
    for cell in 60 * SATELLITES..110 * SATELLITES {
        if [1, 4, 6].contains(&(cell % SATELLITES)) {
            let since = (cell / SATELLITES - 60) as f64;
            scene.range[cell] += 1.5 * since;
            scene.rate[cell] += 1.5;
        }
    }
    let made = fly(&scene, &settings(Mode::Robust), 1).remove(0);
    let named = made.events.iter().map(|e| e.excluded).collect::<Vec<_>>();
    assert!(named.contains(&0b101_0010), "{:?}", made.events);
    assert_eq!(made.usage[80 * SATELLITES + 4], Usage::Excluded as u8);
    assert_eq!(made.usage[158 * SATELLITES + 4], Usage::Used as u8);
    assert!(errors(&scene, &made).0 < 1.0);
}

#[test]
fn one_bad_epoch_of_whatever_size_is_pardoned() {
    let mut scene = scene(260.0, 0.0);
    for k in 0..SATELLITES {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        scene.range[80 * SATELLITES + k] += 5.0 * sign;
    }
    let made = fly(&scene, &settings(Mode::Robust), 1).remove(0);
    assert!(made.events[0].deviate > 8.0, "{:?}", made.events);
    let last = made.events.last().unwrap();
    assert!(last.state == State::Trusted && last.time < 240.0);
    assert!(errors(&scene, &made).0 < 1.0);
}

#[test]
fn satellites_that_the_receiver_calls_spoofed_are_not_used() {
    let mut scene = scene(40.0, 0.0);
    for cell in (3..scene.range.len()).step_by(SATELLITES) {
        scene.spoofed[cell] = true;
        scene.range[cell] += 500.0;
    }
    let made = fly(&scene, &settings(Mode::Robust), 1).remove(0);
    assert_eq!(made.usage[30 * SATELLITES + 3], Usage::Excluded as u8);
    assert!(errors(&scene, &made).0 < 0.8 && made.events.is_empty());
}

#[test]
fn shapes_that_do_not_fit_are_refused() {
    let mut scene = scene(10.0, 0.0);
    scene.cn0.pop();
    let result = std::panic::catch_unwind(|| fly(&scene, &settings(Mode::Off), 1));
    assert!(result.is_err());
}
