//! The bounds of errors. A budget is a list of independent sources, each bounded: a translation along, or a rotation
//! about, one direction of one joint. Bounds of a class are along an axis and across it, whichever way it points;
//! bounds by letters are in machine coordinates.

use crate::analysis::closed_form::{Displacement, minimal_set};
use crate::machine::{
    Approach, Axis, AxisKind, AxisName, Class, Direction, ErrorFamily, ErrorId, ErrorTerm, Frames, JointErrors,
    JointFrame, Machine, Pose,
};
use nalgebra::Vector3;
use std::fmt;

/// A source of error of which only a bound is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// The error, its letter counted in the frame of its axis (along, and two across), or in machine coordinates if
    /// the bound is by letter and the frame is turned against them.
    pub error: ErrorId,
    /// Unit vector of the translation, or of the axis of the rotation, in machine coordinates at the zero pose.
    pub direction: [f64; 3],
    /// Bound of its magnitude (mm, rad).
    pub tolerance: f64,
    /// True if the bound is that of the class, false if the machine file gives it.
    pub of_class: bool,
    /// True if the file gives it by the letter of an error, false if along or across its axis.
    pub by_letter: bool,
    /// The direction's relation to the axis.
    pub role: Role,
    /// True if it is what errors with values by letter leave open of a direction along or across the axis.
    pub is_rest: bool,
}

/// The relation of the direction of a bound to its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Along the axis.
    Along,
    /// The first or second direction across it.
    Across(u8),
    /// Perpendicular to it and to a linear axis that comes before it, 0 to 2 as X, Y, Z.
    Square(usize),
    /// A machine coordinate that is none of these.
    Letter,
}

impl Role {
    /// True if it is along the axis, or the letter (0 to 2 as X, Y, Z) nearest to that.
    fn is_along(self, axis: &Axis, letter: usize) -> bool {
        let size = |k: usize| axis.direction[k].abs();
        let nearest = || (1..3).fold(0, |best, k| if size(k) > size(best) + 1e-9 { k } else { best });
        self == Self::Along || self == Self::Letter && nearest() == letter
    }
}

impl Bound {
    /// True if the bound is along its axis, not across it.
    pub fn is_along(&self, axis: &Axis) -> bool {
        self.role.is_along(axis, self.error.direction.index() % 3)
    }

    /// Returns the translations and rotations X, Y, Z, A, B, C per unit of the source.
    pub fn letters(&self) -> [f64; 6] {
        letters(self.error.direction, self.direction)
    }

    /// Returns the errors by letter of its three directions, along X, Y, Z.
    pub fn letter_ids(&self) -> [ErrorId; 3] {
        let from = if self.error.direction.is_rotation() { 3 } else { 0 };
        std::array::from_fn(|k| ErrorId { direction: Direction::ALL[from + k], ..self.error.clone() })
    }

    /// Returns everything of it as a line of text.
    pub fn canonical(&self) -> String {
        let Self { error, direction: [x, y, z], tolerance, .. } = self;
        format!("{self} {error} {x} {y} {z} {tolerance}\n")
    }

    /// Returns the name that its random numbers hang on.
    pub(super) fn stream(&self) -> String {
        let apart = if self.role == Role::Letter { "~" } else { "" };
        format!("{apart}{}", self.error)
    }
}

/// The name of the error if its whole direction is a letter, otherwise its role: `B about along`.
impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(error) = self.error.lettered(&self.direction).filter(|_| !self.is_rest) {
            return write!(f, "{error}");
        }
        let axis = &self.error.axis;
        let location = if self.error.is_location() { " location" } else { "" };
        let about = if self.error.direction.is_rotation() { " about" } else { "" };
        match self.role {
            Role::Along => write!(f, "{axis}{location}{about} along"),
            Role::Across(n) => write!(f, "{axis}{location}{about} across {n}"),
            Role::Square(other) => write!(f, "{}-{axis} squareness", ["X", "Y", "Z"][other]),
            Role::Letter => write!(f, "{}", self.error),
        }
    }
}

fn letters(letter: Direction, direction: [f64; 3]) -> [f64; 6] {
    let from = if letter.is_rotation() { 3 } else { 0 };
    let mut six = [0.0; 6];
    six[from..from + 3].copy_from_slice(&direction);
    six
}

