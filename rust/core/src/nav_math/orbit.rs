//! Orbit and clock from broadcast Keplerian elements.
//!
//! Sources: IS-GPS-200, 20.3.3.3.3.1 and table 20-IV (GPS); BDS-SIS-ICD-B1I-3.0, 5.2.4.10 and
//! 5.2.4.12 (D1, D2, geostationary satellites included); BDS-SIS-ICD-B1C-1.0, 7.5.2 and 7.7.3
//! (B-CNAV1). One set of formulas serves all: `a_dot` and `delta_n_dot` are 0 where a message has
//! none. Velocity is the exact derivative of position.

use nalgebra::Vector3;

use super::kepler::InPlane;
use super::SPEED_OF_LIGHT_M_S;
use crate::{Error, Result};

/// Values in a row of the table of ephemerides; see [`Orbit::from_row`].
pub const COLUMNS: usize = 24;

/// Inclination of the frame in which elements of geostationary BDS satellites are given.
const GEO_TILT_RAD: f64 = -5.0 * std::f64::consts::PI / 180.0;

/// Which system's constants and formulas hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// GPS: WGS-84.
    Gps,
    /// BDS in medium or inclined geosynchronous orbit: CGCS2000.
    Bds,
    /// BDS in geostationary orbit.
    BdsGeo,
}

impl Model {
    fn of_code(code: f64) -> Result<Self> {
        match code as i64 {
            0 => Ok(Self::Gps),
            1 => Ok(Self::Bds),
            2 => Ok(Self::BdsGeo),
            _ => Err(Error::Invalid(format!("orbit model {code} is unknown"))),
        }
    }

    /// Gravitational constant of the Earth, m^3/s^2.
    pub fn mu(self) -> f64 {
        match self {
            Self::Gps => 3.986_005e14,
            Self::Bds | Self::BdsGeo => 3.986_004_418e14,
        }
    }

    /// Rotation rate of the Earth, rad/s.
    pub fn earth_rate(self) -> f64 {
        match self {
            Self::Gps => 7.292_115_146_7e-5,
            Self::Bds | Self::BdsGeo => 7.292_115_0e-5,
        }
    }
}

/// Where a satellite is and what its clock shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SatelliteState {
    /// Earth-fixed at that instant, m.
    pub position: Vector3<f64>,
    /// In the rotating frame, m/s.
    pub velocity: Vector3<f64>,
    /// Satellite clock minus system time, with relativity, without group delay, s.
    pub clock_s: f64,
    /// Its rate.
    pub clock_drift: f64,
    /// Rotation rate of the Earth in the satellite's system, rad/s.
    pub earth_rate: f64,
}

/// Elements of one ephemeris; angles in rad, lengths in m, times in s since a common reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    pub(super) model: Model,
    pub(super) toe_s: f64,
    pub(super) toe_tow_s: f64,
    pub(super) toc_s: f64,
    pub(super) clock: [f64; 3],
    pub(super) a: f64,
    pub(super) a_dot: f64,
    pub(super) e: f64,
    pub(super) m0: f64,
    pub(super) delta_n: f64,
    pub(super) delta_n_dot: f64,
    pub(super) omega0: f64,
    pub(super) i0: f64,
    pub(super) omega: f64,
    pub(super) omega_dot: f64,
    pub(super) i_dot: f64,
    /// Cosine and sine corrections of latitude, radius, inclination.
    pub(super) latitude: [f64; 2],
    pub(super) radius: [f64; 2],
    pub(super) inclination: [f64; 2],
}

impl Orbit {
    /// Reads `[model, toe_s, toe_tow_s, toc_s, a0, a1, a2, a, a_dot, e, m0, delta_n, delta_n_dot,
    /// omega0, i0, omega, omega_dot, i_dot, cuc, cus, crc, crs, cic, cis]`; model 0 is GPS, 1 BDS,
    /// 2 BDS geostationary; `toe_tow_s` is seconds of the system's own week.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the model is unknown, the eccentricity not in [0, 1), the axis not
    /// positive or any value not finite.
    pub fn from_row(row: &[f64]) -> Result<Self> {
        let v: &[f64; COLUMNS] = row.try_into().map_err(|_| {
            Error::Invalid(format!(
                "an ephemeris has {COLUMNS} values, not {}",
                row.len()
            ))
        })?;
        let orbit = Self {
            model: Model::of_code(v[0])?,
            toe_s: v[1],
            toe_tow_s: v[2],
            toc_s: v[3],
            clock: [v[4], v[5], v[6]],
            a: v[7],
            a_dot: v[8],
            e: v[9],
            m0: v[10],
            delta_n: v[11],
            delta_n_dot: v[12],
            omega0: v[13],
            i0: v[14],
            omega: v[15],
            omega_dot: v[16],
            i_dot: v[17],
            latitude: [v[18], v[19]],
            radius: [v[20], v[21]],
            inclination: [v[22], v[23]],
        };
        let sound =
            v.iter().all(|x| x.is_finite()) && orbit.a > 0.0 && (0.0..1.0).contains(&orbit.e);
        sound.then_some(orbit).ok_or_else(|| {
            Error::Invalid(format!("no orbit: axis {} m, eccentricity {}", v[7], v[9]))
        })
    }

