//! Ionospheric delay from broadcast parameters.

use std::f64::consts::PI;

use super::bdgim::Bdgim;
use super::geodesy::Geodetic;
use super::SPEED_OF_LIGHT_M_S;
use crate::{Error, Result};

const L1_HZ: f64 = 1_575.42e6;
const B1I_HZ: f64 = 1_561.098e6;
const DAY_S: f64 = 86_400.0;

/// A ray from a place on the ground to a satellite, angles in rad.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Where the receiver is.
    pub place: Geodetic,
    /// From north through east.
    pub azimuth: f64,
    /// Above the horizon.
    pub elevation: f64,
}

/// A model and its broadcast parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum Ionosphere {
    /// None: no delay.
    Off,
    /// Eight parameters in GPS's form: alpha, beta; s per power of a semicircle.
    KlobucharGps([f64; 8]),
    /// Eight parameters in BDS's form.
    KlobucharBds([f64; 8]),
    /// Nine parameters, TECU.
    Bdgim(Box<Bdgim>),
}

impl Ionosphere {
    /// From a name and its parameters: `none`, `G` or `C` (Klobuchar in GPS's or BDS's form), or
    /// `bdgim`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the name is unknown or the number of parameters wrong.
    pub fn new(name: &str, parameters: &[f64]) -> Result<Self> {
        let wrong = || {
            let count = parameters.len();
            Error::Invalid(format!("no ionosphere '{name}' with {count} parameters"))
        };
        let eight = || <[f64; 8]>::try_from(parameters).map_err(|_| wrong());
        match name {
            "none" => Ok(Self::Off),
            "G" => Ok(Self::KlobucharGps(eight()?)),
            "C" => Ok(Self::KlobucharBds(eight()?)),
            "bdgim" => {
                let nine = parameters.try_into().map_err(|_| wrong())?;
                Ok(Self::Bdgim(Box::new(Bdgim::new(nine))))
            }
            _ => Err(wrong()),
        }
    }

    /// Delay of a code at `carrier_hz`, in m; `gpst_s` is GPST since 1980-01-06.
    ///
    /// GPS's form takes the time of day of GPST, the others that of BDT.
    pub fn delay_m(&self, ray: &Ray, gpst_s: f64, carrier_hz: f64) -> f64 {
        let bdt_s = gpst_s - 14.0;
        match self {
            Self::Off => 0.0,
            Self::KlobucharGps(p) => {
                klobuchar_gps(p, ray, gpst_s.rem_euclid(DAY_S)) * (L1_HZ / carrier_hz).powi(2)
            }
            Self::KlobucharBds(p) => {
                klobuchar_bds(p, ray, bdt_s.rem_euclid(DAY_S)) * (B1I_HZ / carrier_hz).powi(2)
            }
            Self::Bdgim(model) => model.delay_m(ray, bdt_s, carrier_hz),
        }
    }
}

fn cubic(c: &[f64], x: f64) -> f64 {
    c[0] + x * (c[1] + x * (c[2] + x * c[3]))
}

/// Delay at L1 in m: IS-GPS-200, figure 20-4; angles are semicircles there.
fn klobuchar_gps(p: &[f64; 8], ray: &Ray, day_s: f64) -> f64 {
    let elevation = ray.elevation / PI;
    let psi = 0.0137 / (elevation + 0.11) - 0.022;
    let latitude = (ray.place.latitude / PI + psi * ray.azimuth.cos()).clamp(-0.416, 0.416);
    let longitude = ray.place.longitude / PI + psi * ray.azimuth.sin() / (latitude * PI).cos();
    let geomagnetic = latitude + 0.064 * ((longitude - 1.617) * PI).cos();
    let local = (4.32e4 * longitude + day_s).rem_euclid(DAY_S);
    let slant = 1.0 + 16.0 * (0.53 - elevation).powi(3);
    let amplitude = cubic(&p[..4], geomagnetic).max(0.0);
    let period = cubic(&p[4..], geomagnetic).max(72_000.0);
    let x = 2.0 * PI * (local - 50_400.0) / period;
    let bulge = if x.abs() < 1.57 {
        1.0 - x * x / 2.0 + x.powi(4) / 24.0
    } else {
        0.0
    };
    SPEED_OF_LIGHT_M_S * slant * (5e-9 + amplitude * bulge)
}

/// Delay at B1I in m: BDS-SIS-ICD-B1I-3.0, 5.2.4.7. Single layer at 375 km over a radius of
/// 6378 km, geographic latitude.
fn klobuchar_bds(p: &[f64; 8], ray: &Ray, day_s: f64) -> f64 {
    let (latitude, longitude, sin_zenith) = pierce_point(ray, 6_378.0, 375.0);
    let phi = latitude.abs() / PI;
    let local = (day_s + longitude * 43_200.0 / PI).rem_euclid(DAY_S);
    let amplitude = cubic(&p[..4], phi).max(0.0);
    let period = cubic(&p[4..], phi).clamp(72_000.0, 172_800.0);
    let since = local - 50_400.0;
    let day = since.abs() < period / 4.0;
    let bulge = if day {
        amplitude * (2.0 * PI * since / period).cos()
    } else {
        0.0
    };
    SPEED_OF_LIGHT_M_S * (5e-9 + bulge) / (1.0 - sin_zenith * sin_zenith).sqrt()
}

