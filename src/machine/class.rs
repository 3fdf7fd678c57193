//! Tolerances typical of a class of machines: from the table `classes.yaml`, or of the machine file.

use super::{Axis, AxisKind, ErrorId, ErrorKind};
use crate::units::significant;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The names in the table.
pub const CLASS_NAMES: [&str; 6] = ["ultra-precision", "premium", "production", "commodity", "large-gantry", "desktop"];

/// One class of machine tools.
#[derive(Debug, Clone, PartialEq)]
pub struct Class {
    /// Source of its numbers.
    pub source: String,
    /// A shorter travel counts as this, mm.
    shortest_mm: f64,
    /// In the order of [`ErrorKind::ALL`]: mm per mm, mm, rad. Those of linear axes are all there.
    numbers: [Option<f64>; 10],
}

/// A class with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedClass {
    /// Its name, as outputs have it.
    pub name: String,
    /// The class.
    pub class: Class,
}

/// Numbers of a class as far as they are given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ClassNumbers {
    /// In the order of [`ErrorKind::ALL`]: mm per mm, mm, rad.
    pub all: [Option<f64>; 10],
    /// A shorter travel counts as this, mm.
    pub shortest_mm: Option<f64>,
}

impl ClassNumbers {
    /// Completes them by those of another class. Fails with the number that is missing: all of linear axes are needed,
    /// and all or none of rotary ones.
    pub fn over(self, base: Option<Class>, source: String) -> Result<Class, ErrorKind> {
        let shortest_mm = self.shortest_mm.or(base.as_ref().map(|class| class.shortest_mm)).unwrap_or(0.0);
        let of_base = base.map_or([None; 10], |class| class.numbers);
        let numbers: [Option<f64>; 10] = std::array::from_fn(|i| self.all[i].or(of_base[i]));
        let rotary = numbers[ErrorKind::OF_LINEAR_AXES..].iter().any(Option::is_some);
        let missing = (0..if rotary { 10 } else { ErrorKind::OF_LINEAR_AXES }).find(|i| numbers[*i].is_none());
        match missing {
            Some(i) => Err(ErrorKind::ALL[i]),
            None => Ok(Class { source, shortest_mm, numbers }),
        }
    }
}

#[derive(Debug, Deserialize)]
struct ClassTable {
    min_travel_m: f64,
    classes: BTreeMap<String, ClassRow>,
}

#[derive(Debug, Deserialize)]
struct ClassRow {
    source: String,
    linear: LinearRow,
    rotary: Option<RotaryRow>,
}

#[derive(Debug, Deserialize)]
struct LinearRow {
    positioning_um_per_m: f64,
    straightness_um_per_m: f64,
    angular_urad: f64,
    squareness_urad: f64,
}

#[derive(Debug, Deserialize)]
struct RotaryRow {
    position_um: f64,
    orientation_urad: f64,
    radial_um: f64,
    axial_um: f64,
    tilt_urad: f64,
    angular_positioning_urad: f64,
}

/// Returns all classes of the table by name. The table is part of the program; a test reads it.
pub fn classes() -> BTreeMap<String, Class> {
    let table: Option<ClassTable> = serde_yaml::from_str(include_str!("classes.yaml")).ok();
    let Some(table) = table else { return BTreeMap::new() };
    let (um, urad) = (|x: f64| Some(x * 1e-3), |x: f64| Some(x * 1e-6));
    let class = |(name, row): (String, ClassRow)| {
        let (l, r) = (row.linear, row.rotary.as_ref());
        let numbers = [
            urad(l.positioning_um_per_m),
            urad(l.straightness_um_per_m),
            urad(l.angular_urad),
            urad(l.squareness_urad),
            r.and_then(|r| um(r.position_um)),
            r.and_then(|r| urad(r.orientation_urad)),
            r.and_then(|r| um(r.radial_um)),
            r.and_then(|r| um(r.axial_um)),
            r.and_then(|r| urad(r.tilt_urad)),
            r.and_then(|r| urad(r.angular_positioning_urad)),
        ];
        (name, Class { source: row.source, shortest_mm: table.min_travel_m * 1e3, numbers })
    };
    table.classes.into_iter().map(class).collect()
}

impl Class {
    /// True if it has values for rotary axes.
    pub fn knows_rotary(&self) -> bool {
        self.numbers[ErrorKind::OF_LINEAR_AXES].is_some()
    }

    /// Returns the bound (mm, rad) of an error of an axis, or of the spindle without an axis, along the axis or across
    /// it; `None` if the class has none.
    pub fn tolerance(&self, axis: Option<&Axis>, error: &ErrorId, along: bool) -> Option<f64> {
        let kind = ErrorKind::of(axis, error, along);
        let number = self.numbers[kind as usize];
        match axis {
            None => number.filter(|_| kind == ErrorKind::Squareness),
            Some(axis) if axis.kind == AxisKind::Linear && kind == ErrorKind::Position => None,
            Some(axis) if kind.grows_with_travel() => {
                let (min, max) = axis.travel.interval();
                number.map(|slope| slope * (max - min).max(self.shortest_mm))
            }
            Some(_) => number,
        }
    }

    /// Returns the class as it is written into a machine file, under `class:`.
    pub fn written(&self) -> String {
        let print = |kind: ErrorKind, value: f64| {
            let (factor, unit) = if kind.grows_with_travel() { (1e6, "um/m") } else { kind.direction().micro() };
            format!("{}: {} {unit}", kind.name(), significant(value * factor, 12))
        };
        let section = |name: &str| {
            let of = ErrorKind::ALL.into_iter().zip(self.numbers).filter(|(kind, _)| kind.section() == name);
            of.filter_map(|(kind, value)| Some(print(kind, value?))).collect::<Vec<_>>()
        };
        let (mut linear, rotary) = (section("linear"), section("rotary"));
        linear.push(format!("shortest: {} mm", significant(self.shortest_mm, 12)));
        let mut text = format!("class:\n  source: {}\n", serde_json::Value::from(self.source.as_str()));
        text += &format!("  linear: {{ {} }}\n", linear.join(", "));
        if !rotary.is_empty() {
            text += &format!("  rotary: {{ {} }}\n", rotary.join(", "));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_whole_and_its_numbers_are_plausible() {
        let classes = classes();
        let mut names: Vec<&str> = classes.keys().map(String::as_str).collect();
        names.sort_by_key(|name| CLASS_NAMES.iter().position(|known| known == name));
        assert_eq!(names, CLASS_NAMES);
        for (name, class) in &classes {
            assert!(class.source.contains("class-typical"), "{name}");
            // 1 m/m, 1 mm and 1000 urad are beyond any of them.
            assert!(class.numbers.iter().flatten().all(|x| *x > 0.0 && *x <= 1.0), "{name}");
            let count = class.numbers.iter().flatten().count();
            assert_eq!(count, if class.knows_rotary() { 10 } else { 4 }, "{name}");
        }
        assert!(!classes["commodity"].knows_rotary());
    }
}
