//! What is measured of a satellite, and what it should be at a place.

use nalgebra::Vector3;

use super::geodesy::{azimuth_elevation, enu, Geodetic, WGS84};
use super::ionosphere::{Ionosphere, Ray};
use super::orbit::{turn, SatelliteState};
use super::{troposphere, SPEED_OF_LIGHT_M_S};

/// One signal of a satellite at one instant.
#[derive(Debug, Clone)]
pub struct Measurement {
    /// Column of the observations.
    pub column: usize,
    /// Signals of the same satellite share it.
    pub satellite: usize,
    /// Which system's clock offset it contains.
    pub system: usize,
    /// Signals of one system that share a receiver delay share it.
    pub group: usize,
    /// Pseudorange without the signal's group delay, m.
    pub range_m: f64,
    /// Variance of the noise of `range_m`, m^2.
    pub variance: f64,
    /// Rate of the pseudorange, m/s; NaN where there is none.
    pub rate_m_s: f64,
    /// Variance of `rate_m_s`.
    pub rate_variance: f64,
    /// Carrier, Hz.
    pub carrier_hz: f64,
    /// At the instant of transmission.
    pub state: SatelliteState,
}

/// Settings of a whole batch.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Satellites below are left out, rad.
    pub elevation_mask: f64,
    /// Error that remains after the models of the atmosphere at the zenith, m; grows as the
    /// cosecant of elevation.
    pub zenith_sigma_m: f64,
    /// Ionosphere of each system.
    pub ionosphere: Vec<Ionosphere>,
    /// Whether the troposphere is modelled.
    pub troposphere: bool,
    /// PDOP from which a geometry is useless.
    pub max_pdop: f64,
    /// Largest weighted square sum of residuals by degrees of freedom, from 1 on.
    pub thresholds: Vec<f64>,
    /// Most satellites that RAIM leaves out.
    pub exclusions: usize,
}

/// Geometric range in m with the Earth turned during the travel, unit vector from satellite to
/// receiver, and the satellite's place in the Earth-fixed frame of reception.
///
/// The travel time depends on the range itself: three steps leave less than 1e-9 m.
pub fn geometry(
    state: &SatelliteState,
    receiver: Vector3<f64>,
) -> (f64, Vector3<f64>, Vector3<f64>) {
    let mut place = state.position;
    let mut range = (place - receiver).norm();
    for _ in 0..3 {
        place = turn(
            state.position,
            state.earth_rate * range / SPEED_OF_LIGHT_M_S,
        );
        range = (place - receiver).norm();
    }
    (range, (receiver - place) / range, place)
}

/// Rate of the geometric range for a receiver of some velocity (Earth-fixed), m/s.
///
/// The instant of transmission moves on by 1 - rate / c per second of reception.
pub fn range_rate(state: &SatelliteState, receiver: Vector3<f64>, velocity: Vector3<f64>) -> f64 {
    let (range, unit, place) = geometry(state, receiver);
    let travel = range / SPEED_OF_LIGHT_M_S;
    let motion = unit.dot(&turn(state.velocity, state.earth_rate * travel));
    let spin = unit.dot(&Vector3::new(place.y, -place.x, 0.0)) * state.earth_rate;
    (unit.dot(&velocity) - motion) / (1.0 + (spin - motion) / SPEED_OF_LIGHT_M_S)
}

/// What depends on the receiver's place only weakly: computed once for a place.
#[derive(Debug, Clone, Copy)]
pub struct Correction {
    /// Delay of the atmosphere, m.
    pub delay_m: f64,
    /// Variance of the whole range, m^2.
    pub variance: f64,
    /// rad; a right angle where the receiver's place is not known yet.
    pub elevation: f64,
}

impl Settings {
    /// Largest square sum of some degrees of freedom, one or more.
    pub fn threshold(&self, freedom: usize) -> f64 {
        self.thresholds[freedom.min(self.thresholds.len()) - 1]
    }

