//! The machine as a kinematics module carries it: numbers in the order of the walk, conventions resolved
//! to flags of each joint.

use crate::machine::{
    Axis, AxisKind, Branch, ComponentError, Curve, Direction, ErrorTerm, JointErrors, Joints, Location, LocationAction,
    Machine, MotionSide,
};

/// Letters of the world's nine coordinates, in the controller's order.
pub const WORLD: &str = "XYZABCUVW";

/// The meaning of the words of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum ModuleWords {
    /// X Y Z are the tip of the tool, the others axes.
    Tip = 0,
    /// X Y Z are the tip of the tool and A B C its roll, pitch and yaw, the others axes.
    Pose = 1,
    /// Every word is an axis.
    Axes = 2,
}

impl ModuleWords {
    /// All, by their number.
    pub const ALL: [Self; 3] = [Self::Tip, Self::Pose, Self::Axes];
}

/// A machine as numbers.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ModuleModel {
    /// The meaning of the words of its programs.
    pub words: ModuleWords,
    /// Its axes on the walk from workpiece to tool.
    pub joints: Vec<ModuleJoint>,
    /// Error curves; never empty.
    pub curves: Vec<CurveData>,
    /// Location errors displace the carried body instead of the axis.
    pub carried_body: bool,
    /// Error matrices are 1 + hat(eps).
    pub linearised: bool,
    /// The gauge point, mm.
    pub gauge: [f64; 3],
    /// The vector from the tip of the tool to the gauge point, mm.
    pub tool: [f64; 3],
    /// Displacement of the tip by clamping, mm.
    pub tool_clamping: [f64; 3],
    /// Location errors of the spindle, mm and rad.
    pub spindle: [f64; 6],
    /// The workpiece origin, mm.
    pub workpiece: [f64; 3],
    /// Displacement of the workpiece by clamping, mm and rad.
    pub clamping: [f64; 6],
    /// Sine of the angle from a singular pose below which rotary corrections are bounded.
    pub damping: f64,
    /// The length (mm) at which rotations and translations are weighed against each other.
    pub arm: f64,
    /// True if the direction of the tool is corrected, not only the position of its tip.
    pub orientation: bool,
}

/// A joint.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ModuleJoint {
    /// Index in [`WORLD`] of the coordinate that is its position; none if the tip's place determines it.
    pub letter: Option<usize>,
    /// Number of the controller's joint.
    pub number: usize,
    /// Rotary rather than linear.
    pub rotary: bool,
    /// One of the axes that hold the tip: found from it or, where words are axes, corrected for it.
    pub solved: bool,
    /// True if it is on the workpiece side of the bed.
    pub workpiece_side: bool,
    /// True if the component error is to the left of the motion.
    pub outside: bool,
    /// The component error enters inverted.
    pub inverted: bool,
    /// The location error enters inverted.
    pub location_inverted: bool,
    /// Direction with the sense of a positive command.
    pub direction: [f64; 3],
    /// A point on the line, or the one about which a linear axis's angular errors turn, mm.
    pub origin: [f64; 3],
    /// Location errors, mm and rad.
    pub location: [f64; 6],
    /// For each of the six component errors none, one, or two curves, of which the mean counts.
    pub curves: [[Option<usize>; 2]; 6],
}

/// The form of a curve; the numbers are those in the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum Form {
    /// Positions, then values.
    Linear = 0,
    /// Positions, values, second derivatives.
    Cubic = 1,
    /// Coefficients by rising power.
    Polynomial = 2,
    /// Cosine and sine by rising order.
    Harmonics = 3,
}

impl Form {
    /// All, by their number.
    pub const ALL: [Self; 4] = [Self::Linear, Self::Cubic, Self::Polynomial, Self::Harmonics];

    /// Returns the count of numbers that a point, coefficient or order has.
    pub fn width(self) -> usize {
        match self {
            Self::Polynomial => 1,
            Self::Linear | Self::Harmonics => 2,
            Self::Cubic => 3,
        }
    }
}

/// An error curve: argument in mm or deg, value in mm or rad.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct CurveData {
    /// The meaning of its numbers.
    pub form: Form,
    /// Length of the period; 0 if the ends are held.
    pub period: f64,
    /// Numbers in the order of [`Form`].
    pub numbers: Vec<f64>,
}

