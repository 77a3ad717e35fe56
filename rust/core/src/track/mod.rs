//! Tracking loops.
