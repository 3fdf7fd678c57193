//! A fitted machine as a machine file: self-contained, no `extends`, no tables outside.

use super::model::{BasisFunction, Parameter, ParameterTerm};
use super::solve::{FormUncertainty, Solution};
use crate::identify::thresholds::UNCERTAINTY_SITES;
use crate::lower::{ErrorSite, Source};
use crate::machine::{
    Approach, Axis, ComponentError, Curve, Direction, ErrorFamily, ErrorTerm, JointErrors, JointUncertainty, Machine,
    MachineParts, UnheldMotion, machine_file,
};
use crate::syntax::IdentifyEntry;
use crate::units::significant;
use std::collections::BTreeMap;

/// Entries of a fitted file beside the machine.
#[derive(Debug, Clone, Copy)]
pub struct FileNotes<'a> {
    /// Further entries of the section `provenance` (single lines).
    pub provenance: &'a [(String, String)],
    /// The section `identify`: what was fitted, for the next time.
    pub request: &'a IdentifyEntry,
    /// Writes the joint covariance of the parameters. Without it only each error's own uncertainty is stated.
    pub joint: bool,
    /// The forms of the axes beside the fitted curves; `None` if the readings cannot show any.
    pub form: Option<&'a FormUncertainty>,
    /// Rigid motions of the workpiece frame that the readings do not hold.
    pub unheld: &'a [UnheldMotion],
    /// Ranges (mm, deg) in which the fitted curves of each axis were measured, where that is less than the travel.
    pub measured: &'a [Option<(f64, f64)>],
}

/// Returns the text of a machine file with the fitted values and expanded uncertainties (k = 2, wider for few residual
/// degrees of freedom; of a curve the largest over the travel). Everything else is as in `machine`.
pub fn fitted_file(machine: &Machine, parameters: &[Parameter], solution: &Solution, notes: FileNotes<'_>) -> String {
    let mut parts = machine.to_parts();
    let solution = &solution.clone().with_student_scatter(parameters);
    for ((place, direction), curves) in curves_of(parameters, &solution.theta()) {
        set_error(&mut parts, place, direction, curves);
        let half = expanded_uncertainty(machine, parameters, solution, Source { place, direction });
        let Some(error) = (Source { place, direction }).error(machine) else { continue };
        parts.covariance.iter_mut().for_each(|part| part.remove(&error));
        let _ = match half {
            Some(half) => parts.uncertainty.insert(error, half),
            None => parts.uncertainty.remove(&error),
        };
    }
    let keeps_earlier = parts.covariance.iter().any(|part| !part.is_empty());
    if notes.joint {
        let columns = solution.covariance_factor(parameters.len());
        let part = |column: &Vec<f64>| joint_part(machine, parameters, column);
        let fitted: Vec<JointUncertainty> = columns.iter().map(part).collect();
        parts.covariance.retain(|part| !part.is_empty());
        if let Some(form) = notes.form {
            parts.forms.retain(|known| !form.examined_axes.contains(&known.axis));
            parts.forms.extend(form.forms.iter().cloned());
        }
        // Beyond the readings a curve that only its slope bounds hold is as good as unknown.
        if fitted.iter().all(|part| is_plausible(part, machine)) {
            parts.covariance.extend(fitted);
        }
    }
    let is_curved =
        |i: usize| parameters.iter().flat_map(|p| &p.terms).any(|t| t.source.place == ErrorSite::Component(i));
    for (_, (axis, range)) in machine.axes().iter().zip(notes.measured).enumerate().filter(|(i, _)| is_curved(*i)) {
        let _ = match range {
            Some(range) => parts.measured.insert(axis.name.clone(), *range),
            None => parts.measured.remove(&axis.name),
        };
    }
    // What of an earlier fit stays has the frame of its readings.
    if !keeps_earlier {
        parts.unheld.clear();
    }
    let known = parts.unheld.clone();
    parts.unheld.extend(notes.unheld.iter().filter(|motion| !known.contains(motion)));
    for (i, axis) in machine.axes().iter().enumerate() {
        parts.geometry.follow(&axis.name, machine.axis_errors(i), &parts.errors[i]);
    }
    machine_file(&parts, notes.provenance) + &identify_section(notes.request)
}

/// Returns the curves that the parameters make together with these values, by error.
fn curves_of(parameters: &[Parameter], values: &[f64]) -> BTreeMap<(ErrorSite, Direction), CurvesByApproach> {
    let mut curves: BTreeMap<(ErrorSite, Direction), CurvesByApproach> = BTreeMap::new();
    for (parameter, value) in parameters.iter().zip(values) {
        // A tool as it was clamped for some readings is no part of the machine.
        for term in parameter.terms.iter().filter(|term| term.only.is_none()) {
            let sum = &mut curves.entry((term.source.place, term.source.direction)).or_default()
                [approach_index(term.approach)];
            *sum = Some(add_basis(sum.take(), &term.basis, *value * term.factor));
        }
    }
    curves
}

