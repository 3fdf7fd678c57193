//! Positions of axes, as JSON and in words.

use crate::machine::{Axis, Machine, Pose};
use serde_json::{Map, Value, json};

/// An object of axis names and positions (mm, deg).
pub fn positions(machine: &Machine, pose: &[f64]) -> Value {
    let entry = |(axis, q): (&Axis, &f64)| (axis.name.to_string(), json!(q + 0.0));
    machine.axes().iter().zip(pose).map(entry).collect::<Map<_, _>>().into()
}

/// A pose in words: `A = -120°, C = 90°`.
pub(crate) fn pose_words(machine: &Machine, axes: &[usize], pose: &Pose) -> String {
    let word = |i: &usize| {
        let (axis, q) = (&machine.axes()[*i], crate::units::significant(pose[*i] + 0.0, 6));
        if axis.unit() == "mm" { format!("{} = {q} mm", axis.name) } else { format!("{} = {q}°", axis.name) }
    };
    axes.iter().map(word).collect::<Vec<_>>().join(", ")
}
