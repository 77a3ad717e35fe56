//! BeiDou B1I (BDS-SIS-ICD-B1I-3.0).

use super::code::{
    gold::{gold, Lfsr},
    secondary::{from_bits, NH20},
};
use super::{Modulation, SignalSpec};

/// B1I: BPSK(2), 1 ms code, NH20 and 50 bps on D1 (MEO/IGSO), 500 bps and no NH on D2 (GEO).
pub(super) const B1I: SignalSpec = SignalSpec {
    id: "B1I",
    composite: "B1I",
    description: "BeiDou B1I, BDS-SIS-ICD-B1I-3.0",
    rinex: "2I",
    system: 'C',
    carrier_hz: 1_561.098e6,
    chip_rate_hz: 2.046e6,
    code_length: 2046,
    modulation: Modulation::Bpsk,
    power_share: 1.0,
    phase_offset_cycles: 0.0,
    min_half_bandwidth_hz: 1.023e6,
    prns: || (1..=63).collect(),
    primary,
    overlay: |prn| {
        if is_geo(prn) {
            vec![]
        } else {
            from_bits(NH20, 20)
        }
    },
    symbol_periods: |prn| Some(if is_geo(prn) { 2 } else { 20 }),
};

/// Geostationary satellites, which send D2 and no B1C (BDS-SIS-ICD-B1I-3.0 section 4.2.2).
pub(super) fn is_geo(prn: u16) -> bool {
    matches!(prn, 1..=5 | 59..=63)
}

/// 1-based stages of G2 summed for each PRN (BDS-SIS-ICD-B1I-3.0 table 5-1).
#[rustfmt::skip]
const G2_TAPS: [&[usize]; 63] = [
    &[1, 3], &[1, 4], &[1, 5], &[1, 6], &[1, 8], &[1, 9], &[1, 10],
    &[1, 11], &[2, 7], &[3, 4], &[3, 5], &[3, 6], &[3, 8], &[3, 9],
    &[3, 10], &[3, 11], &[4, 5], &[4, 6], &[4, 8], &[4, 9], &[4, 10],
    &[4, 11], &[5, 6], &[5, 8], &[5, 9], &[5, 10], &[5, 11], &[6, 8],
    &[6, 9], &[6, 10], &[6, 11], &[8, 9], &[8, 10], &[8, 11], &[9, 10],
    &[9, 11], &[10, 11], &[1, 2, 7], &[1, 3, 4], &[1, 3, 6], &[1, 3, 8], &[1, 3, 10],
    &[1, 3, 11], &[1, 4, 5], &[1, 4, 9], &[1, 5, 6], &[1, 5, 8], &[1, 5, 10], &[1, 5, 11],
    &[1, 6, 9], &[1, 8, 9], &[1, 9, 10], &[1, 9, 11], &[2, 3, 7], &[2, 5, 7], &[2, 7, 9],
    &[3, 4, 5], &[3, 4, 9], &[3, 5, 6], &[3, 5, 8], &[3, 5, 10], &[3, 5, 11], &[3, 6, 9],
];

fn primary(prn: u16) -> Vec<i8> {
    // Both registers start at 01010101010; code truncated to 2046 chips (section 5.2.1).
    let start = [0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0];
    let g1 = Lfsr::new(&start, &[1, 7, 8, 9, 10, 11]);
    let g2 = Lfsr::new(&start, &[1, 2, 3, 4, 5, 8, 9, 11]);
    gold(g1, g2, G2_TAPS[prn as usize - 1], B1I.code_length)
}
