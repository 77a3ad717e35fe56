//! The kinds of channels that the correlator is for.

use std::sync::{Arc, LazyLock};

use sdr_spoof_core::dsp::replica::Replica;
use sdr_spoof_core::signal::{self, Modulation, SignalSpec};

pub const PRN: u16 = 20;

/// A signal, and how it is received.
pub struct Kind {
    pub name: &'static str,
    pub id: &'static str,
    pub modulation: Modulation,
    /// The data component is correlated beside its pilot.
    pub companion: Option<&'static str>,
    pub replica: Arc<Replica>,
}

/// Replicas are the same for every test: they are built once.
pub static KINDS: LazyLock<[Kind; 5]> = LazyLock::new(|| {
    [
        ("B1I", "B1I", Modulation::Bpsk, None),
        ("B1C pilot, BOC(1,1)", "B1CP", Modulation::Boc11, None),
        ("B1C pilot, QMBOC", "B1CP", Modulation::Qmboc, None),
        (
            "B1C pilot, QMBOC, and data",
            "B1CP",
            Modulation::Qmboc,
            Some("B1CD"),
        ),
        ("L1 C/A", "L1CA", Modulation::Bpsk, None),
    ]
    .map(|(name, id, modulation, companion)| {
        let spec = signal::find(id).unwrap();
        let mut replica = Replica::new(spec, PRN, modulation).unwrap();
        if let Some(companion) = companion.map(|c| signal::find(c).unwrap()) {
            replica = replica.with_companion(spec, companion, PRN).unwrap();
        }
        Kind {
            name,
            id,
            modulation,
            companion,
            replica: Arc::new(replica),
        }
    })
});

impl Kind {
    pub fn spec(&self) -> &'static SignalSpec {
        signal::find(self.id).unwrap()
    }

    /// Chips of a slice.
    pub fn chips(&self) -> f64 {
        self.replica.chips_per_slice() as f64
    }

    /// Mean length of a run of equal signs of the main layer, chips.
    pub fn run_chips(&self) -> f64 {
        match self.modulation {
            Modulation::Bpsk => 2.0,
            Modulation::Boc11 | Modulation::Qmboc => 2.0 / 3.0,
        }
    }
}