/// Returns the changes of errors by one standard uncertainty of an independent part, `amounts` by parameter.
fn joint_part(machine: &Machine, parameters: &[Parameter], amounts: &[f64]) -> JointUncertainty {
    let mut joint = JointUncertainty::default();
    for ((place, direction), curves) in curves_of(parameters, amounts) {
        let constant = curves[0].as_ref().map_or(0.0, |curve| curve.value(0.0));
        let index = direction.index();
        match (place, Source { place, direction }.error(machine)) {
            (ErrorSite::Tool, _) => joint.setup.tool[index % 3] = constant,
            (ErrorSite::Workpiece, _) => joint.setup.workpiece[index] = constant,
            (_, Some(error)) => {
                let term = match error.family {
                    ErrorFamily::Location => ErrorTerm::Constant(constant),
                    ErrorFamily::Component => ErrorTerm::Component(component(None, curves)),
                };
                joint.errors.entry(error.axis).or_default().six_mut(error.family)[index] = Some(term);
            }
            (_, None) => {}
        }
    }
    joint
}

/// True if no error that the part changes would be refused, with a factor of two for positions between the sites.
fn is_plausible(part: &JointUncertainty, machine: &Machine) -> bool {
    let small = |axis: &Axis, direction: Direction, term: &ErrorTerm| {
        let both = |q: f64| [Approach::Forward, Approach::Reverse].map(|from| term.value(&from.at_position(q)).abs());
        sites(machine, Some(axis))
            .into_iter()
            .flat_map(both)
            .all(|size| size <= 0.5 * crate::machine::largest(direction))
    };
    let errors = |axis: &Axis| part.errors.get(&axis.name).into_iter().flat_map(JointErrors::iter).collect::<Vec<_>>();
    machine.axes().iter().all(|axis| errors(axis).into_iter().all(|(_, direction, term)| small(axis, direction, term)))
}

/// Returns even positions (mm or deg) over the range in which the curves of an axis are judged; one of a spindle.
fn sites(machine: &Machine, axis: Option<&Axis>) -> Vec<f64> {
    axis.map_or_else(
        || vec![0.0],
        |axis| {
            let (min, max) = machine.judged_range(axis);
            (0..UNCERTAINTY_SITES).map(|i| min + (max - min) * i as f64 / (UNCERTAINTY_SITES - 1) as f64).collect()
        },
    )
}

/// Returns the expanded uncertainty (mm or rad, k = 2) of a fitted error, to three digits: the largest over the travel
/// and both directions. `None` if the data leave it free somewhere.
fn expanded_uncertainty(
    machine: &Machine,
    parameters: &[Parameter],
    solution: &Solution,
    source: Source,
) -> Option<f64> {
    let (largest, _) = largest_uncertainty(machine, parameters, solution, source)?;
    let half: f64 = significant(2.0 * largest, 3).parse().ok()?;
    // An uncertainty above the largest error of any machine is not stated.
    (half > 0.0 && half <= crate::machine::largest(source.direction)).then_some(half)
}

/// Returns the largest standard uncertainty (mm or rad) of a fitted error over the travel and both directions, and the
/// position (mm or deg) where it is. `None` if the data leave the error free somewhere.
pub fn largest_uncertainty(
    machine: &Machine,
    parameters: &[Parameter],
    solution: &Solution,
    source: Source,
) -> Option<(f64, f64)> {
    let axis = if let ErrorSite::Component(axis) = source.place { machine.axes().get(axis) } else { None };
    let sites = sites(machine, axis);
    let at = |q: f64, from: Approach| {
        let mine = |t: &&ParameterTerm| t.source == source && (t.approach == from || t.approach == Approach::Mean);
        let factor = |p: &Parameter| p.terms.iter().filter(mine).map(|t| t.factor * t.basis.value(q)).sum::<f64>();
        let sum: Vec<(usize, f64)> = parameters.iter().map(factor).enumerate().collect();
        solution.uncertainty(&sum)
    };
    let both = sites.iter().flat_map(|q| [at(*q, Approach::Forward), at(*q, Approach::Reverse)].map(|u| (u, *q)));
    let larger = |a: Option<(f64, f64)>, b: Option<(f64, f64)>| {
        let (a, b) = (a?, b?);
        Some(if b.0 > a.0 { b } else { a })
    };
    both.map(|(u, q)| Some((u?, q))).reduce(larger).flatten()
}

