use super::*;

fn agreement(inertial: f64, mutual: f64) -> Agreement {
    Agreement {
        all: inertial.max(mutual),
        mutual,
        inertial,
        position: inertial,
        count: 8,
    }
}

fn quiet(time: f64) -> Evidence {
    Evidence {
        time,
        alarm: None,
        agreement: Some(agreement(0.0, 0.0)),
        culprits: None,
        back: 0,
        confirmed: false,
        acquits: true,
        jump: 0.0,
    }
}

fn alarmed() -> Guard {
    let mut guard = Guard::new(Rules::default(), 0.0, 8);
    for time in 0..100 {
        assert_eq!(guard.step(&quiet(f64::from(time))), Action::None);
    }
    let alarm = Some(Alarm { test: 0, age: 60.0 });
    let action = guard.step(&Evidence {
        alarm,
        ..quiet(100.0)
    });
    assert_eq!(action, Action::TakeBack(60.0));
    assert!(guard.blind() && !guard.uses(0));
    guard
}

/// Runs from `from` until it does something, at most `seconds`.
fn until(
    guard: &mut Guard,
    from: f64,
    seconds: u32,
    seen: impl Fn(f64) -> Evidence,
) -> Option<(f64, Action)> {
    (0..seconds).find_map(|k| {
        let time = from + f64::from(k);
        let action = guard.step(&seen(time));
        (action != Action::None).then_some((time, action))
    })
}

#[test]
fn no_alarm_while_starting() {
    let mut guard = Guard::new(Rules::default(), 0.0, 8);
    let alarm = Some(Alarm { test: 0, age: 1.0 });
    let seen = Evidence {
        alarm,
        ..quiet(1.0)
    };
    assert_eq!(guard.step(&seen), Action::None);
    assert_eq!(guard.state(), State::Starting);
    assert!(guard.uses(3));
}

#[test]
fn a_false_alarm_is_pardoned() {
    let mut guard = alarmed();
    assert_eq!(
        until(&mut guard, 101.0, 200, quiet),
        Some((161.0, Action::Coast))
    );
    let (time, action) = until(&mut guard, 162.0, 200, quiet).unwrap();
    assert_eq!((time, action), (250.0, Action::Readmit));
    assert_eq!(guard.state(), State::Trusted);
}

#[test]
fn nothing_is_pardoned_while_what_came_since_is_unusual() {
    let doubtful = |time: f64| Evidence {
        acquits: time > 300.0,
        ..quiet(time)
    };
    let mut guard = alarmed();
    until(&mut guard, 101.0, 100, doubtful).unwrap();
    let found = until(&mut guard, 162.0, 300, doubtful);
    assert_eq!(found, Some((301.0, Action::Readmit)));
}

#[test]
fn an_alarm_lapses_though_the_ins_is_as_far_off_as_it_was() {
    let off = |time| Evidence {
        agreement: Some(agreement(4.0, 0.0)),
        ..quiet(time)
    };
    let mut guard = alarmed();
    until(&mut guard, 101.0, 100, off).unwrap();
    let found = until(&mut guard, 162.0, 400, off);
    assert_eq!(found, Some((400.0, Action::ReadmitAnew)));
}

#[test]
fn a_clock_that_is_off_by_little_is_found_anew_in_the_end() {
    let clock = |time| Evidence {
        agreement: Some(Agreement {
            position: 0.0,
            ..agreement(3.8, 0.0)
        }),
        ..quiet(time)
    };
    let mut guard = alarmed();
    until(&mut guard, 101.0, 100, clock).unwrap();
    let found = until(&mut guard, 162.0, 300, clock);
    assert_eq!(found, Some((250.0, Action::ReadmitAnew)));
}

