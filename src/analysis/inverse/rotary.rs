//! Rotary axes: all the positions, or the nearest ones, that point the tool in a direction.
//!
//! Only the direction of the tool counts, so two axes are enough. The product of the rotations over
//! the walk takes the tool axis at the zero pose, e, to the direction asked for:
//! `R_1 ... R_m e = d`. With all axes but two held, that is `exp(w_1 a) exp(w_2 b) p = t`, which has
//! at most two solutions in closed form, for axes in any directions.

use super::tool_pose::DIRECTION_TOLERANCE;
use crate::algebra::rotation_about;
use crate::evaluate::radical_inverse;
use crate::machine::{Axis, AxisKind, Pose, Travel, sin_cos_degrees};
use nalgebra::{Matrix3, Vector3};

/// Below this length (rad) the part of a unit vector across an axis is rounding: the axis has no effect.
const ALONG_RAD: f64 = 1e-12;

/// A position beyond the travel by less (deg) counts as its end; whether that still points there is checked afterwards.
const AT_END_DEG: f64 = 1e-6;

/// Number of positions tried for the axes that are held, besides their reference.
const SAMPLES: u64 = 48;

/// The same number where a third axis might still bring the place within the travel of the linear axes.
const MANY_SAMPLES: u64 = 512;

/// Number of positions of more than two axes that are refined towards the reference.
const REFINED: usize = 6;

/// A rotary axis: `w` is its direction with the sense of a positive command.
#[derive(Debug, Clone)]
struct Turn {
    axis: usize,
    w: Vector3<f64>,
    travel: Travel,
    reference: f64,
}

/// The rotary axes of a machine, and their reference.
pub struct RotaryDirections {
    turns: Vec<Turn>,
    /// The tool axis at the zero pose.
    tool: Vector3<f64>,
    reference: Pose,
}

/// Candidates for the rotary axes, best first.
pub struct Candidates {
    /// Poses (mm, deg) with the rotary axes set; the linear ones are at the reference.
    pub poses: Vec<Pose>,
    /// The pose that is least beyond the travel of the rotary axes, if a solution was found there.
    pub beyond_travel: Option<Pose>,
    /// Turns that keep the direction. With two rotary axes or fewer and one sweep there is no other candidate.
    pub sweeps: Vec<Sweep>,
    /// True if there may be others, further away, because some axis is free.
    pub more: bool,
}

/// A turn of rotary axes that keeps the direction of the tool: a free axis, or parallel axes against each other.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// A pose of it (mm, deg); the axes that turn may be beyond their travel.
    pub pose: Pose,
    /// The axes that turn, with their motion per deg of the sweep.
    pub rates: Vec<(usize, f64)>,
}

/// One of a pair's angles (rad); `None` if any is a solution.
pub type Angle = Option<f64>;

impl RotaryDirections {
    /// Returns the rotary axes of a machine with its tool axis (unit vector) and a reference pose (mm, deg).
    pub fn new(axes: &[Axis], tool: Vector3<f64>, reference: &[f64]) -> Self {
        let rotary = axes.iter().enumerate().filter(|(_, axis)| axis.kind == AxisKind::Rotary);
        let turn = |(i, axis): (usize, &Axis)| Turn {
            axis: i,
            w: Vector3::from(axis.direction) * axis.sign(),
            travel: axis.travel,
            reference: reference[i],
        };
        Self { turns: rotary.map(turn).collect(), tool, reference: reference.to_vec() }
    }

    /// Returns the candidates nearest to the reference for a direction of the tool (unit vector, unturned).
    pub fn nearest(&self, direction: &Vector3<f64>) -> Candidates {
        let mut search = self.search(direction, [self.start()]);
        let sweeps = std::mem::take(&mut search.sweeps);
        if self.turns.len() > 2 {
            (1..SAMPLES).for_each(|sample| search.around(&self.sample(sample)));
            let rough = self.in_order(std::mem::take(&mut search.found));
            for angles in rough.iter().take(REFINED) {
                // The closed form again, for the last digits.
                search.around(&self.refine(angles, direction));
            }
            search.found.extend(rough);
        }
        let beyond_travel = search.beyond.and_then(|(_, angles)| self.poses(vec![angles]).pop());
        let poses = self.poses(search.found);
        Candidates { poses, beyond_travel, sweeps, more: search.free || self.turns.len() > 2 }
    }

