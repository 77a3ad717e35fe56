//! BDGIM: the global ionosphere of BDS-3 in spherical harmonics.
//!
//! Source: BDS-SIS-ICD-B1C-1.0, section 7.8 with tables 7-9 to 7-11. Nine coefficients are
//! broadcast; seventeen more follow from fixed series in time.

use std::f64::consts::{PI, TAU};

use super::ionosphere::{pierce_point, Ray};

/// Broadcast harmonics, degree and order (table 7-9); a negative order is a sine.
const BROADCAST: [(usize, i32); 9] = [
    (0, 0),
    (1, 0),
    (1, 1),
    (1, -1),
    (2, 0),
    (2, 1),
    (2, -1),
    (2, 2),
    (2, -2),
];

/// The others (table 7-11).
const FIXED: [(usize, i32); 17] = [
    (3, 0),
    (3, 1),
    (3, -1),
    (3, 2),
    (3, -2),
    (3, 3),
    (3, -3),
    (4, 0),
    (4, 1),
    (4, -1),
    (4, 2),
    (4, -2),
    (5, 0),
    (5, 1),
    (5, -1),
    (5, 2),
    (5, -2),
];

/// Periods of the series in days (table 7-11).
const PERIODS: [f64; 12] = [
    1.0, 0.5, 0.33, 14.6, 27.0, 121.6, 182.51, 365.25, 4_028.71, 2_014.35, 1_342.9, 1_007.18,
];

/// For each of [`FIXED`] its mean, then a cosine and a sine amplitude for each period, TECU.
#[rustfmt::skip]
const SERIES: [[f64; 25]; 17] = [
    [-0.61, -0.51, 0.23, -0.06, 0.02, 0.01, 0.0, -0.01, 0.0, 0.0, 0.01, -0.19, -0.09, -0.18, 0.15, 1.09, 0.5, -0.34, 0.0, -0.13, 0.05, -0.06, 0.03, -0.03, 0.04],
    [-1.31, -0.43, -0.2, -0.05, -0.08, -0.03, -0.02, 0.0, -0.02, 0.0, 0.0, -0.02, 0.07, 0.06, -0.31, -0.14, -0.08, -0.09, -0.11, 0.07, 0.03, 0.13, -0.02, 0.08, -0.02],
    [-2.0, 0.34, -0.31, 0.06, -0.06, 0.01, -0.03, 0.01, 0.01, 0.03, 0.0, 0.12, 0.03, -0.55, 0.13, -0.21, -0.38, -1.22, -0.22, -0.37, 0.07, -0.07, 0.04, -0.01, -0.04],
    [-0.03, -0.01, 0.16, 0.17, -0.11, -0.01, -0.05, 0.0, 0.0, 0.01, 0.01, -0.1, 0.06, -0.02, 0.05, 0.52, 0.36, 0.05, 0.01, 0.05, 0.02, 0.03, -0.01, 0.04, 0.0],
    [0.15, 0.17, -0.03, 0.15, 0.15, 0.05, -0.01, 0.01, -0.01, 0.02, 0.0, 0.06, 0.09, 0.09, -0.09, 0.27, 0.14, 0.15, 0.02, 0.06, -0.01, 0.02, -0.03, 0.01, -0.01],
    [-0.48, 0.02, 0.02, 0.0, -0.14, -0.03, -0.07, 0.0, 0.01, 0.01, 0.0, 0.0, 0.01, -0.08, -0.03, 0.0, 0.04, -0.29, -0.03, -0.11, 0.03, -0.05, 0.02, -0.02, 0.0],
    [-0.4, -0.06, 0.04, 0.11, 0.01, 0.05, -0.03, -0.01, 0.0, 0.0, 0.0, -0.02, 0.02, 0.0, 0.06, 0.11, 0.0, -0.17, -0.01, -0.07, 0.02, -0.05, 0.01, -0.02, 0.01],
    [2.28, 0.3, 0.18, -0.05, 0.01, -0.03, -0.01, -0.01, -0.02, -0.02, 0.0, -0.08, 0.0, 0.86, -0.36, 0.17, 0.25, 1.58, 0.49, 0.46, -0.04, 0.01, 0.04, -0.04, 0.07],
    [-0.16, 0.44, 0.34, -0.16, 0.04, -0.01, 0.02, 0.0, 0.0, 0.0, 0.0, -0.02, -0.04, -0.18, 0.08, 0.23, 0.17, -0.06, -0.03, 0.0, -0.01, 0.0, 0.0, 0.0, 0.0],
    [-0.21, -0.28, 0.45, 0.02, -0.14, 0.0, -0.01, 0.0, 0.0, 0.0, 0.0, -0.07, -0.02, -0.05, 0.05, 0.35, 0.27, -0.15, -0.02, -0.04, -0.01, 0.0, 0.0, 0.0, 0.0],
    [-0.1, -0.31, 0.19, 0.11, -0.05, -0.08, 0.03, 0.0, 0.0, 0.0, 0.0, 0.01, -0.01, -0.07, 0.06, -0.05, -0.03, 0.0, 0.01, 0.01, 0.02, 0.0, 0.0, 0.0, 0.0],
    [-0.13, -0.17, -0.25, 0.04, 0.08, -0.04, -0.1, 0.0, 0.0, 0.0, 0.0, 0.03, 0.01, 0.04, -0.02, 0.02, -0.03, 0.13, 0.02, 0.07, 0.03, 0.0, 0.0, 0.0, 0.0],
    [0.21, 0.04, -0.12, 0.12, 0.08, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.15, -0.1, 0.14, -0.05, -0.6, -0.32, 0.28, 0.04, 0.09, 0.02, 0.0, 0.0, 0.0, 0.0],
    [0.68, 0.39, 0.18, 0.07, -0.01, -0.02, 0.05, 0.0, 0.0, 0.0, 0.0, 0.06, 0.0, -0.03, 0.06, 0.02, -0.1, -0.08, -0.04, -0.05, -0.04, 0.0, 0.0, 0.0, 0.0],
    [1.06, -0.12, 0.4, 0.02, 0.01, -0.03, -0.01, 0.0, 0.0, 0.0, 0.0, -0.05, -0.01, 0.37, -0.2, 0.01, 0.2, 0.62, 0.16, 0.15, -0.04, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.12, -0.09, -0.14, 0.11, 0.0, 0.04, 0.0, 0.0, 0.0, 0.0, -0.03, 0.02, -0.11, 0.04, 0.27, 0.1, -0.01, -0.02, -0.01, -0.01, 0.0, 0.0, 0.0, 0.0],
    [-0.12, 0.0, 0.21, -0.14, -0.12, -0.03, 0.0, 0.0, 0.0, 0.0, 0.0, -0.1, 0.05, -0.12, 0.07, 0.32, 0.3, -0.04, -0.01, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0],
];

