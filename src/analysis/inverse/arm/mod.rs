//! Chains whose linear axes do not span space: robots, and machines that place their tip by rotary axes.
//!
//! - `finite` gives all branches of six rotary axes with a spherical wrist or three parallel axes, at a given spin of
//!   the tool about its axis; `bilinear` solves the equations.
//! - `newton` refines branches, and finds poses of other chains with the least motion from the reference; of these it
//!   may miss some.
//! - A free spin is chosen: the pose nearest to the reference.

mod bilinear;
mod finite;
mod newton;
mod screws;

use super::rotary::wrapped;
use super::tool_pose::{
    DIRECTION_TOLERANCE, Miss, PLACE_TOLERANCE, ToolPose, Unreachable, attitude, excess, unturned_tool_pose,
    within_travel,
};
use crate::evaluate::radical_inverse;
use crate::lower::NominalPose;
use crate::machine::{Machine, Pose, Travel};
use finite::{Angles, FiniteArm};
use nalgebra::{Matrix3, Vector3};
use newton::{ArmChain, ToolGoal};
use screws::{ScrewMotion, screws};
use std::f64::consts::TAU;

/// Spins tried for a free tool, and those tried if none of them is within reach.
const SPINS: usize = 24;
const MANY_SPINS: usize = 360;

/// Positions from which Newton's iteration starts, besides the reference.
const STARTS: u64 = 64;

const REFINING: usize = 30;

/// Linear axes span space where the least eigenvalue of the sum of `u u^T` is above this.
const SPANNED: f64 = 1e-9;

/// A machine that places its tip by rotary axes.
#[derive(Debug)]
pub struct RotaryArm<'a> {
    machine: &'a Machine,
    chain: ArmChain,
    finite: Option<FiniteArm>,
}

/// Poses that take a tool pose, whatever the travels.
struct ArmPoses {
    within: Vec<Pose>,
    beyond: Vec<Pose>,
}

impl<'a> RotaryArm<'a> {
    /// Returns the arm of a machine; `None` if its linear axes place the tip, or if fewer than two axes turn: a lathe's
    /// spindle brings places into the plane of its slides in closed form.
    pub fn of(machine: &'a Machine) -> Option<Self> {
        let screws = screws(machine);
        let linear = screws.iter().filter(|s| !s.turns);
        let gram = linear.fold(Matrix3::zeros(), |sum, s| sum + s.w * s.w.transpose());
        if gram.symmetric_eigenvalues().min() > SPANNED || screws.iter().filter(|s| s.turns).count() < 2 {
            return None;
        }
        let travels = machine.axes().iter().map(|axis| axis.travel).collect();
        let finite = FiniteArm::of(&screws);
        Some(Self { machine, chain: ArmChain { screws, tip: machine.tool().tip.into(), travels }, finite })
    }

    /// True if all branches at a given spin are found.
    pub fn is_complete(&self) -> bool {
        self.finite.is_some()
    }

    /// Returns the pose (mm, deg) within the travels that takes a tool pose: of those found the nearest to the
    /// reference. Fails with what is missing.
    pub fn inverse(&self, target: &ToolPose, reference: &[f64]) -> Result<Pose, Miss> {
        if !target.tip.iter().chain(&target.direction).all(|x| x.is_finite()) {
            return Err(Miss::new(Unreachable::Direction));
        }
        let reference: Pose = self.machine.axes().iter().zip(reference).map(|(a, q)| within_travel(a, *q)).collect();
        let found = match (&self.finite, target.spin_rad) {
            (Some(arm), Some(spin)) => self.branches(arm, target, spin, &reference),
            (Some(arm), None) => self.spun(arm, target, &reference),
            (None, _) => ArmPoses { within: self.sought(target, &reference), beyond: Vec::new() },
        };
        let nearest =
            |list: Vec<Pose>| list.into_iter().min_by(|a, b| cost(a, &reference).total_cmp(&cost(b, &reference)));
        if let Some(pose) = nearest(found.within) {
            return Ok(pose);
        }
        let axes = self.machine.axes();
        let misses = found.beyond.into_iter().map(Miss::travel);
        let miss = misses.fold(Miss::new(Unreachable::Place), |failure, miss| miss.or_nearer(failure, axes));
        Err(miss.proved(self.is_complete() && target.spin_rad.is_some()))
    }

    /// Returns the poses of all branches that take a tool pose at its spin, nearest to the reference first; empty for
    /// an arm without finite branches or a tool pose without spin.
    pub fn all(&self, target: &ToolPose, reference: &[f64]) -> Vec<Pose> {
        let (Some(arm), Some(spin)) = (&self.finite, target.spin_rad) else { return Vec::new() };
        let mut poses = self.branches(arm, target, spin, reference).within;
        poses.sort_by(|a, b| cost(a, reference).total_cmp(&cost(b, reference)));
        poses
    }

    /// Returns the poses of all branches within the travels: at the spin of a tool pose, or where it is open at equal
    /// steps. Empty for an arm without finite branches.
    pub fn candidates(&self, target: &ToolPose, reference: &[f64]) -> Vec<Pose> {
        let Some(arm) = &self.finite else { return Vec::new() };
        let spins = target
            .spin_rad
            .map_or_else(|| (0..SPINS).map(|k| TAU * k as f64 / SPINS as f64).collect(), |spin| vec![spin]);
        spins.into_iter().flat_map(|spin| self.branches(arm, target, spin, reference).within).collect()
    }

