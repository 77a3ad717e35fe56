//! Signal processing on samples: the shared front end, the correlator and its slow reference.

pub mod correlator;

pub mod prefix;
pub mod reference;
pub mod replica;
pub mod resample;
