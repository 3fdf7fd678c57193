//! Sine and cosine of degrees over vectors, with the same bits at any width.
//!
//! The angle is reduced in degrees, where quarter turns are exact. On the rest (at most 45 deg) stand the
//! polynomials of FreeBSD's msun (`k_sin`, `k_cos`, S. Moshier's and Sun's coefficients, error below 1 ulp),
//! as in the crate libm: the results are libm's, to the bit, in scalar and in vector code alike.

use super::lanes::Lanes;
use super::links::splat;

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

/// Degrees in radians.
pub const RADIAN: f64 = std::f64::consts::PI / 180.0;

/// The nearest whole number, ties to even, for numbers below 2^51: adding 1.5 * 2^52 leaves no bit for a fraction.
#[inline(always)]
pub fn nearest<V: Lanes>(x: V) -> V {
    let magic = V::splat(6_755_399_441_055_744.0);
    (x + magic) - magic
}

/// Sine and cosine of an angle in degrees (below 1e9), exact at multiples of 90.
#[inline(always)]
pub fn sin_cos<V: Lanes>(degrees: V) -> (V, V) {
    let quarter = nearest(degrees * V::splat(1.0 / 90.0));
    let rest = (degrees - quarter * V::splat(90.0)) * V::splat(RADIAN);
    let (s, c) = (sine(rest), cosine(rest));
    // Which quarter, 0 to 3: a multiple of 1/4 less 3/8 is never a tie.
    let turns = nearest(quarter * V::splat(0.25) - V::splat(0.375));
    let which = quarter - turns * V::splat(4.0);
    let (plus, minus) = (V::splat(1.0), V::splat(-1.0));
    let upper = V::splat(1.5).if_less(which, V::splat(2.0), V::splat(0.0));
    let odd = which - upper;
    let half = V::splat(0.5);
    let off = which - V::splat(1.5);
    let sine_sign = V::splat(1.5).if_less(which, minus, plus);
    let cosine_sign = (off * off).if_less(plus, minus, plus);
    (half.if_less(odd, c, s) * sine_sign, half.if_less(odd, s, c) * cosine_sign)
}

/// Of an angle up to 45 deg, in rad.
#[inline(always)]
fn sine<V: Lanes>(x: V) -> V {
    let [s1, s2, s3] = splat::<V>(&[SINE[0], SINE[1], SINE[2]]);
    let [s4, s5, s6] = splat::<V>(&[SINE[3], SINE[4], SINE[5]]);
    let z = x * x;
    let w = z * z;
    let r = s2 + z * (s3 + z * s4) + z * w * (s5 + z * s6);
    x + z * x * (s1 + z * r)
}

/// Of an angle up to 45 deg, in rad.
#[inline(always)]
fn cosine<V: Lanes>(x: V) -> V {
    let [c1, c2, c3] = splat::<V>(&[COSINE[0], COSINE[1], COSINE[2]]);
    let [c4, c5, c6] = splat::<V>(&[COSINE[3], COSINE[4], COSINE[5]]);
    let one = V::splat(1.0);
    let z = x * x;
    let w = z * z;
    let r = z * (c1 + z * (c2 + z * c3)) + w * w * (c4 + z * (c5 + z * c6));
    let half = V::splat(0.5) * z;
    let w = one - half;
    w + (((one - w) - half) + z * r)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::sin_cos_degrees;

    #[test]
    fn the_bits_are_those_of_libm() {
        for i in -400_000..=400_000 {
            let angle = f64::from(i) * 0.001_234_567;
            let rest = angle - 90.0 * (angle / 90.0).round_ties_even();
            if rest.abs() < 45.0 {
                let (s, c) = sin_cos(rest);
                assert_eq!((s, c), libm::sincos(rest.to_radians()), "{rest}");
            }
            let ((s, c), (es, ec)) = (sin_cos(angle), sin_cos_degrees(angle));
            // The general reduction adds 360 to negative angles, which rounds them to half a last place of 360 deg.
            let bound = 1.2e-16 + if angle < 0.0 { 128.0 * f64::EPSILON * RADIAN } else { 0.0 };
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
