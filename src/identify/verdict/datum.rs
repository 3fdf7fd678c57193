//! The datum of a fit as a value, and a table of all fitted errors in it.

use super::fitted::FitDiagnosis;
use crate::analysis::LocationSet;
use crate::identify::thresholds::ERROR_SITES;
use crate::identify::{DatumConditions, Estimate, Parameter, largest_uncertainty};
use crate::lower::{ErrorSite, Source};
use crate::machine::{Approach, Machine};
use crate::syntax::IdentifyEntry;
use serde::Serialize;

/// A fitted error over the travel of its axis.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct FittedError {
    /// ISO name.
    pub error: String,
    /// Smallest value, in `unit`.
    pub smallest: f64,
    /// Largest value, in `unit`; that of a location error is its only one.
    pub largest: f64,
    /// False if the readings leave one of its parameters free.
    pub determined: bool,
    /// Largest standard uncertainty, in `unit`; none if the data leave the error free somewhere.
    pub sigma: Option<f64>,
    /// `um` or `urad`.
    pub unit: String,
}

/// The conditions that a request asks for; location errors that are redundant beside others are named.
pub(crate) fn conditions(machine: &Machine, request: &IdentifyEntry, own: &[Parameter]) -> DatumConditions {
    let members: Vec<String> = LocationSet::of(machine).members.iter().map(|(id, _)| id.to_string()).collect();
    let location = |p: &&Parameter| matches!(p.terms.first().map(|t| t.source.place), Some(ErrorSite::Location(_)));
    let redundant = own.iter().filter(location).map(|p| p.name.clone()).filter(|name| !members.contains(name));
    DatumConditions { entry: request.datum.unwrap_or_default(), redundant_locations: redundant.collect() }
}

/// Every fitted error of an axis or the spindle.
pub(crate) fn errors(fitted: &FitDiagnosis<'_>) -> Vec<FittedError> {
    let own = &fitted.unknowns[..fitted.own];
    let mut sources: Vec<Source> = Vec::new();
    for term in own.iter().flat_map(|p| &p.terms) {
        let error = matches!(term.source.place, ErrorSite::Location(_) | ErrorSite::Component(_));
        if error && !sources.contains(&term.source) {
            sources.push(term.source);
        }
    }
    sources.into_iter().filter_map(|source| error(fitted, source)).collect()
}

fn error(fitted: &FitDiagnosis<'_>, source: Source) -> Option<FittedError> {
    let own = &fitted.unknowns[..fitted.own];
    let machine = fitted.machine;
    let id = source.error(machine)?;
    let axis = if let ErrorSite::Component(axis) = source.place { machine.axes().get(axis) } else { None };
    let interval = axis.map_or((0.0, 0.0), |axis| machine.judged_range(axis));
    let value = |q: f64, from: Approach| -> f64 {
        let estimates = own.iter().zip(&fitted.solution.estimates);
        let mine =
            |t: &&crate::identify::ParameterTerm| t.source == source && [from, Approach::Mean].contains(&t.approach);
        let part = |p: &Parameter| p.terms.iter().filter(mine).map(|t| t.factor * t.basis.value(q)).sum::<f64>();
        estimates.map(|(p, e)| e.value * part(p)).sum()
    };
    let site = |i: usize| interval.0 + (interval.1 - interval.0) * i as f64 / (ERROR_SITES - 1) as f64;
    let values = (0..ERROR_SITES).flat_map(|i| [Approach::Forward, Approach::Reverse].map(|from| value(site(i), from)));
    let (smallest, largest) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (v.min(low), v.max(high)));
    let (factor, unit) = source.direction.micro();
    let sigma = largest_uncertainty(machine, own, &fitted.solution, source).map(|(sigma, _)| sigma * factor);
    let (smallest, largest) = (smallest * factor + 0.0, largest * factor + 0.0);
    let is_free =
        |(p, of): (&Parameter, &Estimate)| p.terms.iter().any(|t| t.source == source) && of.observability == 0.0;
    let determined = !own.iter().zip(&fitted.solution.estimates).any(is_free);
    Some(FittedError { error: id.to_string(), smallest, largest, determined, sigma, unit: unit.to_owned() })
}
