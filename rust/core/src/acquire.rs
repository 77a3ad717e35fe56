//! FFT search for signals.
