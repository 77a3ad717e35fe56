//! The correlator engine: against the double-precision reference, and against itself.

mod accuracy;
mod bits;
mod doors;
mod format;
mod fuzz;
mod kinds;
mod properties;
mod reference;
mod scenario;
mod setting;
mod sky;
mod tracker;

use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;

/// So many cases, the same in every run.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(20_250_101),
        ..Default::default()
    }
}
