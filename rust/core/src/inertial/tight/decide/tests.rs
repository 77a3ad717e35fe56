use super::*;
use crate::inertial::tight::covariance::zeros;

const NOISE: ReceiverNoise = ReceiverNoise {
    code: 1.0,
    wander: 1.5,
    wander_time: 200.0,
    rate: 0.05,
    change: 0.0,
    reference_cn0: 0.0,
    clock: 0.01,
    drift: 4e-4,
};

fn towards(k: usize) -> Vector3<f64> {
    let (azimuth, height) = (0.9 * k as f64, 0.3 + 0.08 * k as f64);
    let flat = (1.0 - height * height).sqrt();
    Vector3::new(flat * azimuth.cos(), flat * azimuth.sin(), -height)
}

fn covariance() -> Square {
    let mut square = zeros();
    for k in 0..3 {
        square[k][k] = 4.0;
        square[k + 3][k + 3] = 0.0004;
    }
    square[CLOCK][CLOCK] = 4.0;
    square[DRIFT][DRIFT] = 0.01;
    square
}

/// Six satellites, of which `which` are moved by `shift` m and `speed` m/s towards the north.
fn jury(which: u64, shift: f64, speed: f64, clock: f64) -> Jury {
    let mut means = Means::new(10, 8);
    for epoch in 0..10 {
        let (mut range, mut rate) = ([f64::NAN; 8], [f64::NAN; 8]);
        for k in 0..8 {
            let hit = f64::from(u8::from(which >> k & 1 == 1));
            let wobble = ((3 * epoch + 5 * k) % 7) as f64 / 3.5 - 0.857;
            range[k] = wobble - hit * shift * towards(k).x + clock;
            rate[k] = 0.05 * wobble - hit * speed * towards(k).x;
        }
        means.push(&range, &rate);
    }
    let mut jury = Jury::new(8);
    jury.summon(&means, towards, &covariance(), &NOISE);
    jury
}

#[test]
fn clean_satellites_agree() {
    let said = jury(0, 0.0, 0.0, 0.0).agreement(0);
    assert!(said.all < 2.0 && said.mutual < 2.0 && said.inertial < 2.0);
    assert_eq!(said.count, 8);
}

#[test]
fn all_moved_agree_with_one_another_only() {
    let said = jury(0xff, 60.0, 0.5, 0.0).agreement(0);
    assert!(said.mutual < 2.0 && said.inertial > 6.0 && said.position > 6.0);
    assert_eq!(jury(0xff, 60.0, 0.5, 0.0).culprits(3, 2.33), None);
}

#[test]
fn a_clock_that_jumped_moves_no_position() {
    let said = jury(0, 0.0, 0.0, 300.0).agreement(0);
    assert!(said.inertial > 6.0 && said.position < 2.0);
}

#[test]
fn three_are_named() {
    for which in [0b1, 0b101, 0b10_0110] {
        assert_eq!(jury(which, 80.0, 0.8, 0.0).culprits(3, 2.33), Some(which));
    }
    assert_eq!(jury(0b1_0111, 80.0, 0.8, 0.0).culprits(3, 2.33), None);
}
