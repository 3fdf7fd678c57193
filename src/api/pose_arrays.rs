//! Arrays over many poses: nominal tips, effects of errors, uncertainties, values of curves, drawn machines.
//!
//! Poses are rows, one number for each axis in the order of the chain, mm and deg; results are rows, too.

use super::compiled_model::{DeviationSlices, compile_model_of};
use crate::analysis::figure_bands::PoseUncertainty;
use crate::analysis::tool_pose;
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::evaluate::{Frame, Order, frame_rotation};
use crate::job::machine_file::MachineFile;
use crate::job::poses::known;
use crate::lower::sensitivities_to;
use crate::machine::{Approach, ErrorFamily, ErrorId, ErrorTerm, Machine, Pose, parse_error_name};
use crate::run::Cancellation;
use rayon::prelude::*;

/// Poses row by row, and the flag that ends a call about them early.
#[derive(Debug, Clone, Copy)]
pub struct PoseRows<'a> {
    /// The machine.
    pub machine: &'a MachineFile,
    /// A number for each axis of each pose, mm and deg.
    pub rows: &'a [f64],
    /// Ends the call; what is not computed then is 0.
    pub cancellation: &'a Cancellation,
}

/// Constants in place of location errors, a row for each machine.
#[derive(Debug, Clone, Copy)]
pub struct DrawnValues<'a> {
    /// Names of location errors, one for each column.
    pub names: &'a [String],
    /// Values, mm and rad.
    pub rows: &'a [f64],
}

/// Order of the errors, and the side of approach.
#[derive(Debug, Clone, Copy)]
pub struct DrawnConditions {
    /// Order of the errors.
    pub order: Order,
    /// Side of approach.
    pub approach: Approach,
}

impl PoseRows<'_> {
    /// Numbers of a row: one even of a machine without axes.
    fn axes(&self) -> usize {
        self.machine.axes().len().max(1)
    }

    /// Calls `one` with each pose and its part of the result, of `width` numbers.
    fn each(&self, width: usize, one: impl Fn(&[f64], &mut [f64]) + Sync) -> Result<Vec<f64>, Diagnostic> {
        let axes = self.axes();
        if !self.rows.len().is_multiple_of(axes) {
            return Err(Diagnostic::new(codes::E0818, format!("a pose has {axes} positions, one for each axis")));
        }
        let poses: Vec<&[f64]> = self.rows.chunks_exact(axes).collect();
        // The first of several refusals counts, whatever the number of threads.
        poses.iter().try_for_each(|pose| known(self.machine, pose))?;
        let mut all = vec![0.0; poses.len() * width];
        all.par_chunks_mut(width.max(1)).zip(poses.par_iter()).for_each(|(out, pose)| {
            if !self.cancellation.is_asked() {
                one(pose, out);
            }
        });
        Ok(all)
    }

    /// Returns the nominal position of the functional point from the workpiece origin, mm, and the unit vector from it
    /// towards the spindle: six numbers for each pose, in the coordinates of the part.
    ///
    /// Fails where a pose does not fit the machine.
    pub fn nominal(&self) -> Result<Vec<f64>, Diagnostic> {
        self.each(6, |pose, out| {
            let found = tool_pose(self.machine, pose);
            let six = found.tip.iter().chain(found.direction.iter());
            out.iter_mut().zip(six).for_each(|(out, of)| *out = of + 0.0);
        })
    }

    /// Returns the deviation for 1 mm or 1 rad of each error, to first order: for each pose six rows (position along x,
    /// y, z, rotation about x, y, z) of a number for each error.
    ///
    /// Fails for an error that the chain does not have, and where a pose does not fit the machine.
    pub fn jacobian(&self, names: &[String], frame: Frame) -> Result<Vec<f64>, Diagnostic> {
        let errors = names.iter().map(|name| error_of(self.machine, name)).collect::<Result<Vec<_>, _>>()?;
        self.each(6 * errors.len(), |pose, out| {
            let turn = frame_rotation(self.machine, pose, frame);
            for (column, effect) in sensitivities_to(self.machine, pose, &errors).into_iter().enumerate() {
                let both = [effect.deviation, effect.rotation].map(|v| turn.map_or(v, |turn| turn * v));
                for (row, value) in both.iter().flat_map(|v| v.iter()).enumerate() {
                    out[row * errors.len() + column] = value + 0.0;
                }
            }
        })
    }

    /// Returns the expanded uncertainty (k = 2) of the deviation, mm and rad: six numbers for each pose; none where the
    /// machine states no uncertainty of its errors.
    ///
    /// Fails where a pose does not fit the machine.
    pub fn uncertainty(&self, approach: Approach, frame: Frame) -> Result<Option<Vec<f64>>, Diagnostic> {
        let _ = self.each(0, |_, _| ())?;
        let poses: Vec<Pose> = self.rows.chunks_exact(self.axes()).map(<[f64]>::to_vec).collect();
        let found = PoseUncertainty::at(self.machine, &poses, approach.into(), frame, None);
        Ok(found.map(|all| all.iter().flat_map(|of| of.deviation.into_iter().chain(of.rotation)).collect()))
    }

    /// Returns the deviations of machines that differ from this one by constants in place of location errors: for each
    /// machine six rows (position along x, y, z in mm, rotation about x, y, z in rad) of a number for each pose.
    ///
    /// Fails for an error that is no location error of the chain, and where a pose does not fit the machine.
    pub fn drawn(&self, values: DrawnValues<'_>, how: DrawnConditions) -> Result<Vec<f64>, Diagnostic> {
        let errors =
            values.names.iter().map(|name| location_error(self.machine, name)).collect::<Result<Vec<_>, _>>()?;
        let columns: Vec<Vec<f64>> = (0..self.axes()).map(|k| column(self.rows, k, self.axes())).collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let _ = self.each(0, |_, _| ())?;
        let (width, poses) = (errors.len().max(1), columns.first().map_or(0, |column| column.len()));
        if let Some(at) = values.rows.iter().position(|value| !value.is_finite()) {
            let place = format!("row {} of {}", at / width, values.names[at % width]);
            return Err(Diagnostic::new(codes::E0818, format!("the values are not finite: {place}")));
        }
        let mut all = vec![0.0; values.rows.len() / width * 6 * poses];
        let one = |(out, row): (&mut [f64], &[f64])| {
            if self.cancellation.is_asked() {
                return Ok(());
            }
            let machine = self.machine.with_location_values(errors.iter().zip(row.iter().copied()));
            let mut parts = out.chunks_exact_mut(poses);
            let mut next = || parts.next().unwrap_or_default();
            let (position_mm, rotation_rad) = ([next(), next(), next()], [next(), next(), next()]);
            let out = DeviationSlices { position_mm, rotation_rad };
            compile_model_of(&machine, how.order, how.approach).deviations_into(&columns, Frame::Workpiece, out)
        };
        if poses > 0 {
            all.par_chunks_mut(6 * poses).zip(values.rows.par_chunks(width)).try_for_each(one)?;
        }
        Ok(all)
    }
}