    /// Returns the candidates with all axes but two held: at the reference and, where more than two axes turn, at other
    /// positions spread over their travels, `held` in all. They do not depend on the direction.
    pub fn held(&self, direction: &Vector3<f64>, held: u64) -> Candidates {
        let others = if self.turns.len() > 2 { held } else { 1 };
        let starts = std::iter::once(self.start()).chain((1..others).map(|sample| self.sample(sample)));
        let search = self.search(direction, starts);
        Candidates { poses: self.poses(search.found), beyond_travel: None, sweeps: search.sweeps, more: search.free }
    }

    /// Returns the direction of the tool (unit vector, unturned) at a pose (mm, deg).
    pub fn direction(&self, pose: &[f64]) -> Vector3<f64> {
        self.turns.iter().rev().fold(self.tool, |direction, turn| turn.rotation(pose[turn.axis]) * direction)
    }

    /// Returns the rotary axes by index, with their directions (unit vectors, unturned) at a pose (mm, deg).
    pub fn turned_axes(&self, pose: &[f64]) -> Vec<(usize, Vector3<f64>)> {
        let mut turned = Matrix3::identity();
        let mut axes = Vec::new();
        for turn in &self.turns {
            axes.push((turn.axis, turned * turn.w));
            turned *= turn.rotation(pose[turn.axis]);
        }
        axes
    }

    /// True if no more than two axes turn, so that [`RotaryDirections::nearest`] finds all solutions.
    pub fn at_most_two(&self) -> bool {
        self.turns.len() <= 2
    }

    /// Returns candidates whose free axes are away from their reference; of two rotary axes or fewer with the sweeps
    /// through them.
    pub fn others(&self, direction: &Vector3<f64>) -> (Vec<Pose>, Vec<Sweep>) {
        let samples = if self.turns.len() > 2 { MANY_SAMPLES } else { SAMPLES };
        let search = self.search(direction, (1..samples).map(|sample| self.sample(sample)));
        let sweeps = if self.turns.len() > 2 { Vec::new() } else { search.sweeps };
        (self.poses(search.found), sweeps)
    }

    /// Returns the candidates with all axes but two held as in these poses (mm, deg).
    pub fn around(&self, direction: &Vector3<f64>, poses: &[Pose]) -> Vec<Pose> {
        let angles = |pose: &Pose| -> Vec<f64> { self.turns.iter().map(|turn| pose[turn.axis]).collect() };
        self.poses(self.search(direction, poses.iter().map(angles)).found)
    }

    /// Returns the reference, deg.
    fn start(&self) -> Vec<f64> {
        self.turns.iter().map(|turn| turn.reference).collect()
    }

