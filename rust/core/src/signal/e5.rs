//! Galileo E5a and E5b pilots (Galileo OS SIS ICD sections 2.3.1, 3.4.1 and 3.5).
//!
//! Received as two BPSK(10) signals, as the ICD allows, not as one AltBOC. Their data components
//! are not here, so that a power is that of the pilot.

use super::code::{
    gold::{gold, Lfsr},
    secondary::from_bits,
};
use super::{Modulation, SignalSpec};

/// Stages of both shift registers.
const STAGES: usize = 14;
/// Length of a secondary code, CS100.
const SECONDARY_LENGTH: usize = 100;

/// E5a pilot: BPSK(10), 1 ms code, secondary code of 100 ms.
pub(super) const E5AQ: SignalSpec = SignalSpec {
    id: "E5AQ",
    composite: "E5AQ",
    description: "Galileo E5a pilot (E5a-Q), Galileo OS SIS ICD",
    rinex: "5Q",
    system: 'E',
    carrier_hz: 1_176.45e6,
    chip_rate_hz: 10.23e6,
    code_length: 10230,
    modulation: Modulation::Bpsk,
    power_share: 1.0,
    phase_offset_cycles: 0.0,
    min_half_bandwidth_hz: 5.115e6,
    prns: || (1..=36).collect(),
    primary: |prn| {
        primary(
            [&[1, 6, 8, 14], &[4, 5, 7, 8, 12, 14]],
            parameters(&E5A, prn).0,
        )
    },
    overlay: |prn| from_bits(parameters(&E5A, prn).1, SECONDARY_LENGTH),
    symbol_periods: |_| None,
};

/// E5b pilot: as [`E5AQ`].
pub(super) const E5BQ: SignalSpec = SignalSpec {
    id: "E5BQ",
    composite: "E5BQ",
    description: "Galileo E5b pilot (E5b-Q), Galileo OS SIS ICD",
    rinex: "7Q",
    carrier_hz: 1_207.14e6,
    primary: |prn| {
        primary(
            [&[4, 11, 13, 14], &[1, 5, 6, 9, 10, 14]],
            parameters(&E5B, prn).0,
        )
    },
    overlay: |prn| from_bits(parameters(&E5B, prn).1, SECONDARY_LENGTH),
    ..E5AQ
};

/// Start of base register 2, and the secondary code.
type Parameters = (u16, u128);

fn parameters(table: &[Parameters; 36], prn: u16) -> Parameters {
    table[prn as usize - 1]
}

