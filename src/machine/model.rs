//! [`Machine`] and what it is made of.

use super::{
    AlgebraChoice, Axis, AxisKind, AxisName, Conventions, CurveArgument, ErrorId, ErrorTerm, Geometry, JointErrors,
    JointUncertainty, KinematicChain, NamedClass, ResidualForm, SetUp, Tolerances, Travel, UnheldMotion,
    sin_cos_degrees,
};
use crate::algebra::rotation_about;
use indexmap::IndexMap;
use nalgebra::Matrix3;
use std::collections::BTreeMap;

/// Returns the rotation by angles (deg) about the standing X, then Y, then Z.
pub fn rotation_of(angles: [f64; 3]) -> Matrix3<f64> {
    let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let turns = units.iter().zip(angles).filter(|(_, degrees)| *degrees != 0.0);
    turns.fold(Matrix3::identity(), |before, (about, degrees)| rotation_about(about, sin_cos_degrees(degrees)) * before)
}

/// Positions of all axes as programmed (mm, deg), in the order of [`Machine::axes`].
pub type Pose = Vec<f64>;

/// Positions by the names of the axes, in the order of the chain; mm and deg.
pub type AxisPositions = IndexMap<String, f64>;

/// Returns the positions of a pose by name.
pub fn axis_positions(machine: &Machine, pose: &[f64]) -> AxisPositions {
    // Adding zero turns -0 into 0.
    machine.axes().iter().zip(pose).map(|(axis, q)| (axis.name.to_string(), q + 0.0)).collect()
}

/// A tool: two points (mm) and its axis, in machine coordinates at the zero pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    /// The name it is chosen by; empty for the only tool.
    pub name: String,
    /// Gauge point, about which the spindle's errors turn.
    pub gauge: [f64; 3],
    /// The functional point.
    pub tip: [f64; 3],
    /// Its axis: a unit vector from the tip towards the spindle.
    pub direction: [f64; 3],
}

/// A rotary axis on another nominal line.
#[derive(Debug, Clone, PartialEq)]
pub struct MovedLine {
    /// Index in the walk.
    pub axis: usize,
    /// Unit vector, as [`Axis::direction`].
    pub direction: [f64; 3],
    /// A point of the line, mm.
    pub origin: [f64; 3],
    /// Location errors, mm and rad.
    pub location: [f64; 6],
}

/// Interval and step of one axis for maps and tables (mm or deg).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
    /// Largest distance of two nodes.
    pub step: f64,
}

/// The origin of the numbers; free text.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, schemars::JsonSchema)]
pub struct Provenance {
    /// Key and value as written.
    pub entries: Vec<(String, String)>,
}

/// The fields of a [`Machine`]; a value of this type promises nothing.
#[derive(Debug, Clone)]
pub struct MachineParts {
    /// Its name.
    pub name: String,
    /// The graph.
    pub chain: KinematicChain,
    /// The chain's axes on the walk from workpiece to tool.
    pub axes: Vec<Axis>,
    /// Errors of each axis in the same order, then of the spindle if the chain has one.
    pub errors: Vec<JointErrors>,
    /// At least one; the first is in use unless another is chosen.
    pub tools: Vec<Tool>,
    /// Workpiece origin (mm).
    pub workpiece: [f64; 3],
    /// Angles (deg) by which the workpiece's coordinates are turned about the fixed X, then Y, then Z of the machine.
    pub workpiece_rotation: [f64; 3],
    /// Conventions in force.
    pub conventions: Conventions,
    /// Set-up errors.
    pub setup: SetUp,
    /// Interval and step of each axis, in the order of `axes`.
    pub volume: Vec<Grid>,
    /// The origin of the numbers.
    pub provenance: Provenance,
    /// Expanded uncertainties (k = 2; mm, rad) of the values of errors, where the file states them: each common to the
    /// whole curve.
    pub uncertainty: BTreeMap<ErrorId, f64>,
    /// Joint uncertainty of errors: independent parts.
    pub covariance: Vec<JointUncertainty>,
    /// Forms of axes that the errors leave, at most one of each axis.
    pub forms: Vec<ResidualForm>,
    /// Rigid motions of the workpiece frame that the data behind the errors do not hold.
    pub unheld: Vec<UnheldMotion>,
    /// Ranges (mm, deg) in which the curves of axes were measured, of axes for which that is less than the travel.
    pub measured: BTreeMap<AxisName, (f64, f64)>,
    /// The algebra it names, if any.
    pub algebra: Option<AlgebraChoice>,
    /// Bounds along and across axes, and of squareness; those by letter are among the errors.
    pub tolerances: Tolerances,
    /// The class that bounds everything else, if the file names one.
    pub class: Option<NamedClass>,
    /// Geometry of the axes on either side of the bed; `axes`, `errors` and `workpiece` are of the sides on which
    /// the axes stand.
    pub geometry: Geometry,
}