    /// Searches with all axes but two held at each of these positions (deg).
    fn search<'a>(
        &'a self,
        direction: &'a Vector3<f64>,
        starts: impl IntoIterator<Item = Vec<f64>>,
    ) -> DirectionSearch<'a> {
        let mut search = DirectionSearch::new(self, direction);
        starts.into_iter().for_each(|angles| search.around(&angles));
        search
    }

    /// Returns positions (deg) spread over the travels: a Halton sequence.
    fn sample(&self, index: u64) -> Vec<f64> {
        let bases = [2, 3, 5, 7, 11, 13, 17, 19];
        let position = |(turn, base): (&Turn, &u64)| {
            let (min, max) = turn.travel.interval();
            min + (max - min) * radical_inverse(index, *base)
        };
        self.turns.iter().zip(bases.iter().cycle()).map(position).collect()
    }

    /// Sorts positions by their distance from the reference. Those that differ by rounding alone are one candidate, and
    /// of equal distances the larger positions come first, so that the choice does not depend on the last bit.
    fn in_order(&self, found: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let key = |angles: &[f64]| nearness(angles.iter().zip(&self.turns).map(|(q, turn)| (*q, turn.reference)));
        let mut keyed: Vec<_> = found.into_iter().map(|angles| (key(&angles), angles)).collect();
        keyed.sort_by(|a, b| a.0.cmp(&b.0));
        keyed.dedup_by(|a, b| a.0.1 == b.0.1);
        keyed.into_iter().map(|(_, angles)| angles).collect()
    }

    fn poses(&self, found: Vec<Vec<f64>>) -> Vec<Pose> {
        let pose = |angles: Vec<f64>| {
            let mut pose = self.reference.clone();
            self.turns.iter().zip(angles).for_each(|(turn, q)| pose[turn.axis] = q);
            pose
        };
        self.in_order(found).into_iter().map(pose).collect()
    }

    fn rotation(&self, range: std::ops::Range<usize>, angles: &[f64]) -> Matrix3<f64> {
        range.fold(Matrix3::identity(), |product, k| product * self.turns[k].rotation(angles[k]))
    }

    /// Returns positions moved along the solutions towards the reference, within the travel: Newton's iteration, with
    /// the distance to the reference projected into the null space of the Jacobian.
    fn refine(&self, start: &[f64], direction: &Vector3<f64>) -> Vec<f64> {
        let mut angles = start.to_vec();
        for _ in 0..48 {
            let step = self.step(&angles, direction);
            let turned = self.turns.iter().zip(&angles).zip(&step);
            angles = turned.map(|((turn, q), s)| turn.within_travel(q + s.to_degrees().clamp(-20.0, 20.0))).collect();
            if step.iter().all(|s| s.abs() < 1e-12) {
                break;
            }
        }
        angles
    }

    /// Returns `J^+ r + (1 - J^+ J) (reference - q)`, rad; axes pushed against an end of their travel stay there.
    fn step(&self, angles: &[f64], direction: &Vector3<f64>) -> Vec<f64> {
        let mut columns = self.columns(angles);
        let reached = self.rotation(0..self.turns.len(), angles) * self.tool;
        let missing = direction - reached * reached.dot(direction);
        // The normal makes the matrix regular without touching the tangent plane, where the columns are.
        let normal = reached * reached.transpose() + Matrix3::identity() * 1e-12;
        let mut step = vec![0.0; angles.len()];
        for _ in 0..=angles.len() {
            let wish: Vec<f64> = self
                .turns
                .iter()
                .zip(angles)
                .zip(&columns)
                .map(
                    |((turn, q), column)| {
                        if *column == Vector3::zeros() { 0.0 } else { (turn.reference - q).to_radians() }
                    },
                )
                .collect();
            let by_wish = columns.iter().zip(&wish).fold(Vector3::zeros(), |sum, (c, w)| sum + c * *w);
            let gram = columns.iter().fold(normal, |sum, c| sum + c * c.transpose());
            let pull = gram.try_inverse().unwrap_or_default() * (missing - by_wish);
            step = columns.iter().zip(&wish).map(|(c, w)| w + c.dot(&pull)).collect();
            let blocked = (0..angles.len())
                .find(|i| columns[*i] != Vector3::zeros() && self.turns[*i].blocks(angles[*i], step[*i]));
            match blocked {
                Some(i) => columns[i] = Vector3::zeros(),
                None => break,
            }
        }
        step
    }

    /// Returns the derivatives of the direction by each angle (per rad).
    fn columns(&self, angles: &[f64]) -> Vec<Vector3<f64>> {
        let reached = self.rotation(0..self.turns.len(), angles) * self.tool;
        (0..self.turns.len()).map(|i| (self.rotation(0..i, angles) * self.turns[i].w).cross(&reached)).collect()
    }
}

impl Turn {
    fn rotation(&self, degrees: f64) -> Matrix3<f64> {
        rotation_about(&self.w.into(), sin_cos_degrees(degrees))
    }

    fn within_travel(&self, position: f64) -> f64 {
        match self.travel {
            Travel::Range(min, max) => position.clamp(min, max),
            Travel::Continuous => position,
        }
    }