/// Translations or rotations of one family of a joint: three directions.
#[derive(Debug, Clone, Copy)]
struct Triple {
    family: ErrorFamily,
    turns: bool,
    directions: [[f64; 3]; 3],
    roles: [Role; 3],
    /// Tolerances of the file by letter, sorted to the directions.
    written: [Option<f64>; 3],
}

impl Triple {
    /// By the frame of the axis; by the letters where the file bounds one that the frame does not have.
    fn of(frame: &JointFrame, errors: &JointErrors, family: ErrorFamily, turns: bool) -> Self {
        let letter = |slot: usize| Direction::ALL[slot + if turns { 3 } else { 0 }];
        let six = errors.six(family);
        let given: [Option<f64>; 3] = std::array::from_fn(|slot| match six[letter(slot).index()] {
            Some(ErrorTerm::Tolerance(tolerance)) => Some(tolerance),
            _ => None,
        });
        let directions = std::array::from_fn(|slot| frame.direction(family, letter(slot)));
        let same = |k: usize, slot: usize| directions[slot][k].abs() > 1.0 - 1e-9;
        let slots: [Option<usize>; 3] = std::array::from_fn(|k| (0..3).find(|slot| same(k, *slot)));
        if (0..3).any(|k| given[k].is_some() && slots[k].is_none()) {
            let directions = std::array::from_fn(|k| std::array::from_fn(|i| f64::from(u8::from(i == k))));
            return Self { family, turns, directions, roles: [Role::Letter; 3], written: given };
        }
        let mut written = [None; 3];
        (0..3).for_each(|k| slots[k].into_iter().for_each(|slot| written[slot] = written[slot].or(given[k])));
        let mut across = 0;
        let roles = std::array::from_fn(|slot| match frame.squareness_to(family, letter(slot)) {
            _ if frame.is_along(letter(slot)) => Role::Along,
            Some(other) => Role::Square(other),
            None => {
                across += 1;
                Role::Across(across)
            }
        });
        Self { family, turns, directions, roles, written }
    }

    fn error(&self, axis: &AxisName, slot: usize) -> ErrorId {
        let direction = Direction::ALL[slot + if self.turns { 3 } else { 0 }];
        ErrorId { axis: axis.clone(), family: self.family, direction }
    }

    fn bound(&self, axis: &AxisName, slot: usize, tolerance: f64, source: BoundSource) -> Bound {
        let (direction, role) = (self.directions[slot], self.roles[slot]);
        let (of_class, by_letter) = (source == BoundSource::Class, source == BoundSource::Letter);
        Bound { error: self.error(axis, slot), direction, tolerance, of_class, by_letter, role, is_rest: false }
    }
}

/// Where the tolerance of a bound stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BoundSource {
    /// In a class.
    Class,
    /// In the machine file, at an error.
    Letter,
    /// In the machine file, along or across an axis.
    Frame,
}

/// The four triples of a joint, in the order of its errors.
fn triples(frame: &JointFrame, errors: &JointErrors) -> [Triple; 4] {
    let [location, component] = ErrorFamily::ALL;
    [(location, false), (location, true), (component, false), (component, true)]
        .map(|(family, turns)| Triple::of(frame, errors, family, turns))
}

