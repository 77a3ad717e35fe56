//! Signals as data: one file each, gathered in [`SIGNALS`].
//!
//! Everything else in the receiver works from a [`SignalSpec`]; no other file names a signal.

mod b1c;
mod b1i;
pub mod code;
mod e5;
mod l1ca;
pub(crate) mod spectrum;

use crate::{Error, Result};

/// How a chip is shaped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Modulation {
    /// One rectangular pulse per chip.
    Bpsk,
    /// BOC(1,1), sine phase: first half-chip +, second half-chip -.
    Boc11,
    /// QMBOC(6,1,4/33): sqrt(29/33) BOC(1,1) - j sqrt(4/33) BOC(6,1), both sine phase.
    Qmboc,
}

impl Modulation {
    /// Parses the names that specifications are shown with: `Bpsk`, `Boc11`, `Qmboc`.
    ///
    /// # Errors
    /// [`Error::Invalid`] names the known ones.
    pub fn parse(name: &str) -> Result<Self> {
        [Modulation::Bpsk, Modulation::Boc11, Modulation::Qmboc]
            .into_iter()
            .find(|m| format!("{m:?}") == name)
            .ok_or_else(|| Error::Invalid(format!("'{name}' is none of Bpsk, Boc11, Qmboc")))
    }

    /// The subcarrier's layers: (sub-chips per chip, complex weight re, im).
    ///
    /// The replica of a chip is the sum over layers of `weight * (+1, -1, +1, ...)`, each value
    /// lasting one sub-chip. The weights have unit total power.
    pub fn layers(self) -> &'static [Layer] {
        const BPSK: [Layer; 1] = [Layer::new(1, 1.0, 0.0)];
        const BOC11: [Layer; 1] = [Layer::new(2, 1.0, 0.0)];
        // sqrt(29/33) and sqrt(4/33), BDS-SIS-ICD-B1C-1.0 section 4.2.1
        const QMBOC: [Layer; 2] = [
            Layer::new(2, 0.937_436_866_561_092_3, 0.0),
            Layer::new(12, 0.0, -0.348_155_311_911_395_6),
        ];
        match self {
            Modulation::Bpsk => &BPSK,
            Modulation::Boc11 => &BOC11,
            Modulation::Qmboc => &QMBOC,
        }
    }
}

/// One layer of a subcarrier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Square-wave values per chip (1 = plain chip, 2 = BOC(1,1), 12 = BOC(6,1)).
    pub subchips: usize,
    /// Real part of the layer's weight.
    pub re: f64,
    /// Imaginary part of the layer's weight.
    pub im: f64,
}

impl Layer {
    const fn new(subchips: usize, re: f64, im: f64) -> Self {
        Layer { subchips, re, im }
    }
}

/// One signal component, as the ICD defines it.
#[derive(Debug, Clone, Copy)]
pub struct SignalSpec {
    /// Registry name, e.g. `B1CP`.
    pub id: &'static str,
    /// The signal it is part of, as users name it in scenarios, e.g. `B1C`.
    pub composite: &'static str,
    /// What it is, with the ICD.
    pub description: &'static str,
    /// RINEX observation code letters, e.g. `2I`.
    pub rinex: &'static str,
    /// RINEX system letter, e.g. `C`.
    pub system: char,
    /// Carrier frequency in Hz.
    pub carrier_hz: f64,
    /// Chips per second.
    pub chip_rate_hz: f64,
    /// Chips per code period.
    pub code_length: usize,
    /// Chip shape.
    pub modulation: Modulation,
    /// Share of the composite signal's power.
    pub power_share: f64,
    /// Carrier phase relative to the composite's reference component, in cycles.
    pub phase_offset_cycles: f64,
    /// Half bandwidth around the carrier that a recording must hold, in Hz.
    pub min_half_bandwidth_hz: f64,
    /// PRNs that transmit it.
    pub prns: fn() -> Vec<u16>,
    /// Primary code of a valid PRN: chips +1/-1 (ICD bit 0 -> +1).
    pub(crate) primary: fn(u16) -> Vec<i8>,
    /// Secondary code of a valid PRN, one value per code period; empty if there is none.
    pub(crate) overlay: fn(u16) -> Vec<i8>,
    /// Code periods per data symbol of a valid PRN; `None` for a pilot.
    pub(crate) symbol_periods: fn(u16) -> Option<usize>,
}

