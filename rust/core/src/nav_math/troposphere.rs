//! Tropospheric delay: Saastamoinen's zenith delays in a standard atmosphere, mapped by Niell.
//!
//! Sources: Saastamoinen, "Atmospheric correction for the troposphere and stratosphere in radio
//! ranging of satellites" (1972); Niell, "Global mapping functions for the atmosphere delay at
//! radio wavelengths", J. Geophys. Res. 101 (1996) 3227, tables 3 and 4, good down to 3 degrees.

use std::f64::consts::TAU;

use super::ionosphere::Ray;

const HUMIDITY: f64 = 0.5;
const DAY_S: f64 = 86_400.0;
/// 1980-01-06 is day 6 of its year: days of the year are counted by this and the mean year, which
/// is a day off at most; the seasonal term changes by 2 % a day.
const EPOCH_DAY: f64 = 6.0;
const YEAR_DAYS: f64 = 365.25;
const LATITUDES_DEG: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];

/// a, b, c of the continued fraction at each of [`LATITUDES_DEG`].
type Table = [[f64; 5]; 3];

const DRY: Table = [
    [
        1.276_993_4e-3,
        1.268_323_0e-3,
        1.246_539_7e-3,
        1.219_604_9e-3,
        1.204_599_6e-3,
    ],
    [
        2.915_369_5e-3,
        2.915_229_9e-3,
        2.928_844_5e-3,
        2.902_256_5e-3,
        2.902_491_2e-3,
    ],
    [
        62.610_505e-3,
        62.837_393e-3,
        63.721_774e-3,
        63.824_265e-3,
        64.258_455e-3,
    ],
];
const DRY_SEASON: Table = [
    [
        0.0,
        1.270_962_6e-5,
        2.652_366_2e-5,
        3.400_045_2e-5,
        4.120_219_1e-5,
    ],
    [
        0.0,
        2.141_497_9e-5,
        3.016_077_9e-5,
        7.256_272_2e-5,
        11.723_375e-5,
    ],
    [
        0.0,
        9.012_840_0e-5,
        4.349_703_7e-5,
        84.795_348e-5,
        170.372_06e-5,
    ],
];
const WET: Table = [
    [
        5.802_189_7e-4,
        5.679_484_7e-4,
        5.811_801_9e-4,
        5.972_754_2e-4,
        6.164_169_3e-4,
    ],
    [
        1.427_526_8e-3,
        1.513_862_5e-3,
        1.457_275_2e-3,
        1.500_742_8e-3,
        1.759_908_2e-3,
    ],
    [
        4.347_296_1e-2,
        4.672_951_0e-2,
        4.390_893_1e-2,
        4.462_698_2e-2,
        5.473_603_8e-2,
    ],
];
const HEIGHT: [f64; 3] = [2.53e-5, 5.49e-3, 1.14e-3];

/// Slant delay in m; 0 below the horizon or more than 50 km up. `gpst_s` tells the season.
pub fn delay_m(ray: &Ray, gpst_s: f64) -> f64 {
    if ray.elevation <= 0.0 || ray.place.height > 5e4 {
        return 0.0;
    }
    let (dry, wet) = zenith_m(ray.place.latitude, ray.place.height, HUMIDITY);
    let (map_dry, map_wet) = mapping(ray, EPOCH_DAY + gpst_s / DAY_S);
    dry * map_dry + wet * map_wet
}

/// Hydrostatic and wet delay to the zenith in m, in a standard atmosphere (1013.25 hPa and 15
/// degrees at sea level) of a relative humidity in [0, 1].
pub fn zenith_m(latitude: f64, height: f64, humidity: f64) -> (f64, f64) {
    let height = height.clamp(0.0, 4e4);
    let pressure = 1013.25 * (1.0 - 2.2557e-5 * height).powf(5.2568);
    let kelvin = 288.15 - 6.5e-3 * height.min(1.1e4);
    let vapour = 6.108 * humidity * ((17.15 * kelvin - 4684.0) / (kelvin - 38.45)).exp();
    let gravity = 1.0 - 0.00266 * (2.0 * latitude).cos() - 0.00028e-3 * height;
    (
        0.002_276_8 * pressure / gravity,
        0.002_277 * (1255.0 / kelvin + 0.05) * vapour,
    )
}

