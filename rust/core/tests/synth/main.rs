//! The synthesis against the obvious double-precision formula.

mod cn0;
mod filter;
mod purity;
mod reference;
mod truth;
