//! Bytes of any kind become operations on engines and trackers. `cargo test` runs a few, `make
//! fuzz` as many as there is time for.

mod engines;
mod input;
mod trackers;

use std::cell::Cell;
use std::panic::catch_unwind;
use std::sync::Once;
use std::time::{Duration, Instant};

use crate::doors::said;
use input::Random;

/// Panics that are looked for are not printed.
fn quietly<T>(f: impl FnOnce() -> T) -> T {
    thread_local!(static QUIET: Cell<bool> = const { Cell::new(false) });
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let loud = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !QUIET.get() {
                loud(info);
            }
        }));
    });
    QUIET.set(true);
    let result = f();
    QUIET.set(false);
    result
}

/// Runs a target on the input that follows from each seed.
fn run(target: fn(&[u8]), seeds: impl Iterator<Item = u64>) {
    for seed in seeds {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let length = 200 + usize::from(random.byte()) * 8;
        let bytes: Vec<u8> = (0..length).map(|_| random.byte()).collect();
        let outcome = quietly(|| catch_unwind(|| target(&bytes)));
        if let Err(panic) = outcome {
            panic!("seed {seed}: {}", said(&*panic));
        }
    }
}

/// Seeds from `FUZZ_SEED` (0 unless it is set) on, until `FUZZ_SECONDS` (60) are over.
fn timed() -> impl Iterator<Item = u64> {
    let of = |name: &str| std::env::var(name).ok().and_then(|v| v.parse().ok());
    let first = of("FUZZ_SEED").unwrap_or(0);
    let end = Instant::now() + Duration::from_secs(of("FUZZ_SECONDS").unwrap_or(60));
    (first..).take_while(move |seed| {
        let go_on = Instant::now() < end;
        if !go_on {
            println!("seeds {first} to {seed}");
        }
        go_on
    })
}

#[test]
fn a_few_engines() {
    run(engines::engine, 0..60);
}

#[test]
fn a_few_trackers() {
    run(trackers::tracker, 0..20);
}

#[test]
#[ignore = "goes on for FUZZ_SECONDS"]
fn long_engines() {
    run(engines::engine, timed());
}

#[test]
#[ignore = "goes on for FUZZ_SECONDS"]
fn long_trackers() {
    run(trackers::tracker, timed());
}
