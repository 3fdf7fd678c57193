//! An independent part of the joint uncertainty of errors.

use super::{AxisName, ErrorId, JointErrors, SetUp};
use std::collections::BTreeMap;

/// One standard uncertainty of an independent part of the joint uncertainty: the column of a factor L of the covariance
/// L L^T of all values of the errors (JCGM 102:2011, 6.2).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointUncertainty {
    /// Amounts by which errors change, by joint (mm, rad).
    pub errors: BTreeMap<AxisName, JointErrors>,
    /// Amounts by which set-up errors change (mm, rad).
    pub setup: SetUp,
}

impl JointUncertainty {
    /// Largest number of parts of a machine.
    pub const MOST: usize = 1000;

    pub(super) fn moves(&self, error: &ErrorId) -> bool {
        self.errors.get(&error.axis).is_some_and(|six| six.six(error.family)[error.direction.index()].is_some())
    }

    /// True if it moves nothing.
    pub fn is_empty(&self) -> bool {
        self.setup == SetUp::default() && self.errors.values().all(|errors| errors.iter().next().is_none())
    }

    /// Leaves an error out.
    pub fn remove(&mut self, error: &ErrorId) {
        if let Some(errors) = self.errors.get_mut(&error.axis) {
            errors.six_mut(error.family)[error.direction.index()] = None;
        }
    }
}
