//! The kinematic chain: frames, lever arms, and the location errors it needs.

use crate::analysis::{Lever, LocationSet, Status, arm_shares, levers};
use crate::job::machine_file::{InputFile, MachineFile};
use crate::machine::{Axis, AxisKind, BodyMesh, Branch, Conventions, ErrorId, Machine, Sense, Travel};
use crate::report::{self, Picture, rotation_words};

/// The kinematic chain of a machine.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct ChainResult {
    /// Name of the machine.
    pub machine: String,
    /// The chain from workpiece to tool, such as `w C' A' Y' b X Z t`.
    pub chain: String,
    /// The axes in the order of the chain.
    pub axes: Vec<ChainAxis>,
    /// The tools.
    pub tools: Vec<ChainTool>,
    /// Origin of the workpiece in machine coordinates at the zero pose, mm.
    pub workpiece_origin_mm: [f64; 3],
    /// Angles A, B, C by which the workpiece's coordinates are turned about X, then Y, then Z of the machine, deg.
    pub workpiece_rotation_deg: [f64; 3],
    /// Unit vector upwards in the picture, in machine coordinates; none where the file states none.
    pub up: Option<[f64; 3]>,
    /// Meshes that bodies are drawn by.
    pub look: Vec<ChainMesh>,
    /// The conventions in force.
    pub conventions: Conventions,
    /// The location errors.
    pub location_errors: LocationErrors,
    /// The files that the machine was read from.
    pub inputs: Vec<InputFile>,
}

/// An axis of a chain, in machine coordinates at the zero pose.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct ChainAxis {
    /// Name of the axis.
    pub name: String,
    /// Linear or rotary.
    pub kind: AxisKind,
    /// The branch that the axis stands on.
    pub side: Branch,
    /// Sense of the positive direction.
    pub sense: Sense,
    /// Unit vector.
    pub direction: [f64; 3],
    /// Point about which angular errors turn, mm.
    pub origin_mm: [f64; 3],
    /// Limits in `unit`; 0 and 360 for a continuous axis.
    pub travel: [f64; 2],
    /// True if the axis turns without end.
    pub continuous: bool,
    /// `mm` or `deg`.
    pub unit: String,
    /// Arms from the point about which angular errors turn to the functional point.
    pub arm_mm: Arm,
    /// True if the file states the geometry for the side on which the axis stands.
    pub geometry_stated: bool,
    /// Geometry that the file states for the other side.
    pub other_side: Option<OtherSide>,
}

/// Geometry of an axis for the side on which it does not stand, the other axes staying where they are.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct OtherSide {
    /// The other branch.
    pub side: Branch,
    /// Unit vector.
    pub direction: [f64; 3],
    /// Point about which angular errors turn, mm.
    pub origin_mm: [f64; 3],
    /// Limits in the unit of the axis; 0 and 360 for a continuous axis.
    pub travel: [f64; 2],
    /// True if the axis turns without end.
    pub continuous: bool,
}

/// A mesh that a body is drawn by.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ChainMesh {
    /// `bed`, `workpiece`, `tool`, or the name of an axis.
    pub body: String,
    /// Path of its file.
    pub file: String,
    /// Unit of its coordinates, mm; null for that of its format.
    pub unit_mm: Option<f64>,
    /// Place of its origin, mm.
    pub origin_mm: [f64; 3],
    /// Angles A, B, C by which it is turned about X, then Y, then Z, deg.
    pub rotation_deg: [f64; 3],
}

/// A lever arm, mm.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Arm {
    /// At the zero pose.
    pub at_zero: f64,
    /// The longest over the volume.
    pub longest: f64,
    /// Fraction of the sum of squares of all errors, each by itself, that the angular errors of the axis make over the
    /// volume, at their values or bounds. None without errors.
    pub share: Option<f64>,
}

/// A tool, in machine coordinates at the zero pose.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ChainTool {
    /// Name of the tool; may be empty.
    pub name: String,
    /// Gauge point, mm.
    pub gauge_mm: [f64; 3],
    /// Functional point, mm.
    pub tip_mm: [f64; 3],
    /// Unit vector of its axis, from the tip towards the spindle.
    pub direction: [f64; 3],
    /// True for the tool in use.
    #[serde(skip)]
    pub in_use: bool,
}

/// The location errors of a chain.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct LocationErrors {
    /// Those that the chain needs.
    pub set: Vec<LocationError>,
    /// Names of those that are given besides.
    pub besides: Vec<ErrorId>,
}

/// A location error that a chain needs.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct LocationError {
    /// Name of the error.
    pub error: ErrorId,
    /// Status of its value.
    pub status: Status,
}

