//! Earth-fixed coordinates: geodetic, local and topocentric.

use nalgebra::{Matrix3, Vector3};

/// A reference ellipsoid: semi-major axis in m and flattening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// Semi-major axis, m.
    pub a: f64,
    /// Flattening.
    pub f: f64,
}

/// NIMA TR8350.2, table 3.1.
pub const WGS84: Ellipsoid = Ellipsoid {
    a: 6_378_137.0,
    f: 1.0 / 298.257_223_563,
};
/// BDS-SIS-ICD-B1I-3.0, section 3.2.
pub const CGCS2000: Ellipsoid = Ellipsoid {
    a: 6_378_137.0,
    f: 1.0 / 298.257_222_101,
};

/// Latitude and longitude in rad, height above the ellipsoid in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    /// Positive north.
    pub latitude: f64,
    /// Positive east.
    pub longitude: f64,
    /// m.
    pub height: f64,
}

impl Ellipsoid {
    fn e2(self) -> f64 {
        self.f * (2.0 - self.f)
    }

    /// Earth-fixed coordinates of a place, m.
    pub fn ecef(self, place: Geodetic) -> Vector3<f64> {
        let (sin, cos) = place.latitude.sin_cos();
        let n = self.a / (1.0 - self.e2() * sin * sin).sqrt();
        let (sin_l, cos_l) = place.longitude.sin_cos();
        let level = (n + place.height) * cos;
        Vector3::new(
            level * cos_l,
            level * sin_l,
            (n * (1.0 - self.e2()) + place.height) * sin,
        )
    }

    /// Place of Earth-fixed coordinates: Bowring's iteration of the parametric latitude (Survey
    /// Review 23 (1976) 323), exact to below 1e-9 m from the surface to beyond the satellites.
    pub fn geodetic(self, r: Vector3<f64>) -> Geodetic {
        let level = r.x.hypot(r.y);
        let b = self.a * (1.0 - self.f);
        let bulge = self.e2() / (1.0 - self.e2());
        let mut beta = (r.z * self.a).atan2(level * b);
        let mut latitude = beta;
        for _ in 0..8 {
            let (sin, cos) = beta.sin_cos();
            latitude =
                (r.z + bulge * b * sin.powi(3)).atan2(level - self.e2() * self.a * cos.powi(3));
            let next = ((1.0 - self.f) * latitude.sin()).atan2(latitude.cos());
            let step = (next - beta).abs();
            beta = next;
            if step < 1e-16 {
                break;
            }
        }
        let (sin, cos) = latitude.sin_cos();
        let surface = self.a * (1.0 - self.e2() * sin * sin).sqrt();
        Geodetic {
            latitude,
            longitude: if level == 0.0 { 0.0 } else { r.y.atan2(r.x) },
            height: level * cos + r.z * sin - surface,
        }
    }
}

/// Rows east, north, up of a place: turns Earth-fixed vectors into local ones.
pub fn enu(place: Geodetic) -> Matrix3<f64> {
    let (sin_b, cos_b) = place.latitude.sin_cos();
    let (sin_l, cos_l) = place.longitude.sin_cos();
    Matrix3::new(
        -sin_l,
        cos_l,
        0.0,
        -sin_b * cos_l,
        -sin_b * sin_l,
        cos_b,
        cos_b * cos_l,
        cos_b * sin_l,
        sin_b,
    )
}

/// Azimuth in [0, 2 pi) from north through east and elevation, in rad, of a direction.
pub fn azimuth_elevation(local: &Matrix3<f64>, direction: Vector3<f64>) -> (f64, f64) {
    let d = local * direction;
    let azimuth = d.x.atan2(d.y).rem_euclid(std::f64::consts::TAU);
    // A tiny negative angle rounds up to a full turn.
    let azimuth = if azimuth < std::f64::consts::TAU {
        azimuth
    } else {
        0.0
    };
    (azimuth, d.z.atan2(d.x.hypot(d.y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for ellipsoid in [WGS84, CGCS2000] {
            for height in [-5e3, 0.0, 9e3, 4e5, 3.6e7] {
                for step in -90..=90 {
                    let place = Geodetic {
                        latitude: f64::from(step).to_radians(),
                        longitude: f64::from(2 * step).to_radians() * 0.999,
                        height,
                    };
                    let r = ellipsoid.ecef(place);
                    let back = ellipsoid.ecef(ellipsoid.geodetic(r));
                    assert!((back - r).norm() < 1e-7, "{place:?}");
                    assert!((ellipsoid.geodetic(r).height - height).abs() < 1e-7);
                }
            }
        }
    }

    #[test]
    fn directions() {
        let place = Geodetic {
            latitude: 0.7,
            longitude: 2.0,
            height: 0.0,
        };
        let local = enu(place);
        for (vector, azimuth, elevation) in [
            (Vector3::new(0.0, 1.0, 0.0), 0.0, 0.0),
            (Vector3::new(1.0, 0.0, 0.0), 90.0, 0.0),
            (Vector3::new(-1.0, 0.0, 1.0), 270.0, 45.0),
        ] {
            let (az, el) = azimuth_elevation(&local, local.transpose() * vector);
            assert!((az.to_degrees() - azimuth + 180.0).rem_euclid(360.0) - 180.0 < 1e-9);
            assert!((el.to_degrees() - elevation).abs() < 1e-9);
        }
        let up = local.transpose() * Vector3::new(0.0, 0.0, 1.0);
        let lifted = WGS84.ecef(Geodetic {
            height: 1.0,
            ..place
        }) - WGS84.ecef(place);
        assert!((lifted - up).norm() < 1e-9);
    }
}
