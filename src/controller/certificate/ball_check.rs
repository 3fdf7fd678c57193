//! A check of loaded kinematic parameters by a ball: where a probe finds its centre before and after the turn of one
//! rotary axis, with the numbers before and with the set.

use super::tables::TablesUnderTest;
use crate::controller::kinematics::{KinematicsModule, Parameters};
use crate::evaluate::{Bare, Field, Order};
use crate::machine::{AxisKind, AxisPositions, Machine, OperatingConditions, Pose};
use nalgebra::Vector3;

/// Two touches of a ball that stands on the part, one rotary axis turned between them.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct BallCheck {
    /// The axis that is turned.
    pub turned: String,
    /// Positions of the first touch, mm and deg: the tip is at the centre of the ball.
    pub first: AxisPositions,
    /// Positions of the second touch.
    pub second: AxisPositions,
    /// Centre found second less that found first, X, Y, Z of the part, with the numbers before the set, um.
    pub before_um: [f64; 3],
    /// The same with the set, um.
    pub with_um: [f64; 3],
}

/// Angles by which an axis is turned, deg.
const TURNS: [f64; 8] = [90.0, -90.0, 180.0, 60.0, -60.0, 30.0, -30.0, 15.0];

/// Positions of linear axes that are tried, as fractions of the travel.
const FRACTIONS: [f64; 3] = [0.5, 0.25, 0.75];

/// Largest tilt of the probe against its first direction, as a cosine: a ball hides what is below it.
const MIN_COSINE: f64 = -1e-9;

/// Differences of readings that count as equal, mm.
const EQUAL_MM: f64 = 1e-6;

/// The fields between which a check distinguishes.
struct BallFields<'a> {
    machine: &'a Machine,
    parameters: &'a Parameters,
    before: &'a dyn Field,
    with: &'a dyn Field,
    conditions: OperatingConditions,
}

/// Returns for each rotary axis the check with the largest difference between both readings, all with one ball.
pub(crate) fn ball_checks(
    machine: &Machine,
    own: &Parameters,
    tables: TablesUnderTest,
    conditions: OperatingConditions,
) -> Vec<BallCheck> {
    // The words of the blocks are rotary axes: a probe stands where they are.
    let module = KinematicsModule::KinematicParameters(own.clone().with_programming(false));
    let with = tables.beside(machine, &module);
    let before = Bare { machine, order: Order::Exact };
    let fields = BallFields { machine, parameters: own, before: &before, with: &with, conditions };
    let rotary: Vec<usize> =
        (0..machine.axes().len()).filter(|i| machine.axes()[*i].kind == AxisKind::Rotary).collect();
    let places = FRACTIONS.iter().flat_map(|x| FRACTIONS.iter().flat_map(move |y| FRACTIONS.map(|z| [*x, *y, z])));
    let at = |fractions: [f64; 3]| -> Vec<BallCheck> {
        let first = first_pose(machine, fractions);
        rotary.iter().filter_map(|axis| fields.best(&first, *axis)).collect()
    };
    // More axes first, then the weakest of their differences.
    let worth = |checks: &[BallCheck]| (checks.len(), checks.iter().map(difference).fold(f64::INFINITY, f64::min));
    let better = |one: &[BallCheck], than: &[BallCheck]| {
        let (one, than) = (worth(one), worth(than));
        one.0 > than.0 || (one.0 == than.0 && one.1 > than.1 + 1e3 * EQUAL_MM)
    };
    places.map(at).reduce(|best, next| if better(&next, &best) { next } else { best }).unwrap_or_default()
}

/// Linear axes at fractions of their travels, rotary axes at 0, or as near as their travels let them.
fn first_pose(machine: &Machine, fractions: [f64; 3]) -> Pose {
    let mut fractions = fractions.into_iter();
    let of = |axis: &crate::machine::Axis| {
        let (min, max) = axis.travel.interval();
        match axis.kind {
            AxisKind::Linear => libm::round(min + (max - min) * fractions.next().unwrap_or(0.5)).clamp(min, max),
            AxisKind::Rotary => 0.0_f64.clamp(min, max),
        }
    };
    machine.axes().iter().map(of).collect()
}

/// Distance between both readings, um.
fn difference(check: &BallCheck) -> f64 {
    (Vector3::from(check.before_um) - Vector3::from(check.with_um)).norm()
}

impl BallFields<'_> {
    /// Returns the check of an axis with the largest difference; `None` if the ball cannot be reached twice.
    fn best(&self, first: &Pose, axis: usize) -> Option<BallCheck> {
        let checks = TURNS.iter().filter_map(|turn| self.check(first, axis, first[axis] + turn));
        checks.reduce(|best, next| if difference(&next) > difference(&best) + 1e3 * EQUAL_MM { next } else { best })
    }

    fn check(&self, first: &Pose, axis: usize, angle: f64) -> Option<BallCheck> {
        let (second, cosine) = self.parameters.turned_about_tip(self.machine, first, axis, angle);
        if cosine < MIN_COSINE || self.machine.beyond_travel(&second).next().is_some() {
            return None;
        }
        let found = |field: &dyn Field| -> [f64; 3] {
            let [one, other] = [first, &second].map(|pose| field.deviation(&self.conditions.at_pose(pose)).position);
            // A tip that is displaced by d finds the centre at -d.
            ((one - other) * 1e3).into()
        };
        let named = |pose: &Pose| -> AxisPositions {
            self.machine.axes().iter().map(|axis| axis.name.to_string()).zip(pose.iter().copied()).collect()
        };
        Some(BallCheck {
            turned: self.machine.axes()[axis].name.to_string(),
            first: named(first),
            second: named(&second),
            before_um: found(self.before),
            with_um: found(self.with),
        })
    }
}
