//! BeiDou B1C data and pilot (BDS-SIS-ICD-B1C-1.0).

use super::b1i::is_geo;
use super::code::weil::weil;
use super::{Modulation, SignalSpec};

/// Length of the Legendre sequence of the primary codes (table 5-2).
const PRIMARY_N: usize = 10243;
/// Length of the Legendre sequence of the pilot's secondary code (table 5-4).
const SECONDARY_N: usize = 3607;
/// Length of the pilot's secondary code.
const SECONDARY_LENGTH: usize = 1800;

/// B1C data: BOC(1,1), 10 ms code, 100 symbols per second, a quarter of the power.
pub(super) const B1CD: SignalSpec = SignalSpec {
    id: "B1CD",
    composite: "B1C",
    description: "BeiDou B1C data, BDS-SIS-ICD-B1C-1.0",
    rinex: "1D",
    system: 'C',
    carrier_hz: 1_575.42e6,
    chip_rate_hz: 1.023e6,
    code_length: 10230,
    modulation: Modulation::Boc11,
    power_share: 0.25,
    phase_offset_cycles: 0.0,
    min_half_bandwidth_hz: 1.023e6,
    prns,
    primary: |prn| primary(PARAMETERS[prn as usize - 1].data),
    overlay: |_| vec![],
    symbol_periods: |_| Some(1),
};

/// B1C pilot: QMBOC(6,1,4/33) in quadrature to the data, secondary code of 18 s.
pub(super) const B1CP: SignalSpec = SignalSpec {
    id: "B1CP",
    description: "BeiDou B1C pilot, BDS-SIS-ICD-B1C-1.0",
    rinex: "1P",
    modulation: Modulation::Qmboc,
    power_share: 0.75,
    phase_offset_cycles: 0.25,
    primary: |prn| primary(PARAMETERS[prn as usize - 1].pilot),
    overlay: |prn| {
        let (w, p) = PARAMETERS[prn as usize - 1].secondary;
        weil(SECONDARY_N, w, p, SECONDARY_LENGTH)
    },
    symbol_periods: |_| None,
    ..B1CD
};

/// Geostationary satellites send no B1C.
fn prns() -> Vec<u16> {
    (1..=63).filter(|&prn| !is_geo(prn)).collect()
}

fn primary((w, p): (usize, usize)) -> Vec<i8> {
    weil(PRIMARY_N, w, p, B1CD.code_length)
}

/// Weil phase difference w and truncation point p of each code of a PRN.
struct Parameters {
    data: (usize, usize),
    pilot: (usize, usize),
    secondary: (usize, usize),
}

const fn row(data: (usize, usize), pilot: (usize, usize), secondary: (usize, usize)) -> Parameters {
    Parameters {
        data,
        pilot,
        secondary,
    }
}

