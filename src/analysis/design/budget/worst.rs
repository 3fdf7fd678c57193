//! The longest sum of vectors with any signs: the worst case of errors at their bounds.
//!
//! All sums lie in a zonotope; the longest is one of its corners, and every corner is the end of an edge along one of
//! the vectors. So for each vector: the others have the signs of their heights over a direction across it, and as that
//! turns one after the other changes its sign. That is a sort for each vector.

#![allow(clippy::needless_range_loop, reason = "kernels have plain loops: see `evaluate::compiled`")]

use crate::evaluate::{Kernel, Lanes, Width, run_kernel};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeSet;

/// Below this sine two vectors count as parallel.
const PARALLEL: f64 = 1e-12;

/// Relative rounding of sums and eigenvalues, far above what thousands of vectors have.
const ROUNDING: f64 = 1e-9;

/// Numbers of the largest vectors, and of directions spread over the sphere, from which an ascent starts; its steps.
const STARTS: usize = 64;
const DIRECTIONS: usize = 128;
const MAX_CLIMB: usize = 100;

/// Number of directions of an ascent is rounded up to a multiple of this: two of the widest vectors.
const SIDE_BY_SIDE: usize = 16;

/// Returns the length of the longest sum.
#[cfg_attr(small_engine, optimize(speed))]
pub fn longest(vectors: &[[f64; 3]]) -> f64 {
    let vectors: Vec<Vector3<f64>> = vectors.iter().map(|v| Vector3::from(*v)).filter(|v| v.norm() > 0.0).collect();
    let vectors = merge_parallel(vectors);
    if let [one] = vectors[..] {
        return one.norm();
    }
    let mut others = Vec::with_capacity(vectors.len());
    let mut best = 0.0_f64;
    for (i, edge) in vectors.iter().enumerate() {
        others.clear();
        others.extend(vectors.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, other)| (0.0, *other)));
        best = best.max(along_edges(edge, &mut others));
    }
    best
}

/// Returns a length that no sum exceeds. Along a unit vector u the longest sum has the height sum |v u|. Its square is
/// at most sum |v| times sum (v u)^2 / |v| (Cauchy, Schwarz): a quadratic form of u, whose largest eigenvalue counts.
pub fn upper_bound(vectors: &[[f64; 3]]) -> f64 {
    let (mut total, mut form) = (0.0, Matrix3::zeros());
    for v in vectors.iter().map(|v| Vector3::from(*v)) {
        let length = v.norm();
        if length > 0.0 {
            total += length;
            form += v * (v / length).transpose();
        }
    }
    (total * form.symmetric_eigenvalues().max()).sqrt() * (1.0 + ROUNDING)
}

/// Returns the length of the longest sum as an ascent finds it from the largest vectors and from directions spread over
/// the sphere, for more vectors than [`longest`] takes: their signs are those along the sum, until no sign changes.
pub fn longest_by_ascent(vectors: &[[f64; 3]]) -> f64 {
    let vectors: Vec<Vector3<f64>> = vectors.iter().map(|v| Vector3::from(*v)).filter(|v| v.norm() > 0.0).collect();
    let mut starts = vectors.clone();
    starts.sort_by(|a, b| b.norm_squared().total_cmp(&a.norm_squared()));
    starts.truncate(STARTS);
    starts.extend((0..DIRECTIONS).map(spiral));
    let mut sums = sums_along(&vectors, &starts);
    let mut seen = BTreeSet::new();
    let mut best = 0.0_f64;
    for _ in 0..MAX_CLIMB {
        // From the same sum all climbs go on alike.
        sums.retain(|sum| seen.insert(<[f64; 3]>::from(*sum).map(f64::to_bits)));
        let next = sums_along(&vectors, &sums);
        let higher = |(next, sum): (&Vector3<f64>, &Vector3<f64>)| next.norm_squared() > sum.norm_squared();
        best = sums.iter().map(Vector3::norm).fold(best, f64::max);
        sums = next.iter().zip(&sums).filter(|pair| higher(*pair)).map(|(next, _)| *next).collect();
        if sums.is_empty() {
            break;
        }
    }
    sums.iter().map(Vector3::norm).fold(best, f64::max)
}

/// Returns the sums of vectors, each with the sign that it has along a direction, one for every direction.
fn sums_along(vectors: &[Vector3<f64>], directions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let places = directions.len().next_multiple_of(SIDE_BY_SIDE);
    let column = |k: usize| (0..places).map(|i| directions.get(i).map_or(0.0, |u| u[k])).collect();
    let mut columns: [Vec<f64>; 3] = [column(0), column(1), column(2)];
    run_kernel(Width::widest(), SumsAlong { vectors, columns: &mut columns });
    (0..directions.len()).map(|i| Vector3::new(columns[0][i], columns[1][i], columns[2][i])).collect()
}

/// Replaces directions, in columns, by the sums along them.
struct SumsAlong<'a> {
    vectors: &'a [Vector3<f64>],
    columns: &'a mut [Vec<f64>; 3],
}

