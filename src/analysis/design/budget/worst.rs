//! The longest sum of vectors with any signs: the worst case of errors at their bounds.
//!
//! All sums lie in a zonotope; the longest is one of its corners, and every corner is the end of an edge along one of
//! the vectors. So for each vector: the others have the signs of their heights over a direction across it, and as that
//! turns one after the other changes its sign. That is a sort for each vector.

use nalgebra::Vector3;

/// Below this sine two vectors count as parallel.
const PARALLEL: f64 = 1e-12;

/// Numbers of the largest vectors, and of directions spread over the sphere, from which an ascent starts; its steps.
const STARTS: usize = 64;
const DIRECTIONS: usize = 128;
const MAX_CLIMB: usize = 100;

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

/// Returns the length of the longest sum as an ascent finds it from the largest vectors and from directions spread over
/// the sphere, for more vectors than [`longest`] takes: their signs are those along the sum, until no sign changes.
pub fn longest_by_ascent(vectors: &[[f64; 3]]) -> f64 {
    let vectors: Vec<Vector3<f64>> = vectors.iter().map(|v| Vector3::from(*v)).filter(|v| v.norm() > 0.0).collect();
    let mut starts = vectors.clone();
    starts.sort_by(|a, b| b.norm_squared().total_cmp(&a.norm_squared()));
    starts.truncate(STARTS);
    starts.extend((0..DIRECTIONS).map(spiral));
    let sum_along = |u: &Vector3<f64>| vectors.iter().fold(Vector3::zeros(), |sum, v| sum + v * v.dot(u).signum());
    let climb = |start: &Vector3<f64>| {
        let mut sum = sum_along(start);
        for _ in 0..MAX_CLIMB {
            let next = sum_along(&sum);
            if next.norm_squared() <= sum.norm_squared() {
                break;
            }
            sum = next;
        }
        sum.norm()
    };
    starts.iter().map(climb).fold(0.0, f64::max)
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

    #[test]
    fn no_signs_make_a_longer_sum() {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as i64 - (1 << 23)
        };
        for count in 0..11 {
            for round in 0..30 {
                // Coarse numbers make parallel vectors and many of them in one plane.
                let coarse = 1 << [0, 21, 22, 23][round % 4];
                let vectors: Vec<[f64; 3]> =
                    (0..count).map(|_| std::array::from_fn(|_| (next() / coarse) as f64)).collect();
                let (found, brute) = (longest(&vectors), by_all_signs(&vectors));
                assert!((found - brute).abs() <= 1e-12 * brute.max(1.0), "{found} {brute} {vectors:?}");
                let climbed = longest_by_ascent(&vectors);
                assert!(climbed <= found * (1.0 + 1e-12) && climbed >= 0.97 * found, "{climbed} {found} {vectors:?}");
            }
        }
    }
}
