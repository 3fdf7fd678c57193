//! The errors that a file gives, and bounds of them.

use super::context::Context;
use crate::diagnostic::{Place, codes};
use crate::machine::{AxisName, Branch, Direction, ErrorId, ErrorTerm, JointErrors, KinematicChain};
use crate::syntax::{Keys, Scalar};
use std::collections::BTreeMap;

/// The remedy of a negative bound.
pub const NEGATIVE: &str = "a tolerance is a bound: `20 urad` means ±20 urad";

/// The errors by joint, and where each one stands.
#[derive(Default)]
pub struct Errors {
    pub joints: BTreeMap<AxisName, JointErrors>,
    pub places: BTreeMap<ErrorId, Option<Place>>,
    /// Expanded uncertainties (mm, rad).
    pub uncertainty: BTreeMap<ErrorId, f64>,
    /// All errors of axes on the side where the axis does not stand, if they may differ there.
    pub other_side: BTreeMap<AxisName, (Branch, JointErrors)>,
}

impl Errors {
    pub fn put(&mut self, error: &ErrorId, term: Option<ErrorTerm>) {
        let joint = self.joints.entry(error.axis.clone()).or_default();
        joint.six_mut(error.family)[error.direction.index()] = term;
    }

    /// By joint in the order of the walk, then the spindle's; those of other axes stay behind.
    pub fn in_order(&mut self, chain: &KinematicChain) -> Vec<JointErrors> {
        let names = chain.walk().into_iter().map(|(name, _)| name).chain(chain.spindle());
        names.map(|name| self.joints.remove(name).unwrap_or_default()).collect()
    }
}

/// Returns what stands behind both signs: `4 um` of `+-4 um`, `+/-4 um` or `±4 um`.
pub fn behind_both_signs(scalar: &Scalar) -> Option<Scalar> {
    let Scalar::Text(text) = scalar else { return None };
    let rest = ["+-", "+/-", "±"].into_iter().find_map(|signs| text.trim().strip_prefix(signs))?;
    Some(Scalar::Text(rest.trim().to_owned()))
}

/// The bound of an error, from zero up; both signs may stand before it.
pub fn bounded(context: &mut Context, scalar: &Scalar, direction: Direction, here: &Keys) -> Option<f64> {
    let unsigned = behind_both_signs(scalar);
    let value = context.error_value(unsigned.as_ref().unwrap_or(scalar), direction, here)?;
    if value < 0.0 {
        context.at_value(codes::E0411, here, "a negative tolerance", NEGATIVE);
        return None;
    }
    context.plausible(value, direction, here).then_some(value)
}
