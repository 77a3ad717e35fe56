//! The 64-ary LDPC codes (200,100) and (88,44) of B-CNAV1 (BDS-SIS-ICD-B1C-1.0 sections 6.2.2.2
//! and 6.2.2.3, annex).
//!
//! Code words begin with their information. Symbols are sent most significant bit first. Every
//! check holds four symbols, every symbol is in two checks. The decoder is belief propagation over
//! GF(64) by Walsh-Hadamard transforms; checks are served in turn and each uses what the ones
//! before it found, which converges in half the passes. Nothing in it depends on threads or chance.

use std::sync::OnceLock;

use super::gf64::{inverse, PRODUCT, SIZE};
use super::ldpc64_check::{update, Message};
use super::ldpc64_tables::{Row, SUBFRAME2, SUBFRAME3};
use super::{hard, number};

/// Bits of a symbol.
const BITS: usize = 6;
/// Largest logarithm of a likelihood ratio that is believed.
const LARGEST: f32 = 30.0;

/// One of the codes.
pub struct Code {
    rows: &'static [Row],
    /// For each edge (4 to a row) the symbol's other edge.
    partner: Vec<usize>,
    /// For each symbol one of its edges.
    edge_of: Vec<usize>,
    /// Rows of parity symbols by information symbols.
    generator: Vec<Vec<u8>>,
}

/// What came out of a decoder.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    /// All bits of the code word, information first.
    pub bits: Vec<u8>,
    /// Bits that differ from the signs of the input.
    pub corrected: usize,
    /// Passes over all checks.
    pub iterations: usize,
    /// All checks are satisfied; otherwise the bits are the best guess.
    pub converged: bool,
}

/// The (200,100) code of subframe 2.
pub fn subframe2() -> &'static Code {
    static CODE: OnceLock<Code> = OnceLock::new();
    CODE.get_or_init(|| Code::new(&SUBFRAME2))
}

/// The (88,44) code of subframe 3.
pub fn subframe3() -> &'static Code {
    static CODE: OnceLock<Code> = OnceLock::new();
    CODE.get_or_init(|| Code::new(&SUBFRAME3))
}

impl Code {
    fn new(rows: &'static [Row]) -> Self {
        let columns: Vec<u8> = rows.iter().flat_map(|r| r.0).collect();
        let other = |edge: usize| {
            let same = |&e: &usize| e != edge && columns[e] == columns[edge];
            (0..columns.len()).find(same).expect("two checks a symbol")
        };
        let partner = (0..columns.len()).map(other).collect();
        let edge = |symbol: usize| columns.iter().position(|&c| usize::from(c) == symbol);
        let edge_of = (0..2 * rows.len())
            .map(|s| edge(s).expect("every symbol is checked"))
            .collect();
        let generator = generator(rows);
        Self {
            rows,
            partner,
            edge_of,
            generator,
        }
    }

    /// Bits of a code word.
    pub fn length(&self) -> usize {
        2 * self.information()
    }

    /// Bits of information.
    pub fn information(&self) -> usize {
        BITS * self.rows.len()
    }

    /// Code word of information bits.
    ///
    /// # Panics
    /// If their number is not [`Code::information`].
    pub fn encode(&self, information: &[u8]) -> Vec<u8> {
        assert_eq!(information.len(), self.information());
        let symbols: Vec<u8> = symbols(information);
        let parity = self.generator.iter().map(|row| {
            let terms = row.iter().zip(&symbols);
            terms.fold(0, |sum, (&g, &s)| {
                sum ^ PRODUCT[usize::from(g)][usize::from(s)]
            })
        });
        let parity: Vec<u8> = parity.flat_map(bits_of).collect();
        [information, &parity].concat()
    }

    /// Whether bits are a code word.
    pub fn checks(&self, bits: &[u8]) -> bool {
        self.satisfied(&symbols(bits))
    }

    fn satisfied(&self, symbols: &[u8]) -> bool {
        self.rows.iter().all(|(columns, elements)| {
            let term = |k: usize| {
                PRODUCT[usize::from(elements[k])][usize::from(symbols[usize::from(columns[k])])]
            };
            term(0) ^ term(1) ^ term(2) ^ term(3) == 0
        })
    }

