//! Rigid motions of the workpiece frame that the data behind the errors do not hold.

use crate::algebra::linear::beside;
use nalgebra::DVector;

/// Part of a motion of unit length up to which others make it: rounding of printed amounts.
const MIN_OWN_PART: f64 = 1e-6;
/// Lever (mm) by which rotations are weighed beside translations.
const LEVER_MM: f64 = 300.0;

/// A small rigid motion of the workpiece frame that the readings behind the errors do not notice, or that the datum of
/// the errors has decided: deviations of two machines that differ by it are equally good. Of any length but 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnheldMotion {
    /// Translation of the workpiece origin (mm), in machine directions at the zero pose.
    pub translation: [f64; 3],
    /// Rotation about the workpiece origin (rad).
    pub rotation: [f64; 3],
}

impl UnheldMotion {
    /// Returns the motion of six amounts: translations (mm), then rotations (rad).
    pub fn of([x, y, z, a, b, c]: [f64; 6]) -> Self {
        Self { translation: [x, y, z], rotation: [a, b, c] }
    }

    /// True if other motions make this one, too.
    pub(super) fn is_made_by(&self, others: &[Self]) -> bool {
        let unit = |motion: &Self| {
            let [x, y, z, a, b, c] = motion.amounts();
            DVector::from_vec(vec![x, y, z, LEVER_MM * a, LEVER_MM * b, LEVER_MM * c]).normalize()
        };
        let others = others.iter().fold(Vec::new(), |mut all, other| {
            let rest = beside(unit(other), &all);
            if rest.norm() > MIN_OWN_PART {
                all.push(rest.normalize());
            }
            all
        });
        beside(unit(self), &others).norm() <= MIN_OWN_PART
    }

    /// Returns the six amounts: translations (mm), then rotations (rad).
    pub fn amounts(&self) -> [f64; 6] {
        let ([x, y, z], [a, b, c]) = (self.translation, self.rotation);
        [x, y, z, a, b, c]
    }
}