impl MachineParts {
    /// Returns the joints in the order of `errors`: axes, then the spindle, which is none.
    pub(in crate::machine) fn joints(&self) -> impl Iterator<Item = (&AxisName, Option<&Axis>)> {
        let axes = self.axes.iter().map(|axis| (&axis.name, Some(axis)));
        axes.chain(self.chain.spindle().map(|name| (name, None)))
    }
}

/// A position that cannot be evaluated: an error curve is not defined there.
#[derive(Debug, Clone, PartialEq)]
pub struct UndefinedError {
    /// The error.
    pub error: ErrorId,
    /// The position asked for (mm or deg).
    pub position: f64,
    /// The interval in which the curve is defined.
    pub domain: (f64, f64),
}

/// A valid machine: axes and errors belong to the chain, numbers are finite, directions are unit
/// vectors, travels rise, curves cover the travel, and there is a tool.
#[derive(Debug, Clone)]
pub struct Machine {
    parts: MachineParts,
    tool: usize,
}

impl Machine {
    /// Only [`super::resolve()`] makes machines, after its checks.
    pub(in crate::machine) fn new(parts: MachineParts) -> Self {
        Self { parts, tool: 0 }
    }

    /// Returns the pose at which the control homes all axes (mm, deg); none if the file does not state it for each.
    pub fn home(&self) -> Option<Pose> {
        self.axes().iter().map(|axis| axis.home).collect()
    }

    pub(in crate::machine) fn parts(&self) -> &MachineParts {
        &self.parts
    }

    /// Returns the same tool in use with other fields.
    pub(in crate::machine) fn with_parts(&self, parts: MachineParts) -> Self {
        Self { parts, tool: self.tool }
    }

    /// Returns the same machine with other errors, of each axis and then of the spindle: nothing else of it is measured
    /// or bounded.
    pub(crate) fn with_errors(&self, errors: Vec<JointErrors>) -> Self {
        let (uncertainty, covariance, forms, unheld) = Default::default();
        let (setup, tolerances, measured) = Default::default();
        let parts = self.parts.clone();
        self.with_parts(MachineParts {
            errors,
            setup,
            uncertainty,
            covariance,
            forms,
            unheld,
            measured,
            tolerances,
            class: None,
            ..parts
        })
    }

    /// Returns its fields, the tool in use first: with [`super::machine_file()`] the file of another machine.
    pub fn to_parts(&self) -> MachineParts {
        let mut parts = self.parts.clone();
        parts.tools[..=self.tool].rotate_right(1);
        parts
    }

    /// Returns its name.
    pub fn name(&self) -> &str {
        &self.parts.name
    }

    /// Returns the graph.
    pub fn chain(&self) -> &KinematicChain {
        &self.parts.chain
    }

    /// Axes on the walk from workpiece to tool.
    pub fn axes(&self) -> &[Axis] {
        &self.parts.axes
    }

    /// Index of an axis in [`Self::axes`].
    pub fn axis_index(&self, name: &str) -> Option<usize> {
        self.parts.axes.iter().position(|a| a.name.as_str() == name)
    }

    /// Errors of the axis with this index.
    pub fn axis_errors(&self, axis: usize) -> &JointErrors {
        &self.parts.errors[axis]
    }

    /// Errors of the spindle, if the chain has one.
    pub fn spindle_errors(&self) -> Option<&JointErrors> {
        self.parts.errors.get(self.parts.axes.len())
    }

