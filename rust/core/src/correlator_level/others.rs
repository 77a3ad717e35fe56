//! Other signals as noise: those of other satellites, of a pilot's data component, and of spoofers
//! that send them.

use super::front_end::FrontEnd;
use super::separation::separation_s;
use crate::signal::{Layer, SignalSpec};
use crate::synth::{Emitter, Profile};

/// Slices between two looks at the powers that vary.
const SLICES: u32 = 20;

/// Noise power over the thermal noise: in the taps that hear the whole replica, and in the outer
/// ones.
pub(super) type Disturbance = [f64; 2];

/// Their noise power, relative to the thermal noise.
pub(super) struct OtherCodes {
    steady: Disturbance,
    /// With the noise power of a C/N0 of 1 Hz.
    varying: Vec<(Emitter, Disturbance)>,
    now: Disturbance,
    left: u32,
}

/// How much each signal disturbs a replica: found once for all who send it.
struct Shares<'a> {
    front: &'a FrontEnd,
    spec: &'static SignalSpec,
    replicas: [&'a [Layer]; 2],
    known: Vec<(&'static str, Disturbance)>,
}

impl Shares<'_> {
    fn of(&mut self, signal: &'static SignalSpec) -> Disturbance {
        let known = self.known.iter().find(|(id, _)| *id == signal.id);
        known.map(|k| k.1).unwrap_or_else(|| {
            let share = disturbance(self.front, self.spec, self.replicas, signal);
            self.known.push((signal.id, share));
            share
        })
    }
}

impl OtherCodes {
    /// What disturbs the replica of a satellite's signal, with the layers of inner and outer taps.
    pub fn new(
        front: &FrontEnd,
        spec: &'static SignalSpec,
        prn: u16,
        replicas: [&[Layer]; 2],
        emitters: &[Emitter],
    ) -> Self {
        let mut shares = Shares {
            front,
            spec,
            replicas,
            known: Vec::new(),
        };
        let all = emitters
            .iter()
            .filter(|e| e.signal.id != spec.id || e.prn != prn)
            .map(|e| (e.clone(), shares.of(e.signal)));
        let (steady, varying): (Vec<_>, Vec<_>) = all.partition(|(e, _)| is_steady(e));
        OtherCodes {
            steady: steady.iter().fold([0.0; 2], |sum, (e, share)| {
                plus(sum, *share, power_hz(e, 0.0))
            }),
            varying,
            now: [0.0; 2],
            left: 0,
        }
    }

    /// For the slice that begins at a time.
    pub fn noise(&mut self, time_s: f64) -> Disturbance {
        if self.varying.is_empty() {
            return self.steady;
        }
        if self.left == 0 {
            let add =
                |sum, (e, share): &(Emitter, Disturbance)| plus(sum, *share, power_hz(e, time_s));
            self.now = self.varying.iter().fold(self.steady, add);
            self.left = SLICES;
        }
        self.left -= 1;
        self.now
    }
}

/// What a signal of another code and 1 Hz of C/N0 adds.
pub(super) fn disturbance(
    front: &FrontEnd,
    spec: &SignalSpec,
    replicas: [&[Layer]; 2],
    signal: &SignalSpec,
) -> Disturbance {
    let inner = separation_s(front, spec, replicas[0], signal);
    let same = replicas[0] == replicas[1];
    let outer = || separation_s(front, spec, replicas[1], signal);
    [inner, if same { inner } else { outer() }]
}

/// With so much power of another signal.
pub(super) fn plus(sum: Disturbance, share: Disturbance, power_hz: f64) -> Disturbance {
    [sum[0] + share[0] * power_hz, sum[1] + share[1] * power_hz]
}

fn is_steady(e: &Emitter) -> bool {
    let for_ever = e.start_s == f64::NEG_INFINITY && e.end_s == f64::INFINITY;
    for_ever && e.power_db == Profile::default()
}

fn power_hz(e: &Emitter, time_s: f64) -> f64 {
    10f64.powf(0.1 * e.cn0_at_dbhz(time_s))
}