/// Geomagnetic north pole.
const POLE_LATITUDE: f64 = 80.27 * PI / 180.0;
const POLE_LONGITUDE: f64 = -72.58 * PI / 180.0;
/// Earth's radius and height of the layer, km.
const RADIUS: f64 = 6_378.0;
const HEIGHT: f64 = 400.0;
/// m Hz^2 per TECU.
const DELAY_PER_TECU: f64 = 40.28e16;
/// Modified Julian day at which GPS weeks begin.
const GPS_EPOCH_MJD: f64 = 44_244.0;
const DAY_S: f64 = 86_400.0;

/// The model with its nine broadcast coefficients, TECU.
#[derive(Debug, Clone, PartialEq)]
pub struct Bdgim {
    alpha: [f64; 9],
}

impl Bdgim {
    /// With its broadcast coefficients.
    pub fn new(alpha: [f64; 9]) -> Self {
        Self { alpha }
    }

    /// Delay in m at `carrier_hz`; `bdt_s` is BDT counted from 1980-01-06.
    pub fn delay_m(&self, ray: &Ray, bdt_s: f64, carrier_hz: f64) -> f64 {
        let (latitude, longitude, sin_zenith) = pierce_point(ray, RADIUS, HEIGHT);
        let slant = 1.0 / (1.0 - sin_zenith * sin_zenith).sqrt();
        let vertical = self.vertical_tecu(latitude, longitude, GPS_EPOCH_MJD + bdt_s / DAY_S);
        slant * DELAY_PER_TECU / (carrier_hz * carrier_hz) * vertical
    }

    /// Vertical electron content in TECU over a place (rad), never negative.
    pub fn vertical_tecu(&self, latitude: f64, longitude: f64, mjd: f64) -> f64 {
        let (phi, lambda) = solar_geomagnetic(latitude, longitude, mjd);
        let legendre = legendre(phi.sin());
        let harmonic = |&(n, m): &(usize, i32)| {
            let angle = f64::from(m.abs()) * lambda;
            let wave = if m < 0 { angle.sin() } else { angle.cos() };
            legendre[n][m.unsigned_abs() as usize] * wave
        };
        let broadcast: f64 = BROADCAST
            .iter()
            .map(harmonic)
            .zip(self.alpha)
            .map(|(h, a)| h * a)
            .sum();
        let basis = series_basis(mjd);
        let fixed: f64 = FIXED
            .iter()
            .zip(&SERIES)
            .map(|(term, row)| {
                harmonic(term) * row.iter().zip(&basis).map(|(c, b)| c * b).sum::<f64>()
            })
            .sum();
        (broadcast + fixed).max(0.0)
    }
}