    pub(in crate::machine) fn tool_index(&self) -> usize {
        self.tool
    }

    /// Returns the tool in use.
    pub fn tool(&self) -> &Tool {
        &self.parts.tools[self.tool]
    }

    /// Returns all tools.
    pub fn tools(&self) -> &[Tool] {
        &self.parts.tools
    }

    /// Returns the same machine with another tool.
    pub fn with_tool(&self, name: &str) -> Option<Self> {
        let tool = self.parts.tools.iter().position(|t| t.name == name)?;
        Some(Self { parts: self.parts.clone(), tool })
    }

    /// The same machine under another name.
    pub fn named(&self, name: String) -> Self {
        let mut renamed = self.clone();
        renamed.parts.name = name;
        renamed
    }

    /// The same machine with other nominal lines of rotary axes and their location errors, another axis (unit vector)
    /// and tip (mm) of the tool in use, and other location errors of the spindle, if it has one.
    pub fn with_lines(&self, lines: &[MovedLine], direction: [f64; 3], tip: [f64; 3], spindle: [f64; 6]) -> Self {
        let mut moved = self.clone();
        for line in lines {
            let axis = &mut moved.parts.axes[line.axis];
            (axis.direction, axis.origin) = (line.direction, line.origin);
            moved.parts.errors[line.axis].set_location(line.location);
        }
        let of_spindle = moved.parts.errors.get_mut(self.parts.axes.len());
        of_spindle.into_iter().for_each(|errors| errors.set_location(spindle));
        let own = &mut moved.parts.tools[self.tool];
        (own.direction, own.tip) = (direction, tip);
        moved
    }

    /// Returns the same machine with the tip of the tool in use further from the spindle, mm along the tool axis.
    pub fn with_longer_tool(&self, length_mm: f64) -> Self {
        let mut longer = self.clone();
        let tool = &mut longer.parts.tools[self.tool];
        tool.tip = std::array::from_fn(|i| tool.tip[i] - length_mm * tool.direction[i]);
        longer
    }

    /// Workpiece origin (mm).
    pub fn workpiece(&self) -> [f64; 3] {
        self.parts.workpiece
    }

    /// Angles (deg) by which the workpiece's coordinates are turned about the fixed X, then Y, then Z of the machine.
    pub fn workpiece_angles(&self) -> [f64; 3] {
        self.parts.workpiece_rotation
    }

    /// Returns the rotation that turns the workpiece's coordinates into machine directions at the zero pose; `None` if
    /// they are the same.
    pub fn workpiece_rotation(&self) -> Option<Matrix3<f64>> {
        let rotation = rotation_of(self.parts.workpiece_rotation);
        (rotation != Matrix3::identity()).then_some(rotation)
    }

    /// Conventions in force.
    pub fn conventions(&self) -> &Conventions {
        &self.parts.conventions
    }

    /// Set-up errors.
    pub fn setup(&self) -> &SetUp {
        &self.parts.setup
    }

    /// Interval and step of each axis.
    pub fn volume(&self) -> &[Grid] {
        &self.parts.volume
    }

    /// True if the volume is that of a file without one: the travels, in the default steps.
    pub fn has_default_volume(&self) -> bool {
        let is_default = |(axis, grid): (&Axis, &Grid)| {
            (grid.min, grid.max) == axis.travel.interval() && grid.step == axis.kind.default_step()
        };
        self.parts.axes.iter().zip(&self.parts.volume).all(is_default)
    }

    /// Expanded uncertainty (k = 2; mm or rad) of an error's values, if the file states it.
    pub fn uncertainty(&self, error: &ErrorId) -> Option<f64> {
        self.parts.uncertainty.get(error).copied()
    }

    /// What the curves leave of the form of axes.
    pub fn forms(&self) -> &[ResidualForm] {
        &self.parts.forms
    }

    /// Returns the origin of the numbers.
    pub fn provenance(&self) -> &Provenance {
        &self.parts.provenance
    }

    /// Returns the algebra that the file names.
    pub fn algebra(&self) -> Option<&AlgebraChoice> {
        self.parts.algebra.as_ref()
    }

