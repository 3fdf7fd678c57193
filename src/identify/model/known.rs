//! Values that are known before the data, each with a standard uncertainty: `ball b1 50 um`, `EC0Y 5 urad`,
//! `constant S = 150 mm 1 um`.

use super::parameter::{BasisFunction, Parameter, source};
use super::refusal::Refusal;
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::machine::Machine;
use crate::units::{self, Dimension, Quantity};

/// An unknown whose value is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PriorValue {
    /// Index among the unknowns.
    pub unknown: usize,
    /// Value (mm, rad, degrees of position).
    pub value: f64,
    /// Standard uncertainty of the value, in its unit; above 0.
    pub sigma: f64,
}

/// The word for the uncertainties that the machine file states of its constants.
const FILE: &str = "file";
const COORDINATES: [&str; 3] = [".x", ".y", ".z"];
/// Coverage factor of the uncertainties of machine files.
const FILE_COVERAGE_FACTOR: f64 = 2.0;

const HELP: &str = "write a name of the report and a standard uncertainty: `ball b1 50 um` (all three coordinates), \
                    `station S.x 0.1 mm`, `EC0Y 5 urad`, `constant S = 150 mm 1 um`; or `file` for the \
                    uncertainties that the machine file states";

pub(super) fn refusal(message: String, help: impl Into<String>) -> Refusal {
    Box::new(Diagnostic::new(codes::E0516, message).help(help.into()))
}

/// Reads a prior in words. Values are known about where the unknowns start, unless the words say another one.
pub fn parse_prior(words: &str, machine: &Machine, unknowns: &[Parameter]) -> Result<Vec<PriorValue>, Refusal> {
    if words.trim() == FILE {
        return Ok(priors_of_file(machine, unknowns));
    }
    let said = shown(words);
    let unreadable = || refusal(format!("the prior `{said}` has no uncertainty that can be read"), HELP);
    let (name, value, sigma) = match words.split_once('=') {
        Some((name, rest)) => {
            let (value, sigma) = value_and_sigma(rest).ok_or_else(unreadable)?;
            (name.trim().to_owned(), Some(value), sigma)
        }
        None => {
            let (name, sigma) = name_and_sigma(words).ok_or_else(unreadable)?;
            (name, None, sigma)
        }
    };
    let found = matching_unknowns(&name, unknowns);
    if found.is_empty() {
        let names: Vec<&str> = unknowns.iter().map(|p| p.name.as_str()).collect();
        let message = format!("the prior `{said}` names nothing that is fitted");
        return Err(refusal(message, did_you_mean(&name, &names)));
    }
    if value.is_some() && found.len() > 1 {
        return Err(refusal(format!("the prior `{said}` gives one value to {} unknowns", found.len()), HELP));
    }
    let one = |unknown: usize| {
        let parameter = &unknowns[unknown];
        let of_kind = |quantity: &Quantity| in_parameter_unit(parameter, quantity);
        let misfit = || refusal(format!("the prior `{said}`: `{}` is in {}", parameter.name, parameter.unit), HELP);
        let sigma = of_kind(&sigma).ok_or_else(misfit)?;
        let value = value.as_ref().map_or(Some(parameter.start), of_kind).ok_or_else(misfit)?;
        if sigma.is_nan() || sigma <= 0.0 {
            return Err(refusal(format!("the prior `{said}`: an uncertainty is above zero"), HELP));
        }
        Ok(PriorValue { unknown, value, sigma })
    };
    found.into_iter().map(one).collect()
}

/// Returns the constants with an uncertainty in the machine file.
fn priors_of_file(machine: &Machine, unknowns: &[Parameter]) -> Vec<PriorValue> {
    let stated = machine.errors().filter(|(id, _)| id.is_location());
    let stated =
        stated.filter_map(|(id, _)| Some((source(machine, &id), machine.uncertainty(&id)? / FILE_COVERAGE_FACTOR)));
    let one = |(of, sigma): (crate::lower::Source, f64)| {
        let unknown = unknowns.iter().position(|p| match &p.terms[..] {
            [term] => term.source == of && term.basis == BasisFunction::Constant,
            _ => false,
        })?;
        (sigma > 0.0).then(|| PriorValue { unknown, value: unknowns[unknown].start, sigma })
    };
    stated.filter_map(one).collect()
}

/// Returns the unknowns of a name: one as the report names it, or the three coordinates of a point. Points of several
/// runs have the words of their run between: `ball am b1`.
fn matching_unknowns(name: &str, unknowns: &[Parameter]) -> Vec<usize> {
    let bare = |full: &str| full.rsplit_once('/').map_or(full, |(_, bare)| bare).to_owned();
    let all = |fits: &dyn Fn(&str, bool) -> bool| -> Vec<usize> {
        let of = |p: &Parameter| fits(&p.name, false) || (p.is_nuisance() && fits(&bare(&p.name), true));
        (0..unknowns.len()).filter(|j| of(&unknowns[*j])).collect()
    };
    let exact = all(&|full, _| full == name);
    if !exact.is_empty() {
        return exact;
    }
    let point = |full: &str| COORDINATES.iter().find_map(|end| full.strip_suffix(end)).map(str::to_owned);
    let whole = all(&|full, _| point(full).is_some_and(|point| point == name));
    if !whole.is_empty() {
        return whole;
    }
    let Some((first, last)) = name.split_once(' ') else { return Vec::new() };
    let between = |full: &str| {
        let point = point(full)?;
        let (head, tail) = (point.split(' ').next()?, point.rsplit(' ').next()?);
        Some(head == first && tail == last)
    };
    all(&|full, bare| bare && between(full) == Some(true))
}

fn name_and_sigma(words: &str) -> Option<(String, Quantity)> {
    let list: Vec<&str> = words.split_whitespace().collect();
    (1..=2).rev().find_map(|count| {
        let (name, quantity) = list.split_at_checked(list.len().checked_sub(count)?)?;
        let quantity = units::quantity(&quantity.join(" ")).ok()?;
        (!name.is_empty()).then(|| (name.join(" "), quantity))
    })
}

pub(super) fn value_and_sigma(words: &str) -> Option<(Quantity, Quantity)> {
    let words = words.replace("+/-", " ").replace("+-", " ").replace(['\u{b1}', ','], " ");
    let list: Vec<&str> = words.split_whitespace().collect();
    (1..list.len()).find_map(|cut| {
        let (value, sigma) = list.split_at(cut);
        Some((units::quantity(&value.join(" ")).ok()?, units::quantity(&sigma.join(" ")).ok()?))
    })
}

/// Returns a quantity in the unit in which a parameter is kept; `None` if it is of another kind.
fn in_parameter_unit(parameter: &Parameter, quantity: &Quantity) -> Option<f64> {
    let unit = units::quantity(&format!("1 {}", parameter.unit)).ok()?;
    let ratio = quantity.dimension == Dimension::RATIO && unit.dimension == Dimension::ANGLE;
    (ratio || quantity.dimension == unit.dimension).then(|| quantity.value / unit.value / parameter.factor)
}
