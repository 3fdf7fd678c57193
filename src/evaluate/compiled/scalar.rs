//! Vectors of one double: the width that every processor has.

use super::simd::{Lanes, MAX_LANES};

impl Lanes for f64 {
    const COUNT: usize = 1;
    type Row = [f64; 8];

    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
    #[inline(always)]
    fn plus_times(self, a: Self, b: Self) -> Self {
        a.mul_add(b, self)
    }
    #[inline(always)]
    fn minus_times(self, a: Self, b: Self) -> Self {
        (-a).mul_add(b, self)
    }
    #[inline(always)]
    fn quotient(self, other: Self) -> Self {
        self / other
    }
    #[inline(always)]
    fn select_less(self, than: Self, yes: Self, no: Self) -> Self {
        if self < than { yes } else { no }
    }
    #[inline(always)]
    fn truncate(self) -> (Self, [u32; MAX_LANES]) {
        let index = self as i32;
        (f64::from(index), [index as u32, 0, 0, 0, 0, 0, 0, 0])
    }
    #[inline(always)]
    fn to_array(self) -> [f64; MAX_LANES] {
        [self, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    }
    #[inline(always)]
    fn transpose(rows: &[[f64; 8]; MAX_LANES]) -> [Self; 8] {
        rows[0]
    }
}
