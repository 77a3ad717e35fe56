//! Normal numbers for the sensors of an IMU, a pure function of (seed, stream, number).

use nalgebra::Vector3;

use crate::simd::synth::Loops;
use crate::simd::Level;
use crate::synth::random::Noise;

/// Increments whose noise is drawn at once.
const BATCH: usize = 64;
/// Noises of an increment: three gyros, three accelerometers.
const AXES: usize = 6;

/// One noise after another, six at a time.
#[derive(Debug, Clone)]
pub(super) struct Draws {
    noise: Noise,
    loops: Loops,
    next: usize,
    values: [f32; BATCH * AXES],
}

impl Draws {
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        let mut draws = Draws {
            noise: Noise::new(seed, stream),
            loops: Loops::new(Level::best()),
            next: 0,
            values: [0.0; BATCH * AXES],
        };
        draws.fill();
        draws
    }

    /// Leaves out the next `count`.
    pub(super) fn skip(&mut self, count: usize) {
        self.next += count;
        self.fill();
    }

    /// The batch that holds the next.
    fn fill(&mut self) {
        let start = self.next / BATCH * BATCH * AXES;
        self.noise.fill(self.loops, start as i64, &mut self.values);
    }

    #[inline]
    pub(super) fn six(&mut self) -> [Vector3<f64>; 2] {
        let at = self.next % BATCH * AXES;
        let v = |k: usize| f64::from(self.values[at + k]);
        let six = [
            Vector3::new(v(0), v(1), v(2)),
            Vector3::new(v(3), v(4), v(5)),
        ];
        self.next += 1;
        if self.next.is_multiple_of(BATCH) {
            self.fill();
        }
        six
    }
}