    /// True if a step from an end of the travel would leave it.
    fn blocks(&self, position: f64, step: f64) -> bool {
        match self.travel {
            Travel::Range(min, max) => (position <= min && step < 0.0) || (position >= max && step > 0.0),
            Travel::Continuous => false,
        }
    }

    fn wrapped(&self, angle: f64) -> Option<f64> {
        wrapped(self.travel, self.reference, angle)
    }

    /// Returns the position (deg), whole turns away from an angle (rad), that is least beyond the travel, and by how
    /// much (deg).
    fn least_beyond(&self, angle: f64) -> (f64, f64) {
        let position = least_beyond(self.travel, angle);
        let (min, max) = self.travel.interval();
        (position, (min - position).max(position - max).max(0.0))
    }
}

/// Returns the key that sorts positions of rotary axes (deg), each with its reference, by their distance from it; of
/// equal distances the larger positions come first. Both are rounded.
pub fn nearness(positions: impl Iterator<Item = (f64, f64)> + Clone) -> (i64, Vec<i64>) {
    let rounded = |x: f64| (x * 1e6).round() as i64;
    let cost: f64 = positions.clone().map(|(q, reference)| (q - reference) * (q - reference)).sum();
    (rounded(cost), positions.map(|(q, _)| -rounded(q)).collect())
}

/// Returns the position (deg) within a travel, whole turns away from an angle (rad), that is nearest to the reference
/// (deg).
pub fn wrapped(travel: Travel, reference: f64, angle: f64) -> Option<f64> {
    let degrees = angle.to_degrees();
    let turns = ((reference - degrees) / 360.0).round();
    let Travel::Range(min, max) = travel else { return Some(degrees + 360.0 * turns) };
    let lowest = ((min - AT_END_DEG - degrees) / 360.0).ceil();
    let highest = ((max + AT_END_DEG - degrees) / 360.0).floor();
    (lowest <= highest).then(|| (degrees + 360.0 * turns.clamp(lowest, highest)).clamp(min, max))
}

/// Returns the position (deg), whole turns away from an angle (rad), that is least beyond a travel.
pub fn least_beyond(travel: Travel, angle: f64) -> f64 {
    let degrees = angle.to_degrees();
    let (min, max) = travel.interval();
    degrees + 360.0 * (((min + max) / 2.0 - degrees) / 360.0).round()
}

/// The search for one direction, with the solutions found so far.
struct DirectionSearch<'a> {
    directions: &'a RotaryDirections,
    direction: &'a Vector3<f64>,
    found: Vec<Vec<f64>>,
    /// The positions least beyond the travel, with the sum of what is beyond (deg).
    beyond: Option<(f64, Vec<f64>)>,
    sweeps: Vec<Sweep>,
    free: bool,
}

impl<'a> DirectionSearch<'a> {
    fn new(directions: &'a RotaryDirections, direction: &'a Vector3<f64>) -> Self {
        Self { directions, direction, found: Vec::new(), beyond: None, sweeps: Vec::new(), free: false }
    }

    /// Solves for every pair of axes (or the only one) with the others held at `angles`.
    fn around(&mut self, angles: &[f64]) {
        let count = angles.len();
        if count == 0 && (self.direction - self.directions.tool).norm() < DIRECTION_TOLERANCE {
            self.found.push(Vec::new());
        }
        for i in 0..count {
            if count == 1 {
                self.single(i, angles);
            }
            (i + 1..count).for_each(|j| self.pair(i, j, angles));
        }
    }

    /// Solves for axis i alone.
    fn single(&mut self, i: usize, angles: &[f64]) {
        let d = self.directions;
        let before = d.rotation(0..i, angles).transpose() * self.direction;
        let after = d.rotation(i + 1..angles.len(), angles) * d.tool;
        if same_height(&d.turns[i].w, &after, &before) {
            self.keep(angles, &[(i, angle(&d.turns[i].w, &after, &before))]);
        }
    }