/// Tables 5-2, 5-3 and 5-4 of BDS-SIS-ICD-B1C-1.0, PRN 1 first.
#[rustfmt::skip]
const PARAMETERS: [Parameters; 63] = [
    row((2678, 699), (796, 7575), (269, 1889)),
    row((4802, 694), (156, 2369), (1448, 1268)),
    row((958, 7318), (4198, 5688), (1028, 1593)),
    row((859, 2127), (3941, 539), (1324, 1186)),
    row((3843, 715), (1374, 2270), (822, 1239)),
    row((2232, 6682), (1338, 7306), (5, 1930)),
    row((124, 7850), (1833, 6457), (155, 176)),
    row((4352, 5495), (2521, 6254), (458, 1696)),
    row((1816, 1162), (3175, 5644), (310, 26)),
    row((1126, 7682), (168, 7119), (959, 1344)),
    row((1860, 6792), (2715, 1402), (1238, 1271)),
    row((4800, 9973), (4408, 5557), (1180, 1182)),
    row((2267, 6596), (3160, 5764), (1288, 1381)),
    row((424, 2092), (2796, 1073), (334, 1604)),
    row((4192, 19), (459, 7001), (885, 1333)),
    row((4333, 10151), (3594, 5910), (1362, 1185)),
    row((2656, 6297), (4813, 10060), (181, 31)),
    row((4148, 5766), (586, 2710), (1648, 704)),
    row((243, 2359), (1428, 1546), (838, 1190)),
    row((1330, 7136), (2371, 6887), (313, 1646)),
    row((1593, 1706), (2285, 1883), (750, 1385)),
    row((1470, 2128), (3377, 5613), (225, 113)),
    row((882, 6827), (4965, 5062), (1477, 860)),
    row((3202, 693), (3779, 1038), (309, 1656)),
    row((5095, 9729), (4547, 10170), (108, 1921)),
    row((2546, 1620), (1646, 6484), (1457, 1173)),
    row((1733, 6805), (1430, 1718), (149, 1928)),
    row((4795, 534), (607, 2535), (322, 57)),
    row((4577, 712), (2118, 1158), (271, 150)),
    row((1627, 1929), (4709, 526), (576, 1214)),
    row((3638, 5355), (1149, 7331), (1103, 1148)),
    row((2553, 6139), (3283, 5844), (450, 1458)),
    row((3646, 6339), (2473, 6423), (399, 1519)),
    row((1087, 1470), (1006, 6968), (241, 1635)),
    row((1843, 6867), (3670, 1280), (1045, 1257)),
    row((216, 7851), (1817, 1838), (164, 1687)),
    row((2245, 1162), (771, 1989), (513, 1382)),
    row((726, 7659), (2173, 6468), (687, 1514)),
    row((1966, 1156), (740, 2091), (422, 1)),
    row((670, 2672), (1433, 1581), (303, 1583)),
    row((4130, 6043), (2458, 1453), (324, 1806)),
    row((53, 2862), (3459, 6252), (495, 1664)),
    row((4830, 180), (2155, 7122), (725, 1338)),
    row((182, 2663), (1205, 7711), (780, 1111)),
    row((2181, 6940), (413, 7216), (367, 1706)),
    row((2006, 1645), (874, 2113), (882, 1543)),
    row((1080, 1582), (2463, 1095), (631, 1813)),
    row((2288, 951), (1106, 1628), (37, 228)),
    row((2027, 6878), (1590, 1713), (647, 2871)),
    row((271, 7701), (3873, 6102), (1043, 2884)),
    row((915, 1823), (4026, 6123), (24, 1823)),
    row((497, 2391), (4272, 6070), (120, 75)),
    row((139, 2606), (3556, 1115), (134, 11)),
    row((3693, 822), (128, 8047), (136, 63)),
    row((2054, 6403), (1200, 6795), (158, 1937)),
    row((4342, 239), (130, 2575), (214, 22)),
    row((3342, 442), (4494, 53), (335, 1768)),
    row((2592, 6769), (1871, 1729), (340, 1526)),
    row((1007, 2560), (3073, 6388), (661, 1402)),
    row((310, 2502), (4386, 682), (889, 1445)),
    row((4203, 5072), (4098, 5565), (929, 1680)),
    row((455, 7268), (1923, 7160), (1002, 1290)),
    row((4318, 341), (1176, 2277), (1149, 1245)),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn octal(chips: &[i8]) -> String {
        let value = chips.iter().fold(0u32, |v, &c| v << 1 | u32::from(c < 0));
        format!("{value:08o}")
    }

    /// All 63 PRNs, those of the satellites that send no B1C included.
    #[test]
    fn codes_match_the_icd_tables() {
        let table = include_str!("../../../../tests/vectors/icd/b1c.csv");
        let mut rows = 0;
        for line in table.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let prn: u16 = cells[0].parse().unwrap();
            let codes = [
                primary(PARAMETERS[prn as usize - 1].data),
                (B1CP.primary)(prn),
                (B1CP.overlay)(prn),
            ];
            for (code, expected) in codes.iter().zip(cells[1..].chunks(4)) {
                assert_eq!(octal(&code[..24]), expected[2], "PRN {prn}");
                assert_eq!(octal(&code[code.len() - 24..]), expected[3], "PRN {prn}");
            }
            rows += 1;
        }
        assert_eq!(rows, 63);
    }
}
