//! GPS L1 C/A, and the same code family on QZSS and SBAS (IS-GPS-200, SBAS PRN assignments).

use super::code::gold::{gold, Lfsr};
use super::{Modulation, SignalSpec};

/// L1 C/A: BPSK(1), 1 ms code, 50 bps (SBAS: 500 symbols per second).
pub(super) const L1CA: SignalSpec = SignalSpec {
    id: "L1CA",
    composite: "L1CA",
    description: "GPS, QZSS and SBAS L1 C/A, IS-GPS-200N section 3.3.2.3",
    rinex: "1C",
    system: 'G',
    carrier_hz: 1_575.42e6,
    chip_rate_hz: 1.023e6,
    code_length: 1023,
    modulation: Modulation::Bpsk,
    power_share: 1.0,
    phase_offset_cycles: 0.0,
    min_half_bandwidth_hz: 0.5115e6,
    prns: || (1..=32).chain(120..=158).chain(193..=202).collect(),
    primary,
    overlay: |_| vec![],
    symbol_periods: |prn| Some(if (120..=158).contains(&prn) { 2 } else { 20 }),
};

/// G2 delay in chips of GPS PRN 1-32 (IS-GPS-200N table 3-Ia).
#[rustfmt::skip]
const GPS_DELAY: [usize; 32] = [
    5, 6, 7, 8, 17, 18, 139, 140, 141, 251, 252, 254, 255, 256, 257, 258,
    469, 470, 471, 472, 473, 474, 509, 512, 513, 514, 515, 516, 859, 860, 861, 862,
];

/// G2 delay in chips of SBAS PRN 120-158 (L1 C/A PRN code assignments).
#[rustfmt::skip]
const SBAS_DELAY: [usize; 39] = [
    145, 175, 52, 21, 237, 235, 886, 657, 634, 762, 355, 1012, 176, 603, 130, 359,
    595, 68, 386, 797, 456, 499, 883, 307, 127, 211, 121, 118, 163, 628, 853, 484,
    289, 811, 202, 1021, 463, 568, 904,
];

/// G2 delay in chips of QZSS PRN 193-202 (IS-QZSS-PNT-005 table 3.2.2-1).
#[rustfmt::skip]
const QZSS_DELAY: [usize; 10] = [
    339, 208, 711, 189, 263, 537, 663, 942, 173, 900,
];

fn g2_delay(prn: u16) -> usize {
    let prn = prn as usize;
    match prn {
        120..=158 => SBAS_DELAY[prn - 120],
        193..=202 => QZSS_DELAY[prn - 193],
        _ => GPS_DELAY[prn - 1],
    }
}

fn primary(prn: u16) -> Vec<i8> {
    let ones = [1u8; 10];
    let g1 = Lfsr::new(&ones, &[3, 10]);
    let mut g2 = Lfsr::new(&ones, &[2, 3, 6, 8, 9, 10]);
    // A delay of d chips is an advance of 1023 - d.
    for _ in 0..L1CA.code_length - g2_delay(prn) {
        g2.clock();
    }
    gold(g1, g2, &[10], L1CA.code_length)
}
