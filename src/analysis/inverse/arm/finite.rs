//! Six rotary axes with finitely many positions for a pose of the tool: a spherical wrist, at either end, or three
//! neighbouring axes that are parallel. All branches are returned as candidates, for `newton` to refine.

use super::bilinear::{candidates, trigonometric_roots};
use super::screws::{Screw, ScrewMotion, meeting_point, parallel, reverse};
use crate::analysis::inverse::rotary::{angle, pair_angles};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Distance (mm) up to which axes count as meeting.
const MEET_MM: f64 = 1e-6;

/// Six angles, rad.
pub type Angles = [f64; 6];

/// The geometry that makes the branches finite.
#[derive(Debug, Clone, Copy)]
pub enum FiniteBranches {
    /// The last three axes meet at a point (mm).
    Wrist(Vector3<f64>),
    /// Three axes from this index on (0 or 1) are parallel.
    Parallel(usize),
}

/// Six rotary axes with finitely many branches.
#[derive(Debug, Clone, Copy)]
pub struct FiniteArm {
    screws: [Screw; 6],
    kind: FiniteBranches,
    /// True if the screws are those of the walk from tool to workpiece.
    back: bool,
}

impl FiniteArm {
    /// Returns the arm of six rotary axes; `None` for others.
    pub fn of(screws: &[Screw]) -> Option<Self> {
        let screws: [Screw; 6] = screws.try_into().ok()?;
        if !screws.iter().all(|screw| screw.turns) {
            return None;
        }
        [false, true].into_iter().find_map(|back| {
            let screws = if back { reverse(&screws) } else { screws };
            let wrist = || meeting_point(&screws[3..], MEET_MM).map(FiniteBranches::Wrist);
            let three = |k: &usize| parallel(&screws[*k], &screws[k + 1]) && parallel(&screws[*k], &screws[k + 2]);
            let kind = wrist().or_else(|| [1, 0].into_iter().find(three).map(FiniteBranches::Parallel))?;
            Some(Self { screws, kind, back })
        })
    }

    /// Returns the candidates for all branches at a motion of the tool; `free` are the angles (rad) of axes on which
    /// nothing depends.
    pub fn branches(&self, motion: &ScrewMotion, free: &Angles) -> Vec<Angles> {
        let (mut free, motion) = (*free, if self.back { motion.inverse() } else { *motion });
        if self.back {
            free.reverse();
        }
        let mut found = match self.kind {
            FiniteBranches::Wrist(point) => self.by_wrist(&point, &motion, &free),
            FiniteBranches::Parallel(0) => self.parallel_first(&motion, &free),
            FiniteBranches::Parallel(_) => self.parallel_second(&motion, &free),
        };
        if self.back {
            found.iter_mut().for_each(|angles| angles.reverse());
        }
        found
    }

    /// The first three axes bring the wrist to its place; then the last three give the attitude.
    fn by_wrist(&self, wrist: &Vector3<f64>, motion: &ScrewMotion, free: &Angles) -> Vec<Angles> {
        let [s0, s1, s2, ..] = &self.screws;
        let place = motion.apply(wrist);
        let from = place - s0.o;
        // What the first axis does not change: height along it, and distance from a point of it.
        let (height, square) = (s0.w.dot(&from), from.norm_squared());
        let carried = |a: f64, b: f64| s1.motion_at(a).apply(&s2.motion_at(b).apply(wrist)) - s0.o;
        let of = |a: f64, b: f64| {
            let at = carried(a, b);
            [s0.w.dot(&at) - height, at.norm_squared() - square]
        };
        let mut found = Vec::new();
        for (a, b) in candidates(of, free[1]) {
            let first = angle(&s0.w, &carried(a, b), &from).unwrap_or(free[0]);
            let turned = s0.rotation(first) * s1.rotation(a) * s2.rotation(b);
            let attitude = turned.transpose() * motion.r;
            found.extend(self.wrist_angles(&attitude, free).into_iter().map(|[x, y, z]| [first, a, b, x, y, z]));
        }
        found
    }

    /// Returns the angles of the last three axes for an attitude.
    fn wrist_angles(&self, attitude: &Matrix3<f64>, free: &Angles) -> Vec<[f64; 3]> {
        let [.., s3, s4, s5] = &self.screws;
        let mut found = Vec::new();
        for (x, y) in pair_angles(&s3.w, &s4.w, &s5.w, &(attitude * s5.w)) {
            let (x, y) = (x.unwrap_or(free[3]), y.unwrap_or(free[4]));
            let rest = (s3.rotation(x) * s4.rotation(y)).transpose() * attitude;
            let across = perpendicular(&s5.w);
            found.push([x, y, angle(&s5.w, &across, &(rest * across)).unwrap_or(free[5])]);
        }
        found
    }