impl ModuleModel {
    /// Everything but the roles of the axes, which follow from it.
    pub(super) fn geometry(machine: &Machine, damping: f64, orientation: bool) -> Self {
        let mut curves = Vec::new();
        let conventions = machine.conventions();
        let decoded = |axis: &Axis| axis.convention(conventions);
        let joint = |(index, axis): (usize, &Axis)| ModuleJoint {
            letter: None,
            number: index,
            rotary: axis.kind == AxisKind::Rotary,
            solved: false,
            workpiece_side: axis.branch == Branch::Workpiece,
            outside: decoded(axis).component.side == MotionSide::Outer,
            inverted: decoded(axis).component.inverse,
            location_inverted: matches!(decoded(axis).location, LocationAction::Factor(factor) if factor.inverse),
            direction: axis.direction.map(|u| plain(u * decoded(axis).motion_sign)),
            origin: decoded(axis).pivot,
            location: machine.axis_errors(index).location_values(),
            curves: curves_of(machine.axis_errors(index), &mut curves),
        };
        let joints = machine.axes().iter().enumerate().map(joint).collect();
        if curves.is_empty() {
            curves.push(CurveData { form: Form::Polynomial, period: 0.0, numbers: vec![0.0] });
        }
        Self {
            words: ModuleWords::Axes,
            joints,
            curves,
            carried_body: conventions.location == Location::CarriedBody,
            linearised: conventions.joints == Joints::Linearised,
            gauge: machine.tool().gauge,
            tool: tool(machine),
            tool_clamping: machine.setup().tool,
            spindle: machine.spindle_errors().map_or([0.0; 6], JointErrors::location_values),
            workpiece: machine.workpiece(),
            clamping: machine.setup().workpiece,
            damping,
            arm: 1.0,
            orientation,
        }
    }
}

/// Returns the vector from the tip of the machine's tool to the gauge point, mm.
pub(super) fn tool(machine: &Machine) -> [f64; 3] {
    let tool = machine.tool();
    std::array::from_fn(|i| plain(tool.gauge[i] - tool.tip[i]))
}

/// Turns a negative zero into zero.
fn plain(x: f64) -> f64 {
    x + 0.0
}

fn curves_of(errors: &JointErrors, all: &mut Vec<CurveData>) -> [[Option<usize>; 2]; 6] {
    Direction::ALL.map(|direction| match &errors.component[direction.index()] {
        Some(ErrorTerm::Component(ComponentError::Single(curve))) => [keep(curve, all), None],
        Some(ErrorTerm::Component(ComponentError::Bidirectional { forward, reverse })) => {
            [keep(forward, all), keep(reverse, all)]
        }
        Some(term @ ErrorTerm::Constant(_)) => {
            let numbers = vec![term.value(&0.0.into())];
            all.push(CurveData { form: Form::Polynomial, period: 0.0, numbers });
            [Some(all.len() - 1), None]
        }
        Some(ErrorTerm::Tolerance(_)) | None => [None, None],
    })
}

fn keep(curve: &Curve, all: &mut Vec<CurveData>) -> Option<usize> {
    let period = curve.knots().and_then(crate::machine::Knots::period).unwrap_or(0.0);
    let (form, numbers) = match curve {
        Curve::Linear(knots) => (Form::Linear, [knots.positions(), knots.values()].concat()),
        Curve::Cubic(knots, second) => (Form::Cubic, [knots.positions(), knots.values(), second].concat()),
        Curve::BSpline(spline) => (Form::Cubic, spline.pieces()),
        Curve::Polynomial(coefficients) => (Form::Polynomial, coefficients.clone()),
        Curve::Harmonics(orders) => (Form::Harmonics, orders.iter().flat_map(|(c, s)| [*c, *s]).collect()),
    };
    // A missing curve is zero: a curve without numbers has no place in a file.
    if numbers.is_empty() {
        return None;
    }
    all.push(CurveData { form, period, numbers: numbers.into_iter().map(plain).collect() });
    Some(all.len() - 1)
}
