//! The minimum zone of a part: the rigid motion that leaves the smallest largest position deviation at some places.
//!
//! With B the effects of the motions, the fit is `min over x of max |d_i - B_i x|`, with lengths of vectors: a
//! program of second-order cones with six unknowns. Weights w of sum 1 give a lower bound of its square, the least
//! sum of w_i |d_i - B_i x|^2 over x, so a fit proves itself. A few places hold the largest deviation. The fit is
//! made on a set of places by Newton's method with a logarithmic barrier, whose multipliers are the weights; places
//! that exceed it join the set, until bound and largest deviation of all places meet.

use nalgebra::{Matrix3, Matrix6, SMatrix, SVector, SymmetricEigen, Vector3, Vector6};

/// The largest deviation may exceed its lower bound by this part; of 3000 random parts the worst did by 3e-9, where
/// rounding lowers the bound.
const GAP: f64 = 1e-9;

/// The same for the fit on a set of places.
const SET_GAP: f64 = 1e-10;

/// Below this part of the deviations what remains of them is rounding.
const ROUNDING: f64 = 1e-12;

/// Number of places in the first set, and of those that join it in a round.
const FIRST: usize = 24;
const JOINING: usize = 12;

/// Maximum numbers of rounds, and of Newton's steps in one.
const MAX_ROUNDS: usize = 200;
const MAX_STEPS: usize = 500;

/// Factor of the weight of the level from one centre to the next.
const GROWTH: f64 = 12.0;

/// Newton's decrement below which a centre counts as found, and from which on steps are full.
const CENTRED: f64 = 1e-3;
const FULL: f64 = 0.25;

/// Below this part of the largest an eigenvalue of the weighted places is zero.
const RANK: f64 = 1e-14;

/// The places of a part over which a minimum zone is made.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidZone {
    /// The places from their centre, mm.
    arms: Vec<Vector3<f64>>,
    /// Their centre, mm.
    centre: Vector3<f64>,
    /// Rotations as columns, of which the root of the mean square of the motions of the places is 1; zero where the
    /// places do not determine one.
    turns: Matrix3<f64>,
}

/// The fit of a minimum zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZoneMotion {
    /// Translation of the origin (mm) and rotation (rad).
    pub motion: Vector6<f64>,
    /// The largest deviation that remains, mm.
    pub largest: f64,
    /// Lower bound of the least largest deviation, mm.
    pub lower: f64,
}

/// Unknowns of the barrier: the motion and the level.
type Unknowns = SVector<f64, 7>;

/// A fit on a set of places.
struct SetFit {
    motion: Vector6<f64>,
    lower: f64,
}

impl RigidZone {
    /// Returns the zone over places (mm), one at least, with their centre and the roots of the inverse of their moment
    /// of inertia as columns, zero where they do not determine a rotation.
    pub fn new(places: &[Vector3<f64>], centre: Vector3<f64>, roots: &Matrix3<f64>) -> Self {
        let arms: Vec<Vector3<f64>> = places.iter().map(|place| place - centre).collect();
        let turns = roots * (arms.len() as f64).sqrt();
        Self { arms, centre, turns }
    }

