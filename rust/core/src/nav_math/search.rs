//! Where and when a snapshot may have been taken, and from where to begin to look.

use nalgebra::Vector3;

use super::geodesy::{enu, WGS84};
use super::snapshot::Snapshot;

/// Beginnings lie so far apart that from the nearest one codes of 1 ms are told right: signals on
/// opposite sides of the sky then differ by 42 km and 12 km each from what is expected, less than
/// half a period (150 km) together.
const PLACE_STEP_M: f64 = 60e3;
const TIME_STEP_S: f64 = 30.0;
/// A solution may lie so much farther off than the uncertainty says.
const MARGIN: f64 = 1.5;
/// Where and when to search.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// Earth-fixed, m.
    pub place: Vector3<f64>,
    /// How far off it may be, m.
    pub place_uncertainty_m: f64,
    /// Of the snapshot, since the reference of the orbits, s.
    pub time_s: f64,
    /// How far off it may be, s.
    pub time_uncertainty_s: f64,
    /// GPST of the reference since 1980-01-06, s.
    pub reference_s: f64,
}

/// Where a search stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    pub place: Vector3<f64>,
    pub time_s: f64,
}

impl Search {
    pub(super) fn holds(&self, s: &Snapshot) -> bool {
        (s.position - self.place).norm() <= MARGIN * self.place_uncertainty_m.max(PLACE_STEP_M)
            && (s.time_s - self.time_s).abs() <= MARGIN * self.time_uncertainty_s.max(TIME_STEP_S)
    }
}

/// Places and times to begin with, on a raster as wide as the uncertainty.
pub(super) fn beginnings(search: &Search) -> Vec<Trial> {
    let local = enu(WGS84.geodetic(search.place)).transpose();
    let reach = |uncertainty: f64, step: f64| (uncertainty / step - 0.5).ceil().max(0.0) as i32;
    let places = reach(search.place_uncertainty_m, PLACE_STEP_M);
    let times = reach(search.time_uncertainty_s, TIME_STEP_S);
    let mut all = Vec::new();
    for (east, north) in square(places) {
        let shift = Vector3::new(f64::from(east), f64::from(north), 0.0) * PLACE_STEP_M;
        for step in -times..=times {
            all.push(Trial {
                place: search.place + local * shift,
                time_s: search.time_s + f64::from(step) * TIME_STEP_S,
            });
        }
    }
    all
}

fn square(reach: i32) -> impl Iterator<Item = (i32, i32)> {
    (-reach..=reach).flat_map(move |x| (-reach..=reach).map(move |y| (x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_beginning_is_near_wherever_the_truth_is() {
        let place = Vector3::new(-2e6, 4.4e6, 4e6);
        let (place_uncertainty_m, time_uncertainty_s) = (100e3, 60.0);
        let search = Search {
            place,
            place_uncertainty_m,
            time_s: 0.0,
            time_uncertainty_s,
            reference_s: 0.0,
        };
        let all = beginnings(&search);
        let local = enu(WGS84.geodetic(place)).transpose();
        for angle in 0..36 {
            let (sin, cos) = (f64::from(angle) * 0.1745).sin_cos();
            let truth = place + local * Vector3::new(sin, cos, 0.0) * place_uncertainty_m;
            for time_s in [-60.0, -17.0, 0.0, 44.0, 60.0] {
                let near = |t: &Trial| {
                    (t.place - truth).norm() < 43e3 && (t.time_s - time_s).abs() <= 15.0
                };
                assert!(all.iter().any(near), "{angle} {time_s}");
            }
        }
    }
}
