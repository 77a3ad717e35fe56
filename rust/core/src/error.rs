//! The crate's error type: every variant carries the data needed to say what to do.

/// What can go wrong in the core.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The signal is not in the registry.
    #[error("unknown signal '{id}'; known signals: {known}")]
    UnknownSignal {
        /// What was asked for.
        id: String,
        /// Comma-separated registry.
        known: String,
    },
    /// The satellite does not transmit the signal.
    #[error("signal {signal} has no PRN {prn}")]
    UnknownPrn {
        /// Signal asked for.
        signal: String,
        /// PRN asked for.
        prn: u16,
    },
    /// The sample format name is not known.
    #[error("unknown sample format '{name}'; known formats: {known}")]
    UnknownFormat {
        /// What was asked for.
        name: String,
        /// Comma-separated list.
        known: String,
    },
    /// An argument is outside its valid range.
    #[error("{0}")]
    Invalid(String),
}

/// Result with the crate's error.
pub type Result<T> = std::result::Result<T, Error>;
