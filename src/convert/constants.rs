//! The constants of a walk, and their regrouping.

use super::{ConversionRequest, TINY, regroups, tolerance_refusal};
use crate::algebra::{Htm, rotation_vector, skew_vector};
use crate::diagnostic::{Diagnostic, codes};
use crate::lower::{error_motion, invert_if};
use crate::machine::{
    Axis, AxisKind, AxisName, Branch, Direction, ErrorTerm, JointErrors, Joints, KinematicChain, Location,
    LocationAction, Machine, MachineParts, MotionSide,
};
use nalgebra::Vector3;

/// T = K0 X1 K1 ... Xn Kn, in machine coordinates.
#[derive(Debug, Clone)]
pub struct Constants {
    /// Products of the constants before each motion, and of all of them.
    before: Vec<Htm<f64>>,
    /// Product of the constants between workpiece and bed.
    bed: Htm<f64>,
    /// The frame in which the component errors of each axis are given, seen from its joint: X holds C^-1 E C.
    pub(super) frames: Vec<Htm<f64>>,
}

impl Constants {
    /// Reads them from a machine.
    pub fn of(machine: &Machine) -> Self {
        let (conventions, axes) = (machine.conventions(), machine.axes());
        let setup = error_motion(&machine.setup().workpiece, conventions.joints);
        let mut now = Htm::about(&machine.workpiece(), inverse(&setup));
        let (mut before, mut frames) = (Vec::new(), Vec::new());
        let mut bed = None;
        for (i, axis) in axes.iter().enumerate() {
            if axis.branch == Branch::Tool {
                bed.get_or_insert_with(|| now.clone());
            }
            let convention = axis.convention(conventions);
            let own = error_motion(&machine.axis_errors(i).location_values(), conventions.joints);
            match convention.location {
                LocationAction::Displaces => {
                    let located = Htm::about(&convention.pivot, own.clone());
                    now = now.compose(&located);
                    before.push(now.clone());
                    now = now.compose(&inverse(&located));
                    frames.push(own);
                }
                LocationAction::Factor(factor) => {
                    let located = now.compose(&Htm::about(&convention.pivot, invert_if(factor.inverse, own)));
                    before.push(if factor.side == MotionSide::Outer { located.clone() } else { now });
                    now = located;
                    frames.push(Htm::identity());
                }
            }
        }
        let bed = bed.unwrap_or_else(|| now.clone());
        if let Some(errors) = machine.spindle_errors() {
            let spindle = error_motion(&errors.location_values(), conventions.joints);
            now = now.compose(&Htm::about(&machine.tool().gauge, spindle));
        }
        before.push(now);
        Self { before, bed, frames }
    }

    /// Writes location errors, set-up and spindle for the new conventions; returns the frames D of the component
    /// errors: E' = D X D^-1.
    pub(super) fn regroup(
        &self,
        machine: &Machine,
        request: &ConversionRequest,
        parts: &mut MachineParts,
    ) -> Result<Vec<Htm<f64>>, Diagnostic> {
        if !regroups(machine.conventions(), request) && machine.conventions().joints == request.conventions.joints {
            return Ok(self.frames.clone());
        }
        if regroups(machine.conventions(), request) {
            refuse_tolerances(machine)?;
        }
        match request.conventions.location {
            Location::AxisOnly => self.in_one_frame(machine, request, parts),
            Location::CarriedBody => self.each_in_its_carrier(machine, request, parts),
        }
    }

    /// `axis_only`: T = H (L1 X1 L1^-1) ... (Ln Xn Ln^-1) S, H the frame in which the lines lie.
    fn in_one_frame(
        &self,
        machine: &Machine,
        request: &ConversionRequest,
        parts: &mut MachineParts,
    ) -> Result<Vec<Htm<f64>>, Diagnostic> {
        let mut origin = self.bed.clone();
        if let Some(name) = &request.datum {
            let index = machine.axis_index(name.as_str()).unwrap_or_default();
            let axis = &machine.axes()[index];
            let line = line_only(axis, &at_joint(axis, &inverse(&origin).compose(&self.before[index])));
            origin = origin.compose(&Htm::about(&axis.origin, line));
        }
        let back = inverse(&origin);
        let frames: Vec<Htm<f64>> =
            machine.axes().iter().zip(&self.before).map(|(axis, q)| at_joint(axis, &back.compose(q))).collect();
        let same = machine.conventions().location == Location::AxisOnly && request.datum.is_none();
        for (i, (axis, frame)) in machine.axes().iter().zip(&frames).enumerate() {
            // An idle entry is dropped, unless it is the file's own.
            let written = if same { frame.clone() } else { line_only(axis, frame) };
            locate(&mut parts.errors[i], &six_of(&written, request.conventions.joints));
        }
        self.ends(machine, request, parts, [&origin, &origin])?;
        Ok(frames)
    }