/// Every signal that the receiver knows.
pub static SIGNALS: &[SignalSpec] = &[
    b1i::B1I,
    b1c::B1CD,
    b1c::B1CP,
    l1ca::L1CA,
    e5::E5AQ,
    e5::E5BQ,
];

/// Pairs of signals with coherent carriers that are tracked as one unless told otherwise; the first
/// pair of which a satellite has both comes first.
pub static PAIRS: &[(&str, &str)] = &[("B1I", "B1CP"), ("E5AQ", "E5BQ")];

/// Looks a signal up by its registry name.
///
/// # Errors
/// [`Error::UnknownSignal`] names the known ones.
pub fn find(id: &str) -> Result<&'static SignalSpec> {
    SIGNALS
        .iter()
        .find(|s| s.id == id)
        .ok_or_else(|| Error::UnknownSignal {
            id: id.to_owned(),
            known: SIGNALS.iter().map(|s| s.id).collect::<Vec<_>>().join(", "),
        })
}

/// The components of a composite signal (`B1C` -> B1CD, B1CP), or the one component so named.
///
/// # Errors
/// [`Error::UnknownSignal`] where neither is known.
pub fn components(name: &str) -> Result<Vec<&'static SignalSpec>> {
    let parts: Vec<_> = SIGNALS.iter().filter(|s| s.composite == name).collect();
    if parts.is_empty() {
        find(name).map(|s| vec![s])
    } else {
        Ok(parts)
    }
}

impl SignalSpec {
    /// The data component that is sent beside this pilot with the same code timing, if any.
    pub fn companion(&self) -> Option<&'static SignalSpec> {
        let pilot = (self.prns)()
            .first()
            .is_some_and(|&p| (self.symbol_periods)(p).is_none());
        let shape = |s: &SignalSpec| (s.code_length, s.chip_rate_hz, s.carrier_hz);
        SIGNALS.iter().find(|s| {
            pilot && s.id != self.id && s.composite == self.composite && shape(s) == shape(self)
        })
    }

    fn check(&self, prn: u16) -> Result<()> {
        if (self.prns)().contains(&prn) {
            Ok(())
        } else {
            Err(Error::UnknownPrn {
                signal: self.id.to_owned(),
                prn,
            })
        }
    }

    /// Primary code: `code_length` chips, +1/-1 (ICD bit 0 -> +1).
    ///
    /// # Errors
    /// [`Error::UnknownPrn`] if the satellite does not transmit the signal.
    pub fn code(&self, prn: u16) -> Result<Vec<i8>> {
        self.check(prn)?;
        Ok((self.primary)(prn))
    }

    /// Secondary code, one +1/-1 per code period; empty if there is none.
    ///
    /// # Errors
    /// [`Error::UnknownPrn`] if the satellite does not transmit the signal.
    pub fn secondary(&self, prn: u16) -> Result<Vec<i8>> {
        self.check(prn)?;
        Ok((self.overlay)(prn))
    }

    /// Code periods per data symbol; `None` for a pilot.
    ///
    /// # Errors
    /// [`Error::UnknownPrn`] if the satellite does not transmit the signal.
    pub fn periods_per_symbol(&self, prn: u16) -> Result<Option<usize>> {
        self.check(prn)?;
        Ok((self.symbol_periods)(prn))
    }

    /// Code period in seconds.
    pub fn period_s(&self) -> f64 {
        self.code_length as f64 / self.chip_rate_hz
    }
}
