//! The lines of a machine's rotary axes and its tool axis: as they are nominally, and as the location errors displace
//! them.
//!
//! A line is taken from the motion itself: from the displacement of the tool relative to the workpiece when one axis
//! turns by 90 deg and all others stand at 0. So every convention of location errors gives the line that is there.
//! Errors of linear axes have no part in it.

use super::transformation::{RotaryLine, Transformation};
use crate::algebra::Htm;
use crate::compensation::RotaryPlacement;
use crate::diagnostic::{Diagnostic, codes};
use crate::lower::{Chain, Exact, values};
use crate::machine::{Approach, AxisKind, ErrorFamily, ErrorId, Location, Machine, MovedLine};
use nalgebra::Vector3;

/// Largest difference of a direction from a machine axis, or of an offset in mm, that counts as none.
const SAME: f64 = 1e-9;

/// Returns the placement of the rotary axes of a machine that a five-axis transformation can have. Refusal: E0751.
pub fn placement(machine: &Machine) -> Result<RotaryPlacement, Diagnostic> {
    let kinds: Vec<AxisKind> = machine.axes().iter().map(|axis| axis.kind).collect();
    let rotary = |kind: &&AxisKind| **kind == AxisKind::Rotary;
    let tables = kinds.iter().take_while(rotary).count();
    let heads = kinds.iter().rev().take_while(rotary).count();
    let unit = |k: usize| std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
    let along = |k: usize| {
        let sought: [f64; 3] = unit(k);
        machine
            .axes()
            .iter()
            .filter(|axis| axis.kind == AxisKind::Linear)
            .any(|axis| (0..3).all(|i| (axis.direction[i] * axis.sign() - sought[i]).abs() < SAME))
    };
    let fits = kinds.len() == tables + heads + 3 && (0..3).all(along);
    let found = RotaryPlacement::ALL.into_iter().find(|one| fits && one.counts() == (tables, heads));
    found.ok_or_else(|| {
        Diagnostic::new(
            codes::E0751,
            "kinematic parameters are for machines whose linear axes X, Y and Z, along the machine axes and next to \
             one another in the chain, move the tool in + relative to the workpiece, with one or two rotary axes",
        )
        .help("the error tables of other targets have no such condition: `abbe targets MACHINE` compares them")
    })
}

impl Transformation {
    /// Returns the nominal lines. Refusal: E0751.
    pub fn nominal(machine: &Machine) -> Result<Self, Diagnostic> {
        let placement = placement(machine)?;
        let gauge = Vector3::from(machine.tool().gauge);
        let line = |axis: usize| {
            let this = &machine.axes()[axis];
            RotaryLine {
                axis,
                direction: Vector3::from(this.direction) * this.sign(),
                point: Vector3::from(this.origin) - gauge,
            }
        };
        let tables = placement.counts().0;
        let linear = std::array::from_fn(|k| linear_axis(machine, k));
        let rotary = (0..machine.axes().len()).filter(|axis| machine.axes()[*axis].kind == AxisKind::Rotary);
        let mut table: Vec<RotaryLine> = rotary.map(line).collect();
        let head = table.split_off(tables);
        Ok(Self { placement, linear, table, head, tool: Vector3::from(machine.tool().direction) })
    }

    /// Returns the lines that the location errors of rotary axes and spindle displace, in the directions of the linear
    /// axes and counted from where the gauge point then is. Refusal: E0751.
    pub fn actual(machine: &Machine) -> Result<Self, Diagnostic> {
        let mut lines = Self::nominal(machine)?;
        let among = |id: &ErrorId, of: &[RotaryLine]| {
            of.iter().any(|line| id.family == ErrorFamily::Location && machine.axes()[line.axis].name == id.axis)
        };
        let spindle = |id: &ErrorId| machine.chain().spindle() == Some(&id.axis);
        let of_table = machine.filtered(|id| among(id, &lines.table));
        let located = machine.filtered(|id| among(id, &lines.table) || among(id, &lines.head) || spindle(id));
        let zero = tool_place(&located, None);
        // Errors that displace bodies turn the workpiece against the linear axes.
        let workpiece = tool_place(&of_table, None);
        let [back, from_workpiece] = [&zero, &workpiece].map(|of| of.inverse().unwrap_or_else(Htm::identity));
        let of_tool = from_workpiece.compose(&zero);
        let (gauge, nominal_gauge) = (of_tool.apply(&machine.tool().gauge), Vector3::from(machine.tool().gauge));
        for line in lines.table.iter_mut().chain(&mut lines.head) {
            let quarter = tool_place(&located, Some(line.axis)).compose(&back);
            let (direction, foot) = axis_of_quarter_turn(&from_workpiece.compose(&quarter).compose(&workpiece));
            let near = line.point + nominal_gauge - foot;
            line.point = foot + direction * direction.dot(&near) - gauge;
            line.direction = direction;
        }
        lines.tool = (of_tool.linear * lines.tool).normalize();
        Ok(lines)
    }
}

