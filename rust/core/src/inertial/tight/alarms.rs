//! All tests by number: windows of innovations, separation from copies, power.

use super::copies::SPANS;
use super::settings::Testing;

/// Windows of the innovations, s: of rates and changes, and of codes.
pub const WINDOWS: [&[f64]; 3] = [
    &[1.0, 3.0, 7.0, 14.0, 25.0, 50.0, 100.0],
    &[1.0, 3.0, 7.0, 14.0, 25.0, 50.0, 100.0],
    &[1.0, 10.0, 30.0, 100.0],
];
/// All tests: the windows, separation from copies of each span, of the clock likewise, power.
pub const TESTS: usize = SEPARATION + 2 * SPANS.len() + 1;
/// First test of changes.
const CHANGES: usize = 7;
/// First test of codes.
const CODES: usize = 14;
/// First test of separation from copies: all before it are windows.
pub const SEPARATION: usize = 18;
/// First test of separation of the clock.
pub const CLOCKS: usize = SEPARATION + SPANS.len();
/// The test of power.
pub const POWER: usize = TESTS - 1;
/// Threshold of a test, and how old a copy it takes to get away from what it saw.
pub fn limit(test: usize, limits: &Testing) -> (f64, f64) {
    let t = &limits.thresholds;
    let window = |kind: usize, k: usize| (t[kind], 2.0 * WINDOWS[kind][k].max(30.0));
    match test {
        0..CHANGES => window(0, test),
        CHANGES..CODES => window(1, test - CHANGES),
        CODES..SEPARATION => window(2, test - CODES),
        SEPARATION..CLOCKS => (t[3], 2.0 * SPANS[test - SEPARATION].max(30.0)),
        CLOCKS..POWER => (t[4], 2.0 * SPANS[test - CLOCKS].max(30.0)),
        _ => (limits.power_rise, 20.0),
    }
}
