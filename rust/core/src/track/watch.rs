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
