//! `diff` of two machine files: what differs, and what each difference does to the deviations.

use super::compare::nothing_in_common;
use super::machine_file::{MachineFile, sources_of};
use super::order_of;
use super::run::{Answer, Call, Count, Refused, Run};
use crate::analysis::{MachineResult, Work, compare as compared};
use crate::diagnostic::Diagnostics;
use crate::evaluate::{Bare, Field, Order};
use crate::machine::{
    Approach, Axis, AxisName, Direction, ErrorFamily, ErrorId, ErrorSizes, Machine, MachineProperty, SetUp, Tool,
    Travel,
};
use crate::units::significant;

/// Options of [`diff_machines`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct DiffMachinesOptions {
    /// Number of tool poses, drawn from the volume of the first machine.
    pub poses: usize,
    /// Seed of the tool poses.
    pub seed: u64,
    /// Order of the errors; exact by default, unless the conventions of a machine name an order.
    pub order: Option<Order>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
}

impl Default for DiffMachinesOptions {
    fn default() -> Self {
        Self { poses: 1000, seed: 1, order: None, approach: Approach::default() }
    }
}

/// Two machines against each other.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MachineDifference {
    /// Name of each machine.
    pub machines: [String; 2],
    /// File of each machine.
    pub files: [String; 2],
    /// Number of tool poses asked for.
    pub asked: usize,
    /// Number of tool poses that both machines reach, with every difference by itself too.
    pub poses: usize,
    /// Seed of the tool poses.
    pub seed: u64,
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

/// Compares two machines property by property, and states the effect of each difference on the 95 % position
/// deviation over tool poses that both reach.
///
/// Fails if the files are not two, and if no tool pose is reached by both machines.
pub fn diff_machines(
    files: &[MachineFile],
    options: &DiffMachinesOptions,
    run: Run<'_>,
) -> Result<Answer<MachineDifference>, Diagnostics> {
    Call::answer(run, &sources_of(files), |call| difference(call, files, options))
}

fn difference(
    call: &mut Call<'_>,
    files: &[MachineFile],
    options: &DiffMachinesOptions,
) -> Result<MachineDifference, Refused> {
    let [first, second] = files else { return call.usage("`diff` takes two machines") };
    call.bounded(&[Count::Poses(options.poses)])?;
    let properties = first.differences(second);
    // These change no deviation, and a travel taken alone would change the work.
    let idle = |property: &MachineProperty| {
        matches!(
            property,
            MachineProperty::Travel(_)
                | MachineProperty::Controller(_)
                | MachineProperty::Class
                | MachineProperty::Tolerances
        )
    };
    let alone = |property: &&MachineProperty| !idle(property);
    let single: Vec<(&MachineProperty, Machine)> = properties
        .iter()
        .filter(alone)
        .filter_map(|property| Some((property, first.with_property_of(second, property)?)))
        .collect();
    let both = [&**first, &**second].into_iter();
    let machines: Vec<&Machine> = both.chain(single.iter().map(|(_, machine)| machine)).collect();
    let bare: Vec<Bare<'_>> =
        machines.iter().map(|machine| Bare { machine, order: order_of(machine, options.order) }).collect();
    let fields: Vec<&dyn Field> = bare.iter().map(|field| field as &dyn Field).collect();
    let work = Work::random(first, options.poses, options.seed);
    let found = call.stage(work.len(), |advance| compared(&fields, &work, options.approach.into(), advance));
    if found.common.is_empty() {
        return call.refuse(nothing_in_common(files, &found));
    }
    let p95 = |machine: usize| found.machines[machine].statistics.position_um.p95;
    let of = |property: &MachineProperty| {
        let index = single.iter().position(|(known, _)| *known == property)? + 2;
        covered(machines[index], &found.machines[index]).then(|| p95(index))
    };
    // Everything but the chain itself is judged on the chain of the second.
    let base = of(&MachineProperty::Chain).unwrap_or(p95(0));
    let effect = |property: &MachineProperty| {
        let from = if *property == MachineProperty::Chain { p95(0) } else { base };
        of(property).map(|um| um - from)
    };
    Ok(MachineDifference {
        machines: [first, second].map(|file| file.name().to_owned()),
        files: [first, second].map(|file| file.path().to_owned()),
        asked: found.asked,
        poses: found.common.len(),
        seed: options.seed,
        p95_um: [p95(0), p95(1)],
        minus_first_um: p95(1) - p95(0),
        differences: properties.iter().map(|property| described(first, second, property, effect(property))).collect(),
    })
}

/// True if every error curve is defined at the poses.
fn covered(machine: &Machine, side: &MachineResult) -> bool {
    side.reached.iter().all(|(pose, _)| machine.outside(pose).is_none())
}

fn described(
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
    let rotation = super::show::rotation_words(&machine.workpiece_angles());
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
