//! Two machines against each other: the properties in which they differ, in words.

use crate::job::over::Over;
use crate::job::path::PathResult;
use crate::machine::{
    Axis, AxisName, Direction, ErrorFamily, ErrorId, ErrorSizes, Machine, MachineProperty, SetUp, Tool, Travel,
};
use crate::units::significant;

/// Two machines against each other.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MachineDifference {
    /// Name of each machine.
    pub machines: [String; 2],
    /// File of each machine.
    pub files: [String; 2],
    /// Poses and reference of the difference.
    pub over: Over,
    /// Events of the path on each machine, where the tool poses are one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub paths: Vec<PathResult>,
    /// Number of tool poses asked for.
    pub asked: usize,
    /// Number of tool poses that both machines reach, and most differences by themselves: one that reaches less than
    /// nine tenths of them is judged on what it reaches.
    pub poses: usize,
    /// Seed of the tool poses.
    pub seed: u64,
    /// `bounds` where one of the machines bounds errors: then figures are the largest deviation that 95 % of machines
    /// drawn do not exceed; errors with values act in each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<&'static str>,
    /// 95 % position deviation of each machine at these tool poses, um.
    pub p95_um: [f64; 2],
    /// Second less first.
    pub minus_first_um: f64,
    /// The chain first, then geometry, conventions and errors joint by joint.
    pub differences: Vec<PropertyDifference>,
}

/// A property in which two machines differ.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PropertyDifference {
    /// `chain`, `direction`, `origin`, `sense`, `travel`, `tool`, `workpiece`, `conventions`, `setup`, `class`,
    /// `tolerances` or `error`.
    pub kind: &'static str,
    /// Name of the axis or error; empty where the property is the machine's.
    pub name: String,
    /// Value of the first machine, in words: of an error the largest absolute value over the volume.
    pub first: String,
    /// Value of the second.
    pub second: String,
    /// Of an error: the largest absolute difference over the volume, um or urad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest: Option<f64>,
    /// Change of the 95 % position deviation of the first machine by this difference alone, um: of the chain on the
    /// first machine, of all others on the first with the chain of the second. `None` where no deviation depends on it,
    /// and where an error curve of the second does not cover the travel of the first.
    pub minus_first_um: Option<f64>,
}

pub(crate) fn describe(
    first: &Machine,
    second: &Machine,
    property: &MachineProperty,
    minus_first_um: Option<f64>,
) -> PropertyDifference {
    let both = [first, second];
    let axis = |machine: &Machine, name: &str| machine.axis_index(name).map(|i| machine.axes()[i].clone());
    let of_axis = |name: &AxisName, words: fn(&Axis) -> String| {
        both.map(|machine| axis(machine, name.as_str()).map_or_else(|| "none".to_owned(), |axis| words(&axis)))
    };
    let (kind, name, [of_first, of_second], largest) = match property {
        MachineProperty::Chain => ("chain", String::new(), both.map(|m| m.chain().to_string()), None),
        MachineProperty::Direction(name) => {
            ("direction", name.to_string(), of_axis(name, |a| plain(&a.direction)), None)
        }
        MachineProperty::Origin(name) => ("origin", name.to_string(), of_axis(name, |a| point(&a.origin)), None),
        MachineProperty::Sense(name) => ("sense", name.to_string(), of_axis(name, sense), None),
        MachineProperty::Travel(name) => ("travel", name.to_string(), of_axis(name, travel), None),
        MachineProperty::Controller(name) => {
            let words = |axis: &Axis| axis.controller.words().join(", ");
            ("controller", name.to_string(), of_axis(name, words), None)
        }
        MachineProperty::Home(name) => {
            let words = |axis: &Axis| axis.home.map_or_else(|| "none".to_owned(), |q| plain(&[q]) + " " + axis.unit());
            ("home", name.to_string(), of_axis(name, words), None)
        }
        MachineProperty::Tool => ("tool", String::new(), both.map(|m| tool(m.tool())), None),
        MachineProperty::Workpiece => ("workpiece", String::new(), both.map(workpiece), None),
        MachineProperty::Conventions => ("conventions", String::new(), conventions(first, second), None),
        MachineProperty::SetUp => ("setup", String::new(), both.map(|m| set_up(m.setup())), None),
        MachineProperty::Class => ("class", String::new(), both.map(class), None),
        MachineProperty::Tolerances => ("tolerances", String::new(), tolerances(first, second), None),
        MachineProperty::Error(id) => {
            let sizes = first.error_sizes(second, id);
            ("error", id.to_string(), error(id, &sizes), Some(sizes.largest * id.direction.micro().0))
        }
    };
    PropertyDifference { kind, name, first: of_first, second: of_second, largest, minus_first_um }
}

