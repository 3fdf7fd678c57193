//! Tolerances along and across axes, whichever way they point, and between pairs of them.

use super::{AxisName, ErrorFamily, MAIN_AXES};
use std::collections::BTreeMap;

/// Bounds of one family of errors of a joint: along, across, about along, about across (mm, rad).
pub type FrameTolerances = [Option<f64>; 4];

/// The keys of these bounds.
pub const FRAME_KEYS: [&str; 4] = ["along", "across", "about_along", "about_across"];

/// The bounds of a machine that are not by the letter of an error.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tolerances {
    /// By joint; by family as in [`ErrorFamily::ALL`].
    pub joints: BTreeMap<AxisName, [FrameTolerances; 2]>,
    /// Squareness of two of the linear axes X, Y, Z (0 to 2), the lower one first; rad.
    pub squareness: BTreeMap<[usize; 2], f64>,
}

impl Tolerances {
    /// Returns the bound of a translation or rotation along an axis or across it.
    pub fn of(&self, joint: &AxisName, family: ErrorFamily, turns: bool, along: bool) -> Option<f64> {
        let four = self.joints.get(joint)?[usize::from(family == ErrorFamily::Component)];
        four[2 * usize::from(turns) + usize::from(!along)]
    }

    /// Returns the number of bounds that are written.
    pub fn count(&self) -> usize {
        self.list().len()
    }

    /// Returns every bound with a name such as `B location about_across` or `X-Y`: mm, or rad where the flag is true.
    pub fn list(&self) -> Vec<(String, f64, bool)> {
        let mut list = Vec::new();
        for (joint, both) in &self.joints {
            for (family, four) in [" location", ""].into_iter().zip(both) {
                let keys = FRAME_KEYS.iter().zip(four).enumerate();
                let given =
                    keys.filter_map(|(k, (key, value))| Some((format!("{joint}{family} {key}"), (*value)?, k > 1)));
                list.extend(given);
            }
        }
        let pair =
            |([a, b], value): (&[usize; 2], &f64)| (format!("{}-{}", MAIN_AXES[*a], MAIN_AXES[*b]), *value, true);
        list.extend(self.squareness.iter().map(pair));
        list
    }

    /// True if translations or rotations of a family of a joint are bounded here.
    pub fn bounds(&self, joint: &AxisName, family: ErrorFamily, turns: bool) -> bool {
        [true, false].into_iter().any(|along| self.of(joint, family, turns, along).is_some())
    }

    /// True if any location error is bounded here.
    pub fn any_location(&self) -> bool {
        !self.squareness.is_empty() || self.joints.values().any(|both| both[0].iter().any(Option::is_some))
    }
}
