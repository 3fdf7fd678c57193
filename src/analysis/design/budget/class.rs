//! Tolerances typical of a class of machines, from the table `classes.yaml`.

use crate::machine::{Axis, AxisKind, Direction, ErrorId};
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Debug, Deserialize)]
struct ClassTable {
    min_travel_m: f64,
    classes: BTreeMap<String, Class>,
}

/// One class of machine tools.
#[derive(Debug, Clone, Deserialize)]
pub struct Class {
    /// Source of its numbers.
    pub source: String,
    #[serde(skip)]
    /// Shortest travel for which the table holds, mm.
    min_travel_mm: f64,
    linear: Linear,
    rotary: Option<Rotary>,
}

#[derive(Debug, Clone, Deserialize)]
struct Linear {
    positioning_um_per_m: f64,
    straightness_um_per_m: f64,
    angular_urad: f64,
    squareness_urad: f64,
}

#[derive(Debug, Clone, Deserialize)]
struct Rotary {
    position_um: f64,
    orientation_urad: f64,
    radial_um: f64,
    axial_um: f64,
    tilt_urad: f64,
    angular_positioning_urad: f64,
}

/// Returns all classes by name. The table is part of the program; a test reads it.
pub fn classes() -> BTreeMap<String, Class> {
    let table: Option<ClassTable> = serde_yaml::from_str(include_str!("classes.yaml")).ok();
    let Some(table) = table else { return BTreeMap::new() };
    let complete = |(name, class)| (name, Class { min_travel_mm: table.min_travel_m * 1e3, ..class });
    table.classes.into_iter().map(complete).collect()
}

impl Class {
    /// True if it has values for rotary axes.
    pub fn knows_rotary(&self) -> bool {
        self.rotary.is_some()
    }

    /// Returns the bound (mm, rad) of an error of an axis, or of the spindle without an axis; `None` if the class has
    /// none.
    pub fn tolerance(&self, axis: Option<&Axis>, error: &ErrorId) -> Option<f64> {
        let (um, urad) = (1e-3, 1e-6);
        let turns = error.direction.is_rotation();
        let Some(axis) = axis else { return turns.then_some(self.linear.squareness_urad * urad) };
        let own = along(axis, error.direction);
        let (min, max) = axis.travel.interval();
        let metres = (max - min).max(self.min_travel_mm) * 1e-3;
        use crate::machine::ErrorFamily::{Component, Location};
        Some(match (axis.kind, error.family, turns) {
            (AxisKind::Linear, Location, true) => self.linear.squareness_urad * urad,
            (AxisKind::Linear, Location, false) => return None,
            (AxisKind::Linear, Component, true) => self.linear.angular_urad * urad,
            (AxisKind::Linear, Component, false) if own => self.linear.positioning_um_per_m * metres * um,
            (AxisKind::Linear, Component, false) => self.linear.straightness_um_per_m * metres * um,
            (AxisKind::Rotary, Location, true) => self.rotary.as_ref()?.orientation_urad * urad,
            (AxisKind::Rotary, Location, false) => self.rotary.as_ref()?.position_um * um,
            (AxisKind::Rotary, Component, true) if own => self.rotary.as_ref()?.angular_positioning_urad * urad,
            (AxisKind::Rotary, Component, true) => self.rotary.as_ref()?.tilt_urad * urad,
            (AxisKind::Rotary, Component, false) if own => self.rotary.as_ref()?.axial_um * um,
            (AxisKind::Rotary, Component, false) => self.rotary.as_ref()?.radial_um * um,
        })
    }
}

/// True if the direction is the one nearest to that of the axis.
pub(super) fn along(axis: &Axis, direction: Direction) -> bool {
    let size = |i: usize| axis.direction[i].abs();
    let nearest = (1..3).fold(0, |nearest, i| if size(i) > size(nearest) { i } else { nearest });
    direction.index() % 3 == nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_whole_and_its_numbers_are_plausible() {
        let classes = classes();
        let names: Vec<&str> = classes.keys().map(String::as_str).collect();
        assert_eq!(names, ["commodity", "desktop", "large-gantry", "premium", "production", "ultra-precision"]);
        for (name, class) in &classes {
            assert!(class.source.contains("class-typical"), "{name}");
            let linear = &class.linear;
            let rotary = class.rotary.as_ref().map_or(vec![1.0], |r| {
                vec![
                    r.position_um,
                    r.orientation_urad,
                    r.radial_um,
                    r.axial_um,
                    r.tilt_urad,
                    r.angular_positioning_urad,
                ]
            });
            let numbers = [
                linear.positioning_um_per_m,
                linear.straightness_um_per_m,
                linear.angular_urad,
                linear.squareness_urad,
            ];
            assert!(numbers.iter().chain(&rotary).all(|x| *x > 0.0 && *x <= 1000.0), "{name}");
        }
        assert!(!classes["commodity"].knows_rotary());
    }
}