    /// Axes 1, 2 and 3 are parallel: what they do together keeps their direction, and heights along it.
    fn parallel_second(&self, motion: &ScrewMotion, free: &Angles) -> Vec<Angles> {
        let [s0, s1, _, _, s4, s5] = &self.screws;
        let w = s1.w;
        let image = |a: f64| motion.r.transpose() * (s0.rotation(a) * w);
        let seen = |b: f64| motion.apply(&s5.motion_at(-b).apply(&s4.o)) - s0.o;
        let of = |a: f64, b: f64| {
            let along = s4.w.dot(&(s5.rotation(b) * image(a))) - s4.w.dot(&w);
            let height = (s0.rotation(a) * w).dot(&seen(b)) + w.dot(&(s0.o - s4.o));
            [along, height]
        };
        let mut found = Vec::new();
        for (a, b) in candidates(of, free[0]) {
            let fifth = angle(&s4.w, &(s5.rotation(b) * image(a)), &w).unwrap_or(free[4]);
            let outer = s4.motion_at(fifth).after(&s5.motion_at(b));
            let planar = s0.motion_at(-a).after(motion).after(&outer.inverse());
            found.extend(self.planar(1, &planar, free).into_iter().map(|[x, y, z]| [a, x, y, z, fifth, b]));
        }
        found
    }

    /// Axes 0, 1 and 2 are parallel.
    fn parallel_first(&self, motion: &ScrewMotion, free: &Angles) -> Vec<Angles> {
        let [s0, _, _, s3, s4, s5] = &self.screws;
        let w = s0.w;
        let image = motion.r.transpose() * w;
        let of = |a: f64, b: f64| {
            let along = s3.w.dot(&(s4.rotation(a) * s5.rotation(b) * image)) - s3.w.dot(&w);
            let seen = motion.apply(&s5.motion_at(-b).apply(&s4.motion_at(-a).apply(&s3.o)));
            [along, w.dot(&(seen - s3.o))]
        };
        let mut found = Vec::new();
        for (a, b) in candidates(of, free[4]) {
            let fourth = angle(&s3.w, &(s4.rotation(a) * s5.rotation(b) * image), &w).unwrap_or(free[3]);
            let outer = s3.motion_at(fourth).after(&s4.motion_at(a)).after(&s5.motion_at(b));
            let planar = motion.after(&outer.inverse());
            found.extend(self.planar(0, &planar, free).into_iter().map(|[x, y, z]| [x, y, z, fourth, a, b]));
        }
        found
    }

    /// Returns the angles of three parallel axes from an index on for their motion together.
    fn planar(&self, from: usize, motion: &ScrewMotion, free: &Angles) -> Vec<[f64; 3]> {
        let [s1, s2, s3] = [0, 1, 2].map(|k| &self.screws[from + k]);
        let w = s1.w;
        let across = perpendicular(&w);
        let Some(sum) = angle(&w, &across, &(motion.r * across)) else { return Vec::new() };
        // The third axis does not move its own points.
        let place = beside(&w, &(motion.apply(&s3.o) - s1.o));
        let bent = |b: f64| beside(&w, &(s2.motion_at(b).apply(&s3.o) - s1.o));
        let square = |b: f64| bent(b).norm_squared() - place.norm_squared();
        let (zero, half, quarter) = (square(0.0), square(PI), square(FRAC_PI_2));
        let mean = (zero + half) / 2.0;
        let coefficients = Vector3::new(mean, (zero - half) / 2.0, quarter - mean);
        let scale = coefficients.amax().max(1e-300);
        let third = |a: f64, b: f64| (sum - a - b * w.dot(&s2.w)) * w.dot(&s3.w);
        let of = |b: f64| {
            let a = angle(&w, &bent(b), &place).unwrap_or(free[from]);
            [a, b, third(a, b)]
        };
        trigonometric_roots(&(coefficients / scale)).into_iter().map(of).collect()
    }
}

/// Returns the part of a vector across a unit vector.
fn beside(w: &Vector3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    v - w * w.dot(v)
}

/// Returns a unit vector across another.
fn perpendicular(w: &Vector3<f64>) -> Vector3<f64> {
    let least = w.iamin();
    let mut helper = Vector3::zeros();
    helper[least] = 1.0;
    beside(w, &helper).normalize()
}