/// Returns the bounds in the machine file, in the order of [`Machine::errors`]; with a class, also its bounds for the
/// component errors of every axis and for the minimal set of location errors, where the file has no bound of its own.
/// Bounds of zero are left out.
pub fn bounds(machine: &Machine, class: Option<&Class>) -> Vec<Bound> {
    let frames = Frames::of(machine);
    let names = || machine.axes().iter().map(|axis| &axis.name).chain(machine.chain().spindle());
    let all: Vec<[Triple; 4]> =
        names().enumerate().map(|(joint, _)| triples(frames.joint(joint), errors_of(machine, joint))).collect();
    let displacement = |error: &ErrorId| {
        let joint = machine.axis_index(error.axis.as_str()).unwrap_or(machine.axes().len());
        let triple = &all[joint][usize::from(error.direction.is_rotation())];
        let letters = letters(error.direction, triple.directions[error.direction.index() % 3]);
        Displacement { axis: error.axis.clone(), family: error.family, letters }
    };
    let along = |axis: &Axis, letter: Direction| {
        machine.axis_index(axis.name.as_str()).is_some_and(|joint| frames.joint(joint).is_along(letter))
    };
    let location = class.map_or_else(Vec::new, |_| minimal_set(machine, along, displacement));
    let mut bounds = Vec::new();
    for (joint, name) in names().enumerate() {
        let axis = machine.axes().get(joint);
        for (triple, slot) in all[joint].iter().flat_map(|triple| (0..3).map(move |slot| (triple, slot))) {
            let error = triple.error(name, slot);
            let wanted = match triple.family {
                ErrorFamily::Location => location.contains(&error),
                ErrorFamily::Component => axis.is_some(),
            };
            let own = axis.is_some_and(|axis| triple.roles[slot].is_along(axis, slot));
            let of_class = class.filter(|_| wanted).and_then(|class| class.tolerance(axis, &error, own));
            if let Some(tolerance) = triple.written[slot] {
                bounds.push(triple.bound(name, slot, tolerance, BoundSource::Letter));
            } else if let Some(tolerance) = bound_in_frame(machine, name, triple, slot) {
                bounds.push(triple.bound(name, slot, tolerance, BoundSource::Frame));
            } else if let Some(tolerance) = of_class {
                bounds.push(triple.bound(name, slot, tolerance, BoundSource::Class));
            }
        }
    }
    bounds.retain(|bound| bound.tolerance > 0.0);
    bounds
}

/// Returns what the file bounds along or across an axis, or as squareness.
fn bound_in_frame(machine: &Machine, axis: &AxisName, triple: &Triple, slot: usize) -> Option<f64> {
    let (all, role) = (machine.tolerances(), triple.roles[slot]);
    let square = match role {
        Role::Square(other) => axis.main().and_then(|own| all.squareness.get(&[other, own])).copied(),
        _ => None,
    };
    square.or_else(|| all.of(axis, triple.family, triple.turns, role == Role::Along))
}

fn errors_of(machine: &Machine, joint: usize) -> &JointErrors {
    const NONE: &JointErrors = &JointErrors { location: [const { None }; 6], component: [const { None }; 6] };
    if joint < machine.axes().len() { machine.axis_errors(joint) } else { machine.spindle_errors().unwrap_or(NONE) }
}

/// Returns the bounds of all joints on the sides of the bed on which they do not stand. Tolerances by letter of one
/// side replace those of the same direction; a value in place of a tolerance is no bound. All other bounds are the same
/// on either side, in the frame that the axis has there.
pub fn on_other_sides(machine: &Machine, bounds: &[Bound]) -> Vec<Bound> {
    let mut all = bounds.to_vec();
    let frames = Frames::of(machine);
    for (joint, axis) in machine.axes().iter().enumerate() {
        let Some(geometry) = machine.geometry().axes.get(&axis.name) else { continue };
        let there = geometry.on(axis.branch.opposite());
        if there.errors.is_none() && there.direction == axis.direction {
            continue;
        }
        let frame = frames.framed(machine.axes(), axis, there.direction);
        let errors = there.errors.as_ref().unwrap_or_else(|| machine.axis_errors(joint));
        for triple in triples(&frame, errors) {
            let is_of = |bound: &Bound, slot: usize| bound.error == triple.error(&axis.name, slot);
            for slot in 0..3 {
                let known = all.iter().position(|bound| is_of(bound, slot));
                match (triple.written[slot], known) {
                    (Some(tolerance), Some(i)) => {
                        all[i] = triple.bound(&axis.name, slot, tolerance, BoundSource::Letter)
                    }
                    (Some(tolerance), None) => all.push(triple.bound(&axis.name, slot, tolerance, BoundSource::Letter)),
                    (None, Some(i)) if all[i].by_letter => drop(all.remove(i)),
                    (None, Some(i)) => (all[i].direction, all[i].role) = (triple.directions[slot], triple.roles[slot]),
                    (None, None) => {}
                }
            }
        }
    }
    all.retain(|bound| bound.tolerance > 0.0);
    all
}