#[test]
fn three_are_excluded_and_come_back() {
    let mut guard = alarmed();
    let named = |time| Evidence {
        agreement: Some(agreement(9.0, 9.0)),
        culprits: Some(0b111),
        ..quiet(time)
    };
    let (time, action) = until(&mut guard, 101.0, 60, named).unwrap();
    assert_eq!((time, action), (105.0, Action::Exclude(0b111)));
    assert!(!guard.uses(0) && guard.uses(3));
    let back = |time| Evidence {
        back: 0b011,
        ..quiet(time)
    };
    let (time, action) = until(&mut guard, 106.0, 60, back).unwrap();
    assert_eq!((time, action), (126.0, Action::Exclude(0b100)));
    let back = |time| Evidence {
        back: 0b100,
        ..quiet(time)
    };
    let (_, action) = until(&mut guard, 127.0, 60, back).unwrap();
    assert_eq!(action, Action::Readmit);
    assert!((0..8).all(|k| guard.uses(k)));
}

#[test]
fn an_alarm_of_the_rest_leaves_all_out() {
    let mut guard = alarmed();
    let named = |time| Evidence {
        culprits: Some(1),
        agreement: None,
        ..quiet(time)
    };
    until(&mut guard, 101.0, 60, named).unwrap();
    let alarm = Some(Alarm {
        test: 2,
        age: 150.0,
    });
    let again = Evidence {
        alarm,
        ..quiet(120.0)
    };
    assert_eq!(guard.step(&again), Action::TakeBack(150.0));
    assert!(guard.blind());
}

#[test]
fn coasting_ends_with_a_step_back_only() {
    let far = |time| Evidence {
        confirmed: true,
        agreement: Some(agreement(30.0, 0.0)),
        ..quiet(time)
    };
    let mut guard = alarmed();
    let (time, action) = until(&mut guard, 101.0, 100, far).unwrap();
    assert_eq!((time, action), (161.0, Action::Coast));
    assert_eq!(until(&mut guard, 162.0, 300, far), None);
    let back = |time| Evidence {
        confirmed: true,
        jump: if time < 464.0 { 30.0 } else { 0.0 },
        ..quiet(time)
    };
    let (time, action) = until(&mut guard, 462.0, 100, back).unwrap();
    assert_eq!((time, action), (482.0, Action::Readmit));
    // Without a step, and once the alarm is confirmed, nothing is believed.
    let creeps = |time: f64| Evidence {
        confirmed: true,
        agreement: Some(agreement((8.0 - (time - 100.0) / 50.0).max(0.0), 0.0)),
        ..quiet(time)
    };
    let mut guard = alarmed();
    until(&mut guard, 101.0, 100, creeps).unwrap();
    assert_eq!(until(&mut guard, 162.0, 2000, creeps), None);
}

#[test]
fn a_clock_alone_is_found_anew() {
    let mut guard = alarmed();
    let clock = |time| Evidence {
        agreement: Some(Agreement {
            position: 0.0,
            ..agreement(20.0, 0.0)
        }),
        ..quiet(time)
    };
    let (_, action) = until(&mut guard, 101.0, 60, clock).unwrap();
    assert_eq!(action, Action::ReadmitAnew);
}

#[test]
fn an_epoch_out_of_place_does_not_undo_a_step_back() {
    let far = |time| Evidence {
        confirmed: true,
        agreement: Some(agreement(30.0, 0.0)),
        ..quiet(time)
    };
    let landed = |time: f64, out: std::ops::Range<f64>| Evidence {
        confirmed: true,
        jump: if time < 464.0 { 30.0 } else { 0.0 },
        agreement: Some(agreement(0.0, if out.contains(&time) { 3.5 } else { 0.0 })),
        ..quiet(time)
    };
    let mut guard = alarmed();
    until(&mut guard, 101.0, 361, far).unwrap();
    let mut again = guard.clone();
    let found = until(&mut guard, 462.0, 100, |t| landed(t, 481.0..482.0));
    assert_eq!(found, Some((502.0, Action::Readmit)));
    // Who disagrees for longer has left the INS again.
    let found = until(&mut again, 462.0, 1000, |t| landed(t, 475.0..500.0));
    assert_eq!(found, None);
}