/// Two registers with the given feedback, the first of which starts with ones, added and cut off.
fn primary(feedback: [&'static [usize]; 2], start: u16) -> Vec<i8> {
    // Stage 1 is the last bit of a start value.
    let register = |start: u16, feedback| {
        let stages: [u8; STAGES] = std::array::from_fn(|stage| (start >> stage & 1) as u8);
        Lfsr::new(&stages, feedback)
    };
    gold(
        register(u16::MAX, feedback[0]),
        register(start, feedback[1]),
        &[STAGES],
        E5AQ.code_length,
    )
}

/// Start values of E5a-Q, and CS100 1 to 36, PRN 1 first.
#[rustfmt::skip]
const E5A: [Parameters; 36] = [
    (0o25652, 0x83F6F69D8F6E15411FB8C9B1C),
    (0o05142, 0x66558BD3CE0C7792E83350525),
    (0o24723, 0x59A025A9C1AF0651B779A8381),
    (0o31751, 0xD3A32640782F7B18E4DF754B7),
    (0o27366, 0xB91FCAD7760C218FA59348A93),
    (0o24660, 0xBAC77E933A779140F094FBF98),
    (0o33655, 0x537785DE280927C6B58BA6776),
    (0o27450, 0xEFCAB4B65F38531ECA22257E2),
    (0o07626, 0x79F8CAE838475EA5584BEFC9B),
    (0o01705, 0xCA5170FEA3A810EC606B66494),
    (0o12717, 0x1FC32410652A2C49BD845E567),
    (0o32122, 0xFE0A9A7AFDAC44E42CB95D261),
    (0o16075, 0xB03062DC2B71995D5AD8B7DBE),
    (0o16644, 0xF6C398993F598E2DF4235D3D5),
    (0o37556, 0x1BB2FB8B5BF24395C2EF3C5A1),
    (0o02477, 0x2F920687D238CC7046EF6AFC9),
    (0o02265, 0x34163886FC4ED7F2A92EFDBB8),
    (0o06430, 0x66A872CE47833FB2DFD5625AD),
    (0o25046, 0x99D5A70162C920A4BB9DE1CA8),
    (0o12735, 0x81D71BD6E069A7ACCBEDC66CA),
    (0o04262, 0xA654524074A9E6780DB9D3EC6),
    (0o11230, 0xC3396A101BEDAF623CFC5BB37),
    (0o00037, 0xC3D4AB211DF36F2111F2141CD),
    (0o06137, 0x3DFF25EAE761739265AF145C1),
    (0o04312, 0x994909E0757D70CDE389102B5),
    (0o20606, 0xB938535522D119F40C25FDAEC),
    (0o11162, 0xC71AB549C0491537026B390B7),
    (0o22252, 0x0CDB8C9E7B53F55F5B0A0597B),
    (0o30533, 0x61C5FA252F1AF81144766494F),
    (0o24614, 0x626027778FD3C6BB4BAA7A59D),
    (0o07767, 0xE745412FF53DEBD03F1C9A633),
    (0o32705, 0x3592AC083F3175FA724639098),
    (0o05052, 0x52284D941C3DCAF2721DDB1FD),
    (0o27553, 0x73B3D8F0AD55DF4FE814ED890),
    (0o03711, 0x94BF16C83BD7462F6498E0282),
    (0o02041, 0xA8C3DE1AC668089B0B45B3579),
];

/// Start values of E5b-Q, and CS100 51 to 86, PRN 1 first.
#[rustfmt::skip]
const E5B: [Parameters; 36] = [
    (0o03331, 0xCFF914EE3C6126A49FD5E5C94),
    (0o06143, 0xFC317C9A9BF8C6038B5CADAB3),
    (0o25322, 0xA2EAD74B6F9866E414393F239),
    (0o23371, 0x72F2B1180FA6B802CB84DF997),
    (0o00413, 0x13E3AE93BC52391D09E84A982),
    (0o36235, 0x77C04202B91B22C6D3469768E),
    (0o17750, 0xFEBC592DD7C69AB103D0BB29C),
    (0o04745, 0x0B494077E7C66FB6C51942A77),
    (0o13005, 0xDD0E321837A3D52169B7B577C),
    (0o37140, 0x43DEA90EA6C483E7990C3223F),
    (0o30155, 0x0366AB33F0167B6FA979DAE18),
    (0o20237, 0x99CCBBFAB1242CBE31E1BD52D),
    (0o03461, 0xA3466923CEFDF451EC0FCED22),
    (0o31662, 0x1A5271F22A6F9A8D76E79B7F0),
    (0o27146, 0x3204A6BB91B49D1A2D3857960),
    (0o05547, 0x32F83ADD43B599CBFB8628E5B),
    (0o02456, 0x3871FB0D89DB77553EB613CC1),
    (0o30013, 0x6A3CBDFF2D64D17E02773C645),
    (0o00322, 0x2BCD09889A1D7FC219F2EDE3B),
    (0o10761, 0x3E49467F4D4280B9942CD6F8C),
    (0o26767, 0x658E336DCFD9809F86D54A501),
    (0o36004, 0xED4284F345170CF77268C8584),
    (0o30713, 0x29ECCE910D832CAF15E3DF5D1),
    (0o07662, 0x456CCF7FE9353D50E87A708FA),
    (0o21610, 0xFB757CC9E18CBC02BF1B84B9A),
    (0o20134, 0x5686229A8D98224BC426BC7FC),
    (0o11262, 0x700A2D325EA14C4B7B7AA8338),
    (0o10706, 0x1210A330B4D3B507D854CBA3F),
    (0o34143, 0x438EE410BD2F7DBCDD85565BA),
    (0o11051, 0x4B9764CC455AE1F61F7DA432B),
    (0o25460, 0xBF1F45FDDA3594ACF3C4CC806),
    (0o17665, 0xDA425440FE8F6E2C11B8EC1A4),
    (0o32354, 0xEE2C8057A7C16999AFA33FED1),
    (0o21230, 0x2C8BD7D8395C61DFA96243491),
    (0o20146, 0x391E4BB6BC43E98150CDDCADA),
    (0o11362, 0x399F72A9EADB42C90C3ECF7F0),
];
