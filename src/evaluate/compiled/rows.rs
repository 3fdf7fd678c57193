//! Rows of a table, and what is computed with whole rows.

use super::lanes::Lanes;

/// One row: as long as a cache line and aligned with it, so that of the widest vectors it is one load.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Row(pub [f64; 8]);

/// A row in as many vectors as it needs.
pub trait Pieces: Copy {
    /// Of the table.
    fn of(row: &Row) -> Self;
    /// Sum.
    fn plus(self, other: Self) -> Self;
    /// Difference.
    fn minus(self, other: Self) -> Self;
    /// `self + other * factor`.
    fn plus_times(self, other: Self, factor: f64) -> Self;
}

impl<V: Lanes, const N: usize> Pieces for [V; N] {
    #[inline(always)]
    fn of(row: &Row) -> Self {
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
