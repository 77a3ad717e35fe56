//! Dilution of precision: how geometry turns range errors of 1 m into errors of the solution.

use nalgebra::{DMatrix, DVector, Vector3};

use super::geodesy::{enu, WGS84};
use super::least_squares::inverse_normal;

/// Geometric, position, horizontal, vertical and time dilution; time is that of the first clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dop {
    /// Position and all clocks.
    pub gdop: f64,
    /// Position.
    pub pdop: f64,
    /// East and north.
    pub hdop: f64,
    /// Up.
    pub vdop: f64,
    /// First clock.
    pub tdop: f64,
}

impl Dop {
    /// NaN where there is none.
    pub const NONE: Self = Self {
        gdop: f64::NAN,
        pdop: f64::NAN,
        hdop: f64::NAN,
        vdop: f64::NAN,
        tdop: f64::NAN,
    };

    /// Of a design whose columns are position, `systems` clocks and biases, every measurement
    /// weighed alike.
    pub fn of(design: &DMatrix<f64>, systems: usize, place: Vector3<f64>) -> Self {
        let equal = DVector::from_element(design.nrows(), 1.0);
        let Some(shape) = inverse_normal(design, &equal) else {
            return Self::NONE;
        };
        let local = enu(WGS84.geodetic(place));
        let position = local * shape.fixed_view::<3, 3>(0, 0) * local.transpose();
        let clocks: f64 = (0..systems).map(|k| shape[(3 + k, 3 + k)]).sum();
        Self {
            gdop: (position.trace() + clocks).sqrt(),
            pdop: position.trace().sqrt(),
            hdop: (position[(0, 0)] + position[(1, 1)]).sqrt(),
            vdop: position[(2, 2)].sqrt(),
            tdop: shape[(3, 3)].sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::RowVector4;

    use super::*;

    /// One satellite at the zenith and three at the horizon, 120 degrees apart.
    #[test]
    fn the_textbook_geometry() {
        let place = Vector3::new(6_378_137.0, 0.0, 0.0);
        let thirds = [0.0_f64, 120.0, 240.0].map(f64::to_radians);
        let mut design = DMatrix::from_element(4, 4, 1.0);
        design
            .row_mut(0)
            .copy_from(&RowVector4::new(-1.0, 0.0, 0.0, 1.0));
        for (row, azimuth) in thirds.iter().enumerate() {
            let (sin, cos) = azimuth.sin_cos();
            design
                .row_mut(row + 1)
                .copy_from(&RowVector4::new(0.0, -sin, -cos, 1.0));
        }
        let dop = Dop::of(&design, 1, place);
        assert!((dop.hdop - 2.0 / 3_f64.sqrt()).abs() < 1e-12);
        assert!((dop.vdop - (4.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((dop.tdop - (1.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((dop.gdop - 3_f64.sqrt()).abs() < 1e-12);
        assert!(Dop::of(&DMatrix::zeros(4, 4), 1, place).gdop.is_nan());
    }
}