    /// `carried_body`: the constant between two motions belongs to the joint farther from the bed.
    fn each_in_its_carrier(
        &self,
        machine: &Machine,
        request: &ConversionRequest,
        parts: &mut MachineParts,
    ) -> Result<Vec<Htm<f64>>, Diagnostic> {
        if request.datum.is_some() {
            let message =
                "`--datum` names one frame for all axes, `carried_body` refers each to the body that carries it";
            return Err(Diagnostic::new(codes::E0528, message).help("leave one of them out"));
        }
        let axes = machine.axes();
        let side = |k: usize| axes.get(k).map(|axis| axis.branch);
        for (i, axis) in axes.iter().enumerate() {
            let (from, to) = match axis.branch {
                Branch::Workpiece if side(i + 1) == Some(Branch::Workpiece) => (&self.before[i], &self.before[i + 1]),
                Branch::Workpiece => (&self.before[i], &self.bed),
                Branch::Tool if i > 0 && side(i - 1) == Some(Branch::Tool) => (&self.before[i - 1], &self.before[i]),
                Branch::Tool => (&self.bed, &self.before[i]),
            };
            let own = at_joint(axis, &inverse(from).compose(to));
            let inverted =
                matches!(axis.convention(&request.conventions).location, LocationAction::Factor(f) if f.inverse);
            locate(&mut parts.errors[i], &six_of(&invert_if(inverted, own), request.conventions.joints));
        }
        let last = axes.len() - 1;
        let first = if side(0) == Some(Branch::Workpiece) { &self.before[0] } else { &self.bed };
        let tool = if side(last) == Some(Branch::Tool) { &self.before[last] } else { &self.bed };
        self.ends(machine, request, parts, [first, tool])?;
        Ok(vec![Htm::identity(); axes.len()])
    }

    /// Writes the rest at the workpiece (before the first motion) and at the tool (after the last one).
    fn ends(
        &self,
        machine: &Machine,
        request: &ConversionRequest,
        parts: &mut MachineParts,
        [first, last]: [&Htm<f64>; 2],
    ) -> Result<(), Diagnostic> {
        let joints = request.conventions.joints;
        let setup = inverse(&about(&machine.workpiece(), first));
        parts.setup.workpiece = keep_old_numbers(&six_of(&setup, joints), &machine.setup().workpiece);
        let all = self.before.last().unwrap_or(&self.bed);
        let rest = inverse(last).compose(all);
        self.at_the_tool(machine, request, parts, &rest)
    }

    fn at_the_tool(
        &self,
        machine: &Machine,
        request: &ConversionRequest,
        parts: &mut MachineParts,
        rest: &Htm<f64>,
    ) -> Result<(), Diagnostic> {
        let old = machine.spindle_errors().map(JointErrors::location_values);
        let six = six_of(&about(&machine.tool().gauge, rest), request.conventions.joints);
        let turns = six[3..].iter().any(|e| e.abs() > TINY[1]);
        if old.is_none() && !turns {
            let shifted: [f64; 3] = std::array::from_fn(|i| parts.setup.tool[i] + six[i]);
            parts.setup.tool = keep_old_numbers(&shifted, &machine.setup().tool);
            return Ok(());
        }
        let elsewhere = parts.tools.iter().find(|tool| tool.gauge != machine.tool().gauge);
        if let (Some(tool), true) = (elsewhere, old.is_none_or(|old| keep_old_numbers(&six, &old) != old)) {
            let message =
                format!("the spindle's errors would differ from tool to tool: `{}` has another gauge point", tool.name);
            return Err(Diagnostic::new(codes::E0529, message)
                .help("give all tools one gauge point, their lengths as `offset`"));
        }
        if old.is_none() {
            parts.chain = with_new_spindle(machine)?;
            parts.errors.push(JointErrors::default());
        }
        if let Some(errors) = parts.errors.last_mut() {
            locate(errors, &six);
        }
        Ok(())
    }
}