    /// State at an instant of system time, in s since the table's reference.
    pub fn state(&self, time_s: f64) -> SatelliteState {
        let plane = InPlane::of(self, time_s - self.toe_s);
        let (position, velocity) = match self.model {
            Model::BdsGeo => self.geostationary(&plane, time_s - self.toe_s),
            Model::Gps | Model::Bds => {
                let rate = self.omega_dot - self.model.earth_rate();
                plane.turned(self.node(time_s - self.toe_s, rate), rate)
            }
        };
        let (clock_s, clock_drift) = self.clock(time_s - self.toc_s, &plane);
        SatelliteState {
            position,
            velocity,
            clock_s,
            clock_drift,
            earth_rate: self.model.earth_rate(),
        }
    }

    /// Longitude of the ascending node that moves at `rate` from its place at `toe`.
    fn node(&self, tk: f64, rate: f64) -> f64 {
        self.omega0 + rate * tk - self.model.earth_rate() * self.toe_tow_s
    }

    /// Elements of a geostationary satellite are inertial and tilted: turn by -5 degrees about X,
    /// then by the Earth's rotation since `toe` about Z (B1I-3.0, table 5-11).
    fn geostationary(&self, plane: &InPlane, tk: f64) -> (Vector3<f64>, Vector3<f64>) {
        let (position, velocity) = plane.turned(self.node(tk, self.omega_dot), self.omega_dot);
        let (sin, cos) = GEO_TILT_RAD.sin_cos();
        let tilt =
            |v: Vector3<f64>| Vector3::new(v.x, cos * v.y + sin * v.z, cos * v.z - sin * v.y);
        let rate = self.model.earth_rate();
        let position = turn(tilt(position), rate * tk);
        let spin = Vector3::new(position.y, -position.x, 0.0) * rate;
        (position, turn(tilt(velocity), rate * tk) + spin)
    }

    fn clock(&self, dt: f64, plane: &InPlane) -> (f64, f64) {
        let [a0, a1, a2] = self.clock;
        let c2 = SPEED_OF_LIGHT_M_S * SPEED_OF_LIGHT_M_S;
        let relativity = -2.0 * (self.model.mu() * self.a).sqrt() / c2 * self.e;
        (
            a0 + (a1 + a2 * dt) * dt + relativity * plane.sin_anomaly,
            a1 + 2.0 * a2 * dt + relativity * plane.cos_anomaly * plane.anomaly_rate,
        )
    }
}

/// Coordinates of a vector in a frame turned by `angle` about Z.
pub fn turn(v: Vector3<f64>, angle: f64) -> Vector3<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elements(model: f64) -> Vec<f64> {
        vec![
            model, 0.0, 345_600.0, 0.0, 1e-4, 2e-12, 1e-19, 2.79e7, 0.05, 0.02, 1.0, 4e-9, 1e-14,
            0.7, 0.96, -0.5, -7e-9, 1e-10, 1e-6, 8e-6, 200.0, -30.0, 1e-7, -8e-8,
        ]
    }

    #[test]
    fn velocity_and_drift_are_derivatives() {
        for model in [0.0, 1.0, 2.0] {
            let orbit = Orbit::from_row(&elements(model)).unwrap();
            for at in [-3600.0, -10.0, 0.0, 1800.0, 7200.0] {
                let (h, state) = (0.5, orbit.state(at));
                let (before, after) = (orbit.state(at - h), orbit.state(at + h));
                let slope = (after.position - before.position) / (2.0 * h);
                assert!((slope - state.velocity).norm() < 1e-4, "{model} {at}");
                let drift = (after.clock_s - before.clock_s) / (2.0 * h);
                assert!((drift - state.clock_drift).abs() < 1e-17 + 1e-6 * drift.abs());
            }
        }
    }

    #[test]
    fn broken_elements_are_refused() {
        let mut row = elements(0.0);
        row[9] = 1.2;
        assert!(Orbit::from_row(&row).is_err());
        row[9] = f64::NAN;
        assert!(Orbit::from_row(&row).is_err());
        assert!(Orbit::from_row(&elements(7.0)).is_err());
        assert!(Orbit::from_row(&row[..5]).is_err());
    }
}
