//! The interface of the processor's vectors: what a kernel may do with [`Lanes`], and the rows of tables that it reads.
//!
//! A [`Kernel`] is written once over [`Lanes`]; `lanes` implements them for the vectors of each processor, `scalar` for one
//! double, and compiles the kernel for every width.

use std::ops::{Add, Mul, Sub};

/// Lanes of the widest vector; smaller ones leave the rest of an array unused.
pub const MAX_LANES: usize = 8;

/// The sign of a double.
pub const SIGN: u64 = 1 << 63;

/// Some doubles that are worked on at once.
pub trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// How many.
    const COUNT: usize;
    /// Eight doubles in as many registers as they need.
    type Row: RowVector;

    /// The same number in all lanes.
    fn splat(x: f64) -> Self;
    /// The first numbers of a slice (it must have as many).
    fn load(from: &[f64]) -> Self;
    /// To the beginning of a slice (it must be long enough).
    fn store(self, to: &mut [f64]);
    /// Is a vector a whole cache line, which can be stored past the caches?
    const FILLS_CACHE_LINE: bool = false;
    /// Likewise, past the caches if [`Self::FILLS_CACHE_LINE`] and the place is a line. [`store_fence`] must follow.
    #[inline(always)]
    fn store_streaming(self, to: &mut [f64]) {
        self.store(to);
    }
    /// `self + a * b` with one rounding.
    fn plus_times(self, a: Self, b: Self) -> Self;
    /// `self - a * b` with one rounding.
    fn minus_times(self, a: Self, b: Self) -> Self;
    /// Quotient.
    fn quotient(self, other: Self) -> Self;
    /// `yes` where `self < than`, else `no` (also where one is not a number).
    fn select_less(self, than: Self, yes: Self, no: Self) -> Self;
    /// Cut to whole numbers, for `0 <= x < 2^31`: as numbers and as indices.
    fn truncate(self) -> (Self, [u32; MAX_LANES]);
    /// Lane by lane.
    fn to_array(self) -> [f64; MAX_LANES];
    /// Sine and cosine of an angle, some quarter turns further: as many as the last bits of `counted` say
    /// (a whole number to which 1.5 * 2^52 has been added).
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

    /// Column k of the result holds element k of each row: lane i is row i.
    fn transpose(rows: &[Self::Row; MAX_LANES]) -> [Self; 8];

    /// The smaller one.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.select_less(other, self, other)
    }
    /// The larger one.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        other.select_less(self, self, other)
    }
}

/// Something to be computed over vectors. `run` must be inlined: it is compiled once for each width.
pub trait Kernel {
    /// The computation.
    fn run<V: Lanes>(self);
}

/// One row: as long as a cache line and aligned with it, so that of the widest vectors it is one load.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct TableRow(pub [f64; 8]);

/// A row in as many vectors as it needs.
pub trait RowVector: Copy {
    /// Of the table.
    fn of(row: &TableRow) -> Self;
    /// Sum.
    fn plus(self, other: Self) -> Self;
    /// Difference.
    fn minus(self, other: Self) -> Self;
    /// `self + other * factor`.
    fn plus_times(self, other: Self, factor: f64) -> Self;
}

impl<V: Lanes, const N: usize> RowVector for [V; N] {
    #[inline(always)]
    fn of(row: &TableRow) -> Self {
        let mut pieces = [V::splat(0.0); N];
        for k in 0..N {
            pieces[k] = V::load(&row.0[k * V::COUNT..]);
        }
        pieces
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