/// Returns the section `identify` in JSON, which is YAML; empty for an empty request.
fn identify_section(request: &IdentifyEntry) -> String {
    match serde_json::to_string(request) {
        Ok(text) if *request != IdentifyEntry::default() => format!("identify: {text}\n"),
        _ => String::new(),
    }
}

/// Curves of mean, forward and reverse approach, as far as they were fitted.
type CurvesByApproach = [Option<Curve>; 3];

/// Returns the index of an approach in [`CurvesByApproach`].
fn approach_index(approach: Approach) -> usize {
    match approach {
        Approach::Mean => 0,
        Approach::Forward => 1,
        Approach::Reverse => 2,
    }
}

/// Sets a fitted error. A location error that the file does not have and that is fitted as 0 stays away.
fn set_error(parts: &mut MachineParts, place: ErrorSite, direction: Direction, curves: CurvesByApproach) {
    let constant = curves[0].as_ref().map_or(0.0, |curve| curve.value(0.0));
    let index = direction.index();
    match place {
        ErrorSite::Tool => parts.setup.tool[index % 3] = constant,
        ErrorSite::Workpiece => parts.setup.workpiece[index] = constant,
        ErrorSite::Location(joint) => {
            let slot = &mut parts.errors[joint].location[index];
            if slot.is_some() || constant != 0.0 {
                *slot = Some(ErrorTerm::Constant(constant));
            }
        }
        ErrorSite::Component(axis) => {
            let slot = &mut parts.errors[axis].component[index];
            *slot = Some(ErrorTerm::Component(component(slot.take(), curves)));
        }
    }
}

/// Returns a fitted component error; a direction that was not fitted keeps the curve of the file.
fn component(known: Option<ErrorTerm>, [mean, forward, reverse]: CurvesByApproach) -> ComponentError {
    let kept = match known {
        Some(ErrorTerm::Component(ComponentError::Single(curve))) => [curve.clone(), curve],
        Some(ErrorTerm::Component(ComponentError::Bidirectional { forward, reverse })) => [forward, reverse],
        _ => [Curve::Polynomial(vec![0.0]), Curve::Polynomial(vec![0.0])],
    };
    let [before, behind] = kept;
    match mean {
        Some(mean) => ComponentError::Single(mean),
        None => {
            ComponentError::Bidirectional { forward: forward.unwrap_or(before), reverse: reverse.unwrap_or(behind) }
        }
    }
}

/// Adds `amount` of a basis function to a curve.
fn add_basis(known: Option<Curve>, basis: &BasisFunction, amount: f64) -> Curve {
    match basis {
        BasisFunction::Constant => add_power(known, 0, amount),
        BasisFunction::Power(k) => add_power(known, usize::from(*k), amount),
        BasisFunction::Cosine(k) => add_harmonic(known, usize::from(*k), amount, 0.0),
        BasisFunction::Sine(k) => add_harmonic(known, usize::from(*k), 0.0, amount),
        BasisFunction::Spline(curve) => add_spline(known, curve, amount),
    }
}

fn add_power(known: Option<Curve>, k: usize, amount: f64) -> Curve {
    let mut c = if let Some(Curve::Polynomial(c)) = known { c } else { Vec::new() };
    c.resize(c.len().max(k + 1), 0.0);
    c[k] += amount;
    Curve::Polynomial(c)
}

fn add_harmonic(known: Option<Curve>, k: usize, cosine: f64, sine: f64) -> Curve {
    let mut orders = if let Some(Curve::Harmonics(orders)) = known { orders } else { Vec::new() };
    orders.resize(orders.len().max(k + 1), (0.0, 0.0));
    orders[k] = (orders[k].0 + cosine, orders[k].1 + sine);
    Curve::Harmonics(orders)
}

/// Adds splines through the same knots knot by knot.
fn add_spline(known: Option<Curve>, one: &Curve, amount: f64) -> Curve {
    if let Curve::BSpline(one) = one {
        let before = if let Some(Curve::BSpline(known)) = &known { known.coefficients() } else { &[] };
        let sum = |(i, c): (usize, &f64)| before.get(i).unwrap_or(&0.0) + amount * c;
        return Curve::BSpline(Box::new(one.with_coefficients(one.coefficients().iter().enumerate().map(sum))));
    }
    let Some(knots) = one.knots() else { return one.clone() };
    let before = known.as_ref().and_then(Curve::knots);
    let value = |i: usize| before.map_or(0.0, |k| k.values()[i]) + amount * knots.values()[i];
    let points: Vec<(f64, f64)> = knots.positions().iter().enumerate().map(|(i, q)| (*q, value(i))).collect();
    let smooth = matches!(one, Curve::Cubic(..));
    let through = |knots| if smooth { Curve::cubic(knots) } else { Curve::Linear(knots) };
    crate::machine::Knots::new(&points, knots.period()).map_or_else(|_| one.clone(), through)
}
