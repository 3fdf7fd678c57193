//! Positions of all axes together, by Newton's iteration: the last digits of a branch, and poses of chains without
//! closed form, with the least motion from a reference.

use super::screws::{Screw, ScrewMotion};
use crate::machine::{Pose, Travel};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// Length (mm) by which angles count beside lengths.
const LEVER_MM: f64 = 300.0;

/// Largest turn in a step, deg.
const MAX_TURN_DEG: f64 = 20.0;

/// Steps that pull towards the reference, and steps without.
const PULLED: usize = 60;
const PLAIN: usize = 40;

/// Residuals (mm, at the lever) below which nothing is gained.
const ROUNDING_MM: f64 = 1e-11;

/// Part of the way to the reference that a step takes.
const PULL: f64 = 0.5;

/// The tool pose to reach.
#[derive(Debug, Clone, Copy)]
pub struct ToolGoal {
    /// Image of the tip in machine coordinates of the walk, mm.
    pub tip: Vector3<f64>,
    /// Attitude of the tool; of it only the tool axis if its spin is free.
    pub attitude: Matrix3<f64>,
    /// Tool axis at the zero pose, a unit vector.
    pub tool: Vector3<f64>,
    /// True if the tool may turn about its axis.
    pub spins: bool,
}

/// A chain with its tip (mm) at the zero pose and its travels.
#[derive(Debug, Clone)]
pub struct ArmChain {
    /// Axes on the walk from workpiece to tool.
    pub screws: Vec<Screw>,
    /// The tip at the zero pose, mm.
    pub tip: Vector3<f64>,
    /// Travels of the axes.
    pub travels: Vec<Travel>,
}

/// The residual at positions, and its derivatives by each axis (per mm, per deg).
struct Linearised {
    residual: Vector6<f64>,
    columns: Vec<Vector6<f64>>,
}

impl ArmChain {
    /// Returns the motion of the tool at positions (mm, deg).
    pub fn motion(&self, pose: &[f64]) -> ScrewMotion {
        let joints = self.screws.iter().zip(pose).map(|(screw, q)| screw.motion(*q));
        joints.fold(ScrewMotion::identity(), |motion, joint| motion.after(&joint))
    }

    fn linearise(&self, goal: &ToolGoal, pose: &[f64]) -> Linearised {
        let end = self.motion(pose);
        let tip = end.apply(&self.tip);
        let axis = end.r * goal.tool;
        // Turns about the tool axis do not count if it spins.
        let counts = |v: Vector3<f64>| if goal.spins { v - axis * axis.dot(&v) } else { v };
        let turn = if goal.spins {
            turn_between(&axis, &(goal.attitude * goal.tool))
        } else {
            turn_of(&(goal.attitude * end.r.transpose()))
        };
        let stacked = |place: Vector3<f64>, turn: Vector3<f64>| {
            let turn = counts(turn) * LEVER_MM;
            Vector6::new(place.x, place.y, place.z, turn.x, turn.y, turn.z)
        };
        let mut motion = ScrewMotion::identity();
        let mut columns = Vec::with_capacity(pose.len());
        for (screw, q) in self.screws.iter().zip(pose) {
            let w = motion.r * screw.w;
            columns.push(match screw.turns {
                true => stacked(w.cross(&(tip - motion.apply(&screw.o))), w) * 1_f64.to_radians(),
                false => stacked(w, Vector3::zeros()),
            });
            motion = motion.after(&screw.motion(*q));
        }
        Linearised { residual: stacked(goal.tip - tip, turn), columns }
    }

    /// Returns positions near a start that reach the goal, whatever the travels; `None` if the iteration does not come
    /// there.
    pub fn refine(&self, goal: &ToolGoal, start: &[f64], steps: usize) -> Option<Pose> {
        let mut pose = start.to_vec();
        let mut last = f64::INFINITY;
        for _ in 0..steps {
            let at = self.linearise(goal, &pose);
            let size = at.residual.norm();
            if size < ROUNDING_MM || (size < 1e-6 && size >= last) {
                break;
            }
            last = size;
            let step = steps_to(&at, &vec![0.0; pose.len()]);
            self.take(&mut pose, &step, false);
        }
        (self.linearise(goal, &pose).residual.norm() < 1e-8).then_some(pose)
    }

