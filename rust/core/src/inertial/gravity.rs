//! Normal gravity of WGS 84: Somigliana's formula on the ellipsoid, second order in height.

use super::earth::E2;
use crate::nav_math::geodesy::WGS84;

/// Normal gravity at the equator, m/s^2 (NIMA TR8350.2, table 3.4).
pub const EQUATOR: f64 = 9.780_325_335_9;
/// Somigliana's constant (NIMA TR8350.2, table 3.4).
pub const SOMIGLIANA: f64 = 0.001_931_852_652_41;
/// Centrifugal over gravitational acceleration at the equator (NIMA TR8350.2, table 3.4).
const CENTRIFUGAL: f64 = 0.003_449_786_506_84;

/// Along the downward normal, m/s^2, for the sine of a latitude and a height in m.
///
/// NIMA TR8350.2, equations 4-1 and 4-3; good to 1e-6 m/s^2 of normal gravity up to 20 km. The
/// component to the north that grows with height (3e-6 m/s^2 at 400 m) is left out, and so are
/// anomalies and deflections of the vertical (1e-4 m/s^2).
#[inline]
pub fn normal(sin_latitude: f64, height: f64) -> f64 {
    let sin2 = sin_latitude * sin_latitude;
    let surface = EQUATOR * (1.0 + SOMIGLIANA * sin2) / (1.0 - E2 * sin2).sqrt();
    let h = height / WGS84.a;
    let slope = 1.0 + WGS84.f + CENTRIFUGAL - 2.0 * WGS84.f * sin2;
    surface * (1.0 - 2.0 * slope * h + 3.0 * h * h)
}

/// Its change a radian of latitude on the ellipsoid, m/s^2.
pub fn along_meridian(sin_latitude: f64, cos_latitude: f64) -> f64 {
    let (s, sin2) = (sin_latitude, sin_latitude * sin_latitude);
    let root = (1.0 - E2 * sin2).sqrt();
    let slope = 2.0 * SOMIGLIANA * s / root + (1.0 + SOMIGLIANA * sin2) * E2 * s / root.powi(3);
    EQUATOR * slope * cos_latitude
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_values() {
        // TR8350.2, table 3.4: equator, pole; free-air gradient of 0.3086 mGal/m at 45 degrees.
        assert!((normal(0.0, 0.0) - 9.780_325_335_9).abs() < 1e-10);
        assert!((normal(1.0, 0.0) - 9.832_184_937_8).abs() < 1e-9);
        let middle = std::f64::consts::FRAC_1_SQRT_2;
        let gradient = normal(middle, 0.5) - normal(middle, -0.5);
        assert!((gradient + 3.086e-6).abs() < 2e-9);
    }

    #[test]
    fn it_grows_towards_the_poles() {
        let (b, step) = (0.6_f64, 1e-4);
        let change = normal((b + step).sin(), 0.0) - normal((b - step).sin(), 0.0);
        assert!((change / (2.0 * step) - along_meridian(b.sin(), b.cos())).abs() < 1e-8);
    }
}
