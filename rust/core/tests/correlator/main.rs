//! The correlator engine: against the double-precision reference, and against itself.

mod accuracy;
mod kinds;
mod setting;