/// The chain with a spindle whose name is not that of an axis.
fn with_new_spindle(machine: &Machine) -> Result<KinematicChain, Diagnostic> {
    let names = ["S", "SP", "SPINDLE"].into_iter().filter_map(AxisName::new);
    names.filter_map(|name| machine.chain().with_spindle(&name)).next().ok_or_else(|| {
        let message =
            "a rotation of the tool against the last axis needs a spindle, but `S`, `SP` and `SPINDLE` are axes";
        Diagnostic::new(codes::E0529, message).help("put a spindle into the chain, such as `(C9)` before `t`")
    })
}

/// A location error that is only a tolerance cannot be regrouped.
fn refuse_tolerances(machine: &Machine) -> Result<(), Diagnostic> {
    let is = |term: &ErrorTerm| matches!(term, ErrorTerm::Tolerance(_));
    match machine.errors().find(|(id, term)| id.is_location() && is(term)) {
        Some((id, _)) => Err(tolerance_refusal(&id.to_string())),
        None if machine.tolerances().any_location() => Err(tolerance_refusal("location")),
        None => Ok(()),
    }
}

pub(super) fn inverse(motion: &Htm<f64>) -> Htm<f64> {
    invert_if(true, motion.clone())
}

/// A motion given in machine coordinates, with a point as origin.
fn about(point: &[f64; 3], motion: &Htm<f64>) -> Htm<f64> {
    Htm::about(&point.map(|x| -x), motion.clone())
}

fn at_joint(axis: &Axis, motion: &Htm<f64>) -> Htm<f64> {
    about(&axis.origin, motion)
}

/// The smallest displacement that puts the axis's line of motion where this one does.
fn line_only(axis: &Axis, located: &Htm<f64>) -> Htm<f64> {
    let u = Vector3::from(axis.direction);
    let turned = (located.linear * u).normalize();
    let cross = u.cross(&turned);
    let sine = cross.norm();
    let angle = libm::atan2(sine, u.dot(&turned));
    let vector = if sine > 0.0 { cross * (angle / sine) } else { Vector3::zeros() };
    let linear = crate::algebra::exp_hat(&[vector[0], vector[1], vector[2]]);
    let translation = match axis.kind {
        AxisKind::Linear => Vector3::zeros(),
        AxisKind::Rotary => located.translation - turned * (located.translation.dot(&u) / turned.dot(&u)),
    };
    Htm { linear, translation }
}

/// The six errors of a matrix; of one that is no such matrix, those of one near it.
pub(super) fn six_of(motion: &Htm<f64>, joints: Joints) -> [f64; 6] {
    let turn = match joints {
        Joints::Orthogonal => rotation_vector(&motion.linear),
        Joints::Linearised => skew_vector(&motion.linear),
    };
    let t = motion.translation;
    [t[0], t[1], t[2], turn[0], turn[1], turn[2]]
}

/// Rounding is no error: a number that differs by rounding keeps its old value, one within rounding of zero becomes 0.
fn keep_old_numbers<const N: usize>(new: &[f64; N], old: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| if (new[i] - old[i]).abs() <= TINY[i / 3] { old[i] } else { new[i] })
}

fn locate(errors: &mut JointErrors, six: &[f64; 6]) {
    let six = keep_old_numbers(six, &errors.location_values());
    for (slot, direction) in errors.location.iter_mut().zip(Direction::ALL) {
        let value = six[direction.index()];
        let kept = slot.as_ref().is_some_and(|term| term.value(&0.0.into()) == value);
        if !kept {
            *slot = (value.abs() > TINY[usize::from(direction.is_rotation())]).then_some(ErrorTerm::Constant(value));
        }
    }
}
