//! Other codes on the same carrier, as noise: those of other satellites, of a pilot's data
//! component, and of spoofers that send them.

use super::front_end::FrontEnd;
use super::pulse::Pulse;
use crate::signal::{Layer, SignalSpec};
use crate::synth::{Emitter, Profile};

/// Slices between two looks at the powers that vary.
const SLICES: u32 = 20;

/// Their noise power, relative to the thermal noise.
pub(super) struct OtherCodes {
    steady: f64,
    /// With the noise power of a C/N0 of 1 Hz.
    varying: Vec<(Emitter, f64)>,
    now: f64,
    left: u32,
}

impl OtherCodes {
    /// What disturbs the replica of a satellite's signal, with the given layers.
    pub fn new(
        front: &FrontEnd,
        spec: &SignalSpec,
        prn: u16,
        replica: &[Layer],
        emitters: &[Emitter],
    ) -> Self {
        let heard = |e: &&Emitter| {
            let s = e.signal;
            let own = s.id == spec.id && e.prn == prn;
            !own && s.carrier_hz == spec.carrier_hz && s.chip_rate_hz == spec.chip_rate_hz
        };
        let with_share = |e: &Emitter| (e.clone(), noise_share(front, replica, e.signal));
        let all = emitters.iter().filter(heard).map(with_share);
        let (steady, varying): (Vec<_>, Vec<_>) = all.partition(|(e, _)| is_steady(e));
        OtherCodes {
            steady: steady
                .iter()
                .map(|(e, share)| share * power_hz(e, 0.0))
                .sum(),
            varying,
            now: 0.0,
            left: 0,
        }
    }

    /// For the slice that begins at a time.
    pub fn noise(&mut self, time_s: f64) -> f64 {
        if self.varying.is_empty() {
            return self.steady;
        }
        if self.left == 0 {
            let power = |(e, share): &(Emitter, f64)| share * power_hz(e, time_s);
            self.now = self.steady + self.varying.iter().map(power).sum::<f64>();
            self.left = SLICES;
        }
        self.left -= 1;
        self.now
    }
}

/// Noise power over that of the receiver that a signal of another code and 1 Hz of C/N0 makes: a
/// chip's correlation squared, over all delays, in seconds (the spectral separation coefficient of
/// Betz, "Effect of partial-band interference on receiver estimation of C/N0", 2001).
pub(super) fn noise_share(front: &FrontEnd, replica: &[Layer], signal: &SignalSpec) -> f64 {
    let pulse = front.signal(Pulse::new(replica, signal.modulation.layers()));
    pulse.power() / signal.chip_rate_hz
}

fn is_steady(e: &Emitter) -> bool {
    let for_ever = e.start_s == f64::NEG_INFINITY && e.end_s == f64::INFINITY;
    for_ever && e.power_db == Profile::default()
}

fn power_hz(e: &Emitter, time_s: f64) -> f64 {
    10f64.powf(0.1 * e.cn0_at_dbhz(time_s))
}
