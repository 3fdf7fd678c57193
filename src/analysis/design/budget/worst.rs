//! The longest sum of vectors with any signs: the worst case of errors at their bounds.
//!
//! All sums lie in a zonotope; the longest is one of its corners, and every corner lies on a face whose
//! normal is perpendicular to two of the vectors. So for each pair: vectors beside the face have the
//! sign of their height, and those within it are searched in the plane, direction by direction.

use nalgebra::Vector3;

/// Below this sine a vector counts as lying within the plane.
const WITHIN: f64 = 1e-12;

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
    let bars: Vec<f64> = vectors.iter().map(|v| WITHIN * v.norm()).collect();
    let mut within = Vec::with_capacity(vectors.len());
    let mut best = 0.0_f64;
    for (i, a) in vectors.iter().enumerate() {
        for b in &vectors[i + 1..] {
            let normal = a.cross(b).normalize();
            let mut beside = Vector3::zeros();
            within.clear();
            for (w, bar) in vectors.iter().zip(&bars) {
                let height = w.dot(&normal);
                if height.abs() > *bar {
                    beside += w * 1.0_f64.copysign(height);
                } else {
                    within.push((0.0, *w));
                }
            }
            best = best.max(on_face(&beside, &mut within, [a, &normal]));
        }
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
        match merged.iter_mut().find(|m| m.cross(&v).norm() <= WITHIN * m.norm() * v.norm()) {
            Some(m) => *m += v * 1.0_f64.copysign(m.dot(&v)),
            None => merged.push(v),
        }
    }
    merged
}

/// Returns the longest sum of `beside` and the vectors within a plane with any signs; `along` is one of them. Each has
/// a place for its key.
#[cfg_attr(small_engine, optimize(speed))]
fn on_face(beside: &Vector3<f64>, within: &mut [(f64, Vector3<f64>)], [along, normal]: [&Vector3<f64>; 2]) -> f64 {
    let (u, v) = (along.normalize(), normal.cross(along).normalize());
    for (key, w) in &mut *within {
        // Turned into the upper half of the plane: its sign is free anyway.
        let (mut x, mut y) = (w.dot(&u), w.dot(&v));
        if y < 0.0 || (y == 0.0 && x < 0.0) {
            (x, y, *w) = (-x, -y, -*w);
        }
        // Rises with the angle in that half.
        *key = -x / (x.abs() + y);
    }
    within.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    // Around the corners: one vector after the other changes its sign.
    let mut sum = within.iter().fold(Vector3::zeros(), |sum, (_, w)| sum + w);
    let mut best = 0.0_f64;
    for (_, w) in within {
        best = best.max((beside + sum).norm()).max((beside - sum).norm());
        sum -= *w * 2.0;
    }
    best.max((beside + sum).norm())
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