/// Niell's dry and wet mapping; `day` is the day of a year, any whole number of years on.
pub fn mapping(ray: &Ray, day: f64) -> (f64, f64) {
    let south = if ray.place.latitude < 0.0 { 0.5 } else { 0.0 };
    let season = (TAU * ((day - 28.0) / YEAR_DAYS + south)).cos();
    let at = ray.place.latitude.to_degrees().abs();
    let mut dry = interpolate(&DRY, at);
    let swing = interpolate(&DRY_SEASON, at);
    for (c, s) in dry.iter_mut().zip(swing) {
        *c -= s * season;
    }
    let sin = ray.elevation.sin();
    let lift = (1.0 / sin - fraction(sin, HEIGHT)) * ray.place.height * 1e-3;
    (
        fraction(sin, dry) + lift,
        fraction(sin, interpolate(&WET, at)),
    )
}

fn fraction(sin: f64, [a, b, c]: [f64; 3]) -> f64 {
    (1.0 + a / (1.0 + b / (1.0 + c))) / (sin + a / (sin + b / (sin + c)))
}

fn interpolate(table: &Table, latitude_deg: f64) -> [f64; 3] {
    let place = ((latitude_deg - LATITUDES_DEG[0]) / 15.0).clamp(0.0, 4.0);
    let low = (place as usize).min(3);
    let share = place - low as f64;
    table.map(|row| row[low] * (1.0 - share) + row[low + 1] * share)
}

#[cfg(test)]
mod tests {
    use super::super::geodesy::Geodetic;
    use super::*;

    fn ray(latitude: f64, height: f64, elevation: f64) -> Ray {
        let place = Geodetic {
            latitude: latitude.to_radians(),
            longitude: 0.0,
            height,
        };
        Ray {
            place,
            azimuth: 0.0,
            elevation: elevation.to_radians(),
        }
    }

    /// Figures of RTKLIB's unit test of atmospheric models (t_atmos.c, utest3; BSD-2), which maps
    /// with the cosine of the zenith angle.
    #[test]
    fn zenith_delays_are_the_published_ones() {
        for (ray, expected) in [
            (ray(35.0, 100.0, 75.0), 2.447_998_701_440_88),
            (ray(-80.0, 1000.0, 75.0), 2.172_958_172_981_52),
        ] {
            let (dry, wet) = zenith_m(ray.place.latitude, ray.place.height, 0.5);
            assert!(
                ((dry + wet) / ray.elevation.sin() - expected).abs() < 2e-4,
                "{dry} {wet}"
            );
        }
    }

    /// Figures of the same program, utest4.
    #[test]
    fn mappings_are_the_published_ones() {
        let day = 16.25;
        for (ray, dry, wet) in [
            (
                ray(35.0, 100.0, 75.0),
                1.035_184_526_466_435,
                1.035_233_787_448_654,
            ),
            (
                ray(35.0, 100.0, 3.0),
                14.643_271_711_748_2,
                16.455_045_694_559_484,
            ),
            (
                ray(35.0, 100.0, 60.0),
                1.154_226_397_147_367,
                1.154_481_126_139_61,
            ),
            (ray(35.0, 100.0, 90.0), 1.0, 1.0),
            (
                ray(-80.0, 1000.0, 75.0),
                1.035_186_155_749_051,
                1.035_230_548_304_367,
            ),
            (
                ray(10.0, 0.0, 75.0),
                1.035_181_919_429_758,
                1.035_233_200_318_21,
            ),
        ] {
            let (found_dry, found_wet) = mapping(&ray, day);
            assert!((found_dry - dry).abs() < 1e-8, "{found_dry} {dry}");
            assert!((found_wet - wet).abs() < 1e-8, "{found_wet} {wet}");
        }
    }

    #[test]
    fn no_air_no_delay() {
        assert_eq!(delay_m(&ray(10.0, 6e4, 40.0), 0.0), 0.0);
        assert_eq!(delay_m(&ray(10.0, 0.0, -1.0), 0.0), 0.0);
        assert!(delay_m(&ray(10.0, 0.0, 90.0), 0.0) > 2.3);
    }
}
