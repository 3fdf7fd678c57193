//! Advice for a fit that is refused: which parameters may keep the values of the file, found by fitting without them.

use super::diagnose::diagnose;
use super::fitted::FitDiagnosis;
use super::inputs::FitInputs;
use super::problem::Problem;
use super::remarks;
use crate::identify::thresholds::{MAX_ADVISED_FIXED, MAX_FIXING_COST};
use crate::identify::{Invariances, Parameter, ParameterFit, invariances, solve};
use crate::job::machine_file::MachineFile;
use crate::units::significant;

/// Returns `--fixed LIST` with which the machine file is written, and what it costs; `None` if fixing a few of the
/// parameters that are noise does not suffice, or costs more than a little of the residuals.
pub(crate) fn fixing(
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    problem: &Problem,
    fitted: &FitDiagnosis<'_>,
) -> Option<String> {
    let mut fixed: Vec<String> = Vec::new();
    let mut noise = remarks::wide_constants(fitted);
    for _ in 0..MAX_ADVISED_FIXED {
        let trial = |parameter: &&Parameter| {
            let names: Vec<String> = fixed.iter().chain([&parameter.name]).cloned().collect();
            let rest = problem.without(&names);
            let fit = solve(&rest.model(file, inputs.order), &rest.rows, inputs.robust);
            (names, fit)
        };
        let left = |fit: &ParameterFit| fit.reduced.right_norm();
        let nearer = |a: (Vec<String>, ParameterFit), b: (Vec<String>, ParameterFit)| {
            if left(&b.1) < left(&a.1) { b } else { a }
        };
        let (names, fit) = noise.iter().map(trial).reduce(nearer)?;
        let rest = problem.without(&names);
        let model = rest.model(file, inputs.order);
        let found = invariances(&model, &rest.rows, &fit.theta);
        let (judged, _) = diagnose(&model, file, &rest, found, fit);
        let [before, after] = [fitted, &judged].map(|fit| fit.residuals.after);
        if after > MAX_FIXING_COST * before {
            return None;
        }
        if remarks::undetermined_values(&judged).is_none() && remarks::uncertain_prediction(&judged).is_none() {
            let list = inputs.fixed.iter().cloned().chain(names).collect::<Vec<_>>().join(",");
            let [before, after] = [before, after].map(|rms| significant(rms * 1e3, 5));
            return Some(format!("`--fixed {list}` leaves {after} um instead of {before} um"));
        }
        let wide: Vec<&str> = remarks::wide_constants(&judged).iter().map(|p| p.name.as_str()).collect();
        noise = problem.unknowns.iter().filter(|p| wide.contains(&p.name.as_str())).collect();
        fixed = names;
    }
    None
}

/// Returns parameters with which, held at the values of the file, the size of the machine is held at the start and at
/// the solution, as `--fixed` takes them; `None` if a few do not suffice.
pub(crate) fn holding_size(
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    problem: &Problem,
    found: &Invariances,
) -> Option<String> {
    let mut fixed: Vec<String> = Vec::new();
    let (_, mut names) = found.stretches.first()?.clone();
    for _ in 0..MAX_ADVISED_FIXED {
        let trial = |name: &String| {
            let names: Vec<String> = fixed.iter().chain([name]).cloned().collect();
            let rest = problem.without(&names);
            let model = rest.model(file, inputs.order);
            (invariances(&model, &rest.rows, &model.start()).stretches, names)
        };
        let (mut stretches, with) = names.iter().map(trial).min_by_key(|(stretches, _)| stretches.len())?;
        fixed = with;
        if stretches.is_empty() {
            let rest = problem.without(&fixed);
            let model = rest.model(file, inputs.order);
            let fit = solve(&model, &rest.rows, inputs.robust);
            stretches = invariances(&model, &rest.rows, &fit.theta).stretches;
        }
        match stretches.into_iter().next() {
            Some((_, more)) => names = more,
            None => return Some(inputs.fixed.iter().cloned().chain(fixed).collect::<Vec<_>>().join(",")),
        }
    }
    None
}
