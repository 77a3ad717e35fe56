//! Tracking: code, carrier and combo loops of every satellite over all its bands.
//!
//! A [`Sideband`](sideband::Sideband) tracks one signal; a [`Channel`](channel::Channel) holds the
//! sidebands of one satellite and couples two of them as one combo signal; the
//! [`Tracker`](engine::Tracker) feeds all channels from the shared front ends.

mod ambiguity;
pub mod channel;
mod closing;
pub mod combo;
pub mod config;
pub mod discriminator;
pub mod engine;
pub mod epoch;
pub mod frequency;
pub(crate) mod grouping;
mod input;
mod joint_code;
pub mod log;
pub mod loop_filter;
mod pair_rows;
pub mod period_count;
pub mod quality;
pub mod sideband;
pub mod source;
pub mod sync;
pub mod taps;
mod watch;