    /// Corrections at a place, `None` as long as it is not known to within the Earth's vicinity.
    pub fn correction(&self, m: &Measurement, at: Option<Vector3<f64>>, gpst_s: f64) -> Correction {
        let Some(receiver) = at else {
            let elevation = std::f64::consts::FRAC_PI_2;
            return Correction {
                delay_m: 0.0,
                variance: m.variance,
                elevation,
            };
        };
        let place = WGS84.geodetic(receiver);
        let ray = ray(place, m, receiver);
        let csc = 1.0 / ray.elevation.max(0.05).sin();
        Correction {
            delay_m: self.atmosphere_m(m, &ray, gpst_s),
            variance: m.variance + (self.zenith_sigma_m * csc).powi(2),
            elevation: ray.elevation,
        }
    }

    fn atmosphere_m(&self, m: &Measurement, ray: &Ray, gpst_s: f64) -> f64 {
        if ray.elevation <= 0.0 {
            return 0.0;
        }
        let ionosphere = self.ionosphere[m.system].delay_m(ray, gpst_s, m.carrier_hz);
        let troposphere = if self.troposphere {
            troposphere::delay_m(ray, gpst_s)
        } else {
            0.0
        };
        ionosphere + troposphere
    }
}

fn ray(place: Geodetic, m: &Measurement, receiver: Vector3<f64>) -> Ray {
    let (_, unit, _) = geometry(&m.state, receiver);
    let (azimuth, elevation) = azimuth_elevation(&enu(place), -unit);
    Ray {
        place,
        azimuth,
        elevation,
    }
}

/// Whether a place is near enough to the ground for elevations and delays to make sense.
pub fn near_ground(receiver: Vector3<f64>) -> bool {
    (6.3e6..6.9e6).contains(&receiver.norm())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overhead(longitude: f64) -> SatelliteState {
        let rate = 7.292_115e-5;
        SatelliteState {
            position: 2.6e7 * Vector3::new(longitude.cos(), longitude.sin(), 0.0),
            velocity: Vector3::new(100.0, -2900.0, 700.0),
            clock_s: 0.0,
            clock_drift: 0.0,
            earth_rate: rate,
        }
    }

    /// The receiver moves east during the travel: a satellite in the west is farther.
    #[test]
    fn the_earth_turns_away_from_the_west() {
        let receiver = Vector3::new(6.378e6, 0.0, 0.0);
        for (longitude, sign) in [(-1.0, 1.0), (1.0, -1.0)] {
            let state = overhead(longitude);
            let plain = (state.position - receiver).norm();
            let (range, ..) = geometry(&state, receiver);
            let cross = state.position.x * receiver.y - state.position.y * receiver.x;
            let sagnac = state.earth_rate / SPEED_OF_LIGHT_M_S * cross;
            assert!((range - plain) * sign > 20.0);
            assert!(
                (range - plain - sagnac).abs() < 2e-3,
                "{} {sagnac}",
                range - plain
            );
        }
    }

    #[test]
    fn range_rate_is_the_derivative_of_range() {
        let (receiver, velocity) = (Vector3::new(5e6, 3e6, 2e6), Vector3::new(20.0, -30.0, 5.0));
        let satellite = overhead(0.9);
        let range_at = |t: f64| {
            // Transmission before reception at t by the range at t.
            let place = receiver + velocity * t;
            let mut range = 2e7;
            for _ in 0..20 {
                let sent = t - (range - 2e7) / SPEED_OF_LIGHT_M_S;
                let mut state = satellite;
                state.position += satellite.velocity * sent;
                range = geometry(&state, place).0;
            }
            range
        };
        let base = range_at(0.0);
        let mut state = satellite;
        state.position += satellite.velocity * (-(base - 2e7) / SPEED_OF_LIGHT_M_S);
        let slope = (range_at(0.05) - range_at(-0.05)) / 0.1;
        assert!((range_rate(&state, receiver, velocity) - slope).abs() < 1e-6);
    }
}
