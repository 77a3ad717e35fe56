//! Signal processing on samples.

pub mod resample;
