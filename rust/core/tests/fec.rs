//! The codes of the navigation messages on received and on noisy words.

use proptest::prelude::*;
use sdr_spoof_core::fec::{beidou_subframe, cnav1, crc24q, ldpc64};

/// Code words that a satellite sent.
const RECEIVED: &str = include_str!("../../../tests/vectors/messages/bcnav1.txt");

fn received(name: &str) -> Vec<u8> {
    let line = RECEIVED.lines().find_map(|l| l.strip_prefix(name)).unwrap();
    let digits = line.chars().filter_map(|c| c.to_digit(16));
    digits
        .flat_map(|d| (0..4).rev().map(move |k| (d >> k & 1) as u8))
        .collect()
}

/// Normal numbers: a linear congruential generator, and Box and Muller.
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        let (a, c) = (6_364_136_223_846_793_005, 1_442_695_040_888_963_407);
        self.0 = self.0.wrapping_mul(a).wrapping_add(c);
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    fn bits(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| u8::from(self.uniform() < 0.5)).collect()
    }

    /// Soft symbols of unit amplitude and their noise, at a ratio of symbol energy to noise density.
    fn receive(&mut self, bits: &[u8], es_n0_db: f64) -> (Vec<f32>, f64) {
        let sigma = (0.5 / 10f64.powf(es_n0_db / 10.0)).sqrt();
        let value = |&b: &u8| (1.0 - 2.0 * f64::from(b) + sigma * self.next()) as f32;
        (bits.iter().map(value).collect(), sigma)
    }
}

#[test]
fn words_received_from_a_satellite_satisfy_both_codes() {
    for (name, code) in [
        ("subframe2", ldpc64::subframe2()),
        ("subframe3", ldpc64::subframe3()),
    ] {
        let word = received(name);
        assert_eq!(word.len(), code.length());
        assert!(code.checks(&word));
        let information = &word[..code.information()];
        assert!(crc24q::holds(information));
        assert_eq!(code.encode(information), word);
    }
}

#[test]
fn every_unit_of_information_encodes_to_a_code_word() {
    for code in [ldpc64::subframe2(), ldpc64::subframe3()] {
        for k in (0..code.information()).step_by(7) {
            let mut information = vec![0; code.information()];
            information[k] = 1;
            let word = code.encode(&information);
            assert!(code.checks(&word));
            assert!(word.iter().map(|&b| usize::from(b)).sum::<usize>() > 6);
        }
    }
}

#[test]
fn decodes_words_far_into_the_noise() {
    // At an Es/N0 of 0.5 dB 7 % of the hard decisions are wrong.
    let mut normal = Normal(1);
    for code in [ldpc64::subframe2(), ldpc64::subframe3()] {
        for _ in 0..20 {
            let word = code.encode(&normal.bits(code.information()));
            let (values, sigma) = normal.receive(&word, 0.5);
            let scale = (2.0 / (sigma * sigma)) as f32;
            let likelihoods: Vec<f32> = values.iter().map(|v| v * scale).collect();
            let decoded = code.decode(&likelihoods, 60);
            assert!(decoded.converged && decoded.bits == word);
            let wrong = values
                .iter()
                .zip(&word)
                .filter(|(&v, &b)| u8::from(v < 0.0) != b);
            assert_eq!(decoded.corrected, wrong.count());
        }
    }
}

#[test]
fn frames_are_found_and_decoded_with_either_sign() {
    let mut normal = Normal(2);
    let (data2, data3) = (normal.bits(cnav1::DATA2), normal.bits(cnav1::DATA3));
    let symbols: Vec<i8> = (197..203)
        .flat_map(|soh| cnav1::encode(27, soh % 200, &data2, &data3).unwrap())
        .collect();
    let bits: Vec<u8> = symbols.iter().map(|&s| u8::from(s < 0)).collect();
    for (cut, sign) in [(0, 1.0), (700, -1.0)] {
        let (values, _) = normal.receive(&bits[cut..], 0.5);
        let values: Vec<f32> = values.iter().map(|v| sign * v).collect();
        let start = cnav1::find(&values, 27, 3)[0];
        assert_eq!(start.offset, (1800 - cut) % 1800);
        assert_eq!(
            (start.inverted, start.soh),
            (sign < 0.0, if cut == 0 { 197 } else { 198 })
        );
        let first: Vec<f32> = values[start.offset..][..1800]
            .iter()
            .map(|v| sign * v)
            .collect();
        let frame = cnav1::decode(&first, None, cnav1::ITERATIONS);
        assert!(frame.second.ok && frame.third.ok);
        assert_eq!((frame.prn.value, frame.soh.value), (27, start.soh));
        assert_eq!(&frame.second.bits[..576], &data2);
        assert_eq!(&frame.third.bits[..240], &data3);
    }
}

#[test]
fn noise_alone_passes_no_check() {
    let mut normal = Normal(3);
    for _ in 0..30 {
        let values: Vec<f32> = (0..1800).map(|_| normal.next() as f32).collect();
        let frame = cnav1::decode(&values, None, 20);
        assert!(!frame.second.ok && !frame.third.ok);
    }
}

#[test]
fn wrong_sizes_and_numbers_are_refused() {
    assert!(cnav1::encode(0, 0, &[0; 576], &[0; 240]).is_err());
    assert!(cnav1::encode(64, 0, &[0; 576], &[0; 240]).is_err());
    assert!(cnav1::encode(1, 200, &[0; 576], &[0; 240]).is_err());
    assert!(cnav1::encode(1, 0, &[0; 575], &[0; 240]).is_err());
    assert!(cnav1::find(&[1.0; 71], 1, 5).is_empty());
    assert!(cnav1::find(&[1.0; 1800], 99, 5).is_empty());
}

fn anything() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => -4.0f32..4.0,
        1 => any::<f32>(),
        1 => Just(0.0),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn whatever_comes_in_no_frame_comes_out(values in proptest::collection::vec(anything(), 1800)) {
        let frame = cnav1::decode(&values, None, 8);
        prop_assert!(!frame.second.ok && !frame.third.ok);
        cnav1::find(&values, 7, 2);
    }

    #[test]
    fn subframes_of_d1_survive_any_single_error(
        mut bits in proptest::collection::vec(0u8..2, 300), place in 15usize..300,
    ) {
        let bits: &mut [u8; 300] = bits.as_mut_slice().try_into().unwrap();
        let mut symbols = beidou_subframe::encode(bits);
        symbols[place] ^= 1;
        let found = beidou_subframe::correct(&symbols);
        prop_assert_eq!((&found.bits, found.corrected.iter().sum::<usize>()), (&*bits, 1));
    }
}