    /// Solves for axes i < j.
    fn pair(&mut self, i: usize, j: usize, angles: &[f64]) {
        let d = self.directions;
        let between = d.rotation(i + 1..j, angles);
        let before = d.rotation(0..i, angles).transpose() * self.direction;
        let after = between * d.rotation(j + 1..angles.len(), angles) * d.tool;
        let (w1, w2) = (d.turns[i].w, between * d.turns[j].w);
        if w1.cross(&w2).norm_squared() < 1e-12 {
            // Parallel axes do the same: one is enough. Against each other they keep the direction.
            self.single(i, angles);
            self.single(j, angles);
            if j == i + 1 && same_height(&w1, &after, &before) {
                let mut turned = angles.to_vec();
                turned[i] = angle(&w1, &after, &before).map_or(angles[i], f64::to_degrees);
                self.sweep(&turned, &[(i, 1.0), (j, -w1.dot(&w2).signum())]);
            }
            return;
        }
        for (first, second) in pair_angles(&w1, &w2, &after, &before) {
            self.keep(angles, &[(i, first), (j, second)]);
        }
    }

    /// Adds a sweep through positions (deg).
    fn sweep(&mut self, angles: &[f64], rates: &[(usize, f64)]) {
        let turns = &self.directions.turns;
        let mut pose = self.directions.reference.clone();
        turns.iter().zip(angles).for_each(|(turn, q)| pose[turn.axis] = *q);
        let rates = rates.iter().map(|(k, rate)| (turns[*k].axis, *rate)).collect();
        self.sweeps.push(Sweep { pose, rates });
    }

    fn keep(&mut self, angles: &[f64], solved: &[(usize, Angle)]) {
        let mut candidate = angles.to_vec();
        let mut beyond = 0.0;
        for (index, angle) in solved {
            self.free |= angle.is_none();
            let Some(angle) = angle else { continue };
            let turn = &self.directions.turns[*index];
            let (position, by) = turn.wrapped(*angle).map_or_else(|| turn.least_beyond(*angle), |within| (within, 0.0));
            candidate[*index] = position;
            beyond += by;
        }
        if beyond == 0.0 {
            for (index, _) in solved.iter().filter(|(_, angle)| angle.is_none()) {
                self.sweep(&candidate, &[(*index, 1.0)]);
            }
            self.found.push(candidate);
        } else if self.beyond.as_ref().is_none_or(|(least, _)| beyond < *least) {
            self.beyond = Some((beyond, candidate));
        }
    }
}

/// Returns the angle (rad) about w that takes p to t; `None` if w is along p: then any angle does.
pub fn angle(w: &Vector3<f64>, p: &Vector3<f64>, t: &Vector3<f64>) -> Angle {
    let beside = |v: &Vector3<f64>| v - w * w.dot(v);
    let (p, t) = (beside(p), beside(t));
    (p.norm() > ALONG_RAD && t.norm() > ALONG_RAD).then(|| libm::atan2(w.dot(&p.cross(&t)), p.dot(&t)))
}

/// True if a rotation about w takes p to t, up to rounding; solutions are checked afterwards.
fn same_height(w: &Vector3<f64>, p: &Vector3<f64>, t: &Vector3<f64>) -> bool {
    (w.dot(p) - w.dot(t)).abs() < 1e-12
}

/// Returns all (a, b) with `exp(w1 a) exp(w2 b) p = t`. Between the two rotations p is at a point z that is as far
/// along w1 as t and as far along w2 as p.
pub fn pair_angles(w1: &Vector3<f64>, w2: &Vector3<f64>, p: &Vector3<f64>, t: &Vector3<f64>) -> Vec<(Angle, Angle)> {
    let (far_1, far_2) = (w1.cross(t).norm(), w2.cross(p).norm());
    if far_1 <= ALONG_RAD {
        return same_height(w2, p, t).then(|| (None, angle(w2, p, t))).into_iter().collect();
    }
    if far_2 <= ALONG_RAD {
        return same_height(w1, p, t).then(|| (angle(w1, p, t), None)).into_iter().collect();
    }
    // Seen from the axis that is nearer, small distances keep all their digits.
    let between = if far_1 <= far_2 {
        meeting(&Circle { axis: *w1, height: w1.dot(t), radius: far_1 }, w2, w2.dot(p))
    } else {
        meeting(&Circle { axis: *w2, height: w2.dot(p), radius: far_2 }, w1, w1.dot(t))
    };
    between.map_or_else(Vec::new, |points| points.map(|z| (angle(w1, &z, t), angle(w2, p, &z))).to_vec())
}

