//! Sine and cosine of degrees over vectors, with the same bits at any width.
//!
//! The angle is reduced in degrees, where quarter turns are exact. The remainder (at most 45 deg) goes into the
//! polynomials of FreeBSD's msun (`k_sin`, `k_cos`, S. Moshier's and Sun's coefficients), by Horner's scheme in fused
//! operations: within 1 ulp of the sine and cosine of the rest in radians.

use super::simd::Lanes;
use std::ops::{Mul, Sub};

#[allow(clippy::excessive_precision, reason = "as published")]
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_243_48e-1,
    8.333_333_333_322_489_461_24e-3,
    -1.984_126_982_985_794_931_34e-4,
    2.755_731_370_707_006_767_89e-6,
    -2.505_076_025_340_686_341_95e-8,
    1.589_690_995_211_550_102_21e-10,
];

#[allow(clippy::excessive_precision, reason = "as published")]
const COSINE: [f64; 6] = [
    4.166_666_666_666_660_190_37e-2,
    -1.388_888_888_887_410_957_49e-3,
    2.480_158_728_947_672_941_78e-5,
    -2.755_731_435_139_066_330_35e-7,
    2.087_572_321_298_174_827_9e-9,
    -1.135_964_755_778_819_482_65e-11,
];

/// One degree in radians.
pub const RADIAN: f64 = std::f64::consts::PI / 180.0;

/// 1.5 * 2^52: added to a number below 2^51 it leaves no bit for a fraction.
const COUNTER: f64 = 6_755_399_441_055_744.0;

/// Returns the nearest integers, ties to even, of numbers below 2^51.
#[inline(always)]
pub fn nearest<V: Lanes>(x: V) -> V {
    (x + V::splat(COUNTER)) - V::splat(COUNTER)
}

/// Returns sine and cosine of angles in degrees (below 1e9), exact at multiples of 90.
#[inline(always)]
pub fn sin_cos<V: Lanes>(degrees: V) -> (V, V) {
    let ([sine], [cosine]) = sines_cosines([degrees]);
    (sine, cosine)
}

/// Returns the sines and cosines of several vectors of angles in degrees: interleaved, one polynomial fills the latency
/// of another.
#[inline(always)]
pub fn sines_cosines<V: Lanes, const N: usize>(degrees: [V; N]) -> ([V; N], [V; N]) {
    let degrees = VectorArray(degrees);
    let counted = broadcast(COUNTER).plus_times(degrees, broadcast(1.0 / 90.0));
    let quarter = counted - broadcast(COUNTER);
    let rest = degrees.minus_times(quarter, broadcast(90.0)) * broadcast(RADIAN);
    let (VectorArray(mut s), VectorArray(mut c)) = (sine(rest), cosine(rest));
    for k in 0..N {
        (s[k], c[k]) = V::add_quarter_turns(counted.0[k], s[k], c[k]);
    }
    (s, c)
}

/// Several vectors with the same operations, interleaved.
#[derive(Clone, Copy)]
struct VectorArray<V, const N: usize>([V; N]);

/// Returns the same number in all lanes.
#[inline(always)]
fn broadcast<V: Lanes, const N: usize>(x: f64) -> VectorArray<V, N> {
    VectorArray([V::splat(x); N])
}

/// Applies an operation of [`Lanes`] to each of the vectors.
macro_rules! lanewise {
    ($name:ident, $($other:ident),+) => {
        #[inline(always)]
        fn $name(mut self, $($other: Self),+) -> Self {
            for k in 0..N {
                self.0[k] = self.0[k].$name($($other.0[k]),+);
            }
            self
        }
    };
}

impl<V: Lanes, const N: usize> VectorArray<V, N> {
    lanewise!(plus_times, a, b);
    lanewise!(minus_times, a, b);
}

impl<V: Lanes, const N: usize> Sub for VectorArray<V, N> {
    type Output = Self;
    lanewise!(sub, other);
}

impl<V: Lanes, const N: usize> Mul for VectorArray<V, N> {
    type Output = Self;
    lanewise!(mul, other);
}

/// Returns the sine of angles up to 45 deg, in rad: x plus a product, 0.65 ulp.
#[inline(always)]
fn sine<V: Lanes, const N: usize>(x: VectorArray<V, N>) -> VectorArray<V, N> {
    let z = x * x;
    x.plus_times(z * x, horner(&SINE, z))
}

/// Returns the cosine of angles up to 45 deg, in rad: 1 plus a product, 0.7 ulp.
#[inline(always)]
fn cosine<V: Lanes, const N: usize>(x: VectorArray<V, N>) -> VectorArray<V, N> {
    let z = x * x;
    let half = broadcast(-0.5).plus_times(z, horner(&COSINE, z));
    broadcast(1.0).plus_times(z, half)
}

#[inline(always)]
fn horner<V: Lanes, const N: usize>([a, b, c, d, e, f]: &[f64; 6], z: VectorArray<V, N>) -> VectorArray<V, N> {
    let mut sum = broadcast(*f);
    for term in [e, d, c, b, a] {
        sum = broadcast(*term).plus_times(sum, z);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::sin_cos_degrees;

    /// In units of the last place of the second one.
    fn ulps(a: f64, b: f64) -> u64 {
        a.to_bits().abs_diff(b.to_bits())
    }

    #[test]
    fn within_an_ulp_of_libm() {
        for i in -400_000..=400_000 {
            let angle = f64::from(i) * 0.001_234_567;
            let rest = angle - 90.0 * (angle / 90.0).round_ties_even();
            if rest.abs() < 45.0 {
                // 0.7 ulp of ours, and libm's may be 0.8: they differ by one at most.
                let ((s, c), (es, ec)) = (sin_cos(rest), libm::sincos(rest.to_radians()));
                assert!(ulps(s, es) <= 1 && ulps(c, ec) <= 1, "{rest}: {s} {es} {c} {ec}");
            }
            let ((s, c), (es, ec)) = (sin_cos(angle), sin_cos_degrees(angle));
            // Besides, the general reduction adds 360 to negative angles, which rounds them to half a last place of 360
            // deg.
            let bound = 1.7e-16 + if angle < 0.0 { 128.0 * f64::EPSILON * RADIAN } else { 0.0 };
            assert!((s - es).abs() <= bound && (c - ec).abs() <= bound, "{angle}: {s} {es} {c} {ec}");
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        for (angle, s, c) in
            [(0.0, 0.0, 1.0), (90.0, 1.0, 0.0), (180.0, 0.0, -1.0), (-90.0, -1.0, 0.0), (3690.0, 1.0, 0.0)]
        {
            assert_eq!(sin_cos::<f64>(angle), (s, c), "{angle}");
        }
    }
}
