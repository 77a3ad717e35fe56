//! Whether symbols and secondary code of a synchronised signal are still where they were found.
//!
//! Samples missing from a recording by whole code periods leave code and carrier locked, and the
//! count of code periods wrong. What shows it is the overlay: with data, whether another place of
//! it explains the products of consecutive prompts better ([`SymbolSync`]); for a pilot, whose
//! places are too many to try, whether its own place still explains them at all.

use super::sync::SymbolSync;
use crate::C64;

/// Symbols between two looks.
const LOOK_SYMBOLS: usize = 5;
/// Products of a pilot's prompts are summed for this, s: at 25 dB-Hz those in step then have a
/// mean of 8 standard deviations or more.
const PILOT_S: f64 = 1.0;
/// A pilot is in step above the first, and out of step below the second, in standard deviations
/// that know nothing of the sign of the products.
const IN_STEP: f64 = 4.5;
const OUT_OF_STEP: f64 = 2.5;

/// What the prompts say of the count of code periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Nothing yet.
    Open,
    /// It is right.
    In,
    /// It is wrong.
    Out,
}

#[derive(Debug, Clone)]
enum Kind {
    /// A code period a symbol: nothing to tell.
    Blind,
    Symbols(SymbolSync),
    Pilot(Products),
}

/// Sum of the products of a pilot's prompts, signs of the secondary code taken out.
#[derive(Debug, Clone)]
struct Products {
    code: Vec<i8>,
    wanted: usize,
    previous: Option<C64>,
    count: usize,
    sum: f64,
    squares: f64,
}

/// The watch over one signal.
#[derive(Debug, Clone)]
pub struct Watch {
    kind: Kind,
    /// Prompt of the code period in progress.
    prompt: C64,
}

impl Watch {
    /// Of a signal with `symbol` code periods a symbol, none for a pilot.
    pub fn new(overlay: &[i8], symbol: Option<usize>, period_s: f64) -> Self {
        let kind = match symbol {
            Some(1) => Kind::Blind,
            Some(n) => Kind::Symbols(SymbolSync::of(overlay, n)),
            None => Kind::Pilot(Products {
                code: overlay.to_vec(),
                wanted: (PILOT_S / period_s).round() as usize,
                previous: None,
                count: 0,
                sum: 0.0,
                squares: 0.0,
            }),
        };
        let prompt = C64::default();
        Watch { kind, prompt }
    }

    /// Begins anew.
    pub fn restart(&mut self) {
        self.prompt = C64::default();
        match &mut self.kind {
            Kind::Blind => {}
            Kind::Symbols(sync) => sync.forget(),
            Kind::Pilot(products) => products.restart(),
        }
    }

    /// Adds the prompt of a slice, before anything is wiped.
    pub fn add_slice(&mut self, prompt: C64) {
        self.prompt += prompt;
    }

    /// Ends a code period, the one with place `index` in the overlay or symbol. After a verdict
    /// all begins anew.
    pub fn end_period(&mut self, index: usize) -> Step {
        let prompt = std::mem::take(&mut self.prompt);
        match &mut self.kind {
            Kind::Blind => Step::Open,
            Kind::Symbols(sync) => sync.watch(prompt, index, LOOK_SYMBOLS),
            Kind::Pilot(products) => products.add(prompt, index),
        }
    }
}

impl Products {
    fn restart(&mut self) {
        self.previous = None;
        (self.count, self.sum, self.squares) = (0, 0.0, 0.0);
    }