/// Returns the value of an error at positions of its axis, mm or rad; of a tolerance 0.
///
/// Fails for an error that the machine does not have, and beyond its curve.
pub fn error_values(
    machine: &MachineFile,
    name: &str,
    positions: &[f64],
    approach: Approach,
) -> Result<Vec<f64>, Diagnostic> {
    let error = error_of(machine, name)?;
    let Some((_, term)) = machine.errors().find(|(id, _)| *id == error) else {
        return Err(Diagnostic::new(codes::E0818, format!("the machine has no value of {error}")));
    };
    let axis = machine.axis_index(error.axis.as_str());
    let one = |position: &f64| {
        let pose: Pose =
            (0..machine.axes().len()).map(|k| if Some(k) == axis { *position } else { f64::NAN }).collect();
        if position.is_nan() {
            return Err(Diagnostic::new(codes::E0802, "a position is not a number"));
        }
        // The other axes are nowhere, where nothing is beyond a curve.
        if let Some(outside) = machine.outside(&pose) {
            let (from, to) = outside.domain;
            let message = format!("{error} is not known at {} = {position}", error.axis);
            return Err(Diagnostic::new(codes::E0803, message).help(format!("its table covers {from} to {to}")));
        }
        Ok(term.value(&approach.at_position(*position)))
    };
    positions.iter().map(one).collect()
}

fn column(rows: &[f64], axis: usize, axes: usize) -> Vec<f64> {
    rows.iter().skip(axis).step_by(axes).copied().collect()
}

/// Returns the error of a name; the chain has its axis or spindle.
fn error_of(machine: &Machine, name: &str) -> Result<ErrorId, Diagnostic> {
    let found = parse_error_name(name);
    found.filter(|error| machine.joint_names().any(|joint| *joint == error.axis)).ok_or_else(|| {
        let known: Vec<String> = machine.errors().map(|(id, _)| id.to_string()).collect();
        let refusal = Diagnostic::new(codes::E0818, format!("the chain has no error `{}`", shown(name)));
        refusal.help(did_you_mean(name, &known.iter().map(String::as_str).collect::<Vec<_>>()))
    })
}

fn location_error(machine: &Machine, name: &str) -> Result<ErrorId, Diagnostic> {
    let error = error_of(machine, name)?;
    if error.family == ErrorFamily::Location {
        return Ok(error);
    }
    let has_curve = machine.errors().any(|(id, term)| id == error && matches!(term, ErrorTerm::Component(_)));
    let what = if has_curve { "is a curve" } else { "is a component error" };
    let help = "constants stand for location errors; `with_` changes curves";
    Err(Diagnostic::new(codes::E0818, format!("{error} {what}, and a constant does not stand for it")).help(help))
}