    /// Returns positions within the travels that reach the goal, moved towards the reference as far as the goal leaves
    /// it open; `None` if the iteration does not come there.
    pub fn nearest(&self, goal: &ToolGoal, start: &[f64], reference: &[f64]) -> Option<Pose> {
        let mut pose = start.to_vec();
        for step in 0..PULLED + PLAIN {
            let mut at = self.linearise(goal, &pose);
            let wish = |(i, q): (usize, &f64)| if step < PULLED { PULL * (reference[i] - q) } else { 0.0 };
            let wish: Vec<f64> = pose.iter().enumerate().map(wish).collect();
            if step >= PULLED && at.residual.norm() < ROUNDING_MM {
                break;
            }
            let step = self.within_travel(&mut at, wish, &pose);
            let before = pose.clone();
            self.take(&mut pose, &step, true);
            let moved = pose.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if moved < 1e-12 && at.residual.norm() > 1e-6 {
                return None;
            }
        }
        (self.linearise(goal, &pose).residual.norm() < 1e-8).then_some(pose)
    }

    /// Returns the step in which axes that would leave an end of their travel stay there.
    fn within_travel(&self, at: &mut Linearised, mut wish: Vec<f64>, pose: &[f64]) -> Vec<f64> {
        let mut held = vec![false; pose.len()];
        loop {
            let step = steps_to(at, &wish);
            let blocked = |i: &usize| match self.travels[*i] {
                Travel::Range(min, max) => (pose[*i] <= min && step[*i] < 0.0) || (pose[*i] >= max && step[*i] > 0.0),
                Travel::Continuous => false,
            };
            let Some(i) = (0..pose.len()).filter(|i| !held[*i]).find(blocked) else { return step };
            (held[i], wish[i]) = (true, 0.0);
            at.columns[i] = Vector6::zeros();
        }
    }

    /// Moves a pose by a step, shortened to the largest turn.
    fn take(&self, pose: &mut Pose, step: &[f64], within: bool) {
        let turns = self.screws.iter().zip(step).filter(|(screw, _)| screw.turns);
        let largest = turns.map(|(_, s)| s.abs()).fold(0.0, f64::max);
        let share = if largest > MAX_TURN_DEG { MAX_TURN_DEG / largest } else { 1.0 };
        for ((q, s), travel) in pose.iter_mut().zip(step).zip(&self.travels) {
            *q += share * s;
            if let (true, Travel::Range(min, max)) = (within, travel) {
                *q = q.clamp(*min, *max);
            }
        }
    }
}

/// Returns `wish + J^+ (r - J wish)`, damped where the goal is far.
fn steps_to(at: &Linearised, wish: &[f64]) -> Vec<f64> {
    let by_wish = at.columns.iter().zip(wish).fold(Vector6::zeros(), |sum, (c, w)| sum + c * *w);
    let gram = at.columns.iter().fold(Matrix6::zeros(), |sum, c| sum + c * c.transpose());
    let damping = 1e-12 * gram.trace() + 1e-3 * at.residual.norm().min(100.0) + 1e-12;
    let Some(cholesky) = (gram + Matrix6::identity() * damping).cholesky() else { return vec![0.0; wish.len()] };
    let pull = cholesky.solve(&(at.residual - by_wish));
    at.columns.iter().zip(wish).map(|(c, w)| w + c.dot(&pull)).collect()
}

/// Returns the shortest turn (rotation vector, rad) from one unit vector to another.
fn turn_between(from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let across = from.cross(to);
    let sine = across.norm();
    if sine < 1e-300 { across } else { across * (libm::atan2(sine, from.dot(to)) / sine) }
}

/// Returns the rotation vector (rad) of a rotation.
fn turn_of(r: &Matrix3<f64>) -> Vector3<f64> {
    let twice = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let sine = twice.norm() / 2.0;
    if sine < 1e-300 { twice / 2.0 } else { twice * (libm::atan2(sine, (r.trace() - 1.0) / 2.0) / (2.0 * sine)) }
}
