//! A frame of B-CNAV1: 1800 symbols in 18 s (BDS-SIS-ICD-B1C-1.0 section 6.2).

use super::bch_b1c::{self, decode_prn, decode_soh, Choice, PRN_LENGTH, SOH_LENGTH};
use super::crc24q;
use super::interleaver::{deinterleave, interleave};
use super::ldpc64::{subframe2, subframe3, Code};
use super::noise::{estimate, Level};
use crate::{Error, Result};

/// Symbols of a frame.
pub const FRAME: usize = 1800;
/// Symbols of subframe 1.
pub const SUBFRAME1: usize = PRN_LENGTH + SOH_LENGTH;
/// Bits of subframe 2 without its check.
pub const DATA2: usize = 576;
/// Bits of subframe 3 without its check.
pub const DATA3: usize = 240;
/// Passes of the LDPC decoder before it gives up.
pub const ITERATIONS: usize = 60;
/// Subframes 1 that a search for the start of frames looks at.
const SEARCHED: usize = 4;

/// Subframe 2 or 3 as decoded.
#[derive(Debug, Clone, PartialEq)]
pub struct Subframe {
    /// Information bits, the check among them.
    pub bits: Vec<u8>,
    /// Symbols that were received with the wrong sign.
    pub corrected: usize,
    /// Passes of the decoder.
    pub iterations: usize,
    /// A code word, the check holds, and not all bits are zero: so an unmodulated carrier looks.
    pub ok: bool,
}

/// A frame as decoded.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Satellite as subframe 1 names it.
    pub prn: Choice,
    /// Number of the frame in its hour.
    pub soh: Choice,
    /// Ephemeris and clock.
    pub second: Subframe,
    /// A page.
    pub third: Subframe,
    /// What the likelihoods were made with.
    pub level: Level,
}

/// Where frames may start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// First symbol of the first whole frame.
    pub offset: usize,
    /// Symbols have the wrong sign, on the whole.
    pub inverted: bool,
    /// Number of that frame in its hour.
    pub soh: usize,
    /// Mean correlation with the code words of subframe 1, as a share of the largest possible.
    pub score: f32,
}

/// Symbols +1 and -1 of a frame, from its information without checks.
///
/// # Errors
/// [`Error::Invalid`] if a number or a length is wrong.
pub fn encode(prn: usize, soh: usize, data2: &[u8], data3: &[u8]) -> Result<Vec<i8>> {
    if (data2.len(), data3.len()) != (DATA2, DATA3) {
        let (a, b) = (data2.len(), data3.len());
        let message = format!("{a} and {b} bits of data, must be {DATA2} and {DATA3}");
        return Err(Error::Invalid(message));
    }
    let coded = |code: &Code, data: &[u8]| {
        let mut bits = data.to_vec();
        crc24q::append(&mut bits);
        code.encode(&bits)
    };
    let blocks = interleave(&coded(subframe2(), data2), &coded(subframe3(), data3));
    let symbols = first(prn, soh)?.into_iter();
    Ok(symbols.chain(blocks.into_iter().map(sign)).collect())
}

/// Symbols +1 and -1 of subframe 1.
///
/// # Errors
/// [`Error::Invalid`] if a number is wrong.
pub fn first(prn: usize, soh: usize) -> Result<Vec<i8>> {
    if prn == 0 || prn > bch_b1c::LARGEST_PRN || soh >= bch_b1c::FRAMES_PER_HOUR {
        let message = format!("PRN {prn} must be 1 to 63 and frame {soh} of the hour 0 to 199");
        return Err(Error::Invalid(message));
    }
    let words = [bch_b1c::PRN.word(prn), bch_b1c::SOH.word(soh)].concat();
    Ok(words.into_iter().map(sign).collect())
}

fn sign(bit: u8) -> i8 {
    1 - 2 * bit as i8
}