    /// The code word behind soft bits.
    ///
    /// # Arguments
    /// * `likelihoods` - for each bit the logarithm of the probability of 0 over that of 1
    /// * `iterations` - passes over all checks before it gives up
    ///
    /// # Panics
    /// If the number of bits is not [`Code::length`].
    pub fn decode(&self, likelihoods: &[f32], iterations: usize) -> Decoded {
        assert_eq!(likelihoods.len(), self.length());
        let channel: Vec<Message> = likelihoods.chunks_exact(BITS).map(prior).collect();
        let mut found = vec![[1.0 / SIZE as f32; SIZE]; self.partner.len()];
        let mut word: Vec<u8> = channel.iter().map(most_likely).collect();
        let mut done = 0;
        while done < iterations && !self.satisfied(&word) {
            self.pass(&channel, &mut found);
            for (symbol, w) in word.iter_mut().enumerate() {
                let edge = self.edge_of[symbol];
                let both = product(&found[edge], &found[self.partner[edge]]);
                *w = most_likely(&product(&channel[symbol], &both));
            }
            done += 1;
        }
        let bits: Vec<u8> = word.iter().copied().flat_map(bits_of).collect();
        let changed = |(&l, &b): (&f32, &u8)| hard(l) != b;
        Decoded {
            corrected: likelihoods
                .iter()
                .zip(&bits)
                .filter(|&x| changed(x))
                .count(),
            bits,
            iterations: done,
            converged: self.satisfied(&word),
        }
    }

    /// Serve every check once; `found` is what each says of each of its symbols.
    fn pass(&self, channel: &[Message], found: &mut [Message]) {
        for (row, (columns, elements)) in self.rows.iter().enumerate() {
            let messages = std::array::from_fn(|k| {
                let other = &found[self.partner[4 * row + k]];
                product(&channel[usize::from(columns[k])], other)
            });
            found[4 * row..4 * row + 4].copy_from_slice(&update(&messages, elements));
        }
    }
}

/// Probability of each element from its six bits, the largest 1.
fn prior(likelihoods: &[f32]) -> Message {
    let mut p = [1.0f32; SIZE];
    for (k, &l) in likelihoods.iter().enumerate() {
        let l = if l.is_finite() { l } else { 0.0 };
        let unlikely = (-l.abs().min(LARGEST)).exp();
        for (x, p) in p.iter_mut().enumerate() {
            if (x >> (BITS - 1 - k) & 1) as u8 != hard(l) {
                *p *= unlikely;
            }
        }
    }
    p
}

fn product(a: &Message, b: &Message) -> Message {
    std::array::from_fn(|k| a[k] * b[k])
}

/// Element of the largest probability; the lowest one of equals.
fn most_likely(p: &Message) -> u8 {
    let best = (1..SIZE).fold(0, |best, x| if p[x] > p[best] { x } else { best });
    best as u8
}

fn symbols(bits: &[u8]) -> Vec<u8> {
    bits.chunks_exact(BITS).map(|b| number(b) as u8).collect()
}

fn bits_of(symbol: u8) -> [u8; BITS] {
    std::array::from_fn(|k| symbol >> (BITS - 1 - k) & 1)
}

/// Parity symbols as sums of information symbols: the check matrix solved for its right half.
fn generator(rows: &[Row]) -> Vec<Vec<u8>> {
    let m = rows.len();
    // The right half first: once that is the unit matrix, the left half is what is sought.
    let mut matrix = vec![vec![0u8; 2 * m]; m];
    for (line, (columns, elements)) in matrix.iter_mut().zip(rows) {
        for (&c, &e) in columns.iter().zip(elements) {
            line[(usize::from(c) + m) % (2 * m)] = e;
        }
    }
    for column in 0..m {
        let pivot = (column..m).find(|&r| matrix[r][column] != 0);
        matrix.swap(column, pivot.expect("parity can be solved for"));
        let scale = usize::from(inverse(matrix[column][column]));
        matrix[column]
            .iter_mut()
            .for_each(|v| *v = PRODUCT[scale][usize::from(*v)]);
        let pivot = matrix[column].clone();
        for (row, line) in matrix.iter_mut().enumerate() {
            let factor = usize::from(line[column]);
            if row != column && factor != 0 {
                let terms = line.iter_mut().zip(&pivot);
                terms.for_each(|(v, &p)| *v ^= PRODUCT[factor][usize::from(p)]);
            }
        }
    }
    matrix.into_iter().map(|line| line[m..].to_vec()).collect()
}