    /// Returns the branches at a spin (rad).
    fn branches(&self, arm: &FiniteArm, target: &ToolPose, spin: f64, reference: &[f64]) -> ArmPoses {
        let goal = self.goal(target, Some(spin));
        let motion = ScrewMotion { r: goal.attitude, t: goal.tip - goal.attitude * self.chain.tip };
        let mut free: Angles = [0.0; 6];
        free.iter_mut().zip(reference).for_each(|(angle, q)| *angle = q.to_radians());
        let mut found = ArmPoses { within: Vec::new(), beyond: Vec::new() };
        for candidate in arm.branches(&motion, &free) {
            let start: Pose = candidate.iter().map(|angle| angle.to_degrees()).collect();
            let Some(refined) = self.chain.refine(&goal, &start, REFINING) else { continue };
            let axes = self.machine.axes().iter().zip(&refined).zip(reference);
            let turned: Vec<(f64, bool)> = axes
                .map(|((axis, q), reference)| match wrapped(axis.travel, *reference, q.to_radians()) {
                    Some(position) => (position, true),
                    None => (super::rotary::least_beyond(axis.travel, q.to_radians()), false),
                })
                .collect();
            let within = turned.iter().all(|(_, within)| *within);
            let pose: Pose = turned.into_iter().map(|(q, _)| q).collect();
            let list = if within { &mut found.within } else { &mut found.beyond };
            if self.takes(&pose, target) && !list.iter().any(|known| same(known, &pose)) {
                list.push(pose);
            }
        }
        found
    }

    /// Returns the branches over the spins of the tool, with the best of them moved towards the reference.
    fn spun(&self, arm: &FiniteArm, target: &ToolPose, reference: &[f64]) -> ArmPoses {
        let mut found = ArmPoses { within: Vec::new(), beyond: Vec::new() };
        for spins in [SPINS, MANY_SPINS] {
            for k in 0..spins {
                let at = self.branches(arm, target, TAU * k as f64 / spins as f64, reference);
                found.within.extend(at.within);
                found.beyond.extend(at.beyond);
            }
            if !found.within.is_empty() {
                break;
            }
        }
        if found.within.is_empty() {
            found.within = self.sought(target, reference);
        }
        let best = found.within.iter().min_by(|a, b| cost(a, reference).total_cmp(&cost(b, reference)));
        let moved = best.and_then(|best| self.chain.nearest(&self.goal(target, None), best, reference));
        found.within.extend(moved.filter(|pose| self.takes(pose, target) && self.within(pose)));
        found
    }

    /// Returns poses within the travels that Newton's iteration finds from the reference; if there are none, from
    /// positions spread over the travels.
    fn sought(&self, target: &ToolPose, reference: &[f64]) -> Vec<Pose> {
        let goal = self.goal(target, target.spin_rad);
        let from = |start: &[f64]| {
            let found = self.chain.nearest(&goal, start, reference)?;
            (self.takes(&found, target) && self.within(&found)).then_some(found)
        };
        from(reference).map_or_else(|| (1..STARTS).filter_map(|k| from(&self.sample(k))).collect(), |pose| vec![pose])
    }

    /// Returns positions (mm, deg) spread over the travels.
    fn sample(&self, index: u64) -> Pose {
        let bases = [2, 3, 5, 7, 11, 13, 17, 19];
        let position = |(travel, base): (&Travel, &u64)| {
            let (min, max) = travel.interval();
            min + (max - min) * radical_inverse(index, *base)
        };
        self.chain.travels.iter().zip(bases.iter().cycle()).map(position).collect()
    }

    fn goal(&self, target: &ToolPose, spin: Option<f64>) -> ToolGoal {
        let tip = target.tip + Vector3::from(self.machine.workpiece());
        let tool = Vector3::from(self.machine.tool().direction);
        ToolGoal { tip, attitude: attitude(&tool, &target.direction, spin.unwrap_or(0.0)), tool, spins: spin.is_none() }
    }

    /// True if the nominal machine takes the tool pose at a pose.
    fn takes(&self, pose: &[f64], target: &ToolPose) -> bool {
        let at = unturned_tool_pose(self.machine, pose);
        let spin = target.spin_rad.is_none_or(|spin| {
            let reached = NominalPose::at(self.machine, pose).pose.linear;
            let tool = Vector3::from(self.machine.tool().direction);
            (reached - attitude(&tool, &target.direction, spin)).norm() <= 4.0 * DIRECTION_TOLERANCE
        });
        let turned = (at.direction - target.direction).norm();
        spin && turned <= DIRECTION_TOLERANCE && (at.tip - target.tip).norm() <= PLACE_TOLERANCE
    }

    fn within(&self, pose: &[f64]) -> bool {
        excess(self.machine.axes(), pose).is_empty()
    }
}

/// Returns the distance of a pose from the reference: the sum of the squared motions, mm and deg alike.
fn cost(pose: &[f64], reference: &[f64]) -> f64 {
    // Rounded, so that equal distances do not hang on the last bit.
    let sum: f64 = pose.iter().zip(reference).map(|(q, r)| (q - r) * (q - r)).sum();
    (sum * 1e6).round() / 1e6
}

/// True for poses that differ by rounding alone.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6)
}