impl Kernel for SumsAlong<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        // Two at a time: the sum of one waits for the sum before it.
        const PAIR: usize = 2;
        let [x, y, z] = self.columns;
        for first in (0..x.len()).step_by(PAIR * V::COUNT) {
            let mut along = [[V::splat(0.0); 3]; PAIR];
            let mut sums = along;
            for i in 0..PAIR {
                let at = first + i * V::COUNT;
                along[i] = [V::load(&x[at..]), V::load(&y[at..]), V::load(&z[at..])];
            }
            for v in self.vectors {
                let [a, b, c] = [V::splat(v[0]), V::splat(v[1]), V::splat(v[2])];
                for i in 0..PAIR {
                    let height = a * along[i][0] + b * along[i][1] + c * along[i][2];
                    sums[i][0] = sums[i][0] + a.with_sign_of(height);
                    sums[i][1] = sums[i][1] + b.with_sign_of(height);
                    sums[i][2] = sums[i][2] + c.with_sign_of(height);
                }
            }
            for i in 0..PAIR {
                let at = first + i * V::COUNT;
                sums[i][0].store(&mut x[at..]);
                sums[i][1].store(&mut y[at..]);
                sums[i][2].store(&mut z[at..]);
            }
        }
    }
}

/// Returns the i-th of [`DIRECTIONS`] unit vectors along a spiral over the half sphere, nearly even.
fn spiral(i: usize) -> Vector3<f64> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let z = (i as f64 + 0.5) / DIRECTIONS as f64;
    let (sin, cos) = libm::sincos(GOLDEN_ANGLE * i as f64);
    Vector3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + Vector3::z() * z
}

/// Returns the vectors with parallel ones added up.
fn merge_parallel(vectors: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
    let mut merged: Vec<Vector3<f64>> = Vec::new();
    for v in vectors {
        match merged.iter_mut().find(|m| m.cross(&v).norm() <= PARALLEL * m.norm() * v.norm()) {
            Some(m) => *m += v * 1.0_f64.copysign(m.dot(&v)),
            None => merged.push(v),
        }
    }
    merged
}

/// Returns the length of the longest sum at an end of the edges along a vector. Each of the others, none of them
/// parallel to it, has a place for its key.
#[cfg_attr(small_engine, optimize(speed))]
fn along_edges(edge: &Vector3<f64>, others: &mut [(f64, Vector3<f64>)]) -> f64 {
    let u = edge.cross(&Vector3::ith(edge.iamin(), 1.0)).normalize();
    let v = edge.cross(&u).normalize();
    for (key, w) in &mut *others {
        // Turned into the upper half of the plane across the edge: its sign is free anyway.
        let (mut x, mut y) = (w.dot(&u), w.dot(&v));
        if y < 0.0 || (y == 0.0 && x < 0.0) {
            (x, y, *w) = (-x, -y, -*w);
        }
        // Rises with the angle in that half.
        *key = -x / (x.abs() + y);
    }
    others.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = others.iter().fold(Vector3::zeros(), |sum, (_, w)| sum + w);
    let longer = |sum: &Vector3<f64>| (edge + sum).norm_squared().max((edge - sum).norm_squared());
    let mut best = longer(&sum);
    for (_, w) in others {
        sum -= *w * 2.0;
        best = best.max(longer(&sum));
    }
    best.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_all_signs(vectors: &[[f64; 3]]) -> f64 {
        let sum = |signs: u32| {
            let signed = |(k, v): (usize, &[f64; 3])| Vector3::from(*v) * if signs >> k & 1 == 0 { 1.0 } else { -1.0 };
            vectors.iter().enumerate().map(signed).sum::<Vector3<f64>>().norm()
        };
        (0..1 << vectors.len()).map(sum).fold(0.0, f64::max)
    }

    /// Whole numbers of at most 2^23.
    fn whole_numbers() -> impl FnMut() -> i64 {
        let mut state = 7_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as i64 - (1 << 23)
        }
    }

    #[test]
    fn sums_along_directions_are_the_same_at_every_width() {
        let mut next = whole_numbers();
        // Halved until many are 0, with both signs: where a vector lies across a direction its sign is that of 0.
        let mut number = || (next() >> 21) as f64 * if next() < 0 { 0.1 } else { -0.1 };
        let mut vector = |_| Vector3::new(number(), number(), number());
        let (vectors, directions): (Vec<_>, Vec<_>) =
            ((0..99).map(&mut vector).collect(), (0..32).map(vector).collect());
        for width in Width::ALL.into_iter().filter(|width| width.is_supported()) {
            let mut columns = [0, 1, 2].map(|k| directions.iter().map(|u| u[k]).collect());
            run_kernel(width, SumsAlong { vectors: &vectors, columns: &mut columns });
            for (i, u) in directions.iter().enumerate() {
                let sum = vectors.iter().fold(Vector3::zeros(), |sum, v| sum + v * v.dot(u).signum());
                let found = Vector3::from_fn(|k, _| columns[k][i]);
                assert_eq!(found.map(f64::to_bits), sum.map(f64::to_bits), "{width:?} {u}");
            }
        }
    }

    #[test]
    fn no_signs_make_a_longer_sum() {
        let mut next = whole_numbers();
        for count in 0..11 {
            for round in 0..30 {
                // Coarse numbers make parallel vectors and many of them in one plane.
                let coarse = 1 << [0, 21, 22, 23][round % 4];
                let vectors: Vec<[f64; 3]> =
                    (0..count).map(|_| std::array::from_fn(|_| (next() / coarse) as f64)).collect();
                let (found, brute) = (longest(&vectors), by_all_signs(&vectors));
                assert!((found - brute).abs() <= 1e-12 * brute.max(1.0), "{found} {brute} {vectors:?}");
                let climbed = longest_by_ascent(&vectors);
                let upper = upper_bound(&vectors);
                assert!(found <= upper && upper <= 1.0_f64.max(2.0 * found), "{upper} {found} {vectors:?}");
                assert!(climbed <= found * (1.0 + 1e-12) && climbed >= 0.97 * found, "{climbed} {found} {vectors:?}");
            }
        }
    }
}
