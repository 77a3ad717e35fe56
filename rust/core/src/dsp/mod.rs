//! Signal processing on samples: shared front ends, correlators and their slow reference.
//!
//! Raw bytes go through a [`front_end::FrontEnd`] into the running sums of its
//! [`band::Band`]s; a [`correlator::Correlator`] reads one signal off them. An
//! [`engine::Engine`] is all of it together.

pub mod band;
pub mod clock;
pub mod correlator;
pub mod engine;
pub mod front_end;
pub(crate) mod low_pass;
pub(crate) mod oscillator;
pub mod raw;
pub mod reference;
pub mod replica;
pub mod resample;
pub(crate) mod ring;
mod tap_plan;