/// 1, then cosine and sine of each period, at the middle of the two-hour span that `mjd` lies in.
fn series_basis(mjd: f64) -> [f64; 25] {
    let middle = ((mjd * 12.0).floor() + 0.5) / 12.0;
    let mut basis = [1.0; 25];
    for (pair, period) in basis[1..].chunks_exact_mut(2).zip(PERIODS) {
        let (sin, cos) = (TAU * (middle / period).fract()).sin_cos();
        pair.copy_from_slice(&[cos, sin]);
    }
    basis
}

/// Geomagnetic latitude and longitude against the sun's (equations 7-15 to 7-18).
fn solar_geomagnetic(latitude: f64, longitude: f64, mjd: f64) -> (f64, f64) {
    let (sin_pole, cos_pole) = POLE_LATITUDE.sin_cos();
    let (sin_b, cos_b) = latitude.sin_cos();
    let (sin_l, cos_l) = (longitude - POLE_LONGITUDE).sin_cos();
    let sin_phi = sin_pole * sin_b + cos_pole * cos_b * cos_l;
    let lambda = (cos_b * sin_l).atan2(sin_pole * cos_b * cos_l - cos_pole * sin_b);
    let (sin_sun, cos_sun) = (PI * (1.0 - 2.0 * mjd.fract()) - POLE_LONGITUDE).sin_cos();
    (
        sin_phi.clamp(-1.0, 1.0).asin(),
        lambda - sin_sun.atan2(sin_pole * cos_sun),
    )
}

/// Fully normalised associated Legendre functions by degree and order, up to 5 and 3.
fn legendre(x: f64) -> [[f64; 4]; 6] {
    let mut p = [[0.0_f64; 4]; 6];
    let root = (1.0 - x * x).max(0.0).sqrt();
    p[0][0] = 1.0;
    for m in 1..4 {
        p[m][m] = (2 * m - 1) as f64 * root * p[m - 1][m - 1];
    }
    for m in 0..4 {
        p[m + 1][m] = x * (2 * m + 1) as f64 * p[m][m];
        for n in m + 2..6 {
            let (a, b) = ((2 * n - 1) as f64, (n + m - 1) as f64);
            p[n][m] = (a * x * p[n - 1][m] - b * p[n - 2][m]) / (n - m) as f64;
        }
    }
    for (n, row) in p.iter_mut().enumerate() {
        for (m, value) in row.iter_mut().enumerate().take(n + 1) {
            let ratio: f64 = (n - m + 1..=n + m).map(|k| k as f64).product();
            let twice = if m == 0 { 1.0 } else { 2.0 };
            *value *= (twice * (2 * n + 1) as f64 / ratio).sqrt();
        }
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Electron contents that the authors' own program of 2021 gives (Li and Wang, Aerospace
    /// Information Research Institute): figures only, for its sample parameters.
    #[test]
    fn electron_content_is_that_of_the_authors() {
        let alpha = [
            13.826_420_69,
            -1.780_046_16,
            5.172,
            3.130_309_4,
            -4.589_613_29,
            0.324_838_67,
            -0.078_023_83,
            1.243_125_9,
            0.377_636_27,
        ];
        let model = Bdgim::new(alpha);
        for (mjd, latitude, longitude, expected) in [
            (59158.7083333333, 0.60, 2.00, 6.238239680),
            (59158.7083333333, -0.30, -1.20, 34.533662428),
            (59158.7083333333, 1.20, 0.40, 2.595341341),
            (59158.2600000000, 0.60, 2.00, 20.785999849),
            (59158.2600000000, -0.30, -1.20, 9.935353671),
            (59158.2600000000, 1.20, 0.40, 6.871141065),
            (59975.9000000000, 0.60, 2.00, 5.655813098),
            (59975.9000000000, -0.30, -1.20, 33.744135324),
            (59975.9000000000, 1.20, 0.40, 2.848717592),
            (60015.5100000000, 0.60, 2.00, 8.450468241),
            (60015.5100000000, -0.30, -1.20, 13.534960095),
            (60015.5100000000, 1.20, 0.40, 5.854873583),
        ] {
            let content = model.vertical_tecu(latitude, longitude, mjd);
            assert!((content - expected).abs() < 2e-6, "{content} {expected}");
        }
    }

    #[test]
    fn a_slant_ray_is_longer_and_the_sign_right() {
        let model = Bdgim::new([20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let place = super::super::geodesy::Geodetic {
            latitude: 0.5,
            longitude: 2.0,
            height: 0.0,
        };
        let delay = |elevation| {
            let ray = Ray {
                place,
                azimuth: 1.0,
                elevation,
            };
            model.delay_m(&ray, 1.36e9, 1_575.42e6)
        };
        assert!(delay(1.5) > 0.5 && delay(0.2) > 1.5 * delay(1.5));
    }
}
