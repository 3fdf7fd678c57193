//! Positions of axes in words.

use crate::machine::{Machine, Pose};

/// A pose in words: `A = -120°, C = 90°`.
pub(crate) fn pose_words(machine: &Machine, axes: &[usize], pose: &Pose) -> String {
    let word = |i: &usize| {
        let (axis, q) = (&machine.axes()[*i], crate::units::significant(pose[*i] + 0.0, 6));
        if axis.unit() == "mm" { format!("{} = {q} mm", axis.name) } else { format!("{} = {q}°", axis.name) }
    };
    axes.iter().map(word).collect::<Vec<_>>().join(", ")
}
