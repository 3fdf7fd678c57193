//! Rewrites the errors of a machine for other conventions, and says what changed.

use super::component::ComponentErrors;
use super::constants::Constants;
use super::request::{ConversionRequest, TINY, tolerance_refusal};
use super::shape::shape;
use crate::diagnostic::Diagnostic;
use crate::machine::{
    Axis, AxisName, Branch, Direction, ErrorFamily, ErrorId, ErrorTerm, Grid, JointErrors, Machine, MachineParts,
    Travel,
};

/// An error that no curve of the language holds exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// The error.
    pub error: ErrorId,
    /// The deviation of the curve written (mm or rad).
    pub size: f64,
    /// The function it would have to be, in words.
    pub nature: &'static str,
}

/// A machine under its new conventions, not yet proved.
#[derive(Debug, Clone)]
pub struct Conversion {
    /// The parts of the converted machine.
    pub parts: MachineParts,
    /// The errors that the curves miss.
    pub misfits: Vec<Misfit>,
}

/// Rewrites the errors of a machine for other conventions.
pub fn convert(machine: &Machine, request: &ConversionRequest) -> Result<Conversion, Diagnostic> {
    let mut parts = machine.to_parts();
    parts.conventions = request.conventions;
    // Values are regrouped: the uncertainty of one of them is not that of the sums.
    parts.uncertainty.clear();
    parts.covariance.clear();
    parts.forms.clear();
    // The proof is of the arrangement at hand.
    parts.geometry.forget_other_sides(&machine.sides());
    let turned = |axis: &Axis| turns_over(machine, axis, request);
    for (axis, grid) in parts.axes.iter_mut().zip(&mut parts.volume).filter(|(axis, _)| turned(axis)) {
        *axis = mirror(axis);
        *grid = Grid { min: -grid.max, max: -grid.min, ..*grid };
    }
    let constants = Constants::of(machine);
    let frames = constants.regroup(machine, request, &mut parts)?;
    let mut misfits = Vec::new();
    for (i, frame) in frames.iter().enumerate() {
        let errors = ComponentErrors::new(machine, i, &parts, [&constants.frames[i], frame]);
        tolerances(machine, i, &errors)?;
        component(machine, i, &errors, request, &mut parts, &mut misfits);
    }
    Ok(Conversion { parts, misfits })
}

/// True if the conversion reverses the sense of a positive command of the axis.
fn turns_over(machine: &Machine, axis: &Axis, request: &ConversionRequest) -> bool {
    let wanted = request.conventions.workpiece_axes;
    axis.branch == Branch::Workpiece && wanted != machine.conventions().workpiece_axes && axis.sense != wanted
}

fn mirror(axis: &Axis) -> Axis {
    let travel = match axis.travel {
        Travel::Range(min, max) => Travel::Range(-max, -min),
        Travel::Continuous => Travel::Continuous,
    };
    let sense = match axis.sense {
        crate::machine::Sense::Iso841 => crate::machine::Sense::Direct,
        crate::machine::Sense::Direct => crate::machine::Sense::Iso841,
    };
    Axis { travel, sense, home: axis.home.map(|home| 0.0 - home), ..axis.clone() }
}

/// A tolerance does not state how errors go together: it can stay, but not be turned into others.
fn tolerances(machine: &Machine, axis: usize, errors: &ComponentErrors<'_>) -> Result<(), Diagnostic> {
    let given = machine.axis_errors(axis);
    let bounded = given
        .iter()
        .find(|(family, _, term)| *family == ErrorFamily::Component && matches!(term, ErrorTerm::Tolerance(_)));
    let name = &machine.axes()[axis].name;
    let framed = |turns| machine.tolerances().bounds(name, ErrorFamily::Component, turns);
    match bounded {
        Some((_, direction, _)) if errors.mixes() => {
            let id = ErrorId { axis: machine.axes()[axis].name.clone(), family: ErrorFamily::Component, direction };
            Err(tolerance_refusal(&id.to_string()))
        }
        None if errors.mixes() && [false, true].into_iter().any(framed) => {
            Err(tolerance_refusal(&format!("{name} across")))
        }
        _ => Ok(()),
    }
}

fn component(
    machine: &Machine,
    axis: usize,
    errors: &ComponentErrors<'_>,
    request: &ConversionRequest,
    parts: &mut MachineParts,
    misfits: &mut Vec<Misfit>,
) {
    let old: &JointErrors = machine.axis_errors(axis);
    for direction in Direction::ALL {
        let (term, size) = shape(errors, &old.component, direction, &parts.axes[axis], request.within_mm);
        parts.errors[axis].component[direction.index()] = term;
        if size > TINY[usize::from(direction.is_rotation())] {
            let error = ErrorId { axis: machine.axes()[axis].name.clone(), family: ErrorFamily::Component, direction };
            misfits.push(Misfit { error, size, nature: errors.nature() });
        }
    }
}

/// The errors whose terms differ between a machine and its conversion; those of the set-up as `tool.X`, `workpiece.A`.
pub fn changes(old: &Machine, new: &MachineParts) -> Vec<Change> {
    let constant = |term: &Option<ErrorTerm>| term.as_ref().map_or(0.0, |t| t.value(&0.0.into()));
    let before = |name: &AxisName| match old.axis_index(name.as_str()) {
        Some(i) => old.axis_errors(i).clone(),
        None => old.spindle_errors().cloned().unwrap_or_default(),
    };
    let mut all = Vec::new();
    for (name, after) in new.axes.iter().map(|axis| &axis.name).chain(new.chain.spindle()).zip(&new.errors) {
        let before = before(name);
        for (family, direction) in ErrorFamily::ALL.into_iter().flat_map(|f| Direction::ALL.map(|d| (f, d))) {
            let [a, b] = [&before, after].map(|errors| &errors.six(family)[direction.index()]);
            if a != b {
                let name = ErrorId { axis: name.clone(), family, direction }.to_string();
                all.push(Change {
                    name,
                    direction,
                    values: (family == ErrorFamily::Location).then(|| [constant(a), constant(b)]),
                });
            }
        }
    }
    let setup = [
        ("workpiece", &old.setup().workpiece[..], &new.setup.workpiece[..]),
        ("tool", &old.setup().tool, &new.setup.tool),
    ];
    for (word, before, after) in setup {
        for ((a, b), direction) in before.iter().zip(after).zip(Direction::ALL).filter(|((a, b), _)| a != b) {
            all.push(Change { name: format!("{word}.{}", direction.letter()), direction, values: Some([*a, *b]) });
        }
    }
    all
}

/// An error that is another number, or another curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// `EC0Y`, `EXX`, `workpiece.A`.
    pub name: String,
    /// The direction of the error.
    pub direction: Direction,
    /// Constants before and after (mm or rad); curves have none.
    pub values: Option<[f64; 2]>,
}
