//! Vectors of three components, each of them a SIMD vector: lane i of all three belongs to pose i.

use super::simd::Lanes;

/// A vector or a point: x, y, z.
pub type Vector<V> = [V; 3];

/// Returns `a x b`.
#[inline(always)]
pub fn cross<V: Lanes>(a: Vector<V>, b: Vector<V>) -> Vector<V> {
    let products = [a[1] * b[2], a[2] * b[0], a[0] * b[1]];
    [products[0].minus_times(a[2], b[1]), products[1].minus_times(a[0], b[2]), products[2].minus_times(a[1], b[0])]
}

/// Returns `sum + a x b`.
#[inline(always)]
pub fn plus_cross<V: Lanes>(sum: Vector<V>, a: Vector<V>, b: Vector<V>) -> Vector<V> {
    let sum = [sum[0].plus_times(a[1], b[2]), sum[1].plus_times(a[2], b[0]), sum[2].plus_times(a[0], b[1])];
    [sum[0].minus_times(a[2], b[1]), sum[1].minus_times(a[0], b[2]), sum[2].minus_times(a[1], b[0])]
}

/// Returns `a + b`.
#[inline(always)]
pub fn plus<V: Lanes>(a: Vector<V>, b: Vector<V>) -> Vector<V> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Returns `a - b`.
#[inline(always)]
pub fn minus<V: Lanes>(a: Vector<V>, b: Vector<V>) -> Vector<V> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns `a * factor`.
#[inline(always)]
pub fn times<V: Lanes>(a: Vector<V>, factor: V) -> Vector<V> {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Returns `sum + a * factor`.
#[inline(always)]
pub fn plus_times<V: Lanes>(sum: Vector<V>, a: Vector<V>, factor: V) -> Vector<V> {
    [sum[0].plus_times(a[0], factor), sum[1].plus_times(a[1], factor), sum[2].plus_times(a[2], factor)]
}

/// Returns the same vector in all lanes.
#[inline(always)]
pub fn splat<V: Lanes>(a: &[f64; 3]) -> Vector<V> {
    [V::splat(a[0]), V::splat(a[1]), V::splat(a[2])]
}

/// Returns `a . b`.
#[inline(always)]
pub fn dot<V: Lanes>(a: Vector<V>, b: Vector<V>) -> V {
    (a[0] * b[0]).plus_times(a[1], b[1]).plus_times(a[2], b[2])
}