impl ChainResult {
    /// Returns the rotation of the workpiece in words, such as `A -90 deg, C 45 deg`; `None` without one.
    pub fn workpiece_rotation(&self) -> Option<String> {
        rotation_words(&self.workpiece_rotation_deg)
    }
}

/// Returns the kinematic chain of a machine.
pub fn show(file: &MachineFile) -> ChainResult {
    let used = &file.tool().name;
    let tool = |tool: &crate::machine::Tool| ChainTool {
        name: tool.name.clone(),
        gauge_mm: tool.gauge,
        tip_mm: tool.tip,
        direction: tool.direction,
        in_use: tool.name == *used,
    };
    let set = LocationSet::of(file);
    let member = |(error, status): (ErrorId, Status)| LocationError { error, status };
    ChainResult {
        machine: file.name().to_owned(),
        chain: file.chain().to_string(),
        axes: axes(file),
        tools: file.tools().iter().map(tool).collect(),
        workpiece_origin_mm: file.workpiece(),
        workpiece_rotation_deg: file.workpiece_angles(),
        up: file.look.up,
        look: drawn_meshes(file).map(chain_mesh).collect(),
        conventions: *file.conventions(),
        location_errors: LocationErrors { set: set.members.into_iter().map(member).collect(), besides: set.besides },
        inputs: file.input_files().to_vec(),
    }
}

/// Returns the meshes of bodies that the machine has; variants drop axes.
pub(super) fn drawn_meshes(file: &MachineFile) -> impl Iterator<Item = &BodyMesh> {
    let is_there = |body: &str| {
        ["bed", "workpiece", "tool"].contains(&body) || file.axes().iter().any(|axis| axis.name.as_str() == body)
    };
    file.look.meshes.iter().filter(move |mesh| is_there(&mesh.body))
}

fn chain_mesh(of: &BodyMesh) -> ChainMesh {
    ChainMesh {
        body: of.body.clone(),
        file: of.path.display().to_string(),
        unit_mm: of.unit_mm,
        origin_mm: of.origin,
        rotation_deg: of.rotation,
    }
}

fn axes(machine: &Machine) -> Vec<ChainAxis> {
    let of = machine.axes().iter().zip(arms(machine));
    of.map(|(of, arm)| axis(machine, of, arm)).collect()
}

/// Returns the lever arms of all axes of a machine, with what hangs on them.
pub(crate) fn arms(machine: &Machine) -> Vec<Arm> {
    let shares = arm_shares(machine);
    let arm = |(i, lever): (usize, Lever)| {
        let share = shares.as_ref().map(|shares| shares[i]);
        Arm { at_zero: lever.at_zero, longest: lever.longest, share }
    };
    levers(machine).into_iter().enumerate().map(arm).collect()
}

fn axis(machine: &Machine, axis: &Axis, arm_mm: Arm) -> ChainAxis {
    let (min, max) = axis.travel.interval();
    ChainAxis {
        name: axis.name.to_string(),
        kind: axis.kind,
        side: axis.branch,
        sense: axis.sense,
        direction: axis.direction,
        origin_mm: axis.origin,
        travel: [min, max],
        continuous: axis.travel == Travel::Continuous,
        unit: axis.unit().to_owned(),
        arm_mm,
        geometry_stated: machine.geometry().unstated(&axis.name, &machine.sides()).is_none(),
        other_side: other_side(machine, axis),
    }
}

fn other_side(machine: &Machine, axis: &Axis) -> Option<OtherSide> {
    let (geometry, mut sides) = (machine.geometry(), machine.sides());
    let side = axis.branch.opposite();
    let _ = sides.insert(axis.name.clone(), side);
    if geometry.unstated(&axis.name, &sides).is_some() {
        return None;
    }
    let there = geometry.axes.get(&axis.name)?.on(side);
    let (min, max) = there.travel.interval();
    Some(OtherSide {
        side,
        direction: there.direction,
        origin_mm: geometry.origins(&sides).axis(&axis.name),
        travel: [min, max],
        continuous: there.travel == Travel::Continuous,
    })
}

impl MachineFile {
    /// Returns a picture of the kinematic chain.
    pub fn chain_picture(&self) -> Picture {
        report::chain_picture(self)
    }

    /// Returns a drawing of the zero pose in three views.
    pub fn zero_pose_picture(&self) -> Picture {
        report::zero_pose_picture(self)
    }

    /// Returns the kinematic chain as a graph for Graphviz.
    pub fn chain_dot(&self) -> String {
        report::chain_dot(self)
    }

    /// Returns a picture of the curves of the component errors; none without component errors.
    pub fn error_curves(&self) -> Option<Picture> {
        report::all_curves(self)
    }
}