/// Returns the place of the tool with one axis at 90 deg and all others at 0.
fn tool_place(machine: &Machine, axis: Option<usize>) -> Htm<f64> {
    let pose: Vec<f64> = (0..machine.axes().len()).map(|i| if Some(i) == axis { 90.0 } else { 0.0 }).collect();
    Chain::<f64>::actual(machine, &pose, &values(machine, &Approach::Mean.at_pose(&pose)), &Exact).t_wt()
}

/// Smallest difference of direction cosines or mm that counts as a displacement of a line.
const DISPLACED: f64 = 1e-13;

impl Transformation {
    /// Returns the machine whose nominal lines are these and whose errors are what is then left: location errors lead
    /// from these lines to the actual ones. Refusal: E0751, where location errors displace bodies.
    pub fn remaining(&self, machine: &Machine) -> Result<Machine, Diagnostic> {
        if machine.conventions().location != Location::AxisOnly {
            return Err(Diagnostic::new(
                codes::E0751,
                "tables beside kinematic parameters are for machines whose location errors displace axes only",
            )
            .help("`abbe convert` writes the machine with `location: axis_only`"));
        }
        let actual = Self::actual(machine)?;
        let spindle = machine.spindle_errors().map(crate::machine::JointErrors::location_values);
        let spindle = spindle.unwrap_or_default();
        let gauge = Vector3::from(machine.tool().gauge) + Vector3::new(spindle[0], spindle[1], spindle[2]);
        let lines = self.table.iter().chain(&self.head).zip(actual.table.iter().chain(&actual.head));
        let moved = lines.map(|(own, actual)| {
            let across = |v: Vector3<f64>| v - own.direction * own.direction.dot(&v);
            let (shift, turn) = (across(actual.point - own.point), own.direction.cross(&actual.direction));
            MovedLine {
                axis: own.axis,
                direction: (own.direction * machine.axes()[own.axis].sign()).into(),
                origin: (own.point + gauge).into(),
                location: six(shift, turn),
            }
        });
        let own_turn = self.tool.cross(&actual.tool);
        let spindle = six(Vector3::new(spindle[0], spindle[1], spindle[2]), own_turn);
        let tip = self.tip_vector(machine) + Vector3::from(machine.tool().gauge);
        Ok(machine.with_lines(&moved.collect::<Vec<_>>(), self.tool.into(), tip.into(), spindle))
    }

    /// The vector from the gauge point to the tip of a tool along this tool axis.
    fn tip_vector(&self, machine: &Machine) -> Vector3<f64> {
        let [gauge, tip, axis] =
            [machine.tool().gauge, machine.tool().tip, machine.tool().direction].map(Vector3::from);
        self.tilt(&(tip - gauge), &axis)
    }
}

/// Location errors, those that are rounding left out.
fn six(shift: Vector3<f64>, turn: Vector3<f64>) -> [f64; 6] {
    let kept = |value: f64| if value.abs() > DISPLACED { value } else { 0.0 };
    [shift[0], shift[1], shift[2], turn[0], turn[1], turn[2]].map(kept)
}

/// Returns the index of the linear axis along X, Y or Z; the machine has one.
fn linear_axis(machine: &Machine, k: usize) -> usize {
    let along = |axis: &crate::machine::Axis| axis.kind == AxisKind::Linear && axis.direction[k].abs() > 0.5;
    machine.axes().iter().position(along).unwrap_or_default()
}

/// Returns the unit vector about which a motion turns by 90 deg right-handed, and the point of its axis nearest to the
/// zero of the frame.
fn axis_of_quarter_turn(motion: &Htm<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let r = &motion.linear;
    let direction = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]).normalize();
    // t = p - u x p for the point p of the axis with u p = 0, so t + u x t = 2 p.
    let across = motion.translation - direction * direction.dot(&motion.translation);
    (direction, (across + direction.cross(&across)) * 0.5)
}