    /// Bounds along and across axes, and of squareness.
    pub fn tolerances(&self) -> &Tolerances {
        &self.parts.tolerances
    }

    /// Returns the class that bounds what the file does not, if it names one.
    pub fn class(&self) -> Option<&NamedClass> {
        self.parts.class.as_ref()
    }

    /// Names of the axes and the spindle, in the order of the errors.
    pub fn joint_names(&self) -> impl Iterator<Item = &AxisName> {
        self.parts.axes.iter().map(|a| &a.name).chain(self.parts.chain.spindle())
    }

    /// Returns every error that is given, with its term, joint by joint.
    pub fn errors(&self) -> impl Iterator<Item = (ErrorId, &ErrorTerm)> {
        self.joint_names().zip(&self.parts.errors).flat_map(|(axis, errors)| {
            errors
                .iter()
                .map(move |(family, direction, term)| (ErrorId { axis: axis.clone(), family, direction }, term))
        })
    }

    /// Returns the machine with constants (mm, rad) in place of these location errors.
    pub fn with_location_values<'a>(&self, values: impl IntoIterator<Item = (&'a ErrorId, f64)>) -> Self {
        let mut parts = self.parts.clone();
        for (error, value) in values {
            let joint = self.joint_names().position(|name| *name == error.axis);
            if let Some(errors) = joint.and_then(|joint| parts.errors.get_mut(joint)) {
                errors.location[error.direction.index()] = Some(ErrorTerm::Constant(value));
            }
        }
        self.with_parts(parts)
    }

    /// The same machine with only the errors (no set-up errors, no bounds but by letter) that `keep` accepts.
    pub fn filtered(&self, keep: impl Fn(&ErrorId) -> bool) -> Self {
        let mut parts = self.parts.clone();
        let names: Vec<AxisName> = self.joint_names().cloned().collect();
        parts.setup = SetUp::default();
        (parts.tolerances, parts.class) = (Tolerances::default(), None);
        for (axis, errors) in names.into_iter().zip(&mut parts.errors) {
            errors.retain(&axis, &keep);
        }
        for (axis, geometry) in &mut parts.geometry.axes {
            let sides = [&mut geometry.tool.errors, &mut geometry.workpiece.errors];
            sides.into_iter().flatten().for_each(|errors| errors.retain(axis, &keep));
        }
        Self { parts, tool: self.tool }
    }

    /// Returns the first error curve that is not defined at the pose. Within the travel there is none: a curve that
    /// stops short of it goes on.
    pub fn outside(&self, pose: &[f64]) -> Option<UndefinedError> {
        self.errors().find_map(|(error, term)| {
            let axis = self.axis_index(error.axis.as_str())?;
            let position = *pose.get(axis)?;
            if self.parts.axes[axis].travel.contains(position) {
                return None;
            }
            let ErrorTerm::Component(component) = term else { return None };
            let beyond = |d: &(f64, f64)| position < d.0 || position > d.1;
            let domain = component.curves().filter_map(super::Curve::domain).find(beyond)?;
            Some(UndefinedError { error, position, domain })
        })
    }

    /// Axes whose position is outside their travel.
    pub fn beyond_travel<'a>(&'a self, pose: &'a [f64]) -> impl Iterator<Item = &'a Axis> {
        self.parts.axes.iter().zip(pose).filter(|(axis, q)| !axis.travel.contains(**q)).map(|(axis, _)| axis)
    }

    /// True if any error has two directions of approach.
    pub fn is_bidirectional(&self) -> bool {
        use super::ComponentError::Bidirectional;
        self.errors().any(|(_, term)| matches!(term, ErrorTerm::Component(Bidirectional { .. })))
    }

    /// Component errors of an axis where it stands (mm, rad).
    pub fn component_values(&self, axis: usize, at: &CurveArgument<'_>) -> [f64; 6] {
        self.parts.errors[axis].component_values(at)
    }

    /// True if the axis is rotary and without ends.
    pub fn is_continuous(&self, axis: usize) -> bool {
        self.parts.axes[axis].kind == AxisKind::Rotary && self.parts.axes[axis].travel == Travel::Continuous
    }
}
