//! What is recorded of a pair of sidebands, epoch by epoch.

use super::ambiguity::Ambiguity;
use super::epoch::{Epoch, Measured};
use super::joint_code::weights;
use super::log::{ComboRows, State};
use super::sideband::Sideband;

/// Speed of light in vacuum, m/s (exact).
const LIGHT_M_S: f64 = 299_792_458.0;

/// The rows of a pair, and what they need to remember.
#[derive(Debug, Default)]
pub struct PairRecorder {
    ambiguity: Ambiguity,
}

/// Two epochs that belong together, lower and upper.
pub struct PairEpoch<'a> {
    pub epochs: [&'a Epoch; 2],
    pub measured: [Measured; 2],
    pub state: State,
    pub subcarrier_lock: f64,
}

/// Phases and code delays at the middle of the upper sideband's epoch.
struct Observed {
    time_s: f64,
    phases_cycles: [f64; 2],
    delays_s: [f64; 2],
    /// Upper minus lower, within half a code period.
    difference_s: f64,
}

impl PairRecorder {
    /// Forgets what holds only as long as both phases go on.
    pub fn forget(&mut self) {
        self.ambiguity = Ambiguity::default();
    }

    /// Adds a row.
    pub fn record(&mut self, rows: &mut ComboRows, sidebands: [&Sideband; 2], pair: &PairEpoch) {
        let seen = observe(sidebands, pair);
        let [lower, upper] = seen.phases_cycles;
        let interval_s = pair.epochs[1].interval_s();
        rows.time_s.push(seen.time_s);
        rows.integration_s.push(interval_s);
        rows.state.push(pair.state as u8);
        rows.phase_lower_cycles.push(lower);
        rows.phase_upper_cycles.push(upper);
        rows.main_phase_cycles.push(0.5 * (upper + lower));
        rows.subcarrier_phase_cycles.push(0.5 * (upper - lower));
        rows.subcarrier_range_m
            .push(self.subcarrier_range_m(sidebands, &seen, interval_s));
        rows.code_delay_lower_s.push(seen.delays_s[0]);
        rows.code_delay_upper_s.push(seen.delays_s[1]);
        rows.code_difference_s.push(seen.difference_s);
        rows.cn0_lower_dbhz.push(sidebands[0].cn0_dbhz());
        rows.cn0_upper_dbhz.push(sidebands[1].cn0_dbhz());
        rows.subcarrier_lock.push(pair.subcarrier_lock);
    }

    /// The phase difference of the sidebands repeats every wavelength of f_u - f_l; every half
    /// wavelength where the sign of a sideband, and with it half a cycle of its phase, is unknown.
    fn subcarrier_range_m(&mut self, s: [&Sideband; 2], seen: &Observed, interval_s: f64) -> f64 {
        let spacing_hz = s[1].spec.carrier_hz - s[0].spec.carrier_hz;
        if spacing_hz == 0.0 {
            return f64::NAN;
        }
        let wavelength_m = LIGHT_M_S / spacing_hz;
        let signed = s.iter().all(|s| s.signed);
        let step_m = if signed { 1.0 } else { 0.5 } * wavelength_m;
        let phase_m = wavelength_m * (seen.phases_cycles[1] - seen.phases_cycles[0]);
        let variances = s.map(|s| s.code_variance_s2(interval_s));
        let weights = weights(variances);
        // The weighted mean of both codes, counted in periods of the upper one.
        let delay_s = seen.delays_s[1] - weights[0] * seen.difference_s;
        let variance_s2 = weights[0] * variances[0];
        let code = [LIGHT_M_S * delay_s, LIGHT_M_S * LIGHT_M_S * variance_s2];
        self.ambiguity.resolve(phase_m, step_m, code, interval_s)
    }
}

/// Brings the lower sideband's values to the middle of the upper one's epoch.
fn observe([lower, upper]: [&Sideband; 2], pair: &PairEpoch) -> Observed {
    let [ml, mu] = pair.measured;
    let rate_hz = upper.sample_rate_hz;
    let time_s = pair.epochs[1].middle() / rate_hz;
    let wait_s = (pair.epochs[1].middle() - pair.epochs[0].middle()) / rate_hz;
    let sent_lower_s = ml.code_chips / lower.spec.chip_rate_hz + wait_s;
    let sent_upper_s = mu.code_chips / upper.spec.chip_rate_hz;
    let period = lower.spec.period_s().min(upper.spec.period_s());
    let ahead = (sent_upper_s - sent_lower_s) / period;
    Observed {
        time_s,
        phases_cycles: [
            ml.phase_cycles - lower.doppler_hz() * wait_s,
            mu.phase_cycles,
        ],
        delays_s: [time_s - sent_lower_s, time_s - sent_upper_s],
        // Received later = code phase behind.
        difference_s: -(ahead - ahead.round()) * period,
    }
}
