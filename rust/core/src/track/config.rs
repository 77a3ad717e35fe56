//! Settings of the tracking loops.

use super::log::State;
use crate::dsp::replica::SLICE_S;
use crate::{signal, Error, Result};

/// Settings of the tracking loops; bandwidths are single-sided noise bandwidths.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackConfig {
    /// Phase-locked loop, once synchronised, Hz.
    pub pll_bandwidth_hz: f64,
    /// Phase-locked loop on 1 ms integrations before that, Hz.
    pub pull_in_pll_bandwidth_hz: f64,
    /// Frequency-locked loop that assists the phase loop before that, Hz.
    pub fll_bandwidth_hz: f64,
    /// Delay-locked loop, once synchronised, Hz.
    pub dll_bandwidth_hz: f64,
    /// Main-carrier loop of a combo, Hz.
    pub main_bandwidth_hz: f64,
    /// Subcarrier loop of a combo, Hz.
    pub subcarrier_bandwidth_hz: f64,
    /// Loop of a combo that follows the difference of the two codes, Hz.
    pub code_bias_bandwidth_hz: f64,
    /// Longest coherent integration, ms.
    pub integration_ms: usize,
    /// Below this C/N0 a signal counts as lost, dB-Hz.
    pub cn0_min_dbhz: f64,
    /// Receive the QMBOC pilot whole, or as BOC(1,1) where the bandwidth is narrow.
    pub qmboc: bool,
    /// Couple the two sidebands of a satellite.
    pub combo: bool,
    /// Which signals of a satellite are such sidebands; the first pair that it has, if several.
    pub pairs: Vec<(String, String)>,
    /// Correlate the data component beside its pilot.
    pub data_component: bool,
}

impl Default for TrackConfig {
    fn default() -> Self {
        TrackConfig {
            pll_bandwidth_hz: 10.0,
            pull_in_pll_bandwidth_hz: 20.0,
            fll_bandwidth_hz: 1.0,
            dll_bandwidth_hz: 1.0,
            main_bandwidth_hz: 10.0,
            subcarrier_bandwidth_hz: 5.0,
            code_bias_bandwidth_hz: 0.1,
            integration_ms: 10,
            cn0_min_dbhz: 25.0,
            qmboc: true,
            combo: true,
            pairs: signal::PAIRS
                .iter()
                .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
                .collect(),
            data_component: false,
        }
    }
}

/// What a sideband's loops are in a state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    /// Integration in slices.
    pub length: usize,
    pub pll_order: usize,
    pub pll_bandwidth_hz: f64,
    pub dll_bandwidth_hz: f64,
    pub lock_memory_s: f64,
}

impl TrackConfig {
    /// The loops of a state, for a code period and a synchronised integration in slices.
    pub(super) fn plan(&self, state: State, period: usize, synced: usize) -> Plan {
        let pull_in = Plan {
            length: 1,
            pll_order: 2,
            pll_bandwidth_hz: self.pull_in_pll_bandwidth_hz,
            dll_bandwidth_hz: 2.0 * self.dll_bandwidth_hz,
            lock_memory_s: 0.05,
        };
        let synced = Plan {
            length: synced,
            pll_order: 3,
            pll_bandwidth_hz: self.pll_bandwidth_hz,
            dll_bandwidth_hz: self.dll_bandwidth_hz,
            lock_memory_s: 0.2,
        };
        match state {
            State::Lost | State::PullIn => pull_in,
            // A code period at a time: what synchronisation works on.
            State::Tracking => Plan {
                length: period,
                // Wide, to catch an acceleration, within what the integration allows.
                pll_bandwidth_hz: pull_in
                    .pll_bandwidth_hz
                    .min(0.25 / (period as f64 * SLICE_S)),
                dll_bandwidth_hz: pull_in.dll_bandwidth_hz,
                ..synced
            },
            State::Synced | State::Combo | State::Captured => synced,
        }
    }

    /// Checks ranges, and that the pairs are pairs.
    ///
    /// # Errors
    /// [`Error::Invalid`] names the setting; [`Error::UnknownSignal`].
    pub fn check(&self) -> Result<()> {
        self.check_loops()?;
        for (a, b) in &self.pairs {
            let systems = (signal::find(a)?.system, signal::find(b)?.system);
            if a == b || systems.0 != systems.1 {
                return Err(Error::Invalid(format!(
                    "{a} and {b} are no pair: name two signals of one satellite"
                )));
            }
        }
        Ok(())
    }

    fn check_loops(&self) -> Result<()> {
        if !matches!(self.integration_ms, 1 | 2 | 4 | 5 | 10 | 20) {
            return Err(Error::Invalid(format!(
                "integration_ms is {}; choose 1, 2, 4, 5, 10 or 20",
                self.integration_ms
            )));
        }
        // The B1C pilot is tracked on code periods of 10 ms until its secondary code is found.
        let interval = self.integration_ms.max(10) as f64 * 1e-3;
        for (name, value, longest) in [
            ("pll_bandwidth_hz", self.pll_bandwidth_hz, interval),
            ("dll_bandwidth_hz", self.dll_bandwidth_hz, interval),
            ("main_bandwidth_hz", self.main_bandwidth_hz, interval),
            (
                "subcarrier_bandwidth_hz",
                self.subcarrier_bandwidth_hz,
                interval,
            ),
            (
                "code_bias_bandwidth_hz",
                self.code_bias_bandwidth_hz,
                interval,
            ),
            (
                "pull_in_pll_bandwidth_hz",
                self.pull_in_pll_bandwidth_hz,
                1e-3,
            ),
            ("fll_bandwidth_hz", self.fll_bandwidth_hz, 1e-3),
        ] {
            if !(value > 0.0 && value * longest <= 0.25) {
                return Err(Error::Invalid(format!(
                    "{name} is {value}; it must be positive and at most {} Hz at this integration time",
                    0.25 / longest
                )));
            }
        }
        Ok(())
    }
}
