//! The ball of relative readings rests on the workpiece while rotary axes turn and linear axes follow. Where the
//! machine file lets it wander, an origin or the tool of the file is not that of the machine.

use super::fitted::FitDiagnosis;
use crate::diagnostic::{Diagnostic, codes};
use crate::identify::data::rotation_to;
use crate::identify::thresholds::{MAX_RESTING_SHARE, MIN_WANDER_MM};
use crate::identify::{BasisFunction, FitModel, Measurement, Parameter, Reading};
use crate::lower::{ErrorSite, NominalPose, Source};
use crate::machine::{AxisKind, Direction, Machine};
use crate::units::significant;
use nalgebra::{Matrix3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// A reading relative to the first of its run.
struct Relative<'a> {
    m: &'a Measurement,
    /// The unknown that its run has.
    run: usize,
    /// Nominal functional point (mm, workpiece frame).
    place: Vector3<f64>,
}

/// Names the points of the machine file of which another one would let wandering balls rest.
pub(crate) fn wandering(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let rows = relative(fitted);
    let runs: Vec<usize> = rows.iter().map(|row| row.run).collect();
    let places: Vec<Vector3<f64>> = rows.iter().map(|row| row.place).collect();
    let wander = about_means(&places, &runs);
    let before = rms(&wander);
    if rows.len() < 4 || before < MIN_WANDER_MM {
        return None;
    }
    let machine = fitted.machine;
    let rotary = (0..machine.axes().len()).filter(|i| machine.axes()[*i].kind == AxisKind::Rotary);
    let points = rotary.map(ErrorSite::Location).chain([ErrorSite::Tool]);
    let shifted = points.map(|point| {
        let columns: Vec<Vec<Vector3<f64>>> =
            effects(fitted, &rows, point).iter().map(|column| about_means(column, &runs)).collect();
        let dot = |a: &[Vector3<f64>], b: &[Vector3<f64>]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
        let normal = Matrix3::from_fn(|i, k| dot(&columns[i], &columns[k]));
        let force = Vector3::from_fn(|i, _| -dot(&columns[i], &wander));
        // What the point does not move has no share.
        let parts = normal.symmetric_eigen();
        let least = 1e-9 * parts.eigenvalues.amax();
        let pairs = parts.eigenvalues.iter().zip(parts.eigenvectors.column_iter());
        let felt = pairs.filter(|(value, _)| **value > least);
        let shift: Vector3<f64> = felt.map(|(value, way)| way * (way.dot(&force) / value)).sum();
        let moved = |i: usize| (0..3).map(|k| columns[k][i] * shift[k]).sum::<Vector3<f64>>();
        let rest: Vec<Vector3<f64>> = wander.iter().enumerate().map(|(i, v)| v + moved(i)).collect();
        (point, shift, rms(&rest))
    });
    let rests = shifted.filter(|(.., left)| *left <= MAX_RESTING_SHARE * before);
    let words = rests.map(|(point, shift, _)| {
        let by: Vec<String> = shift.iter().map(|x| significant(libm::round(x * 100.0) / 100.0 + 0.0, 6)).collect();
        let what = match point {
            ErrorSite::Location(i) => format!("the origin of {}", machine.axes()[i].name),
            _ => "the tip of the tool".to_owned(),
        };
        format!("{what} moved by [{}] mm", by.join(", "))
    });
    let words: Vec<String> = words.collect();
    if words.is_empty() {
        return None;
    }
    let message = format!(
        "the nominal tip wanders by {} mm in runs of relative readings: the ball would rest with {}",
        significant(before, 3),
        words.join(", or with ")
    );
    let help = "compare origins and length of the tool with the machine on which the readings were taken";
    Some(Diagnostic::new(codes::W0520, message).help(help))
}

/// Returns the relative readings of runs in which rotary axes turn.
fn relative<'a>(fitted: &'a FitDiagnosis<'_>) -> Vec<Relative<'a>> {
    let is_run = |index: usize| {
        let name = fitted.unknowns.get(fitted.own + index).map_or("", |unknown| unknown.name.as_str());
        !name.rsplit('/').next().unwrap_or(name).starts_with("ball")
    };
    let machine = fitted.machine;
    let with = |name: &str| machine.with_tool(name).unwrap_or_else(|| machine.clone());
    let machines: Vec<Machine> = machine.tools().iter().map(|tool| with(&tool.name)).collect();
    let row = |m: &'a Measurement| {
        let Reading::Deviation { zero, .. } = &m.reading else { return None };
        let run = zero.iter().flatten().next().copied().filter(|run| is_run(*run))?;
        let place = NominalPose::in_part(&machines[m.tool], &m.pose).pose.translation;
        Some(Relative { m, run, place })
    };
    let mut rows: Vec<Relative<'a>> = fitted.data.iter().filter_map(row).collect();
    let rotary = |m: &Measurement| -> Vec<f64> {
        let all = machine.axes().iter().zip(&m.pose);
        all.filter(|(axis, _)| axis.kind == AxisKind::Rotary).map(|(_, q)| *q).collect()
    };
    let (mut first, mut turning) = (BTreeMap::new(), BTreeSet::new());
    for row in &rows {
        let at = rotary(row.m);
        if *first.entry(row.run).or_insert_with(|| at.clone()) != at {
            let _ = turning.insert(row.run);
        }
    }
    rows.retain(|row| turning.contains(&row.run));
    rows
}

/// Returns what displacements (mm) of a point by X, Y and Z do to the places, a column each.
fn effects(fitted: &FitDiagnosis<'_>, rows: &[Relative<'_>], point: ErrorSite) -> [Vec<Vector3<f64>>; 3] {
    let machine = fitted.machine;
    let one = |k: usize| {
        let source = Source { place: point, direction: Direction::ALL[k] };
        Parameter::single(machine, format!("{k}"), source, BasisFunction::Constant, 0.0)
    };
    let list: Vec<Parameter> = (0..3).map(one).chain(fitted.unknowns[fitted.own..].iter().cloned()).collect();
    let (model, theta) = (FitModel::new(machine, &list), vec![0.0; list.len()]);
    let mut columns: [Vec<Vector3<f64>>; 3] = Default::default();
    for row in rows {
        let (of, _) = model.rows(row.m, &theta);
        let frame = match row.m.reading {
            Reading::Deviation { frame, .. } => frame,
            _ => continue,
        };
        let turn = rotation_to(frame, &NominalPose::in_part(model.machine(row.m), &row.m.pose));
        columns.iter_mut().zip(of).for_each(|(column, effect)| column.push(turn.transpose() * effect));
    }
    columns
}

/// Returns the vectors less the mean of those of their run.
fn about_means(of: &[Vector3<f64>], runs: &[usize]) -> Vec<Vector3<f64>> {
    let mut sums: BTreeMap<usize, (Vector3<f64>, f64)> = BTreeMap::new();
    for (v, run) in of.iter().zip(runs) {
        let (sum, count) = sums.entry(*run).or_insert((Vector3::zeros(), 0.0));
        (*sum, *count) = (*sum + v, *count + 1.0);
    }
    of.iter().zip(runs).map(|(v, run)| v - sums.get(run).map_or_else(Vector3::zeros, |(sum, n)| sum / *n)).collect()
}

fn rms(of: &[Vector3<f64>]) -> f64 {
    libm::sqrt(of.iter().map(Vector3::norm_squared).sum::<f64>() / of.len().max(1) as f64)
}