/// The points at one height along an axis, and at one distance from it.
struct Circle {
    axis: Vector3<f64>,
    height: f64,
    radius: f64,
}

/// Returns the two points of a circle at a height along another axis.
fn meeting(circle: &Circle, other: &Vector3<f64>, along_other: f64) -> Option<[Vector3<f64>; 2]> {
    let Circle { axis, height, radius } = circle;
    let normal = axis.cross(other);
    let sine = normal.norm();
    let towards = (other - axis * axis.dot(other)) / sine;
    let near = (along_other - axis.dot(other) * *height) / sine;
    let square = (radius - near) * (radius + near);
    // A touching point may be missed by rounding; whether it is one is checked afterwards.
    (square > -1e-10).then(|| {
        let aside = normal * (square.max(0.0).sqrt() / sine);
        let foot = axis * *height + towards * near;
        [foot + aside, foot - aside]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(axis: usize, w: [f64; 3], travel: Travel) -> Turn {
        Turn { axis, w: Vector3::from(w).normalize(), travel, reference: 0.0 }
    }

    fn directions(turns: Vec<Turn>) -> RotaryDirections {
        RotaryDirections { reference: vec![0.0; turns.len()], tool: Vector3::z(), turns }
    }

    #[test]
    fn both_solutions_of_a_pair_are_found_and_the_nearer_comes_first() {
        let c_a = directions(vec![
            turn(0, [0.0, 0.0, 1.0], Travel::Continuous),
            turn(1, [1.0, 0.0, 0.0], Travel::Range(-130.0, 130.0)),
        ]);
        let wanted = c_a.rotation(0..2, &[40.0, 30.0]) * Vector3::z();
        let found = c_a.nearest(&wanted).poses;
        assert_eq!(found.len(), 2);
        assert!((found[0][0] - 40.0).abs() < 1e-12 && (found[0][1] - 30.0).abs() < 1e-12, "{found:?}");
        assert!((found[1][0] + 140.0).abs() < 1e-12 && (found[1][1] + 30.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_nutating_axis_reaches_its_cone_and_no_further() {
        let b = directions(vec![turn(0, [0.0, 1.0, 1.0], Travel::Range(0.0, 180.0))]);
        assert!((b.nearest(&Vector3::y()).poses[0][0] - 180.0).abs() < 1e-9);
        assert!(b.nearest(&Vector3::x()).poses.is_empty());
        let both = directions(vec![turn(0, [0.0, 0.0, 1.0], Travel::Continuous), b.turns[0].clone()]);
        assert!(!both.nearest(&Vector3::x()).poses.is_empty());
        assert!(both.nearest(&-Vector3::z()).poses.is_empty());
    }

    #[test]
    fn an_axis_along_the_tool_keeps_its_reference() {
        let mut c_a = directions(vec![
            turn(0, [0.0, 0.0, 1.0], Travel::Continuous),
            turn(1, [1.0, 0.0, 0.0], Travel::Range(-130.0, 130.0)),
        ]);
        c_a.turns[0].reference = 77.0;
        let found = c_a.nearest(&Vector3::z());
        assert_eq!(found.poses[0], [77.0, 0.0]);
        assert!(found.more);
    }

    #[test]
    fn three_axes_share_the_way() {
        let three = directions(vec![
            turn(0, [0.0, 1.0, 0.0], Travel::Range(-100.0, 100.0)),
            turn(1, [0.0, 1.0, 0.0], Travel::Range(-100.0, 100.0)),
            turn(2, [1.0, 0.0, 0.0], Travel::Range(-100.0, 100.0)),
        ]);
        let (s, c) = sin_cos_degrees(60.0);
        let found = three.nearest(&Vector3::new(s, 0.0, c)).poses;
        assert!((found[0][0] - 30.0).abs() < 1e-6 && (found[0][1] - 30.0).abs() < 1e-6, "{:?}", found[0]);
    }
}
