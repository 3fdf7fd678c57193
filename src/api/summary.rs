//! The machine in short: axes, tools, conventions and how many errors it has.

use super::show::{Arm, arms};
use crate::analysis::budget::{Coverage, adding, bounds};
use crate::job::machine_file::{InputFile, MachineFile};
use crate::machine::{AxisKind, Branch, Conventions, ErrorId, ErrorTerm, Travel};
use indexmap::IndexMap;

/// A machine in short, as `check` prints it.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct MachineSummary {
    /// Name of the machine.
    pub machine: String,
    /// The kinematic chain from workpiece to tool, such as `w C' A' Y' b X Z t`.
    pub chain: String,
    /// The axes in the order of the chain.
    pub axes: Vec<AxisSummary>,
    /// Names of the tools; empty for a tool without a name.
    pub tools: Vec<String>,
    /// The conventions in force.
    pub conventions: Conventions,
    /// Counts of the errors.
    pub errors: ErrorCounts,
    /// Which of the errors that act are known, by the file and the class that it names.
    pub coverage: Coverage,
    /// The files that the machine was read from.
    pub inputs: Vec<InputFile>,
}

/// An axis in short.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct AxisSummary {
    /// Name of the axis.
    pub name: String,
    /// Linear or rotary.
    pub kind: AxisKind,
    /// The branch that the axis is on.
    pub branch: Branch,
    /// Unit vector in machine coordinates at the zero pose.
    pub direction: [f64; 3],
    /// Point about which angular errors turn, in machine coordinates at the zero pose, mm.
    pub origin: [f64; 3],
    /// True if the axis turns without end.
    pub continuous: bool,
    /// Limits in `unit`; 0 and 360 for a continuous axis.
    pub travel: [f64; 2],
    /// Range in which its curves were measured, in `unit`, where it is less than the travel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<[f64; 2]>,
    /// `mm` or `deg`.
    pub unit: String,
    /// Arms from the point about which angular errors turn to the functional point, and what hangs on them.
    pub arm_mm: Arm,
}

/// Counts of the errors of a machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct ErrorCounts {
    /// Location errors with a value.
    pub location: usize,
    /// Component errors with a value.
    pub component: usize,
    /// Bounds that the file states: of errors, of axes and of squareness.
    pub tolerance: usize,
}

/// Returns a machine in short.
pub fn summary(file: &MachineFile) -> MachineSummary {
    let axis = |(axis, arm_mm): (&crate::machine::Axis, Arm)| {
        let (min, max) = axis.travel.interval();
        AxisSummary {
            name: axis.name.to_string(),
            kind: axis.kind,
            branch: axis.branch,
            direction: axis.direction,
            origin: axis.origin,
            continuous: axis.travel == Travel::Continuous,
            travel: [min, max],
            measured: file.measured_range(&axis.name).map(Into::into),
            unit: axis.unit().to_owned(),
            arm_mm,
        }
    };
    MachineSummary {
        machine: file.name().to_owned(),
        chain: file.chain().to_string(),
        axes: file.axes().iter().zip(arms(file)).map(axis).collect(),
        tools: file.tools().iter().map(|tool| tool.name.clone()).collect(),
        conventions: *file.conventions(),
        errors: counts(file),
        coverage: Coverage::of(file, &adding(file, &bounds(file, file.class().map(|named| &named.class)))),
        inputs: file.input_files().to_vec(),
    }
}

/// An error that is one number: a location error, or a bound.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ErrorNumber {
    /// Its value, or how far it is bounded to either side.
    pub value: f64,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// True for a bound.
    pub bound: bool,
}

/// Returns the errors that are one number, wherever the machine was read from, by name in the order of the chain.
pub(crate) fn error_numbers(file: &MachineFile) -> IndexMap<String, ErrorNumber> {
    let number = |(error, term): (ErrorId, &ErrorTerm)| {
        let (value, bound) = match term {
            ErrorTerm::Constant(value) => (*value, false),
            ErrorTerm::Tolerance(value) => (*value, true),
            ErrorTerm::Component(_) => return None,
        };
        let (factor, unit) = error.direction.micro();
        Some((error.to_string(), ErrorNumber { value: value * factor + 0.0, unit, bound }))
    };
    file.errors().filter_map(number).collect()
}

fn counts(file: &MachineFile) -> ErrorCounts {
    let mut counts = ErrorCounts { tolerance: file.tolerances().count(), ..ErrorCounts::default() };
    for (_, term) in file.errors() {
        *match term {
            ErrorTerm::Constant(_) => &mut counts.location,
            ErrorTerm::Component(_) => &mut counts.component,
            ErrorTerm::Tolerance(_) => &mut counts.tolerance,
        } += 1;
    }
    counts
}