/// Returns the number of errors of a machine that have a value; a budget leaves them out.
pub fn known(machine: &Machine) -> usize {
    machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_))).count()
}

/// Returns a bound for each error of a machine with a value: the largest that it has at poses (mm, deg), from either
/// side. Errors without a value there are left out.
pub fn bounds_by_values(machine: &Machine, poses: &[Pose]) -> Vec<Bound> {
    let sides = [Approach::Forward, Approach::Reverse];
    let bound = |(error, term): (ErrorId, &ErrorTerm)| {
        let axis = machine.axis_index(error.axis.as_str()).unwrap_or(machine.axes().len());
        let at = |(pose, side): (&Pose, Approach)| term.value(&side.at_pose(pose).argument(axis)).abs();
        let all = poses.iter().flat_map(|pose| sides.map(|side| (pose, side)));
        let (tolerance, role) = (all.map(at).fold(0.0, f64::max), Role::Letter);
        let direction = std::array::from_fn(|k| f64::from(u8::from(k == error.direction.index() % 3)));
        Bound { error, direction, tolerance, of_class: false, by_letter: false, role, is_rest: false }
    };
    machine.errors().map(bound).filter(|bound| bound.tolerance > 0.0).collect()
}

/// True if any error of a machine has a value, or its set-up.
pub fn is_measured(machine: &Machine) -> bool {
    let setup = machine.setup();
    known(machine) > 0 || setup.tool.iter().chain(&setup.workpiece).any(|x| *x != 0.0)
}

/// Returns the bounds of what has no value: those that add to the measured errors. Of a bound on an oblique axis what
/// values by letter say is taken out, and the rest stays. Of location errors, the part along the axis is none.
pub fn adding(machine: &Machine, bounds: &[Bound]) -> Vec<Bound> {
    let valued: Vec<ErrorId> =
        machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_))).map(|(error, _)| error).collect();
    let frames = Frames::of(machine);
    bounds.iter().filter_map(|bound| rest(bound, &valued, along(machine, &frames, bound))).collect()
}

/// Returns the direction of the axis of a location error across it; `None` for all others.
fn along(machine: &Machine, frames: &Frames, bound: &Bound) -> Option<Vector3<f64>> {
    let joint = machine.axis_index(bound.error.axis.as_str()).unwrap_or(machine.axes().len());
    let frame = frames.joint(joint);
    let letter = Direction::ALL[..3].iter().find(|letter| frame.is_along(**letter))?;
    let along = Vector3::from(frame.direction(bound.error.family, *letter));
    let is_across = along.dot(&Vector3::from(bound.direction)).abs() < FAINT_PART;
    (bound.error.is_location() && is_across).then_some(along)
}

/// Parts of a direction below this are rounding.
const FAINT_PART: f64 = 1e-9;

/// Returns what a bound leaves open beside errors with values; `None` if they say all of it.
fn rest(bound: &Bound, valued: &[ErrorId], along: Option<Vector3<f64>>) -> Option<Bound> {
    let mut known: Vec<Vector3<f64>> = Vec::new();
    for (k, _) in bound.letter_ids().iter().enumerate().filter(|(_, error)| valued.contains(error)) {
        let across = |letter: Vector3<f64>| along.map_or(letter, |along| letter - along * along.dot(&letter));
        let said = known.iter().fold(across(Vector3::ith(k, 1.0)), |said, of| said - of * of.dot(&said));
        known.extend(said.try_normalize(FAINT_PART));
    }
    let direction = Vector3::from(bound.direction);
    if known.iter().all(|of| of.dot(&direction).abs() < FAINT_PART) {
        return Some(bound.clone());
    }
    let open = known.iter().fold(direction, |open, of| open - of * of.dot(&direction));
    let (tolerance, unit) = (bound.tolerance * open.norm(), open.try_normalize(FAINT_PART)?);
    Some(Bound { direction: unit.into(), tolerance, is_rest: true, ..bound.clone() })
}

/// True if the machine has rotary axes and the class has no values for them.
pub fn lacks_rotary(machine: &Machine, class: &Class) -> bool {
    !class.knows_rotary() && machine.axes().iter().any(|axis| axis.kind == AxisKind::Rotary)
}
