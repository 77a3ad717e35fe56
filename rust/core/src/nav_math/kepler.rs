//! Motion in the orbital plane, and Kepler's equation.

use nalgebra::Vector3;

use super::orbit::Orbit;

/// Place and motion within the orbital plane, and the plane's inclination.
pub(super) struct InPlane {
    pub sin_anomaly: f64,
    pub cos_anomaly: f64,
    pub anomaly_rate: f64,
    x: f64,
    y: f64,
    x_rate: f64,
    y_rate: f64,
    inclination: f64,
    inclination_rate: f64,
}

impl InPlane {
    pub fn of(o: &Orbit, tk: f64) -> Self {
        let a = o.a + o.a_dot * tk;
        let n0 = (o.model.mu() / o.a.powi(3)).sqrt();
        let mean = o.m0 + (n0 + o.delta_n + 0.5 * o.delta_n_dot * tk) * tk;
        let mean_rate = n0 + o.delta_n + o.delta_n_dot * tk;
        let (sin_e, cos_e) = eccentric_anomaly(mean, o.e).sin_cos();
        let share = 1.0 - o.e * cos_e;
        let anomaly_rate = mean_rate / share;
        let root = (1.0 - o.e * o.e).sqrt();
        // Argument of latitude and its rate, before corrections.
        let phi = (root * sin_e).atan2(cos_e - o.e) + o.omega;
        let phi_rate = root * anomaly_rate / share;
        let (sin2, cos2) = (2.0 * phi).sin_cos();
        let wave = |c: [f64; 2]| c[0] * cos2 + c[1] * sin2;
        let wave_rate = |c: [f64; 2]| 2.0 * phi_rate * (c[1] * cos2 - c[0] * sin2);
        let r = a * share + wave(o.radius);
        let r_rate = o.a_dot * share + a * o.e * sin_e * anomaly_rate + wave_rate(o.radius);
        let u_rate = phi_rate + wave_rate(o.latitude);
        let (sin_u, cos_u) = (phi + wave(o.latitude)).sin_cos();
        Self {
            sin_anomaly: sin_e,
            cos_anomaly: cos_e,
            anomaly_rate,
            x: r * cos_u,
            y: r * sin_u,
            x_rate: r_rate * cos_u - r * u_rate * sin_u,
            y_rate: r_rate * sin_u + r * u_rate * cos_u,
            inclination: o.i0 + o.i_dot * tk + wave(o.inclination),
            inclination_rate: o.i_dot + wave_rate(o.inclination),
        }
    }

    /// Position and velocity in the frame against which the node has longitude `node`.
    pub fn turned(&self, node: f64, node_rate: f64) -> (Vector3<f64>, Vector3<f64>) {
        let (sin_i, cos_i) = self.inclination.sin_cos();
        let (sin_n, cos_n) = node.sin_cos();
        let flat = self.y * cos_i;
        let flat_rate = self.y_rate * cos_i - self.y * sin_i * self.inclination_rate;
        let position = Vector3::new(
            self.x * cos_n - flat * sin_n,
            self.x * sin_n + flat * cos_n,
            self.y * sin_i,
        );
        let velocity = Vector3::new(
            self.x_rate * cos_n - flat_rate * sin_n - node_rate * position.y,
            self.x_rate * sin_n + flat_rate * cos_n + node_rate * position.x,
            self.y_rate * sin_i + self.y * cos_i * self.inclination_rate,
        );
        (position, velocity)
    }
}

/// Solves Kepler's equation M = E - e sin E for any e in [0, 1): Newton's steps, kept within
/// [M - e, M + e], where the root lies.
pub fn eccentric_anomaly(mean: f64, e: f64) -> f64 {
    let mean = mean - (mean / std::f64::consts::TAU).round() * std::f64::consts::TAU;
    let (mut low, mut high) = (mean - e, mean + e);
    let mut anomaly = mean + 0.85 * e * mean.sin().signum();
    for _ in 0..60 {
        let (sin, cos) = anomaly.sin_cos();
        let miss = anomaly - e * sin - mean;
        if miss > 0.0 {
            high = anomaly;
        } else {
            low = anomaly;
        }
        let newton = anomaly - miss / (1.0 - e * cos);
        let next = if (low..=high).contains(&newton) {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - anomaly).abs() <= 1e-15 * (1.0 + anomaly.abs()) {
            return next;
        }
        anomaly = next;
    }
    anomaly
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kepler_holds_for_any_eccentricity() {
        for e in [0.0, 1e-3, 0.1, 0.5, 0.9, 0.99] {
            for step in -400..400 {
                let mean = f64::from(step) * 0.031;
                let anomaly = eccentric_anomaly(mean, e);
                let turns = (anomaly - e * anomaly.sin() - mean) / std::f64::consts::TAU;
                assert!((turns - turns.round()).abs() < 1e-14, "{mean} {e}");
            }
        }
    }
}