fn plain(vector: &[f64]) -> String {
    vector.iter().map(|x| significant(*x + 0.0, 6)).collect::<Vec<_>>().join(", ")
}

fn point(point: &[f64; 3]) -> String {
    format!("{} mm", plain(point))
}

fn sense(axis: &Axis) -> String {
    if axis.sign() < 0.0 { "direct" } else { "iso841" }.to_owned()
}

fn travel(axis: &Axis) -> String {
    match axis.travel {
        Travel::Continuous => "continuous".to_owned(),
        Travel::Range(min, max) => format!("{} .. {} {}", significant(min, 6), significant(max, 6), axis.unit()),
    }
}

fn tool(tool: &Tool) -> String {
    let points = format!("gauge {}, functional point {}", point(&tool.gauge), point(&tool.tip));
    if tool.direction == [0.0, 0.0, 1.0] { points } else { format!("{points}, direction {}", plain(&tool.direction)) }
}

fn workpiece(machine: &Machine) -> String {
    let rotation = rotation_words(&machine.workpiece_angles());
    point(&machine.workpiece()) + &rotation.map_or_else(String::new, |words| format!(", rotation {words}"))
}

fn class(machine: &Machine) -> String {
    machine.class().map_or_else(|| "none".to_owned(), |class| class.name.clone())
}

/// The bounds of either machine that the other does not share.
fn tolerances(first: &Machine, second: &Machine) -> [String; 2] {
    let own = |machine: &Machine, other: &Machine| {
        let shared = other.tolerances().list();
        let words = |(name, bound, turns): &(String, f64, bool)| {
            let (factor, unit) = if *turns { Direction::A } else { Direction::X }.micro();
            format!("{name} within {} {unit}", significant(bound * factor, 4))
        };
        let list = machine.tolerances().list();
        let apart: Vec<String> = list.iter().filter(|bound| !shared.contains(bound)).map(words).collect();
        if apart.is_empty() { "none".to_owned() } else { apart.join(", ") }
    };
    [own(first, second), own(second, first)]
}

/// Words of either machine where the two differ.
fn conventions(first: &Machine, second: &Machine) -> [String; 2] {
    let there = |a: &Machine, b: &Machine| {
        let words = a.conventions().changes(b.conventions());
        let new = |change: &String| Some(format!("{} {}", change.split_once(' ')?.0, change.rsplit_once(' ')?.1));
        words.iter().filter_map(new).collect::<Vec<_>>().join(", ")
    };
    [there(second, first), there(first, second)]
}

fn set_up(setup: &SetUp) -> String {
    let length = |values: &[f64]| format!("{} um", plain(&values.iter().map(|mm| mm * 1e3).collect::<Vec<_>>()));
    let angles: Vec<f64> = setup.workpiece[3..].iter().map(|rad| rad * 1e6).collect();
    format!("tool {}, workpiece {} and {} urad", length(&setup.tool), length(&setup.workpiece[..3]), plain(&angles))
}

fn error(id: &ErrorId, sizes: &ErrorSizes) -> [String; 2] {
    let (factor, unit) = id.direction.micro();
    [0, 1].map(|i: usize| match sizes.sizes[i] {
        None => "none".to_owned(),
        Some(size) if sizes.bounded[i] => format!("within {} {unit}", significant(size * factor, 4)),
        Some(size) if id.family == ErrorFamily::Location => format!("{} {unit}", significant(size * factor, 4)),
        Some(size) => format!("up to {} {unit}", significant(size.abs() * factor, 4)),
    })
}

/// Returns the rotation of a workpiece by its angles about X, Y, Z (deg) in words; `None` without one.
pub(crate) fn rotation_words(angles: &[f64; 3]) -> Option<String> {
    let turns = ["A", "B", "C"].iter().zip(angles).filter(|(_, degrees)| **degrees != 0.0);
    let words: Vec<String> =
        turns.map(|(letter, degrees)| format!("{letter} {} deg", significant(*degrees, 7))).collect();
    (!words.is_empty()).then(|| words.join(", "))
}
