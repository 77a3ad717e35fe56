//! Where the running sums lie in memory.
//!
//! The sum before sample k is in plane k mod 8, row k / 8: edges stay exact to the sample, and
//! eight taps 8 samples apart are eight neighbours in memory, one load of a vector unit. The rows
//! are a ring; its first rows are repeated behind the last, so that no load has to wrap.

/// Planes, and taps in one load.
pub const LANES: usize = 8;
/// Samples that front ends take in one step.
pub const BLOCK: usize = 128;
/// The most samples that the runs of one step of a correlator may span. Those of full scale then
/// stay within 32 bits: 2^12 times 2^15 sqrt(2) times the oscillator's 127, in units of 2^4.
pub(crate) const LONGEST_STEP: usize = 4096;
/// Rows behind each plane: the repeated ones, and some that keep planes off the same cache sets.
const PAD: usize = 24;

/// One running sum: I and Q, each modulo 2^32.
pub(crate) type Sum = [i32; 2];

/// Where sums begin: only differences mean anything, and I in the middle of its range spares the
/// portable front end the wrap.
pub(crate) const ORIGIN: Sum = [i32::MIN, 0];

/// Bits that running totals have below those of the sums. Products of 16-bit samples fill them,
/// so that the sums of [`LONGEST_STEP`] samples stay within 32 bits and nothing is rounded but
/// the sums.
pub(crate) const TOTAL_BITS: u32 = 4;

/// A running sum before it is rounded: I and Q.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Total([i64; 2]);

impl From<Sum> for Total {
    #[inline(always)]
    fn from(sum: Sum) -> Self {
        Total(sum.map(|s| i64::from(s) << TOTAL_BITS))
    }
}

impl Total {
    #[inline(always)]
    pub(crate) fn sum(self) -> Sum {
        self.0.map(|t| (t >> TOTAL_BITS) as i32)
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, [i, q]: [i32; 2]) {
        self.0[0] = self.0[0].wrapping_add(i64::from(i));
        self.0[1] = self.0[1].wrapping_add(i64::from(q));
    }
}

/// The running sums of a band.
#[derive(Debug)]
pub(crate) struct Ring {
    cells: Vec<Sum>,
    /// First cell that is aligned to a vector.
    first: usize,
    rows: usize,
}

/// The cells of a ring, for the kernels.
///
/// Invariants, checked by [`Geometry::check`] at the kernels' doors: `rows` is a power of two,
/// a plane is longer than that by at least [`LANES`], and there are [`LANES`] planes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Geometry {
    pub(crate) rows: usize,
    pub(crate) stride: usize,
}

impl Geometry {
    /// # Panics
    /// If a kernel could leave a buffer of `cells` cells.
    #[inline]
    pub(crate) fn check(self, cells: usize) {
        assert!(
            self.rows.is_power_of_two()
                && self.rows.is_multiple_of(BLOCK / LANES)
                && self.stride >= self.rows + LANES
                && self.stride <= cells / LANES,
            "a ring of the wrong shape"
        );
    }

    /// Cell of the sum before sample `k`.
    #[inline(always)]
    pub(crate) fn cell(self, k: u64) -> usize {
        (k as usize & (LANES - 1)) * self.stride + self.row(k)
    }

    #[inline(always)]
    pub(crate) fn row(self, k: u64) -> usize {
        (k >> LANES.trailing_zeros()) as usize & (self.rows - 1)
    }
}

impl Ring {
    /// A ring that holds at least `samples` sums, as if nothing but zeros had been absorbed.
    pub(crate) fn new(samples: usize) -> Self {
        let rows = samples.div_ceil(LANES).next_power_of_two().max(BLOCK);
        let mut ring = Ring {
            cells: vec![ORIGIN; LANES * (rows + PAD) + LANES],
            first: 0,
            rows,
        };
        // Vector stores that straddle two cache lines would cost twice.
        let offset = ring.cells.as_ptr().align_offset(64);
        ring.first = if offset < LANES { offset } else { 0 };
        ring
    }

    /// Sums held.
    pub(crate) fn capacity(&self) -> usize {
        self.rows * LANES
    }

    pub(crate) fn geometry(&self) -> Geometry {
        Geometry {
            rows: self.rows,
            stride: self.rows + PAD,
        }
    }

    pub(crate) fn cells(&self) -> &[Sum] {
        &self.cells[self.first..]
    }

    pub(crate) fn cells_mut(&mut self) -> &mut [Sum] {
        &mut self.cells[self.first..]
    }

    /// Stores the sum before sample `k`.
    #[inline(always)]
    pub(crate) fn store(&mut self, k: u64, sum: Sum) {
        let geometry = self.geometry();
        let cell = geometry.cell(k);
        let repeated = geometry.row(k) < LANES;
        let cells = self.cells_mut();
        cells[cell] = sum;
        if repeated {
            cells[cell + geometry.rows] = sum;
        }
    }

    /// Repeats the first rows behind the last; after they have been written block-wise.
    pub(crate) fn repeat_first_rows(&mut self) {
        let Geometry { rows, stride } = self.geometry();
        for plane in self.cells_mut().chunks_exact_mut(stride).take(LANES) {
            plane.copy_within(..LANES, rows);
        }
    }
}
