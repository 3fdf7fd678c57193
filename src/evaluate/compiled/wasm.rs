//! Vectors of two doubles of WebAssembly with relaxed SIMD.
//!
//! Its multiply-add has one rounding or two, as the processor below has it. [`fuses`] asks which; with two roundings
//! the width is not taken, so that every number keeps its bits.

use super::simd::{Lanes, MAX_LANES};
use std::arch::wasm32::*;
use std::hint::black_box;
use std::ops::{Add, Mul, Sub};

/// True if both multiply-adds have one rounding.
pub fn fuses() -> bool {
    // (1 + e)^2 = 1 + 2e + e^2 needs more bits than a double has.
    let e = 2.0_f64.powi(-30);
    let (factor, near) = (black_box(f64x2_splat(1.0 + e)), black_box(f64x2_splat(1.0 + 2.0 * e)));
    let plus = f64x2_relaxed_madd(factor, factor, f64x2_neg(near));
    let minus = f64x2_relaxed_nmadd(factor, factor, near);
    F64x2(plus).to_array()[..2] == [e * e; 2] && F64x2(minus).to_array()[..2] == [-e * e; 2]
}

/// Two doubles.
#[derive(Clone, Copy)]
pub struct F64x2(v128);

impl Add for F64x2 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(f64x2_add(self.0, other.0))
    }
}

impl Sub for F64x2 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(f64x2_sub(self.0, other.0))
    }
}

impl Mul for F64x2 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(f64x2_mul(self.0, other.0))
    }
}

impl Lanes for F64x2 {
    const COUNT: usize = 2;
    type Row = [Self; 4];

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(f64x2_splat(x))
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from = &from[..2];
        Self(f64x2(from[0], from[1]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to = &mut to[..2];
        to[0] = f64x2_extract_lane::<0>(self.0);
        to[1] = f64x2_extract_lane::<1>(self.0);
    }
    #[inline(always)]
    fn plus_times(self, a: Self, b: Self) -> Self {
        Self(f64x2_relaxed_madd(a.0, b.0, self.0))
    }
    #[inline(always)]
    fn minus_times(self, a: Self, b: Self) -> Self {
        Self(f64x2_relaxed_nmadd(a.0, b.0, self.0))
    }
    #[inline(always)]
    fn quotient(self, other: Self) -> Self {
        Self(f64x2_div(self.0, other.0))
    }
    #[inline(always)]
    fn select_less(self, than: Self, yes: Self, no: Self) -> Self {
        Self(v128_bitselect(yes.0, no.0, f64x2_lt(self.0, than.0)))
    }
    #[inline(always)]
    fn truncate(self) -> (Self, [u32; MAX_LANES]) {
        let whole = i32x4_trunc_sat_f64x2_zero(self.0);
        let indices = [i32x4_extract_lane::<0>(whole) as u32, i32x4_extract_lane::<1>(whole) as u32];
        (Self(f64x2_convert_low_i32x4(whole)), [indices[0], indices[1], 0, 0, 0, 0, 0, 0])
    }
    #[inline(always)]
    fn to_array(self) -> [f64; MAX_LANES] {
        [f64x2_extract_lane::<0>(self.0), f64x2_extract_lane::<1>(self.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    }
    #[inline(always)]
    fn add_quarter_turns(counted: Self, sine: Self, cosine: Self) -> (Self, Self) {
        let (count, sign) = (counted.0, i64x2_splat(i64::MIN));
        // All bits where the number of turns is odd.
        let odd = i64x2_shr(i64x2_shl(count, 63), 63);
        let (s, c) = (v128_bitselect(cosine.0, sine.0, odd), v128_bitselect(sine.0, cosine.0, odd));
        let twos = v128_and(i64x2_shl(count, 62), sign);
        let next = v128_and(i64x2_shl(i64x2_add(count, i64x2_splat(1)), 62), sign);
        (Self(v128_xor(s, twos)), Self(v128_xor(c, next)))
    }
    #[inline(always)]
    fn transpose(rows: &[Self::Row; MAX_LANES]) -> [Self; 8] {
        let low = |k: usize| Self(i64x2_shuffle::<0, 2>(rows[0][k].0, rows[1][k].0));
        let high = |k: usize| Self(i64x2_shuffle::<1, 3>(rows[0][k].0, rows[1][k].0));
        [low(0), high(0), low(1), high(1), low(2), high(2), low(3), high(3)]
    }
}
