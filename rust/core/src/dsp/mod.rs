//! Signal processing on samples.
