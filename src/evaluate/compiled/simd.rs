//! The interface of the processor's vectors: the operations of [`Lanes`] for kernels, and the rows of tables that they
//! read.
//!
//! A [`Kernel`] is written once over [`Lanes`]; `lanes` implements them for the vectors of each processor, `scalar` for
//! one double, and compiles the kernel for every width.

use std::ops::{Add, Mul, Sub};

/// Lanes of the widest vector; narrower ones leave the rest of an array unused.
pub const MAX_LANES: usize = 8;

/// The sign bit of a double.
pub const SIGN: u64 = 1 << 63;

/// A vector of doubles. All operations are those of IEEE 754, with one rounding each.
pub trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    const COUNT: usize;
    /// The eight doubles of a table row, in as many registers as they need.
    type Row: RowVector;

    /// Returns a vector with the same number in all lanes.
    fn splat(x: f64) -> Self;
    /// Loads the first numbers of a slice, which must hold as many as the vector has lanes.
    fn load(from: &[f64]) -> Self;
    /// Stores to the beginning of a slice, which must hold as many as the vector has lanes.
    fn store(self, to: &mut [f64]);
    /// True if a vector is a whole cache line, which can be stored past the caches.
    const FILLS_CACHE_LINE: bool = false;
    /// Stores past the caches if [`Self::FILLS_CACHE_LINE`] and the address is that of a line, else as [`Self::store`].
    /// A `lanes::store_fence` must follow.
    #[inline(always)]
    fn store_streaming(self, to: &mut [f64]) {
        self.store(to);
    }
    /// Returns `self + a * b` with one rounding.
    fn plus_times(self, a: Self, b: Self) -> Self;
    /// Returns `self - a * b` with one rounding.
    fn minus_times(self, a: Self, b: Self) -> Self;
    /// Returns `self / other`.
    fn quotient(self, other: Self) -> Self;
    /// Returns `yes` where `self < than`, else `no` (also where one is not a number).
    fn select_less(self, than: Self, yes: Self, no: Self) -> Self;
    /// Truncates to integers, for `0 <= x < 2^31`: as doubles and as indices.
    fn truncate(self) -> (Self, [u32; MAX_LANES]);
    fn to_array(self) -> [f64; MAX_LANES];
    /// Returns sine and cosine of an angle increased by quarter turns, whose number is `counted - 1.5 * 2^52`: the last
    /// bits of `counted` hold it.
    #[inline(always)]
    fn add_quarter_turns(counted: Self, sine: Self, cosine: Self) -> (Self, Self) {
        let (counted, mut sine, mut cosine) = (counted.to_array(), sine.to_array(), cosine.to_array());
        for lane in 0..Self::COUNT {
            let count = counted[lane].to_bits();
            let (s, c) = (sine[lane], cosine[lane]);
            let (s, c) = if count & 1 == 0 { (s, c) } else { (c, s) };
            sine[lane] = f64::from_bits(s.to_bits() ^ (count << 62 & SIGN));
            cosine[lane] = f64::from_bits(c.to_bits() ^ (count.wrapping_add(1) << 62 & SIGN));
        }
        (Self::load(&sine), Self::load(&cosine))
    }

    /// Transposes rows: lane i of vector k is element k of row i.
    fn transpose(rows: &[Self::Row; MAX_LANES]) -> [Self; 8];

    /// Returns `self`, its sign changed where the sign bit of `other` is set.
    #[inline(always)]
    fn with_sign_of(self, other: Self) -> Self {
        let (mut lanes, other) = (self.to_array(), other.to_array());
        for lane in 0..Self::COUNT {
            lanes[lane] = f64::from_bits(lanes[lane].to_bits() ^ (other[lane].to_bits() & SIGN));
        }
        Self::load(&lanes)
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.select_less(other, self, other)
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        other.select_less(self, self, other)
    }
}

/// A computation over vectors. Its `run` must be inlined: it is compiled once for each width.
pub trait Kernel {
    fn run<V: Lanes>(self);
}

/// One row of a table: a cache line, aligned, so that the widest vectors load it at once.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct TableRow(pub [f64; 8]);

/// A row of a table in as many vectors as it needs.
pub trait RowVector: Copy {
    fn of(row: &TableRow) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    /// Returns `self + other * factor`.
    fn plus_times(self, other: Self, factor: f64) -> Self;
}

impl<V: Lanes, const N: usize> RowVector for [V; N] {
    #[inline(always)]
    fn of(row: &TableRow) -> Self {
        let mut vectors = [V::splat(0.0); N];
        for k in 0..N {
            vectors[k] = V::load(&row.0[k * V::COUNT..]);
        }
        vectors
    }

    #[inline(always)]
    fn plus(mut self, other: Self) -> Self {
        for k in 0..N {
            self[k] = self[k] + other[k];
        }
        self
    }

    #[inline(always)]
    fn minus(mut self, other: Self) -> Self {
        for k in 0..N {
            self[k] = self[k] - other[k];
        }
        self
    }

    #[inline(always)]
    fn plus_times(mut self, other: Self, factor: f64) -> Self {
        let factor = V::splat(factor);
        for k in 0..N {
            self[k] = self[k].plus_times(other[k], factor);
        }
        self
    }
}
