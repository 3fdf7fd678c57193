//! Positions of a machine at 20 deg C, of readings at another temperature of its material.

use super::channels::axis_direction;
use super::sample::Import;
use crate::standards::{REFERENCE, Thermal};

impl Import {
    /// True if an error is that of the position of a linear axis itself.
    pub fn is_positioning(&self, error: usize) -> bool {
        let of = self.errors.get(error).filter(|_| !self.rotary);
        of.is_some_and(|of| !of.direction.is_rotation() && axis_direction(&of.axis) == Some(of.direction.index()))
    }
}

/// Takes the expansion of the material off the positions of a linear axis, about the first target.
pub(super) fn to_reference(import: &mut Import, material: Thermal) {
    let slope = material.expansion * (material.temperature - REFERENCE);
    for error in (0..import.errors.len()).filter(|error| import.is_positioning(*error)).collect::<Vec<_>>() {
        let mine = || import.samples.iter().filter(|sample| sample.error == error).map(|sample| sample.position);
        let first = mine().fold(f64::INFINITY, f64::min);
        let samples = import.samples.iter_mut().filter(|sample| sample.error == error);
        samples.for_each(|sample| sample.value -= slope * (sample.position - first));
    }
}