/// A frame from its soft symbols of known sign, 0 where one is missing.
///
/// # Arguments
/// * `level` - amplitude and noise of the symbols, estimated from them where it is not given
/// * `iterations` - passes of the LDPC decoder before it gives up, such as [`ITERATIONS`]
///
/// # Panics
/// If there are not 1800.
pub fn decode(values: &[f32], level: Option<Level>, iterations: usize) -> Frame {
    assert_eq!(values.len(), FRAME);
    let level = level.unwrap_or_else(|| estimate(values));
    let likelihoods = level.likelihoods(values);
    let (second, third) = deinterleave(&likelihoods[SUBFRAME1..]);
    Frame {
        prn: decode_prn(&likelihoods[..PRN_LENGTH]),
        soh: decode_soh(&likelihoods[PRN_LENGTH..SUBFRAME1]),
        second: decode_subframe(subframe2(), &second, iterations),
        third: decode_subframe(subframe3(), &third, iterations),
        level,
    }
}

fn decode_subframe(code: &Code, likelihoods: &[f32], iterations: usize) -> Subframe {
    let decoded = code.decode(likelihoods, iterations);
    let bits = decoded.bits[..code.information()].to_vec();
    Subframe {
        ok: decoded.converged && crc24q::holds(&bits) && bits.contains(&1),
        bits,
        corrected: decoded.corrected,
        iterations: decoded.iterations,
    }
}

/// Where frames of a satellite may start among soft symbols of unknown sign, most likely first,
/// by the code words of four frames spread over them: those of consecutive frames count up, and
/// the sign may change between them. The whole subframe 1 of a frame must be there, the frame need not.
///
/// # Arguments
/// * `limit` - how many starts to return at most
pub fn find(values: &[f32], prn: usize, limit: usize) -> Vec<Start> {
    if values.len() < SUBFRAME1 || !(1..=bch_b1c::LARGEST_PRN).contains(&prn) {
        return Vec::new();
    }
    let finite = |v: &f32| if v.is_finite() { *v } else { 0.0 };
    let values: Vec<f32> = values.iter().map(finite).collect();
    let offsets = 0..FRAME.min(values.len() - SUBFRAME1 + 1);
    let mut starts: Vec<Start> = offsets.map(|o| best_start(&values, prn, o)).collect();
    starts.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.offset.cmp(&b.offset)));
    starts.truncate(limit);
    starts
}

/// The most likely number of the frame at an offset.
fn best_start(values: &[f32], prn: usize, offset: usize) -> Start {
    let firsts: Vec<&[f32]> = values[offset..]
        .chunks(FRAME)
        .filter_map(|f| f.get(..SUBFRAME1))
        .collect();
    let step = firsts.len().div_ceil(SEARCHED);
    let word = bch_b1c::PRN.word(prn);
    let mut agreement = [0.0f32; bch_b1c::FRAMES_PER_HOUR];
    let mut signed = agreement;
    let mut total = 0.0;
    for (k, first) in firsts.iter().enumerate().step_by(step) {
        total += first.iter().map(|v| v.abs()).sum::<f32>();
        let named = signed_sum(first, &word);
        let all = bch_b1c::SOH.correlations(&first[PRN_LENGTH..]);
        for soh in 0..bch_b1c::FRAMES_PER_HOUR {
            let sum = named + all[(soh + k) % bch_b1c::FRAMES_PER_HOUR];
            agreement[soh] += sum.abs();
            signed[soh] += sum;
        }
    }
    let best = (1..agreement.len()).fold(0, |best, soh| {
        if agreement[soh] > agreement[best] {
            soh
        } else {
            best
        }
    });
    let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
    Start {
        offset,
        inverted: signed[best] < 0.0,
        soh: best,
        score: agreement[best] * scale,
    }
}

fn signed_sum(values: &[f32], bits: &[u8]) -> f32 {
    let signed = |(&v, &b): (&f32, &u8)| if b == 0 { v } else { -v };
    values.iter().zip(bits).map(signed).sum()
}