    /// Returns the motion that leaves the smallest largest deviation of deviations (mm), one a place. Of several
    /// motions it is one: that to which the barrier leads from the least squares.
    pub fn fit(&self, deviations: &[Vector3<f64>]) -> ZoneMotion {
        let count = self.arms.len().min(deviations.len());
        let sum = (0..count).fold(Vector6::zeros(), |sum, i| sum + self.adjoint(i, &deviations[i]));
        // The columns are orthonormal over the places.
        let start = sum / count.max(1) as f64;
        let left: Vec<Vector3<f64>> = (0..count).map(|i| deviations[i] - self.effect(i, &start)).collect();
        let largest =
            |motion: &Vector6<f64>| (0..count).map(|i| (left[i] - self.effect(i, motion)).norm()).fold(0.0, f64::max);
        let scale = largest(&Vector6::zeros());
        let size = deviations.iter().map(Vector3::norm).fold(0.0, f64::max);
        let mut best = ZoneMotion { motion: Vector6::zeros(), largest: scale, lower: 0.0 };
        let mut set = joining(&(0..count).map(|i| left[i].norm()).collect::<Vec<_>>(), &[], 0.0, FIRST);
        for _ in 0..MAX_ROUNDS {
            if best.largest <= best.lower * (1.0 + GAP) || best.largest <= ROUNDING * size {
                break;
            }
            let SetFit { motion, lower } = self.fit_set(&set, &left, scale);
            best.lower = best.lower.max(lower);
            let lengths: Vec<f64> = (0..count).map(|i| (left[i] - self.effect(i, &motion)).norm()).collect();
            let over = lengths.iter().copied().fold(0.0, f64::max);
            if over < best.largest {
                best = ZoneMotion { motion, largest: over, ..best };
            }
            let more = joining(&lengths, &set, lower, JOINING);
            if more.is_empty() {
                break;
            }
            set.extend(more);
        }
        let motion = self.about_origin(&(start + best.motion));
        ZoneMotion { motion, ..best }
    }

    /// Returns the effect of a motion at a place.
    fn effect(&self, place: usize, motion: &Vector6<f64>) -> Vector3<f64> {
        let [shift, turn] = [motion.fixed_rows::<3>(0), motion.fixed_rows::<3>(3)];
        shift + (self.turns * turn).cross(&self.arms[place])
    }

    /// Returns the transpose of the effects at a place times a vector.
    fn adjoint(&self, place: usize, vector: &Vector3<f64>) -> Vector6<f64> {
        let turn = self.turns.tr_mul(&self.arms[place].cross(vector));
        Vector6::new(vector.x, vector.y, vector.z, turn.x, turn.y, turn.z)
    }

    /// Returns the effects at a place: rows of the deviation, columns of the motions.
    fn effects(&self, place: usize) -> SMatrix<f64, 3, 6> {
        let turns = -self.arms[place].cross_matrix() * self.turns;
        SMatrix::from_fn(|i, k| if k < 3 { f64::from(u8::from(i == k)) } else { turns[(i, k - 3)] })
    }

    /// Returns translation of the origin and rotation.
    fn about_origin(&self, motion: &Vector6<f64>) -> Vector6<f64> {
        let rotation = self.turns * motion.fixed_rows::<3>(3);
        let shift = motion.fixed_rows::<3>(0) - rotation.cross(&self.centre);
        Vector6::new(shift.x, shift.y, shift.z, rotation.x, rotation.y, rotation.z)
    }

    /// Returns the fit on a set of places, with its lower bound; `scale` is the size of the deviations (mm).
    fn fit_set(&self, set: &[usize], left: &[Vector3<f64>], scale: f64) -> SetFit {
        let rows: Vec<SMatrix<f64, 3, 6>> = set.iter().map(|place| self.effects(*place)).collect();
        let values: Vec<Vector3<f64>> = set.iter().map(|place| left[*place] / scale).collect();
        let mut barrier = Barrier { rows: &rows, values: &values, at: Unknowns::zeros(), weight: set.len() as f64 };
        barrier.at[6] = 1.1;
        let mut lower = 0.0_f64;
        for _ in 0..MAX_STEPS {
            let Some(decrement) = barrier.step() else { break };
            if decrement < CENTRED {
                // Close to the end rounding of the slacks, and so of the multipliers, lowers the bound.
                lower = lower.max(barrier.lower_bound());
                if set.len() as f64 <= barrier.weight * SET_GAP * barrier.at[6] {
                    break;
                }
                barrier.weight *= GROWTH;
            }
        }
        let motion = barrier.motion();
        SetFit { motion: motion * scale, lower: lower.max(barrier.lower_bound()) * scale }
    }
}

/// Returns the places with the largest lengths above a level that are not in a set, at most `count`, the largest first.
fn joining(lengths: &[f64], set: &[usize], level: f64, count: usize) -> Vec<usize> {
    let mut found: Vec<usize> = (0..lengths.len()).filter(|i| lengths[*i] > level && !set.contains(i)).collect();
    let order = |a: &usize, b: &usize| lengths[*b].total_cmp(&lengths[*a]).then(a.cmp(b));
    if found.len() > count {
        let _ = found.select_nth_unstable_by(count, order);
        found.truncate(count);
    }
    found.sort_by(order);
    found
}