    fn add(&mut self, prompt: C64, index: usize) -> Step {
        if let Some(previous) = self.previous {
            let n = self.code.len();
            let sign = self.code[index % n] * self.code[(index + n - 1) % n];
            let product = (prompt * previous.conj()).re;
            self.sum += f64::from(sign) * product;
            self.squares += product * product;
            self.count += 1;
        }
        self.previous = Some(prompt);
        if self.count < self.wanted {
            return Step::Open;
        }
        let sigmas = self.sum / self.squares.sqrt();
        (self.count, self.sum, self.squares) = (0, 0.0, 0.0);
        match sigmas {
            s if s > IN_STEP => Step::In,
            s if s < OUT_OF_STEP => Step::Out,
            _ => Step::Open,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{self, SignalSpec};
    use crate::synth::random::hash;

    /// Independent Gaussian numbers of variance 1.
    struct Normal {
        key: u64,
        count: u64,
    }

    impl Normal {
        fn next(&mut self) -> f64 {
            let mut uniform = || {
                self.count += 1;
                (hash(self.key, self.count) >> 11) as f64 / (1u64 << 53) as f64
            };
            let (size, turn) = (uniform(), uniform());
            (-2.0 * (1.0 - size).ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
        }
    }

    /// Signals and satellites.
    const SIGNALS: [(&str, u16); 5] = [
        ("B1I", 20),
        ("B1I", 3),
        ("L1CA", 7),
        ("B1CP", 20),
        ("E5AQ", 5),
    ];
    const CN0_DBHZ: [f64; 3] = [30.0, 40.0, 50.0];

    /// Prompts of a signal with random data, and the watch over them.
    struct Air {
        spec: &'static SignalSpec,
        overlay: Vec<i8>,
        symbol: Option<usize>,
        amplitude: f64,
        noise: Normal,
        data: f64,
        watch: Watch,
    }

    impl Air {
        fn new((signal, prn): (&str, u16), cn0_dbhz: f64, seed: u64) -> Self {
            let spec = signal::find(signal).unwrap();
            let (overlay, symbol) = (
                spec.secondary(prn).unwrap(),
                spec.periods_per_symbol(prn).unwrap(),
            );
            let watch = Watch::new(&overlay, symbol, spec.period_s());
            let snr = 10f64.powf(0.1 * cn0_dbhz) * spec.period_s();
            Air {
                spec,
                overlay,
                symbol,
                amplitude: (2.0 * snr).sqrt(),
                noise: Normal {
                    key: hash(seed, 0),
                    count: 0,
                },
                data: 1.0,
                watch,
            }
        }

        fn places(&self) -> usize {
            self.overlay.len().max(self.symbol.unwrap_or(1))
        }

        /// Passes the period with a place in the overlay as if it were that of another.
        fn period(&mut self, sent: usize, counted: usize) -> Step {
            if self.symbol.is_some_and(|n| sent.is_multiple_of(n)) {
                self.data = self.noise.next().signum();
            }
            let chip = self.overlay.get(sent).map_or(1.0, |&c| f64::from(c));
            let signal = C64::from_polar(self.amplitude * self.data * chip, 0.7);
            let noise = C64::new(self.noise.next(), self.noise.next());
            self.watch.add_slice(signal + noise);
            self.watch.end_period(counted)
        }

        /// Verdicts (right, wrong) over a time, with so many periods missing before it.
        fn run(&mut self, missing: usize, duration_s: f64) -> (usize, usize) {
            let (n, mut right, mut wrong) = (self.places(), 0, 0);
            for k in 0..(duration_s / self.spec.period_s()) as usize {
                match self.period((k + missing) % n, k % n) {
                    Step::Open => {}
                    Step::In => right += 1,
                    Step::Out => wrong += 1,
                }
            }
            (right, wrong)
        }
    }

    fn false_alarms(duration_s: f64) -> usize {
        let mut wrong = 0;
        for (i, signal) in SIGNALS.into_iter().enumerate() {
            for (j, cn0_dbhz) in CN0_DBHZ.into_iter().enumerate() {
                let found = Air::new(signal, cn0_dbhz, (10 * i + j) as u64).run(0, duration_s);
                assert!(
                    found.0 as f64 > 0.1 * duration_s,
                    "{signal:?} {cn0_dbhz} {found:?}"
                );
                wrong += found.1;
            }
        }
        wrong
    }

    #[test]
    fn what_is_in_step_is_confirmed_and_never_called_wrong() {
        assert_eq!(false_alarms(100.0), 0);
    }

    #[test]
    #[ignore = "hours of prompts: the rate in docs/validation.md"]
    fn false_alarms_of_hours() {
        assert_eq!(false_alarms(36_000.0), 0);
    }

    #[test]
    fn what_is_out_of_step_is_found() {
        for (i, signal) in SIGNALS.into_iter().enumerate() {
            for (j, cn0_dbhz) in CN0_DBHZ.into_iter().enumerate() {
                for missing in [1, 3, 7] {
                    let mut air = Air::new(signal, cn0_dbhz, (100 + 10 * i + j) as u64);
                    if missing % air.places() == 0 {
                        continue;
                    }
                    let (right, wrong) = air.run(missing, 20.0);
                    assert!(
                        right == 0 && wrong > 0,
                        "{signal:?} {cn0_dbhz} {missing}: {right} {wrong}"
                    );
                }
            }
        }
    }
}
