//! Data symbols of an emitter.

use std::sync::Arc;

use super::random::hash;
use crate::{Error, Result};

/// What an emitter sends as its data symbols.
///
/// Symbol `index` begins at code phase `index` times the length of a symbol; without a delay of the
/// data, symbol 0 begins with code period 0.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Data {
    /// All +1.
    #[default]
    None,
    /// Pseudo-random ones, a hash of (seed, symbol index).
    Seeded(u64),
    /// These, +1 or -1; before the first and after the last one +1.
    Given {
        /// Index of the first of them.
        first_index: i64,
        /// Shared between copies of the emitter.
        symbols: Arc<[i8]>,
    },
}

impl Data {
    /// The symbol of an index, +1 or -1.
    pub fn symbol(&self, index: i64) -> i8 {
        match self {
            Data::None => 1,
            Data::Seeded(seed) => 1 - 2 * (hash(*seed, index as u64) >> 63) as i8,
            Data::Given {
                first_index,
                symbols,
            } => {
                let place = usize::try_from(index.wrapping_sub(*first_index)).ok();
                place.and_then(|k| symbols.get(k)).copied().unwrap_or(1)
            }
        }
    }

    /// Seed of which symbols are wrong, if there are any symbols.
    pub(super) fn seed(&self) -> Option<u64> {
        match self {
            Data::None => None,
            Data::Seeded(seed) => Some(*seed),
            Data::Given { first_index, .. } => Some(*first_index as u64),
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        match self {
            Data::Given { symbols, .. } if symbols.iter().any(|s| s.abs() != 1) => Err(
                Error::Invalid("given data symbols must be +1 or -1 each".into()),
            ),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_symbols_are_sent_and_beyond_them_ones() {
        let symbols: Arc<[i8]> = [-1, 1, -1].into();
        let data = Data::Given {
            first_index: -2,
            symbols,
        };
        let sent: Vec<i8> = (-4..4).map(|k| data.symbol(k)).collect();
        assert_eq!(sent, [1, 1, -1, 1, -1, 1, 1, 1]);
        assert_eq!(data.symbol(i64::MAX), 1);
        assert_eq!(data.symbol(i64::MIN), 1);
        data.check().unwrap();
        let symbols: Arc<[i8]> = [1, 0].into();
        let bad = Data::Given {
            first_index: 0,
            symbols,
        };
        assert!(bad.check().is_err());
    }
}