/// The barrier `weight h - sum log(h^2 - |r_i|^2)`, with r = values - rows x.
struct Barrier<'a> {
    rows: &'a [SMatrix<f64, 3, 6>],
    values: &'a [Vector3<f64>],
    at: Unknowns,
    weight: f64,
}

impl Barrier<'_> {
    fn motion(&self) -> Vector6<f64> {
        self.at.fixed_rows::<6>(0).into_owned()
    }

    /// Returns what remains at each place, and the slack h^2 - |r|^2.
    fn residuals(&self) -> impl Iterator<Item = (&SMatrix<f64, 3, 6>, Vector3<f64>, f64)> {
        let (motion, level) = (self.motion(), self.at[6]);
        self.rows.iter().zip(self.values).map(move |(row, value)| {
            let left = value - row * motion;
            let length = left.norm();
            (row, left, (level - length) * (level + length))
        })
    }

    /// Takes a step of Newton, shorter where it is far from the centre; returns its decrement.
    fn step(&mut self) -> Option<f64> {
        let level = self.at[6];
        let (mut gradient, mut hessian) = (Unknowns::zeros(), SMatrix::<f64, 7, 7>::zeros());
        gradient[6] = self.weight;
        for (row, left, slack) in self.residuals() {
            let along = row.tr_mul(&left) * 2.0;
            let slope = Unknowns::from_fn(|k, _| if k < 6 { along[k] } else { 2.0 * level }) / slack;
            gradient -= slope;
            hessian += slope * slope.transpose();
            let bend = row.tr_mul(row) * (2.0 / slack);
            let mut block = hessian.fixed_view_mut::<6, 6>(0, 0);
            block += bend;
            hessian[(6, 6)] -= 2.0 / slack;
        }
        // A rotation that the places do not determine stays.
        (3..6).filter(|k| hessian[(*k, *k)] == 0.0).collect::<Vec<_>>().iter().for_each(|k| hessian[(*k, *k)] = 1.0);
        let step = hessian.cholesky()?.solve(&gradient);
        let decrement = step.dot(&gradient).max(0.0).sqrt();
        let factor = if decrement > FULL { 1.0 / (1.0 + decrement) } else { 1.0 };
        let before = self.at;
        self.at -= step * factor;
        let inside = self.at[6] > 0.0 && self.residuals().all(|(_, _, slack)| slack > 0.0);
        if !inside || !decrement.is_finite() {
            self.at = before;
            return None;
        }
        Some(decrement)
    }

    /// Returns the lower bound by the multipliers.
    fn lower_bound(&self) -> f64 {
        let total: f64 = self.residuals().map(|(_, _, slack)| 1.0 / slack).sum();
        let (mut sum, mut along, mut normal) = (0.0, Vector6::zeros(), Matrix6::zeros());
        for (row, left, slack) in self.residuals() {
            let weight = 1.0 / (slack * total);
            sum += weight * left.norm_squared();
            along += row.tr_mul(&left) * weight;
            normal += row.tr_mul(row) * weight;
        }
        let SymmetricEigen { eigenvectors, eigenvalues } = normal.symmetric_eigen();
        let parts = eigenvectors.tr_mul(&along);
        let gain = |k: usize| {
            let determined = eigenvalues[k] > RANK * eigenvalues.max();
            if determined { parts[k] * parts[k] / eigenvalues[k] } else { 0.0 }
        };
        (sum - (0..6).map(gain).sum::<f64>()).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type V = Vector3<f64>;

    /// The zone over places, with rotations about all axes unless they are all at one place.
    fn zone(places: &[V]) -> RigidZone {
        let centre = places.iter().sum::<V>() / places.len() as f64;
        let inertia = places
            .iter()
            .map(|p| p - centre)
            .fold(Matrix3::zeros(), |sum, arm| sum + Matrix3::identity() * arm.norm_squared() - arm * arm.transpose());
        let SymmetricEigen { eigenvectors, eigenvalues } = inertia.symmetric_eigen();
        let roots = eigenvalues.map(|value| if value > 1e-6 { 1.0 / value.sqrt() } else { 0.0 });
        RigidZone::new(places, centre, &(eigenvectors * Matrix3::from_diagonal(&roots)))
    }

    fn left(motion: &Vector6<f64>, place: &V, deviation: &V) -> V {
        let [shift, turn] = [motion.fixed_rows::<3>(0), motion.fixed_rows::<3>(3)];
        deviation - shift - turn.into_owned().cross(place)
    }

    fn fit(places: &[V], deviations: &[V]) -> f64 {
        let found = zone(places).fit(deviations);
        let lengths = places.iter().zip(deviations).map(|(p, d)| left(&found.motion, p, d).norm());
        let largest = lengths.fold(0.0, f64::max);
        assert!((largest - found.largest).abs() < 1e-12, "{largest} {found:?}");
        let size = deviations.iter().map(V::norm).fold(0.0, f64::max);
        let proven = found.largest <= found.lower * (1.0 + 1e-9) + 1e-12 * size;
        assert!(proven && found.lower <= found.largest * (1.0 + 1e-12), "{found:?}");
        found.largest
    }

    fn axes(length: f64) -> Vec<V> {
        [V::x(), V::y(), V::z()].iter().flat_map(|axis| [axis * length, -axis * length]).collect()
    }

    #[test]
    fn it_is_that_of_closed_forms() {
        // Two places drift apart: no motion brings them together.
        let pair = [V::new(-50.0, 3.0, 7.0), V::new(70.0, 3.0, 7.0)];
        assert!((fit(&pair, &[V::x() * -0.02, V::x() * 0.03]) - 0.025).abs() < 1e-12);
        // A part that grows, seen at the ends of three axes, of which the middle stays.
        let places: Vec<V> = axes(80.0).into_iter().chain([V::zeros()]).collect();
        assert!((fit(&places, &places.iter().map(|p| p * 1e-4).collect::<Vec<_>>()) - 0.008).abs() < 1e-11);
        // Places on a line with deviations along it: the middle of the two ends.
        let line: Vec<V> = (0..40).map(|i| V::new(1.0, 2.0, 2.0) * f64::from(i)).collect();
        let along = V::new(1.0, 2.0, 2.0) / 3.0;
        let of: Vec<V> = (0..40).map(|i| along * if i == 7 { 0.012 } else { 0.0 }).collect();
        assert!((fit(&line, &of) - 0.006).abs() < 1e-11);
        // One place: the smallest ball about the deviations, of a triangle that is not obtuse its circumcircle.
        let one = [V::new(5.0, 6.0, 7.0); 4];
        let triangle = [V::x() * 0.03, V::y() * 0.04, V::zeros(), V::new(0.01, 0.01, 0.0)];
        assert!((fit(&one, &triangle) - 0.025).abs() < 1e-11);
        // A motion leaves nothing.
        let moved: Vec<V> =
            places.iter().map(|p| V::new(0.3, -0.2, 0.1) + V::new(1e-4, 3e-4, -2e-4).cross(p)).collect();
        assert!(fit(&places, &moved) < 1e-12);
        assert_eq!(fit(&places, &[V::zeros(); 7]), 0.0);
    }

    #[test]
    fn large_sets_prove_themselves() {
        let mut state = 11_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for count in [500, 20_000] {
            let mut vectors = |size: V| -> Vec<V> {
                (0..count).map(|_| V::new(next(), next(), next()).component_mul(&size)).collect()
            };
            // A part as flat as a foil, and deviations that lie on a grid.
            let (places, deviations) = (vectors(V::new(900.0, 300.0, 1e-3)), vectors(V::new(0.02, 0.01, 0.03)));
            let grid: Vec<V> = deviations.iter().map(|d| d.map(|x| (x * 200.0).round() / 200.0)).collect();
            assert!(fit(&places, &deviations) > 0.02 && fit(&places, &grid) > 0.02);
        }
    }
}