/// Where a ray meets a layer over a sphere, radius and height in km: latitude, longitude and the
/// sine of the ray's zenith angle there.
pub fn pierce_point(ray: &Ray, radius: f64, height: f64) -> (f64, f64, f64) {
    let sin_zenith = radius / (radius + height) * ray.elevation.cos();
    let psi = PI / 2.0 - ray.elevation - sin_zenith.asin();
    let (sin_psi, cos_psi) = psi.sin_cos();
    let (sin_b, cos_b) = ray.place.latitude.sin_cos();
    let sin_latitude = sin_b * cos_psi + cos_b * sin_psi * ray.azimuth.cos();
    // By both coordinates: over the pole the arc sine of the ICDs takes the wrong branch.
    let east = sin_psi * ray.azimuth.sin();
    let north = cos_psi * cos_b - sin_b * sin_psi * ray.azimuth.cos();
    (
        sin_latitude.clamp(-1.0, 1.0).asin(),
        ray.place.longitude + east.atan2(north),
        sin_zenith,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(latitude: f64, longitude: f64, azimuth: f64, elevation: f64) -> Ray {
        let place = Geodetic {
            latitude: latitude.to_radians(),
            longitude: longitude.to_radians(),
            height: 0.0,
        };
        Ray {
            place,
            azimuth: azimuth.to_radians(),
            elevation: elevation.to_radians(),
        }
    }

    /// Figures of RTKLIB's unit test of atmospheric models (t_atmos.c, utest1; BSD-2).
    #[test]
    fn gps_form_gives_published_delays() {
        let p = [
            0.2e-7, -0.8e-8, -0.5e-7, 0.1e-6, 0.2e6, 0.2e6, -0.1e6, -0.1e7,
        ];
        for (ray, hour, expected) in [
            (ray(35.0, 140.0, 60.0, 75.0), 1.0, 6.735_905_320_994_38),
            (ray(-80.0, -170.0, 60.0, 75.0), 1.0, 3.568_953_821_973_87),
            (ray(10.0, 30.0, 60.0, 75.0), 1.0, 3.807_164_356_551_61),
            (ray(35.0, 140.0, 60.0, 75.0), 13.0, 5.217_969_545_854_52),
            (ray(35.0, 140.0, 60.0, 75.0), 22.0, 5.901_905_392_647_77),
            (ray(35.0, 140.0, 190.0, 3.0), 1.0, 21.634_541_512_363_2),
            (ray(35.0, 140.0, 350.0, 60.0), 1.0, 7.338_442_788_225_61),
            (ray(35.0, 140.0, 0.0, 90.0), 1.0, 6.583_397_114_006_94),
        ] {
            let model = Ionosphere::new("G", &p).unwrap();
            let delay = model.delay_m(&ray, hour * 3600.0, L1_HZ);
            assert!((delay - expected).abs() < 1e-8, "{delay} {expected}");
        }
    }

    #[test]
    fn bds_form_peaks_at_14_hours_and_maps_with_the_zenith_angle() {
        let p = [2e-8, 0.0, 0.0, 0.0, 1e5, 0.0, 0.0, 0.0];
        let model = Ionosphere::new("C", &p).unwrap();
        let at = |hour: f64, elevation: f64| {
            model.delay_m(
                &ray(30.0, 0.0, 0.0, elevation),
                14.0 + hour * 3600.0,
                B1I_HZ,
            )
        };
        assert!((at(14.0, 90.0) - 25e-9 * SPEED_OF_LIGHT_M_S).abs() < 1e-12);
        assert!((at(2.0, 90.0) - 5e-9 * SPEED_OF_LIGHT_M_S).abs() < 1e-12);
        let sin = 6_378.0 / 6_753.0 * 10_f64.to_radians().cos();
        assert!((at(2.0, 10.0) / at(2.0, 90.0) - 1.0 / (1.0 - sin * sin).sqrt()).abs() < 1e-12);
        // A full cosine, a quarter of whose period is 25000 s.
        let quarter = at(14.0 + 12_500.0 / 3600.0, 90.0);
        let expected = (5e-9 + 2e-8 * 0.5_f64.sqrt()) * SPEED_OF_LIGHT_M_S;
        assert!((quarter - expected).abs() < 1e-9);
    }

    #[test]
    fn delay_falls_with_the_square_of_frequency() {
        for (name, count) in [("G", 8), ("C", 8), ("bdgim", 9)] {
            let mut p = vec![0.0; count];
            p[0] = if count == 9 { 20.0 } else { 2e-8 };
            let model = Ionosphere::new(name, &p).unwrap();
            let ray = ray(30.0, 100.0, 40.0, 20.0);
            let delay = |f| model.delay_m(&ray, 1.36e9, f);
            let ratio = delay(B1I_HZ) / delay(L1_HZ);
            assert!((ratio - (L1_HZ / B1I_HZ).powi(2)).abs() < 1e-12);
        }
        assert!(Ionosphere::new("G", &[0.0; 9]).is_err());
        assert!(Ionosphere::new("x", &[]).is_err());
    }
}
