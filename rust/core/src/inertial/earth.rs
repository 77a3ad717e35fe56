//! The Earth as an INS feels it: radii of curvature, rotation, and the turn of the local axes.

use nalgebra::Vector3;

use crate::nav_math::geodesy::WGS84;

/// Rotation rate, rad/s (NIMA TR8350.2, table 3.1).
pub const ROTATION_RATE: f64 = 7.292_115e-5;
/// First eccentricity squared of WGS 84.
pub const E2: f64 = WGS84.f * (2.0 - WGS84.f);

/// Radii of curvature at one place, the height included, with sine and cosine of the latitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Earth {
    /// Sine of the latitude.
    pub sin: f64,
    /// Cosine of the latitude.
    pub cos: f64,
    /// Of the meridian, plus height, m: metres to the north a radian of latitude.
    pub meridian: f64,
    /// Of the prime vertical, plus height, m.
    pub normal: f64,
    /// Their reciprocals, 1/m, and the tangent of the latitude: no division is needed twice.
    per_north: f64,
    per_east: f64,
    tan: f64,
}

impl Earth {
    /// At a latitude in rad and a height in m.
    #[inline]
    pub fn at(latitude: f64, height: f64) -> Self {
        let (sin, cos) = latitude.sin_cos();
        let squeeze = 1.0 / (1.0 - E2 * sin * sin);
        let radius = WGS84.a * squeeze.sqrt();
        let meridian = radius * (1.0 - E2) * squeeze + height;
        let normal = radius + height;
        Earth {
            sin,
            cos,
            meridian,
            normal,
            per_north: 1.0 / meridian,
            per_east: 1.0 / normal,
            tan: sin / cos,
        }
    }

    /// Gaussian mean of both radii, m.
    #[inline]
    pub fn mean(&self) -> f64 {
        (self.meridian * self.normal).sqrt()
    }

    /// Turn of the Earth against inertial space, in local axes, rad/s.
    #[inline]
    pub fn rotation(&self) -> Vector3<f64> {
        Vector3::new(ROTATION_RATE * self.cos, 0.0, -ROTATION_RATE * self.sin)
    }

    /// Turn of the local axes against the Earth at a velocity (north, east, down), rad/s.
    #[inline]
    pub fn transport(&self, velocity: &Vector3<f64>) -> Vector3<f64> {
        let east = velocity.y * self.per_east;
        Vector3::new(east, -velocity.x * self.per_north, -east * self.tan)
    }

    /// Change of latitude and longitude in rad along metres to the north and to the east.
    #[inline]
    pub fn angles(&self, north: f64, east: f64) -> [f64; 2] {
        [north * self.per_north, east * self.per_east / self.cos]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nav_math::geodesy::Geodetic;

    #[test]
    fn radii_are_metres_a_radian() {
        let (latitude, height, step) = (0.6, 400.0, 1e-5);
        let earth = Earth::at(latitude, height);
        let at = |latitude, longitude| {
            WGS84.ecef(Geodetic {
                latitude,
                longitude,
                height,
            })
        };
        let north = (at(latitude + step, 0.0) - at(latitude - step, 0.0)).norm() / (2.0 * step);
        let east = (at(latitude, step) - at(latitude, -step)).norm() / (2.0 * step);
        assert!((north / earth.meridian - 1.0).abs() < 1e-8);
        assert!((east / (earth.normal * earth.cos) - 1.0).abs() < 1e-8);
    }
}
